"""Electrostatic energies of molecules from APBS, with dielectric maps made by eses-blocks.

All molecules of a run share one grid, and all energies are total electrostatic energies on it. With
focusing, a coarse grid gives the potential at the faces of this grid. `grids` is the list of both,
or of the one grid; the coarse grid comes second.
"""

import collections
import contextlib
import itertools
import math
import os
import pathlib
import re
import shutil
import tempfile

from eses_tools.atoms import read_charged_atoms
from eses_tools.common import FOLDER, PROGRAM, Failed, unpacked
from eses_tools import measuring

# Dielectric boundaries: maps of eses-blocks, and APBS's own `srfm mol` and `srfm smol`.
ESES, MOL, SMOL = "eses-blocks", "mol", "smol"
REFERENCE = "reference"  # the dielectric of the solute everywhere

MULTIGRID_STEP = 32  # APBS's mg-manual halves the grid four times: 32 k + 1 points along an axis
INPUT, ENERGIES, LOG = "apbs.in", "energies.txt", "apbs.log"
POTENTIAL = "potential"  # APBS appends .dx, or -PE0.dx if it is built with MPI
LEVELS = ("", "-coarse")  # suffixes of the names of files and calculations of a grid

# Resources that APBS 3.4.1 takes, measured on one core (CPU time) with grids of 0.3 to 2.7 million
# points.
BYTES_PER_POINT = 260  # memory of the multigrid solver
MAP_BYTES_PER_POINT = 8  # memory of each map; all maps are read at the start
FILE_BYTES_PER_POINT = 14  # size of each map on disk
SECONDS_PER_POINT = 3e-6  # time to solve one calculation
SECONDS_PER_BOUNDARY_TERM = 1e-8  # time of bcfl mdh for each atom at each point of the boundary

Molecule = collections.namedtuple("Molecule", "path atoms")  # atoms: Atom, in the file's order
Atom = collections.namedtuple("Atom", "x y z charge radius")
Grid = collections.namedtuple("Grid", "center points spacing")

# A kind of ions: charge in elementary charges, molar in mol/l.
Ion = collections.namedtuple("Ion", "charge molar")

# Lengths in angstrom, temperature in kelvin; equation is lpbe or npbe, boundary and charges are
# APBS's keywords bcfl and chgm.
Settings = collections.namedtuple(
    "Settings", "probe_radius solute_dielectric solvent_dielectric ions ion_radius temperature "
    "boundary charges equation", defaults=["lpbe"])

# A section `elec` of the input file.
Calculation = collections.namedtuple("Calculation", "name molecule surface")

# energies: kJ/mol, by name of the calculation.
Result = collections.namedtuple("Result", "energies seconds peak_bytes")


# --------------------------------------------------------------------------- molecules and grid


def read_molecule(path, program=PROGRAM):
    return Molecule(path, [Atom(*numbers) for numbers in read_charged_atoms(path, program)])


def identity(atom):
    """Returns a key that is equal for the same atom in two files with different numbers of
    decimals."""
    return (*(round(value, 3) for value in atom[:3]), round(atom.charge, 4), round(atom.radius, 4))


def require_parts(whole, parts):
    """Throws Failed unless the atoms of the complex are those of its parts, which are other files.

    The energy of each charge in its own field, which grows without bound on finer grids, cancels
    only if the charge is at the same place in both.
    """
    for part in parts:
        if os.path.samefile(whole.path, part.path):
            raise Failed(f"{part.path} is the same file as the complex, {whole.path}; expected the "
                         "complex, followed by its parts")
    left = collections.Counter(map(identity, whole.atoms))
    left.subtract(identity(atom) for part in parts for atom in part.atoms)
    for atoms, where in ((left, "in none of the other files"), (-left, f"not in {whole.path}")):
        unmatched = list((+atoms).elements())
        if unmatched:
            x, y, z, charge, radius = unmatched[0]
            raise Failed(
                f"{whole.path} is not the complex of the other molecules: {len(unmatched)} "
                f"atom{'s are' if len(unmatched) > 1 else ' is'} {where}, the first at {x:g} {y:g} "
                f"{z:g} with charge {charge:g} and radius {radius:g}; coordinates, charges and radii "
                "of complex and parts must be the same")


