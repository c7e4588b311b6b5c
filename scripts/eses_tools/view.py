"""Writes a page that shows molecular surfaces in a browser.

Files are structures (xyzr, PQR, PDB, mmCIF) or meshes of eses-blocks --mesh. Several files are shown
side by side. The page needs no network and no other file. Ligands and metals of PDB, mmCIF and PQR
files are left out of the surface and drawn as sticks and spheres.

--electrostatics computes the potential of one PDB, mmCIF or PQR file with PDB2PQR and APBS. PDB2PQR
has no charges for ligands, metals and modified residues, which a warning names.
Arguments after -- are passed to eses-blocks and choose how structures are read, such as
-- --radii bondi --chains A. Needs numpy (Debian: python3-numpy).
"""

import sys

from eses_tools import quiet_interrupt  # before the modules that take time to load

import csv
import io
import json
import math
import pathlib
import tempfile

from eses_tools.common import (NAME, Failed, Parser, at_least, between, command_of,
                               complete_file, describe_build, end_with, files_among, input_file, require_file,
                               require_kind, require_output, say, show)
from eses_tools import SCHEMES, STYLES, measuring, mmcif, pdb_to_pqr
from eses_tools.structures import KINDS, split_name

meshes = open_dx = page = None  # imported after --help and the checks of the arguments, which need no numpy

MIN_SPACING = 0.25  # angstrom, of structures without --spacing
MAX_TRIANGLES = 1e6  # of a structure without --spacing
MAX_NAMES = 8  # of residues in a message
LONGEST_MOVE = 0.9  # angstrom, of heavy atoms by PDB2PQR
AREAS = {"ses": "ses_area", "sas": "sas_area", "vdw": "ses_area"}  # columns of atoms, by the surface
SURFACE_ONLY = {"--allow-far-atoms"}  # arguments after -- that the areas do not take
# Titles of the columns of --table that say which atom or residue a row is about. The page knows the same.
TABLE_KEYS = {"serial": ("serial", "atom_serial"),
              "number": ("residue_number", "resi", "resid", "auth_seq_id", "number")}
TRIANGLES_PER_CELL = 3  # of surface whose area is the square of the spacing


def import_modules():
    global meshes, page
    from eses_tools import meshes
    from eses_tools import page


def import_numpy():
    global open_dx
    try:
        from eses_tools import open_dx
    except ImportError:
        raise Failed("install numpy (Debian: python3-numpy)") from None


# ----------------------------------------------------------------------------------- programs


def run_program(command):
    """Runs eses-blocks and returns its messages. Throws Failed if it fails, and ends with exit code
    2 if it refuses the arguments after `--`."""
    code, text, *_ = measuring.run_quietly(command)
    if code == 2:
        say(text.partition("\n")[0])
        sys.exit(2)
    if code != 0:
        raise Failed(text or f"{command[0]}: exit code {code}")
    return text


def prepare_pqr(options, path, folder):
    """Returns a PQR file of a structure, which PDB2PQR makes unless it is one, and the rows of the
    atoms that PDB2PQR leaves out."""
    _, layout = split_name(path.name)
    if layout == "pqr":
        return path, ()
    if layout == "xyzr":
        raise Failed(f"{path}: xyzr files have no charges; use a PQR, PDB or mmCIF file")
    program = pdb_to_pqr.find_program()
    if program is None:
        raise Failed(f"{path}: PDB2PQR is missing; install it with `apt-get install "
                     f"{pdb_to_pqr.PACKAGE}`")
    show(f"PDB2PQR: {path}")
    rows = list_atoms(options, path, folder / "atoms")
    try:
        pdb_to_pqr.write_protein(path, layout, folder / "protein.pdb")
    except Failed as error:
        raise Failed(f"{path}: {str(error).replace(mmcif.ADVICE, '; give a PQR file')}") from None
    made = folder / f"{path.name.partition('.')[0]}.pqr"
    with open(folder / "pdb2pqr.log", "w+", encoding="utf-8", errors="replace") as log:
        code, _, _ = measuring.run([program, *pdb_to_pqr.OPTIONS, folder / "protein.pdb", made],
                                   log, log, cwd=folder)
        log.seek(0)
        text = log.read()
    if code != 0 or not made.exists():
        raise Failed(f"{path}: PDB2PQR: {pdb_to_pqr.failure(text)}")
    if remark := pdb_to_pqr.remark(text):
        say(f"{path}: {remark}")
    missing = missing_rows(rows, list_atoms(options, made, folder / "made"))
    if missing:
        say(f"warning: {path}: {residue_names(missing)} left out, because PDB2PQR has no charges for "
            "ligands, metals and modified residues; surface and potential are those of the others; to "
            "show them, give a PQR file with their charges")
    return made, missing


