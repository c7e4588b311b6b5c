"""From a PDB file to atoms with CHARMM radii, by PDB2PQR.

Prepared as the structures in the table of Zhao et al. (2018) were: HETATM records and hydrogens are
removed; hydrogens and missing atoms are then rebuilt, and radii assigned, by `pdb2pqr --ff=CHARMM`.
The paper does not say so: found by trying, as these atoms reproduce its numbers of atoms and its
grids.

Columns: "Protein Data Bank contents guide: atomic coordinate entry format, version 3.3".
"""

import gzip
import itertools
import re
import shutil

from common import Failed

OPTIONS = ["--ff=CHARMM"]
PACKAGE = "pdb2pqr"  # of Debian; elsewhere it is installed by pip under the same name


def find_program():
    """PDB2PQR under either of its names, or None."""
    return shutil.which("pdb2pqr30") or shutil.which("pdb2pqr")


# ------------------------------------------------------------------------------------- cleaning


def is_hydrogen(line):
    element = line[76:78].strip()
    if not element.isalpha():  # old files have none, or other things there
        element = line[12:16].strip().lstrip("0123456789")[:1]
    return element.upper() in ("H", "D")


def first_model(lines):
    for line in lines:
        if line.startswith("ENDMDL"):
            return
        yield line


def residue(line):
    """Equal for neighbouring lines of one residue; TER ends it."""
    return line[:3] == "TER", line[17:27]


def protein_lines(lines):
    """What PDB2PQR shall see: heavy atoms of the first model, and the ends of chains.

    A residue of which nothing but the nitrogen of the backbone is there is left out. It stands at
    the end of some chains, where PDB2PQR cannot rebuild it and gives up.
    """
    kept = (line for line in first_model(lines)
            if line.startswith("TER") or (line.startswith("ATOM  ") and not is_hydrogen(line)))
    for (is_end, _), group in itertools.groupby(kept, residue):
        group = list(group)
        if is_end or {line[12:16].strip() for line in group} != {"N"}:
            yield from group


def write_protein(source, target):
    """Throws Failed if no atom is left."""
    opened = gzip.open if source.suffix.lower() == ".gz" else open
    # Any byte may stand in remarks.
    with opened(source, "rt", encoding="latin-1") as file:
        lines = [line.rstrip() + "\n" for line in protein_lines(file)]
    if not any(line.startswith("ATOM") for line in lines):
        raise Failed("no ATOM records other than hydrogens")
    with open(target, "w", encoding="latin-1") as file:
        file.writelines([*lines, "END\n"])


# ------------------------------------------------------------------------------ PDB2PQR's answer


def failure(log):
    """Why PDB2PQR gave up, as far as one line can tell."""
    told = re.findall(r"^(?:ERROR|CRITICAL):\s*(.*\S)", log, re.MULTILINE)
    told = [text for text in told if text != "Giving up."]
    return (told or log.strip().splitlines() or ["no message"])[-1]


def remark(log):
    """What a user must know of a success: PDB2PQR leaves out what it has no parameters for."""
    left_out = re.search(r"^WARNING:\s*Ignoring (\d+) missing lines", log, re.MULTILINE)
    return f"PDB2PQR has left out {left_out[1]} atoms that it does not know" if left_out else ""
