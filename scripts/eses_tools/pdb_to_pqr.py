"""Prepares PDB and mmCIF files for PDB2PQR, which assigns CHARMM radii.

The steps are those of the structures in the table of Zhao et al. (2018). HETATM records and
hydrogens are removed. Then `pdb2pqr --ff=CHARMM` rebuilds hydrogens and missing atoms and assigns
radii. The paper does not describe its preparation; these steps were found by trial, and reproduce
its numbers of atoms and its grids.

Columns: "Protein Data Bank contents guide: atomic coordinate entry format, version 3.3".
"""

import gzip
import itertools
import re
import shutil

from eses_tools.common import Failed, gzip_errors
from eses_tools import mmcif
from eses_tools.structures import is_assembly_file

OPTIONS = ["--ff=CHARMM"]
RADII = "charmm"  # name of these radii in tables
WATERS = frozenset("HOH WAT H2O DOD SOL TIP TP3 T3P T4P SPC".split())
PACKAGE = "pdb2pqr"  # name of Debian's package; pip installs it under the same name


def find_program():
    """Returns PDB2PQR under either of its names, or None."""
    return shutil.which("pdb2pqr30") or shutil.which("pdb2pqr")


# ------------------------------------------------------------------------------------- cleaning


def is_hydrogen(line):
    element = line[76:78].strip()
    if not element.isalpha():  # old files have other text or none there
        element = line[12:16].strip().lstrip("0123456789")[:1]
    return element.upper() in ("H", "D")


def usual_record(line):
    """Returns an ATOM record in capital letters and with a serial number of five digits."""
    return f"ATOM  {line[6:12]}{line[12:20].upper()}{line[20:]}" if line[:4].upper() == "ATOM" else line


def first_model(lines):
    for line in lines:
        if line.startswith("ENDMDL"):
            return
        yield line


def residue(line):
    """Returns a key that is equal for neighbouring lines of one residue. TER ends a residue."""
    return line[:3] == "TER", line[17:27]


def protein_lines(lines):
    """Yields the input of PDB2PQR: heavy atoms of the first model without water, and the ends of
    chains.

    A residue with only the nitrogen of the backbone is left out. Some chains end with one, and
    PDB2PQR fails because it cannot rebuild it.
    """
    kept = (line for line in map(usual_record, first_model(lines))
            if line.startswith("TER") or (line.startswith("ATOM  ") and not is_hydrogen(line)
                                          and line[17:20].strip() not in WATERS))
    for (is_end, _), group in itertools.groupby(kept, residue):
        group = list(group)
        if is_end or {line[12:16].strip() for line in group} != {"N"}:
            yield from group


def require_whole_residues(lines):
    """Throws Failed if most residues have no atom but the alpha carbon."""
    names = [{line[12:16].strip() for line in group}
             for (is_end, _), group in itertools.groupby(lines, residue) if not is_end]
    count = names.count({"CA"})
    if 2 * count > len(names):
        raise Failed(f"{count} of {len(names)} residues have only their C-alpha atom; PDB2PQR "
                     "cannot rebuild the others")


def read_records(source, layout):
    """Returns the lines of a PDB file, or of an mmCIF file in the PDB format."""
    opened = gzip.open if source.suffix.lower() == ".gz" else open
    # Remarks may contain any byte.
    with gzip_errors(source), opened(source, "rt", encoding="latin-1") as file:
        lines = list(file)
    return list(mmcif.to_pdb(lines)) if layout == "mmcif" else lines


def write_protein(source, layout, target):
    """Writes the input of PDB2PQR from a file in the layout pdb or mmcif.

    Throws Failed if no atom is left, if most residues have only an alpha carbon, or if the file is
    an assembly of several models.
    """
    source_lines = read_records(source, layout)
    models = sum(line.startswith("MODEL ") for line in source_lines)
    if is_assembly_file(source.name) and models > 1:
        raise Failed(f"{models} models, which are the copies of an assembly; use the PDB file of "
                     "the entry")
    lines = [line.rstrip() + "\n" for line in protein_lines(source_lines)]
    if not any(line.startswith("ATOM") for line in lines):
        raise Failed("no atoms of a protein or nucleic acid in ATOM records")
    require_whole_residues(lines)
    with open(target, "w", encoding="latin-1") as file:
        file.writelines([*lines, "END\n"])


# ------------------------------------------------------------------------------ PDB2PQR's answer


# PDB2PQR 3.5 fails to format its message that too many atoms are missing.
MISSING_ATOMS = "Unknown format code 'i' for object of type 'int'"


def failure(log):
    """Returns the reason why PDB2PQR failed, as one line."""
    errors = re.findall(r"^(?:ERROR|CRITICAL):\s*(.*\S)", log, re.MULTILINE)
    errors = [text for text in errors if text != "Giving up."]
    if MISSING_ATOMS in errors:
        return "too many heavy atoms are missing to rebuild them"
    return (errors or log.strip().splitlines() or ["no message"])[-1]


def remark(log):
    """Returns a remark for the user on a success: the residues without parameters, which PDB2PQR
    drops."""
    left_out = re.search(r"^WARNING:\s*Ignoring (\d+) missing lines", log, re.MULTILINE)
    return f"PDB2PQR has left out {left_out[1]} atoms that it does not know" if left_out else ""