def missing_rows(rows, made):
    """Returns the rows of atoms whose residues are not among those that PDB2PQR has made. It moves
    some atoms, and may choose other alternate locations."""
    atoms, others = make_atoms(rows), make_atoms(made)
    heavy = others.centers[[element != "H" for element in others.elements]]
    residues = {}
    for atom, residue in enumerate(atoms.residues):
        residues.setdefault(residue, []).append(atom)
    return [rows[atom] for found in residues.values()
            if not page.is_near(atoms.centers[found], heavy, LONGEST_MOVE) for atom in found]


def residue_names(rows):
    """Returns the names of the residues of atoms as a text."""
    names = list(dict.fromkeys(" ".join(filter(None, (row["residue"], row["chain"], row["residue_number"])))
                               for row in rows))
    more = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    return ", ".join(names[:MAX_NAMES]) + more


def compute_potential(options, atoms, folder):
    """Returns the file of the potential around a PQR file, which eses-apbs computes."""
    potential = folder / "potential.dx"
    with open(folder / "energies.json", "w+", encoding="utf-8") as report:
        # Its messages and progress go to standard error, as those of this script.
        code, _, _ = measuring.run(
            [*command_of("apbs"), atoms, "--write-potential", potential, "--json", "--program",
             options.program, "--probe-radius", options.probe_radius, "--ionic-strength",
             options.ionic_strength], report, None)
        report.seek(0)
        if code != 0:
            raise Failed("eses-apbs has failed, see the message above")
        energy = json.load(report)["solvation_energy"]
    say(f"solvation energy {next(iter(energy.values())):.2f} kJ/mol")
    return potential


# ----------------------------------------------------------------------------------- molecules


def read_table(path):
    with open(path, encoding="utf-8", newline="") as source:
        return list(csv.DictReader(source))


def measure(options, arguments, folder):
    """Returns the tables of atoms and, for the solvent excluded surface, of cavities that
    eses-blocks measure writes into the folder."""
    is_ses = options.surface == "ses"
    # Without a probe, the solvent excluded surface is that of van der Waals.
    probe = 0 if options.surface == "vdw" else options.probe_radius
    run_program([options.program, "measure", *arguments, "--probe-radius", probe, "--quiet", "--write",
                 "atoms,cavities" if is_ses else "atoms", *(["--cavities"] if is_ses else []), "-o", folder])
    atoms, = folder.glob("*.atoms.csv")
    rows = [{**row, "ses_area": row[AREAS[options.surface]]} for row in read_table(atoms)]
    return rows, [row for path in folder.glob("*.cavities.csv") for row in read_table(path)]


def list_atoms(options, path, folder):
    """Returns the rows of the atoms of a structure. Their areas, for a probe of radius 0, take
    the least time."""
    folder.mkdir()
    run_program([options.program, "measure", path, *options.arguments, "--probe-radius", "0", "--surface", "ses",
                 "--quiet", "--write", "atoms", "-o", folder])
    table, = folder.glob("*.atoms.csv")
    return read_table(table)


def make_atoms(rows):
    """Returns the atoms of a table."""
    import numpy

    def numbers(*names):
        return numpy.array([[float(row[name]) for name in names] for row in rows])

    residues = [(row["residue"], row["residue_number"], row["chain"]) for row in rows]
    return page.Atoms(
        serial=numbers("serial")[:, 0].astype(int), centers=numbers("x", "y", "z"),
        radii=numbers("radius")[:, 0], areas=numbers("ses_area")[:, 0],
        names=[row["name"] for row in rows], elements=[row["element"] for row in rows],
        residues=residues if any(map(any, residues)) else None)


