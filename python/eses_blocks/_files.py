"""Structures with a value for each atom in the column of the B-factor, and names of mmCIF files."""

from __future__ import annotations

import os
import re
from typing import Any, Iterable, Optional

import numpy as np

from ._references import is_polymer


def output_path(path: Any, read: Iterable[str] = ()) -> str:
    """Returns the path of a file to write. Raises TypeError if it is no path, and ValueError if it is one of the
    files that were read, under whatever name."""
    if not isinstance(path, (str, bytes, os.PathLike)):
        raise TypeError(f"path must be a path, not {path!r:.80}")
    name = os.fsdecode(path)
    if any(os.path.exists(source) and os.path.exists(name) and os.path.samefile(source, name) for source in read):
        raise ValueError(f"{name} was read, and would be overwritten; choose another name")
    return name


def _too_wide(what: str, value: Any, i: int) -> ValueError:
    return ValueError(f"atom {i} (counted from 0): {what} {value} is too wide for a PDB file; save a .cif file")


def _record(residue: str) -> str:
    """Returns the name of the record of an atom: HETATM unless the residue is that of a polymer."""
    return "ATOM" if is_polymer(residue) else "HETATM"


def _pdb_line(serial: int, i: int, molecule: Any, value: float) -> str:
    name, residue, chain = (str(column[i]) for column in (molecule.name, molecule.residue, molecule.chain))
    element, icode = str(molecule.element[i]), str(molecule.icode[i])
    x, y, z = molecule.positions[i].tolist()
    padded = name if len(name) >= 4 or len(element) == 2 else f" {name}"
    fields = (("serial number", f"{serial:5d}", 5), ("atom name", f"{padded:<4}", 4), ("residue name", f"{residue:>3}", 3),
              ("chain name", f"{chain:1}", 1), ("residue number", f"{molecule.residue_number[i]:4d}", 4),
              ("insertion code", f"{icode:1}", 1), ("x", f"{x:8.3f}", 8), ("y", f"{y:8.3f}", 8), ("z", f"{z:8.3f}", 8),
              ("value", f"{value:6.2f}", 6))
    for what, text, width in fields:
        if len(text) > width:
            raise _too_wide(what, text.strip(), i)
    column = [field for _, field, _ in fields]
    return (f"{_record(residue):<6}{column[0]} {column[1]} {column[2]} {column[3]}{column[4]}{column[5]}   {column[6]}{column[7]}{column[8]}"
            f"  1.00{column[9]}          {element.upper():>2}\n")


def write_pdb(path: str, molecule: Any, values: Any) -> None:
    """Writes the atoms whose value is a number. Raises ValueError, before it writes, if one does not
    fit into its columns."""
    lines = [_pdb_line(serial, i, molecule, float(values[i]))
             for serial, i in enumerate(np.flatnonzero(~np.isnan(values)).tolist(), 1)]
    with open(path, "w", encoding="utf-8") as target:
        target.writelines([*lines, "END\n"])


def _cif(value: Any) -> str:
    text = str(value)
    if not text:
        return "."
    if re.fullmatch(r"[A-Za-z0-9+*.-][^\s'\"]*", text) and not re.match(r"(?i)data_|save_|loop_|stop_|global_|[.?]$", text):
        return text
    return f'"{text}"' if '"' not in text else f"'{text}'"


def write_cif(path: str, molecule: Any, values: Any) -> None:
    """Writes the atoms whose value is a number."""
    columns = ("group_PDB id type_symbol label_atom_id label_alt_id label_comp_id label_asym_id label_entity_id label_seq_id "
               "pdbx_PDB_ins_code Cartn_x Cartn_y Cartn_z occupancy B_iso_or_equiv auth_seq_id auth_comp_id auth_asym_id "
               "auth_atom_id pdbx_PDB_model_num").split()
    with open(path, "w", encoding="utf-8") as target:
        target.write("data_areas\n#\nloop_\n" + "".join(f"_atom_site.{name}\n" for name in columns))
        for serial, i in enumerate(np.flatnonzero(~np.isnan(values)).tolist(), 1):
            name, residue, chain, element, icode = (_cif(column[i]) for column in (
                molecule.name, molecule.residue, molecule.chain, molecule.element, molecule.icode))
            x, y, z = molecule.positions[i].tolist()
            number = molecule.residue_number[i]
            target.write(f"{_record(str(molecule.residue[i]))} {serial} {element if element != '.' else 'X'} {name} . {residue} {chain} 1 . {icode} "
                         f"{x:.3f} {y:.3f} {z:.3f} 1.00 {float(values[i]):.4f} {number} {residue} {chain} {name} 1\n")
        target.write("#\n")


