"""Reading atoms from xyzr and PQR files as eses-blocks does."""

import math
import pathlib
import re
import tempfile

from eses_tools.common import Failed, unpacked

# Matches an element symbol with an optional formal charge: N, Zn, O1-. Some programs append it.
ELEMENT = re.compile(r"[A-Za-z]{1,2}([0-9][+-])?")

# Numbers in a record of a PDB file: first column (from 0), width and decimals.
OCCUPANCY, B_FACTOR = (54, 6, 2), (60, 6, 2)
COORDINATES = ((30, 8, 3), (38, 8, 3), (46, 8, 3))
END_OF_B_FACTOR = 66
MAX_USUAL_RADIUS = 4  # angstrom; most B-factors are larger


def number(text):
    """Parses a number as eses-blocks does: with Fortran's D exponents, without underscores, nan
    or inf."""
    try:
        value = float(text.lower().replace("d", "e"))
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or "_" in text:
        raise Failed(f"expected a number, found {text[:40]!a}")
    return value


def is_record(line):
    """Returns whether a line of a PQR or PDB file is an atom."""
    return line.upper().startswith(("ATOM", "HETATM"))


def pqr_fields(line):
    """Returns the texts of x, y, z, charge and radius, or None if the line is not an atom."""
    if not is_record(line):
        return None
    fields = line.split()
    if ELEMENT.fullmatch(fields[-1]):
        fields.pop()
    # The fields are: ATOM serial name residue number x y z charge radius. HETATM and serial may
    # have no blank between them.
    fewest = 9 if fields[0][-1].isdigit() else 10
    if len(fields) < fewest:
        raise Failed(f"expected at least {fewest} fields separated by blanks, the last five "
                     f"being x y z charge radius, found {len(fields)}")
    return fields[-5:]


def xyzr_fields(line):
    """Returns the texts of x, y, z, charge (0) and radius, or None if the line is not an atom."""
    if not line.strip() or line.lstrip().startswith("#"):
        return None
    fields = line.split()[:4]
    if len(fields) < 4:
        raise Failed(f"expected x y z radius, found {len(fields)} fields")
    return [*fields[:3], "0", fields[3]]


def fixed_number(line, column, width, decimals):
    """Returns the number in these columns, or None if there is no number with so many decimals."""
    text = line[column:column + width]
    is_number = len(text) == width and re.fullmatch(rf"[ \t]*[+-]?\d*\.\d{{{decimals}}}", text)
    return float(text) if is_number else None


class PdbLikeness:
    """Recognises a PDB file that is read as PQR, by the rules of eses-blocks."""

    def __init__(self):
        self.records = 0
        self.in_columns = 0  # records with numbers in the columns of PDB files
        self.plausible = 0  # records among them whose numbers can hardly be charge and radius

    def add(self, line):
        """Counts a line if it is a record."""
        if not is_record(line):
            return
        self.records += 1
        line = line.rstrip("\r\n")
        if (any(fixed_number(line, *columns) is None for columns in COORDINATES)
                or line[END_OF_B_FACTOR:END_OF_B_FACTOR + 1].strip(" \t")):
            return
        if not line[OCCUPANCY[0]:END_OF_B_FACTOR].strip():  # as some programs write it
            self.in_columns += 1
            self.plausible += 1
            return
        occupancy, b_factor = fixed_number(line, *OCCUPANCY), fixed_number(line, *B_FACTOR)
        if occupancy is not None and b_factor is not None and 0 <= occupancy <= 1:
            self.in_columns += 1
            self.plausible += (occupancy == 1 or b_factor > MAX_USUAL_RADIUS
                               or occupancy == b_factor == 0)

    def refuse(self):
        """Throws Failed if the records are those of a PDB file."""
        if (self.records and 10 * self.in_columns >= 9 * self.records
                and 2 * self.plausible >= self.records):
            raise Failed(" this is a PDB file: its columns 55 to 66 hold occupancy and B-factor, "
                         "which are not charge and radius; make a PQR file of it with pdb2pqr")


def atoms_in(lines, layout):
    """Yields x, y, z, charge and the text of the radius of each atom."""
    fields_of = {"pqr": pqr_fields, "xyzr": xyzr_fields}[layout]
    likeness = PdbLikeness()
    is_empty = True
    for count, line in enumerate(lines, 1):
        if layout == "pqr":
            likeness.add(line)
        try:
            fields = fields_of(line)
            if fields is None:
                continue
            x, y, z, charge = map(number, fields[:4])
            if number(fields[4]) < 0:
                raise Failed(f"negative radius {fields[4]}")
        except Failed as error:
            if layout == "pqr":  # the error may be that of a PDB file
                for further in lines:
                    likeness.add(further)
                likeness.refuse()
            raise Failed(f"{count}: {error}") from None
        is_empty = False
        yield x, y, z, charge, fields[4]
    if is_empty:
        raise Failed(" no atoms" + ("; expected ATOM or HETATM records" if layout == "pqr" else ""))
    if layout == "pqr":
        likeness.refuse()


def read_records(name, layout):
    """Yields x, y, z, charge and the text of the radius of each atom; `-` is standard input."""
    with tempfile.TemporaryDirectory() as scratch:
        source = 0 if name == "-" else unpacked(pathlib.Path(name), pathlib.Path(scratch))
        try:
            # Remarks may contain bytes that are not ASCII. In a number they are an error.
            with open(source, encoding="ascii", errors="replace", closefd=source != 0) as lines:
                yield from atoms_in(lines, layout)
        except Failed as error:
            raise Failed(f"{'standard input' if source == 0 else name}:{error}") from None


def read_atoms(name, layout="auto"):
    """Yields x, y, z and the text of the radius of each atom; `-` is standard input."""
    if layout == "auto":
        layout = "pqr" if name.lower().removesuffix(".gz").endswith(".pqr") else "xyzr"
    for x, y, z, _, radius in read_records(name, layout):
        yield x, y, z, radius


def read_charged_atoms(name):
    """Returns x, y, z, charge and radius of each atom of a PQR file."""
    for x, y, z, charge, radius in read_records(name, "pqr"):
        yield x, y, z, charge, number(radius)