def choose_spacing(area):
    """Returns a spacing with which a surface of this area has at most MAX_TRIANGLES triangles."""
    return max(MIN_SPACING, math.ceil(100 * math.sqrt(TRIANGLES_PER_CELL * area / MAX_TRIANGLES)) / 100)


def divide(rows):
    """Returns the rows of a table of atoms that the surface has, and those of ligands and metals."""
    ligands = make_atoms(rows).ligands()
    if ligands is None:
        return rows, []
    return ([row for row, is_ligand in zip(rows, ligands) if not is_ligand],
            [row for row, is_ligand in zip(rows, ligands) if is_ligand])


def read_structure(options, path, folder, ligands=()):
    """Returns the surface and atoms of a structure, which eses-blocks computes in the folder.

    `ligands` are rows of atoms that are drawn in addition."""
    import numpy
    reading = [path, *options.arguments]
    show(f"areas of {path}")
    more = []
    if options.ligands == "sticks" and split_name(path.name)[1] != "xyzr":
        rest, more = divide(list_atoms(options, path, folder / "ligands"))
        if more and options.electrostatics:
            say(f"warning: {path}: the surface is without {residue_names(more)}, whose charges the "
                "potential has")
    if more:  # the surface is that of the others
        reading = [folder / f"{path.name.partition('.')[0]}.xyzr"]
        reading[0].write_text("".join(f"{row['x']} {row['y']} {row['z']} {row['radius']}\n"
                                      for row in rest), encoding="ascii")
    rows, cavities = measure(options, reading, folder)
    if more:
        rows = [{**row, "ses_area": result["ses_area"]} for row, result in zip(rest, rows)]
        ligands = [*ligands, *more]
    atoms = make_atoms([*rows, *ligands])
    if ligands:
        atoms.are_ligands = numpy.arange(len(atoms.serial)) >= len(rows)
    spacing = options.spacing or choose_spacing(float(atoms.areas[:len(rows)].sum()))
    show(f"surface of {path}")
    mesh = folder / "surface.ply"
    margin = 2 * spacing  # does not cut the surface
    probe = [] if options.surface == "vdw" else ["--probe-radius", options.probe_radius]
    messages = run_program([options.program, *reading, *options.surface_arguments, "--surface", options.surface, *probe,
                            "--spacing", spacing, "--margin", margin, "--json", "--write", "none",
                            "--independent", "-o", folder, "--mesh", mesh, "--color",
                            "component" if options.surface == "ses" else "atom"])
    if messages:
        say(messages)
    read = with_creases(meshes.read_mesh(mesh))
    return page.Molecule(path.name, read.points, read.normals, read.triangles,
                         patch=read.values.get("patch"), component=read.values.get("component"),
                         atom=read.values["atom"], atoms=atoms,
                         voids=[float(row["void_volume"]) for row in cavities])


def with_creases(mesh):
    """Returns a mesh whose triangles are cut where spheres meet, if it is one of spheres with atoms."""
    from eses_tools import patch_borders
    if not patch_borders.is_of_spheres(mesh):
        return mesh
    points, normals, triangles, owners = patch_borders.cut_by_atom(mesh)
    values = {name: array[owners] for name, array in mesh.values.items()}
    return mesh._replace(points=points, normals=normals, triangles=triangles, values=values)


def atoms_of_mesh(mesh):
    """Returns the atoms that a mesh names, and the index of the atom of each vertex."""
    import numpy
    values = mesh.values
    found, first, index = numpy.unique(values["atom"], return_index=True, return_inverse=True)
    corners = mesh.points[mesh.triangles]
    areas = numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0],
                                          corners[:, 2] - corners[:, 0]), axis=1) / 2
    shares = numpy.repeat(areas / 3, 3)  # a third of each triangle for each corner
    residues = None
    if "residue" in values:
        texts = [mesh.residues[number] for number in values["residue"][first]]
        chains = [mesh.chains[number] for number in values["chain"][first]]
        residues = [split_residue(text, chain) for text, chain in zip(texts, chains)]
    return index, page.Atoms(
        serial=found + 1, residues=residues,
        areas=numpy.bincount(index[mesh.triangles.ravel()], shares, len(found)))


def split_residue(text, chain):
    """Returns name, number and chain of a residue, from a text such as `ALA 52A B`."""
    words = text.removesuffix(f" {chain}" if chain else "").split(" ")
    return " ".join(words[:-1]), words[-1], chain


