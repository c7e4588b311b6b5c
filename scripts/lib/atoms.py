"""Reading atoms from xyzr and PQR files as eses-blocks does."""

import math
import pathlib
import tempfile

from common import Failed, unpacked


def number(text):
    """As eses-blocks reads it: also Fortran's D exponents, but no underscores, nan or inf."""
    try:
        value = float(text.lower().replace("d", "e"))
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or "_" in text:
        raise Failed(f"expected a number, found {text[:40]!a}")
    return value


def pqr_fields(line):
    """The texts of x, y, z, radius; None if the line is no atom."""
    if not line.upper().startswith(("ATOM", "HETATM")):
        return None
    fields = line.split()
    # ATOM serial name residue number x y z charge radius; HETATM and serial may run together.
    fewest = 9 if fields[0][-1].isdigit() else 10
    if len(fields) < fewest:
        raise Failed(f"expected at least {fewest} fields separated by blanks, the last five "
                     f"being x y z charge radius, found {len(fields)}")
    return (*fields[-5:-2], fields[-1])


def xyzr_fields(line):
    """The texts of x, y, z, radius; None if the line is no atom."""
    if not line.strip() or line.lstrip().startswith("#"):
        return None
    fields = line.split()[:4]
    if len(fields) < 4:
        raise Failed(f"expected x y z radius, found {len(fields)} fields")
    return fields


def atoms_in(lines, fields_of):
    """x, y, z and the text of the radius, atom by atom."""
    is_empty = True
    for count, line in enumerate(lines, 1):
        try:
            fields = fields_of(line)
            if fields is None:
                continue
            x, y, z = map(number, fields[:3])
            if number(fields[3]) < 0:
                raise Failed(f"negative radius {fields[3]}")
        except Failed as error:
            raise Failed(f"{count}: {error}") from None
        is_empty = False
        yield x, y, z, fields[3]
    if is_empty:
        raise Failed(" no atoms")


def read_atoms(name, layout="auto"):
    """x, y, z and the text of the radius, atom by atom; `-` is standard input."""
    if layout == "auto":
        layout = "pqr" if name.lower().removesuffix(".gz").endswith(".pqr") else "xyzr"
    fields_of = {"pqr": pqr_fields, "xyzr": xyzr_fields}[layout]
    with tempfile.TemporaryDirectory() as scratch:
        source = 0 if name == "-" else unpacked(pathlib.Path(name), pathlib.Path(scratch))
        try:
            # Bytes that are no ASCII may stand in remarks; in a number they fail as such.
            with open(source, encoding="ascii", errors="replace", closefd=source != 0) as lines:
                yield from atoms_in(lines, fields_of)
        except Failed as error:
            raise Failed(f"{'standard input' if source == 0 else name}:{error}") from None
