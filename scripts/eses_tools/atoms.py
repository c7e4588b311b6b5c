"""Atoms of xyzr and PQR files, which eses-blocks reads."""

import collections
import subprocess

from eses_tools.common import PROGRAM, Failed, describe_build, file_argument
from eses_tools.measuring import plain
from eses_tools.structures import split_name

# Numbers as texts, in angstrom and elementary charges.
Atom = collections.namedtuple("Atom", "x y z radius charge")

# What eses-blocks advises for a PDB file that is named .pqr, and what a tool without that choice does.
ADVICE = "read it with --format pdb, or with --format pqr if they are"
ADVICE_OF_TOOLS = "make a PQR file of it with pdb2pqr"


def read_atoms(name, layout="auto", program=PROGRAM):
    """Returns the atoms of a file; `-` is standard input. Files without the suffix .pqr are xyzr
    files, unless `layout` is pqr. Throws Failed with the message of eses-blocks."""
    is_pqr = str(name).lower().removesuffix(".gz").endswith(".pqr")
    if layout == "auto" and not is_pqr:
        layout = "xyzr"
    command = [program, "pdb_to_xyzr", "--charges", "--format", layout, file_argument(name)]
    try:
        done = subprocess.run(command, capture_output=True, encoding="utf-8", errors="replace",
                              check=False)
    except OSError:
        describe_build(program)  # says what to do
        raise
    if done.returncode != 0:
        text = plain(done.stderr).replace(ADVICE, ADVICE_OF_TOOLS)
        raise Failed(text or f"{program}: exit code {done.returncode}")
    return [Atom(*line.split()) for line in done.stdout.splitlines()]


def read_charged_atoms(path, program=PROGRAM):
    """Returns x, y, z, charge and radius of each atom of a PQR file, as numbers. Throws Failed for
    files of other formats."""
    name = str(path).lower()
    found = split_name(path.name)
    if found and found[1] in ("pdb", "mmcif"):
        kind = "a PDB" if found[1] == "pdb" else "an mmCIF"
        raise Failed(f"{path}: this is {kind} file by its name, without charges and radii; {ADVICE_OF_TOOLS}")
    layout = "auto" if name.removesuffix(".gz").endswith(".pqr") else "pqr"
    return [tuple(map(float, (atom.x, atom.y, atom.z, atom.charge, atom.radius)))
            for atom in read_atoms(path, layout, program)]
