"""Computes electrostatic energies with APBS on the dielectric maps of eses-blocks.

With one PQR file, the result is its solvation energy: the difference between the molecule in the
solvent and in a medium with the dielectric of the solute. With several files, the result is the
binding energy of a complex (the first file) of the molecules in the other files. All calculations
use one grid, which fits APBS's multigrid solver. With --coarse-padding, a coarse and larger grid
gives the potential at its faces.

Energies are in kJ/mol. doc/poisson-boltzmann.md explains the method and its accuracy.
"""

import sys

from eses_tools import quiet_interrupt  # before the modules that take time to load

import argparse
import contextlib
import csv
import json
import math
import pathlib
import shutil
import tempfile

from eses_tools.common import (NAME, Failed, Parser, at_least, complete_file,
                               describe_build, end_with, input_file, printable, require_writable,
                               require_output, say, show)
from eses_tools import poisson_boltzmann as pb

LABELS = {pb.ESES: "eses-blocks", pb.MOL: "srfm mol", pb.SMOL: "srfm smol"}


# ------------------------------------------------------------------------------------- messages


def size_text(value):
    return f"{value / 1e9:.1f} GB" if value >= 1e9 else f"{max(1, round(value / 1e6))} MB"


def time_text(seconds):
    if seconds < 90:
        return f"{max(1, round(seconds))} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def announce(grids, molecules, calculations, settings, is_memory_ignored):
    """Prints the memory, time and disk space of the run. Throws Failed if this machine has less
    memory, unless that is to be ignored."""
    memory, disk, seconds = pb.estimate(grids, molecules, calculations, settings)
    counts = " and ".join(" x ".join(map(str, grid.points)) for grid in grids)
    say(f"{counts} grid points, {len(calculations)} calculations: APBS takes about "
        f"{size_text(memory)} of memory and {time_text(seconds)}, the maps {size_text(disk)} of disk")
    available = pb.available_bytes()
    if available is not None and memory > available:
        problem = f"only {size_text(available)} of {size_text(memory)} of memory are available"
        if not is_memory_ignored:
            raise Failed(f"{problem}; use a larger --spacing or a smaller --padding, or start APBS "
                         "all the same with --ignore-memory")
        say(f"warning: {problem}")


# -------------------------------------------------------------------------------------- results


def grid_report(grid):
    lower = [center - pb.half_length(grid, axis) for axis, center in enumerate(grid.center)]
    return {"origin": lower, "center": grid.center, "points": grid.points, "spacing": grid.spacing}


def result_name(molecules):
    return "solvation_energy" if len(molecules) == 1 else "binding_energy"


def report(molecules, surfaces, calculations, grids, settings, result):
    """Returns the object that --json prints."""
    energies = [{"file": str(molecules[c.molecule].path), "surface": c.surface,
                 "energy": result.energies[c.name]} for c in calculations]
    return {
        "unit": "kJ/mol",
        "molecules": [{"file": str(molecule.path), "atoms": len(molecule.atoms),
                       "charge": round(math.fsum(atom.charge for atom in molecule.atoms), 6)}
                      for molecule in molecules],
        "grid": grid_report(grids[0]),
        "coarse_grid": grid_report(grids[1]) if len(grids) > 1 else None,
        "settings": {**settings._asdict(), "ions": [ion._asdict() for ion in settings.ions],
                     "ionic_strength": pb.ionic_strength(settings)},
        "energies": energies,
        result_name(molecules): {surface: pb.difference(molecules, surface, result.energies)
                                 for surface in surfaces},
        "apbs": {"seconds": round(result.seconds, 2), "peak_bytes": result.peak_bytes},
    }


def print_csv(done):
    """Prints the energies of a report as CSV, the result in the last lines."""
    kind = result_name(done["molecules"])
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(["quantity", "file", "surface", "energy_kj_mol"])
    for row in done["energies"]:
        writer.writerow(["total_energy", row["file"], row["surface"], row["energy"]])
    for surface, energy in done[kind].items():
        writer.writerow([kind, done["molecules"][0]["file"], surface, energy])


def table(molecules, surfaces, energies):
    """Returns rows of text: the total energies of all calculations, and their difference."""
    def row(label, values):
        return [label, *(f"{value:.2f}" for value in values)]

    def total(index, surface):
        return energies[f"{pb.molecule_name(index)}-{surface}"]

    rows = [["total electrostatic energy", *(LABELS[surface] for surface in surfaces)]]
    for index, molecule in enumerate(molecules):
        rows.append(row(printable(molecule.path.name) + " in the solvent",
                        [total(index, surface) for surface in surfaces]))
    if len(molecules) == 1:
        rows.append(row("reference", [total(0, pb.REFERENCE)] * len(surfaces)))
    rows.append(row("solvation energy" if len(molecules) == 1 else "binding energy",
                    [pb.difference(molecules, surface, energies) for surface in surfaces]))
    return rows