def write_structure(path: str, molecule: Any, values: Any) -> None:
    """Writes the atoms whose value is a number, as the suffix says. Raises ValueError for suffixes other
    than .pdb and .cif."""
    writers = {".pdb": write_pdb, ".cif": write_cif}
    suffix = os.path.splitext(path)[1].lower()
    if suffix not in writers:
        raise ValueError(f"{path}: the suffix must be .pdb, .cif, .csv or .parquet")
    writers[suffix](path, molecule, values)


_CIF_VALUE = re.compile(rb"""'(?:[^']|'(?=\S))*'|"(?:[^"]|"(?=\S))*"|\S+""")


def values_in_lines(text: bytes, column: bytes, lines: list[int]) -> Optional[list[str]]:
    """Returns the values of a column in these lines of an mmCIF text, each of which is a row of atoms; None if
    there is no such column or a row is not a line."""
    columns = re.findall(rb"(?im)^\s*_atom_site\.(\S+)\s*$", text)
    names = [name.lower() for name in columns]
    if column not in names:
        return None
    at, rows = names.index(column), text.split(b"\n")
    found = []
    for number in lines:
        values = rows[number - 1].split() if number <= len(rows) else []
        if len(values) != len(names):  # quoted values may contain blanks
            values = _CIF_VALUE.findall(rows[number - 1]) if values else []
        if len(values) != len(names):
            return None
        found.append(values[at].strip(b"'\"").decode("utf-8", "replace"))
    return found


class RowsOfFile:
    """The rows of a file from which its atoms were read. Rows of an mmCIF file may be in the same line, and images of an
    assembly are from the same row, so that the centres distinguish them."""

    def __init__(self, atoms: Any) -> None:
        self._lines = atoms.lines.copy()  # a view would keep all atoms
        has_shared_lines = (self._lines[1:] == self._lines[:-1]).any()
        self._centers = atoms.centers.copy() if has_shared_lines else None

    def marks(self, atoms: Any) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """Returns the mask of the atoms that are among others of the file."""
        if self._centers is None:
            return np.isin(self._lines, atoms.lines)
        known = set(zip(atoms.lines.tolist(), map(tuple, atoms.centers.tolist())))
        return np.array([row in known for row in zip(self._lines.tolist(), map(tuple, self._centers.tolist()))], bool)


def model_numbers(text: bytes, layout: str) -> list[int]:
    """Returns the numbers of the models of a text of the layout pdb, pqr or mmcif, in their order; [0] if it names none."""
    if layout != "mmcif":
        found = re.findall(rb"(?m)^MODEL\s+(\d+)", text)
    else:
        names = [name.lower() for name in re.findall(rb"(?im)^\s*_atom_site\.(\S+)\s*$", text)]
        if b"pdbx_pdb_model_num" not in names:
            return [0]
        at = names.index(b"pdbx_pdb_model_num")
        rows = (_CIF_VALUE.findall(row) for row in re.findall(rb"(?m)^(?:ATOM|HETATM)\s.*$", text))
        found = [row[at] for row in rows if len(row) == len(names)]
    return list(dict.fromkeys(int(number) for number in found if number.isdigit())) or [0]


def notes_of(noted: Any, is_model_chosen: bool) -> tuple[str, ...]:
    """Returns the notes on a PDB or mmCIF file as texts; none for other files."""
    if noted is None:
        return ()
    model, models, segments, atoms, assemblies = noted
    notes = []
    if models > 1:
        notes.append(f"model {model}; the file has {models} models" if is_model_chosen else
                     f"model {model} was read, and the file has {models} models; choose another with model=, or models='all'")
    if segments:
        notes.append(f"chains are named by the segments in columns 73 to 76: {', '.join(segments[:8])}")
    copies = [(name, f"{operators} copies" if operators > 1 else "", f"{count} of the {atoms} atoms" if count < atoms else "")
              for name, operators, count in assemblies]
    if copies:
        texts = [f"assembly {name} has {' of '.join(filter(None, parts))}" for name, *parts in copies[:4]]
        more = f" and {len(copies) - 4} more" if len(copies) > 4 else ""
        notes.append(f"{', '.join(texts)}{more}; build it with assembly={copies[0][0]!r}")
    return tuple(notes)