def choose_grid(molecules, spacing, padding, center=None):
    """The smallest grid for APBS with at least `padding` between all spheres and its faces."""
    lower = [min(atom[axis] - atom.radius for m in molecules for atom in m.atoms)
             for axis in range(3)]
    upper = [max(atom[axis] + atom.radius for m in molecules for atom in m.atoms)
             for axis in range(3)]
    if center is None:
        center = [round((low + high) / 2, 3) for low, high in zip(lower, upper)]
    reach = [max(high - middle, middle - low) + padding
             for low, middle, high in zip(lower, center, upper)]
    return grid_around(center, reach, spacing)


def choose_coarse_grid(molecules, fine, spacing, padding):
    """The smallest grid around the same centre that encloses the fine grid and has this padding."""
    needed = choose_grid(molecules, spacing, padding, fine.center)
    reach = [max(half_length(grid, axis) for grid in (needed, fine)) for axis in range(3)]
    return grid_around(fine.center, reach, spacing)


def half_length(grid, axis):
    return (grid.points[axis] - 1) / 2 * grid.spacing


def grid_around(center, reach, spacing):
    """The smallest grid for APBS that reaches at least so far from its centre along each axis."""
    # A grid that is exactly as long as needed is not enlarged because of rounding.
    steps = [math.ceil(2 * length / (spacing * MULTIGRID_STEP) - 1e-9) for length in reach]
    points = [MULTIGRID_STEP * max(1, count) + 1 for count in steps]
    return Grid(tuple(center), tuple(points), spacing)


# ------------------------------------------------------------------------------------ estimates


def ionic_strength(settings):
    return sum(ion.charge**2 * ion.molar for ion in settings.ions) / 2


def has_map(calculation):
    return calculation.surface == ESES


def estimate(grids, molecules, calculations, settings):
    """Bytes of memory, bytes of maps on disk and seconds that APBS takes, roughly.

    While APBS solves on the fine grid it keeps the coarse one.
    """
    points = sum(math.prod(grid.points) for grid in grids)
    maps = sum(map(has_map, calculations)) * (4 if settings.ions else 3)
    seconds = points * SECONDS_PER_POINT * len(calculations)
    if settings.boundary == "mdh":
        faces = 2 * sum(a * b for a, b in itertools.combinations(grids[-1].points, 2))
        seconds += SECONDS_PER_BOUNDARY_TERM * faces * sum(
            len(molecules[calculation.molecule].atoms) for calculation in calculations)
    return (points * (BYTES_PER_POINT + maps * MAP_BYTES_PER_POINT),
            points * maps * FILE_BYTES_PER_POINT, seconds)


def available_bytes():
    """Returns the memory that processes can use without swapping, or None if it is unknown."""
    with contextlib.suppress(OSError):
        found = re.search(r"^MemAvailable:\s+(\d+) kB",
                          pathlib.Path("/proc/meminfo").read_text(encoding="ascii"), re.MULTILINE)
        if found:
            return 1024 * int(found[1])
    return None


# ---------------------------------------------------------------------------------------- input


def molecule_name(index):
    return f"molecule{index + 1}"


def atoms_file(folder, index):
    return folder / f"{molecule_name(index)}.pqr"


def written_files(folder, molecules):
    """Returns the files that are overwritten without a temporary name, for this number of molecules."""
    return [folder / name for name in (INPUT, LOG, ENERGIES)] + [atoms_file(folder, index) for index in range(molecules)]


def plan(molecules, surfaces):
    """Returns the calculations: all molecules with all surfaces, and the reference of a single
    molecule."""
    kinds = [*surfaces, REFERENCE] if len(molecules) == 1 else surfaces
    return [Calculation(f"{molecule_name(index)}-{surface}", index, surface)
            for surface in kinds for index in range(len(molecules))]