def print_table(rows):
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        print("  ".join([row[0].ljust(widths[0]),
                         *(text.rjust(width) for text, width in zip(row[1:], widths[1:]))]))


# --------------------------------------------------------------------------------- command line


def numbers(count, kind, text):
    values = [kind(word) for word in text.split(",")]
    if len(values) != count or not all(map(math.isfinite, values)):
        raise ValueError
    return tuple(values)


def place(text):
    """Converts text to three coordinates."""
    try:
        return numbers(3, float, text)
    except ValueError:
        raise argparse.ArgumentTypeError("expected X,Y,Z") from None


def ion(text):
    """Converts text to a kind of ions."""
    try:
        charge, molar = numbers(2, float, text)
    except ValueError:
        raise argparse.ArgumentTypeError("expected CHARGE,MOLAR") from None
    if charge == 0 or molar <= 0:
        raise argparse.ArgumentTypeError("expected a charge other than 0 and more than 0 mol/l")
    return pb.Ion(charge, molar)


def parse_options():
    above_zero = at_least(0, is_open=True)
    parser = Parser(__doc__, lead=2, usage=f"{NAME} [OPTION...] PQR...",
                    examples=(("1crn.pqr", "solvation energy of a molecule"),
                              ("ab.pqr a.pqr b.pqr", "binding energy of a complex"),
                              ("1crn.pqr --write-potential 1crn.dx", "the potential, for eses-view")),
                    advanced=("--grid-center", "--coarse-padding", "--coarse-spacing", "--ion", "--ion-radius",
                              "--temperature", "--bcfl", "--chgm", "--ignore-memory", "--program"))
    parser.add_argument("molecules", nargs="+", metavar="PQR", type=input_file,
                        help="molecule, or complex followed by its parts; .pqr or .pqr.gz")
    grid = parser.add_argument_group("grid")
    grid.add_argument("--spacing", type=above_zero, default=0.5, metavar="ANGSTROM",
                      help="distance between grid points (default: 0.5)")
    grid.add_argument("--padding", type=at_least(0), default=6.0, metavar="ANGSTROM",
                      help="minimum distance between the atoms' spheres and the faces of the grid "
                           "(default: 6)")
    grid.add_argument("--grid-center", type=place, metavar="X,Y,Z",
                      help="centre of the grid (default: the centre of the molecules)")
    grid.add_argument("--coarse-padding", type=above_zero, metavar="ANGSTROM",
                      help="solve on a coarse grid with this padding first, which gives the "
                           "potential at the faces of the grid")
    grid.add_argument("--coarse-spacing", type=above_zero, metavar="ANGSTROM",
                      help="distance between points of the coarse grid (default: twice --spacing)")
    model = parser.add_argument_group("model")
    model.add_argument("--probe-radius", type=above_zero, default=1.4, metavar="ANGSTROM",
                       help="radius of the solvent probe (default: 1.4)")
    model.add_argument("--solute-dielectric", type=above_zero, default=2.0, metavar="E",
                       help="relative permittivity inside the surface (default: 2)")
    model.add_argument("--solvent-dielectric", type=above_zero, default=78.54, metavar="E",
                       help="relative permittivity outside (default: 78.54)")
    model.add_argument("--equation", choices=("lpbe", "npbe"), default="lpbe",
                       help="linearized (the default) or nonlinear Poisson-Boltzmann equation")
    salt = model.add_mutually_exclusive_group()
    salt.add_argument("--ionic-strength", type=at_least(0), default=0.0, metavar="MOLAR",
                      help="concentration of a 1:1 salt (default: 0)")
    salt.add_argument("--ion", type=ion, action="append", default=[], metavar="CHARGE,MOLAR",
                      help="charge and concentration of one kind of ions, such as --ion=-2,0.05; "
                           "given for each kind, and together neutral")
    model.add_argument("--ion-radius", type=at_least(0), default=2.0, metavar="ANGSTROM",
                       help="distance that ions keep from the atoms' spheres (default: 2)")
    model.add_argument("--temperature", type=above_zero, default=298.15, metavar="KELVIN",
                       help="temperature (default: 298.15)")
    model.add_argument("--bcfl", choices=("zero", "sdh", "mdh"), default="mdh",
                       help="APBS's boundary condition (default: mdh)")
    model.add_argument("--chgm", choices=("spl0", "spl2", "spl4"), default="spl2",
                       help="how APBS spreads charges over grid points (default: spl2)")
    parser.add_argument("--compare", action="store_true",
                        help="also compute with APBS's own surfaces, srfm mol and srfm smol")
    output = parser.add_mutually_exclusive_group()
    output.add_argument("--json", action="store_true", help="print one JSON object")
    output.add_argument("--csv", action="store_true", help="print the energies as CSV")
    parser.add_argument("--write-potential", type=pathlib.Path, metavar="FILE.dx",
                        help="write the potential around the first molecule, in kT/e, as OpenDX; "
                             "also .dx.gz")
    parser.add_argument("--keep", metavar="DIR", type=pathlib.Path,
                        help="keep maps, input file and output of APBS in this folder")
    parser.add_argument("--ignore-memory", action="store_true",
                        help="start APBS even if it needs more memory than is available")
    parser.add_program()
    options = parser.parse_args()
    complete_options(parser, options)
    return options