def read_mesh(path):
    show(f"mesh {path}")
    mesh = with_creases(meshes.read_mesh(path))
    molecule = page.Molecule(path.name, mesh.points, mesh.normals, mesh.triangles,
                             patch=mesh.values.get("patch"), component=mesh.values.get("component"),
                             color=mesh.values.get("color"),
                             potential=mesh.values.get("potential"))
    if "atom" in mesh.values:
        molecule.atom, molecule.atoms = atoms_of_mesh(mesh)
    return molecule


def make_molecules(options):
    molecules = []
    with tempfile.TemporaryDirectory(prefix="view-") as scratch:
        for number, path in enumerate(options.files):
            folder = pathlib.Path(scratch) / str(number)
            folder.mkdir()
            potential = options.potential[number % len(options.potential)] if options.potential else None
            if meshes.is_mesh(path):
                molecule = read_mesh(path)
            elif options.electrostatics:
                atoms, missing = prepare_pqr(options, path, folder)
                potential = compute_potential(options, atoms, folder)
                molecule = read_structure(options, atoms, folder, missing)
                molecule.name = path.name
            else:
                molecule = read_structure(options, path, folder)
            if potential is not None:
                show(f"potential {potential}")
                molecule.potential = open_dx.potential_at(
                    open_dx.read_map(potential), molecule.points, molecule.normals,
                    options.potential_offset)
            molecules.append(molecule)
    if options.color == "potential" and all(one.potential is None for one in molecules):
        raise Failed("the meshes have no potential; give one with --potential")
    return molecules


# -------------------------------------------------------------------------------- command line


def parse():
    above_zero = at_least(0, is_open=True)
    parser = Parser(__doc__, lead=2,
                    examples=(("1crn.pdb -o 1crn.html", "a structure, in the colours of its chains"),
                              ("1brs.pdb --electrostatics -o p.html", "its potential"),
                              ("1crn.ply a.glb -o both.html", "two meshes side by side")),
                    advanced=("--spacing", "--potential-offset", "--potential-limit", "--ionic-strength", "--program"),
                    usage=f"{NAME} [OPTION...] FILE... -o PAGE.html [-- ARGUMENT...]")
    parser.add_argument("files", nargs="+", metavar="FILE", type=input_file,
                        help=f"structure ({KINDS}) or mesh (.ply, .vtp, .obj, .off, .stl, .glb, .vert or .face)")
    parser.add_argument("-o", "--output", required=True, metavar="PAGE.html", type=pathlib.Path,
                        help="page to write; - for standard output")
    parser.add_argument("--title", help="title of the page (default: the names of the files)")
    look = parser.add_argument_group("first view, which the controls of the page change")
    look.add_argument("--color", choices=SCHEMES,
                      help="colours of the surface (default: potential if there is one, file if a "
                           "mesh has colours, chain if there are several, otherwise plain)")
    look.add_argument("--table", type=pathlib.Path, metavar="FILE.csv",
                      help="colour by the columns of a table with a column serial (of atoms) or "
                           "residue_number and chain")
    look.add_argument("--atoms", default="none", choices=STYLES,
                      help="drawing of the atoms of structures (default: none)")
    look.add_argument("--opacity", type=between(0, 100, int), metavar="PERCENT",
                      help="opacity (default: 100, or 45 with --atoms)")
    surface = parser.add_argument_group("surface of structures")
    surface.add_argument("--surface", default="ses", choices=tuple(AREAS),
                         help="kind of surface (default: ses)")
    surface.add_argument("--probe-radius", type=above_zero, default=1.4, metavar="ANGSTROM",
                         help="radius of the solvent probe (default: 1.4)")
    surface.add_argument("--ligands", choices=("sticks", "surface"),
                         help="ligands and metals: sticks draws them, and leaves them out of the "
                              "surface; surface makes them part of it (default: surface with "
                              "--electrostatics, otherwise sticks)")
    surface.add_argument("--spacing", type=above_zero, metavar="ANGSTROM",
                         help=f"distance between grid points (default: {MIN_SPACING}, or more for "
                              f"at most {MAX_TRIANGLES:,.0f} triangles)")
    potential = parser.add_argument_group("potential")
    potential.add_argument("--potential", action="append", type=pathlib.Path, metavar="FILE.dx",
                           help="OpenDX map of the potential in kT/e, such as those of APBS; also "
                                ".dx.gz; given once, or once for each file")
    potential.add_argument("--electrostatics", action="store_true",
                           help="compute the potential with PDB2PQR and APBS")
    potential.add_argument("--potential-offset", type=at_least(0), default=0.0,
                           metavar="ANGSTROM",
                           help="take the potential at this distance outside of the surface "
                                "(default: 0)")
    potential.add_argument("--potential-limit", type=above_zero, metavar="KT/E",
                           help="end of the scale of colours (default: a round number that 2 per "
                                "cent of the vertices exceed)")
    potential.add_argument("--ionic-strength", type=at_least(0), default=0.15, metavar="MOLAR",
                           help="concentration of a 1:1 salt for --electrostatics (default: 0.15)")
    parser.add_program()
    options, arguments = parser.parse_before_dashes()
    options.arguments = [each for each in arguments if each not in SURFACE_ONLY]
    options.surface_arguments = [each for each in arguments if each in SURFACE_ONLY]
    import_modules()
    complete_options(parser, options)
    import_numpy()
    return options