def elec_section(calculation, level, grids, molecules, settings, potential):
    """Returns the `elec` section of a calculation on one of the grids."""
    is_reference = calculation.surface == REFERENCE
    grid, is_focused = grids[level], level + 1 < len(grids)
    lines = [
        "mg-manual",
        "dime " + " ".join(map(str, grid.points)),
        "grid " + " ".join([repr(grid.spacing)] * 3),
        "gcent " + " ".join(map(repr, grid.center)),
        f"mol {calculation.molecule + 1}",
        "lpbe" if is_reference else settings.equation,  # the reference has no ions
        f"bcfl {'focus' if is_focused else settings.boundary}",
        f"pdie {settings.solute_dielectric!r}",
        f"sdie {settings.solute_dielectric if is_reference else settings.solvent_dielectric!r}",
        f"chgm {settings.charges}",
        # Without a boundary, or with one from maps, APBS need not construct one.
        f"srfm {calculation.surface if calculation.surface in (MOL, SMOL) else MOL}",
        f"srad {settings.probe_radius if calculation.surface in (MOL, SMOL) else 0.0!r}",
        "swin 0.3",
        "sdens 10.0",
        f"temp {settings.temperature!r}",
        "calcenergy total",
        "calcforce no",
    ]
    if not is_reference:
        lines += [f"ion charge {ion.charge:g} conc {ion.molar!r} radius {settings.ion_radius!r}"
                  for ion in settings.ions]
    if has_map(calculation):
        number = level * len(molecules) + calculation.molecule + 1
        lines += [f"usemap diel {number}"]
        if settings.ions:
            lines += [f"usemap kappa {number}"]
        if potential and level == 0 and calculation.molecule == 0:
            lines += [f"write pot dx {POTENTIAL}"]
    return "\n    ".join([f"elec name {calculation.name}{LEVELS[level]}", *lines]) + "\nend\n"


def input_text(molecules, calculations, grids, settings, potential=False):
    """Returns the input file of APBS. Maps and molecules are numbered in the order of the `read`
    section. With `potential` APBS writes the potential of the first molecule with maps."""
    names = [molecule_name(index) for index in range(len(molecules))]
    reads = [f"mol pqr {name}.pqr" for name in names]
    if any(map(has_map, calculations)):
        maps = [name + suffix for suffix in LEVELS[:len(grids)] for name in names]
        reads += [f"diel dx {name}-x.dx {name}-y.dx {name}-z.dx" for name in maps]
        if settings.ions:
            reads += [f"kappa dx {name}-kappa.dx" for name in maps]
    sections = ["\n    ".join(["read", *reads]) + "\nend\n"]
    # APBS takes the boundary values of a grid from the section before.
    sections += [elec_section(calculation, level, grids, molecules, settings, potential)
                 for calculation in calculations for level in reversed(range(len(grids)))]
    for surface in dict.fromkeys(calculation.surface for calculation in calculations):
        if surface != REFERENCE:
            terms = [f"{names[0]}-{surface}", *subtracted(molecules, surface)]
            sections.append(f"print elecEnergy {' - '.join(terms)} end\n")
    return "\n".join([*sections, "quit\n"])


def write_pqr(path, atoms):
    """Writes the atoms as APBS reads them, with all their digits."""
    with open(path, "w", encoding="ascii") as target:
        for number, atom in enumerate(atoms, 1):
            target.write(f"ATOM {number} X MOL 1 {' '.join(map(repr, atom))}\n")


def map_command(program, atoms, name, grid, settings):
    """Returns the command that writes NAME-x.dx, NAME-y.dx, NAME-z.dx and NAME-kappa.dx."""
    command = [program, atoms, "--format", "pqr",
               "--probe-radius", repr(settings.probe_radius), "--spacing", repr(grid.spacing),
               "--grid-center=" + ",".join(map(repr, grid.center)),
               "--grid-points", ",".join(map(str, grid.points)),
               "--dielectric", f"{name}-",
               "--solute-dielectric", repr(settings.solute_dielectric),
               "--solvent-dielectric", repr(settings.solvent_dielectric),
               "--write", "none", "--independent", "--json"]
    if settings.ions:
        command += ["--kappa", f"{name}-kappa.dx", "--ion-radius", repr(settings.ion_radius)]
    return command


def write_maps(program, molecule, name, grid, settings, folder):
    """Runs eses-blocks in the folder and returns its messages. Throws Failed if it fails."""
    with tempfile.TemporaryDirectory() as scratch:
        atoms = unpacked(molecule.path, pathlib.Path(scratch)).absolute()
        code, text, *_ = measuring.run_quietly(map_command(program, atoms, name, grid, settings), cwd=folder)
    # Messages name the user's own file, so that its line numbers are right.
    text = text.replace(str(atoms), str(molecule.path))
    if code != 0:
        raise Failed(text or f"{program}: exit code {code}")
    return text