def complete_options(parser, options):
    """Sets `ions` and `coarse_spacing`. Ends with exit code 2 if options contradict each other."""
    molar = options.ionic_strength
    options.ions = tuple(options.ion or (pb.Ion(charge, molar) for charge in (1, -1) if molar > 0))
    charges = [one.charge * one.molar for one in options.ions]
    if abs(math.fsum(charges)) > 1e-6 * math.fsum(map(abs, charges)):
        parser.error(f"the ions of --ion are not neutral together: {math.fsum(charges):+g} mol/l")
    if options.equation == "npbe" and not options.ions:
        parser.error("--equation npbe needs ions: --ionic-strength or --ion")
    if options.equation == "npbe" and options.coarse_padding is not None:
        parser.error("--equation npbe and --coarse-padding exclude each other: APBS's nonlinear "
                     "energy contains an integral over the whole solvent, and would take it over "
                     "the fine grid only")
    if options.coarse_padding is None and options.coarse_spacing is not None:
        parser.error("--coarse-spacing needs --coarse-padding")
    if options.coarse_padding is not None:
        options.coarse_spacing = options.coarse_spacing or 2 * options.spacing
        for name in ("spacing", "padding"):
            if getattr(options, f"coarse_{name}") <= getattr(options, name):
                parser.error(f"--coarse-{name} must be larger than --{name}")
    if (options.write_potential
            and not options.write_potential.name.lower().endswith((".dx", ".dx.gz"))):
        parser.error(f"--write-potential: {options.write_potential} does not end with .dx or "
                     ".dx.gz")


def make_grids(options, molecules):
    """Returns the grid, and the coarse one if there is one."""
    fine = pb.choose_grid(molecules, options.spacing, options.padding, options.grid_center)
    if options.coarse_padding is None:
        return [fine]
    return [fine, pb.choose_coarse_grid(molecules, fine, options.coarse_spacing,
                                        options.coarse_padding)]


def write_potential(folder, path):
    is_gzip = path.suffix.lower() == ".gz"
    with (open(pb.potential_file(folder), encoding="ascii") as source,
          complete_file(path, compressed=is_gzip, encoding="ascii") as target):
        shutil.copyfileobj(source, target)


def run(options, folder):
    settings = pb.Settings(options.probe_radius, options.solute_dielectric,
                           options.solvent_dielectric, options.ions, options.ion_radius,
                           options.temperature, options.bcfl, options.chgm, options.equation)
    molecules = [pb.read_molecule(path, options.program) for path in options.molecules]
    if len(molecules) > 1:
        pb.require_parts(molecules[0], molecules[1:])
    surfaces = [pb.ESES, *((pb.MOL, pb.SMOL) if options.compare else ())]
    calculations = pb.plan(molecules, surfaces)
    grids = make_grids(options, molecules)
    announce(grids, molecules, calculations, settings, options.ignore_memory)
    result = pb.compute(options.program, options.apbs, molecules, calculations, grids, settings,
                        folder, show, say, potential=options.write_potential is not None)
    if options.write_potential:
        write_potential(folder, options.write_potential)
    show("")
    if not (options.json or options.csv):
        print_table(table(molecules, surfaces, result.energies))
        return
    done = report(molecules, surfaces, calculations, grids, settings, result)
    if options.csv:
        print_csv(done)
    else:
        print(json.dumps(done, indent=1))


def main():
    options = parse_options()
    options.apbs = pb.find_apbs()
    describe_build(options.program)
    if options.write_potential:
        require_output(options.write_potential, options.molecules)
    with contextlib.ExitStack() as opened:
        folder = options.keep or opened.enter_context(tempfile.TemporaryDirectory(prefix="apbs-"))
        if options.keep:
            require_writable(options.keep)
            for path in pb.written_files(options.keep, len(options.molecules)):
                require_output(path, options.molecules)
        run(options, pathlib.Path(folder))


def start():
    end_with(main)