def complete_options(parser, options):
    """Sets the title. Ends with exit code 2 if options contradict each other."""
    require_kind(parser, options.output, "a page", ".html", ".htm")
    is_mesh = [meshes.is_mesh(path) for path in options.files]
    for path, known in zip(options.files, is_mesh):
        if not known and split_name(path.name) is None:
            require_file(path)
            parser.error(f"{path}: neither a structure nor a mesh; the suffixes are {KINDS}, and "
                         f"{', '.join(meshes.SUFFIXES)}")
    parser.refuse_own(options.arguments)
    if options.electrostatics and options.potential:
        parser.error("--electrostatics and --potential exclude each other")
    if options.electrostatics and any(is_mesh):
        parser.error("--electrostatics needs structures, not meshes")
    if options.electrostatics and (options.arguments or options.surface_arguments):
        parser.error("--electrostatics reads the atoms that PDB2PQR has made; leave out the "
                     "arguments after --")
    if options.potential and len(options.potential) not in (1, len(options.files)):
        parser.error(f"{len(options.potential)} maps of --potential for {len(options.files)} files; "
                     "give one, or one for each file")
    if options.color == "potential" and not (options.potential or options.electrostatics
                                             or any(is_mesh)):
        parser.error("--color potential needs --potential or --electrostatics")
    options.ligands = options.ligands or ("surface" if options.electrostatics else "sticks")
    options.needs_program = not all(is_mesh)
    options.title = options.title or ", ".join(path.name for path in options.files)


def read_colors(path, molecules):
    """Returns the text of --table, which must name an atom or residue of the molecules."""
    text = path.read_text(encoding="utf-8-sig", errors="replace")
    rows = list(csv.DictReader(io.StringIO(text)))
    titles = {title.strip().lower(): title for title in (rows[0] if rows else ()) if title}
    keys = {key: titles[name] for key, names in TABLE_KEYS.items() for name in names if name in titles}
    if not keys:
        raise Failed(f"{path}: no column serial or residue_number with values")
    atoms = [molecule.atoms for molecule in molecules if molecule.atoms is not None]
    known = ({str(serial) for one in atoms for serial in one.serial} if "serial" in keys
             else {number for one in atoms for _, number, _ in one.residues or ()})
    if not known & {(row[keys.get("serial", keys.get("number"))] or "").strip() for row in rows}:
        raise Failed(f"{path}: names no atom or residue of {', '.join(one.name for one in molecules)}")
    return text


def main():
    options = parse()
    read = [*options.files, *(options.potential or ()), *([options.table] if options.table else [])]
    for path in read:
        require_file(path)
    require_output(options.output, [*read, *files_among(options.arguments)])
    if options.needs_program:
        describe_build(options.program)
    molecules = make_molecules(options)
    show("writing the page")
    table = options.table and (options.table.name, read_colors(options.table, molecules))
    text = page.make_page(molecules, options.title, options.color, options.atoms, options.opacity,
                          options.potential_limit, table)
    with complete_file(options.output, encoding="utf-8") as target:
        target.write(text)
    show("")


def start():
    end_with(main)