# ----------------------------------------------------------------------------------------- APBS


def find_apbs():
    """Returns the path of APBS, skipping scripts/apbs, which has the same name. Throws Failed if it
    is missing."""
    for folder in os.get_exec_path():
        found = shutil.which("apbs", path=folder)
        if found and os.path.realpath(found) != str(FOLDER.parent / "apbs"):
            return os.path.abspath(found)
    raise Failed("APBS is not installed; install it with `apt-get install apbs`")


def failure(log):
    """Returns the last line of APBS's output that describes an error."""
    lines = [line.strip() for line in log.splitlines()
            if re.search(r"error|fail|fatal|unable|invalid|off .*map", line, re.IGNORECASE)]
    # "bailing out" ends every map, and "VASSERT" follows a line that says more.
    lines = [line for line in lines if "bailing out" not in line and "VASSERT" not in line]
    return (lines or log.strip().splitlines() or ["no message"])[-1]


def parse_energies(text):
    """Returns total energies by name of the calculation, from APBS's flat output file."""
    return {name: float(value) for name, value in
            re.findall(r"^elec name (\S+)$.*?^\s+totEnergy (\S+) kJ/mol$", text,
                       re.MULTILINE | re.DOTALL)}


def run_apbs(apbs, calculations, folder):
    """Runs APBS in the folder with the input file there. Throws Failed unless all energies are
    finite."""
    (folder / ENERGIES).unlink(missing_ok=True)
    with open(folder / LOG, "w", encoding="utf-8") as log:
        code, seconds, usage = measuring.run(
            [apbs, f"--output-file={ENERGIES}", "--output-format=flat", INPUT], log, log,
            cwd=folder)
    log = (folder / LOG).read_text(encoding="utf-8", errors="replace")
    (folder / "io.mc").unlink(missing_ok=True)  # log of a library that APBS uses
    if code != 0 or not (folder / ENERGIES).is_file():
        raise Failed(f"APBS fails (exit code {code}): {failure(log)}")
    energies = parse_energies((folder / ENERGIES).read_text(encoding="utf-8", errors="replace"))
    for calculation in calculations:
        energy = energies.get(calculation.name)
        if energy is None:
            raise Failed(f"APBS gives no energy of {calculation.name}: {failure(log)}")
        if not math.isfinite(energy):
            raise Failed(f"APBS gives the energy {energy} for {calculation.name}; its solver does "
                         "not converge")
    return Result(energies, seconds, measuring.peak_bytes(usage))


def compute(program, apbs, molecules, calculations, grids, settings, folder,
            progress=lambda _: None, warn=lambda _: None, potential=False):
    """Makes the maps and runs APBS in `folder`, and leaves all files there."""
    for index, molecule in enumerate(molecules):
        name = molecule_name(index)
        write_pqr(atoms_file(folder, index), molecule.atoms)
        if any(map(has_map, calculations)):
            progress(f"dielectric maps of {molecule.path}")
            messages = [write_maps(program, molecule, name + suffix, grid, settings, folder)
                        for suffix, grid in zip(LEVELS, grids)]
            if messages[0]:
                warn(messages[0])
    (folder / INPUT).write_text(input_text(molecules, calculations, grids, settings, potential),
                                encoding="ascii")
    for path in folder.glob(f"{POTENTIAL}*.dx"):
        path.unlink()
    progress(f"APBS: {len(calculations)} calculation{'s' if len(calculations) > 1 else ''}")
    return run_apbs(apbs, calculations, folder)


def potential_file(folder):
    """Returns the file of the potential that APBS has written. Throws Failed if there is none."""
    found = list(folder.glob(f"{POTENTIAL}*.dx"))
    if len(found) != 1:
        raise Failed("APBS has written no potential")
    return found[0]


def subtracted(molecules, surface):
    """Returns the calculations whose energies are subtracted from that of the first molecule."""
    if len(molecules) == 1:
        return [f"{molecule_name(0)}-{REFERENCE}"]
    return [f"{molecule_name(index)}-{surface}" for index in range(1, len(molecules))]


def difference(molecules, surface, energies):
    """Returns the solvation energy of one molecule or the binding energy of several, in kJ/mol."""
    return energies[f"{molecule_name(0)}-{surface}"] - sum(
        energies[name] for name in subtracted(molecules, surface))
