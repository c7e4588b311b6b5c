"""Radii of named atoms, and the publications of the sets."""

from __future__ import annotations

import difflib
import os
from typing import Any, Iterable

import numpy as np
import numpy.typing as npt

from . import _arguments, _core

_Texts = npt.NDArray[np.str_]
_Bools = npt.NDArray[np.bool_]

SOURCES = {
    "protor": "Tsai et al. 1999, doi:10.1006/jmbi.1999.2829, extended as in FreeSASA",
    "bondi": "Bondi 1964, doi:10.1021/j100785a001; Mantina et al. 2009, doi:10.1021/jp8111556; "
             "Alvarez 2013, doi:10.1039/c3dt50599e",
    "msms": "pdb_to_xyzr of MSMS, Sanner et al. 1996, doi:10.1002/(SICI)1097-0282(199603)38:3<305::AID-BIP4>3.0.CO;2-Y",
    "naccess": "Chothia 1976, doi:10.1016/0022-2836(76)90191-1, as in NACCESS, Hubbard and Thornton 1993",
    "oons": "Ooi et al. 1987, doi:10.1073/pnas.84.10.3086, extended as in FreeSASA",
    "protor+ccd": "Tsai et al. 1999, doi:10.1006/jmbi.1999.2829, for ligands by their bonds in the Chemical Component "
                  "Dictionary, doi:10.1093/bioinformatics/btu789, of Biotite",
    "file": "the input file",
    "given": "the caller",
}
for _name in ("protor", "bondi", "msms", "naccess", "oons", "protor+ccd"):
    SOURCES[f"{_name}+shannon"] = f"{SOURCES[_name]}; ions: Shannon 1976, doi:10.1107/S0567739476001551, for six neighbours"


def without_ccd(radii: Any) -> tuple[Any, bool]:
    """Returns a set of radii without `+ccd`, and whether it had that. Raises ValueError unless the set is ProtOr."""
    if not isinstance(radii, str) or "+" not in radii or os.path.exists(radii):
        return radii, False
    word = radii.lower()
    name, *parts = word.split("+")
    if "ccd" in parts and name != "protor":
        raise ValueError(f"radii: +ccd needs protor, as in 'protor+ccd' or 'protor+ccd+shannon', not {radii!r}")
    if "ccd" not in parts and word not in SOURCES:
        known = [each for each in SOURCES if "+ccd" in each]
        if meant := difflib.get_close_matches(word, known, 1, 0.85):
            raise ValueError(f"radii: unknown set {radii!r}; did you mean {meant[0]}?")
    if "ccd" not in parts:
        return radii, False
    return "+".join([name, *(part for part in parts if part != "ccd")]), True


def find_radii(residue: _Texts, name: _Texts, element: _Texts, which: str) -> tuple[str, bool, Any, _Texts, Any, Any, Any]:
    """Returns what _core._find_radii returns, asking for each kind of atom once."""
    kinds: dict[tuple[str, str, str], int] = {}
    index = np.array([kinds.setdefault(kind, len(kinds))
                      for kind in zip(residue.tolist(), name.tolist(), element.tolist())], int)
    columns = [list(column) for column in zip(*kinds)] or [[], [], []]
    set_name, are_united, radii, symbols, by_element, by_name, classes = _core._find_radii(*columns, which)
    return (set_name, are_united, np.array(radii, float)[index], np.array(symbols, str)[index],
            np.array(by_element, bool)[index], np.array(by_name, bool)[index], np.array(classes, np.uint8)[index])


def _residue_columns(named: Any, chosen: Any) -> tuple[list[Any], ...]:
    """Returns the indices of the residues of the chosen atoms, and the names of the residues, atoms and elements."""
    columns = [column[chosen] for column in (named.chain, named.residue, named.residue_number, named.icode)]
    starts = np.zeros(len(columns[0]), np.int64)
    starts[1:] = np.any([column[1:] != column[:-1] for column in columns], axis=0)
    return tuple(column.tolist() for column in (starts.cumsum(), columns[1], named.name[chosen], named.element[chosen]))


def correct_elements(named: Any) -> tuple[_Bools, _Bools]:
    """Corrects the elements that the library of an object has derived from the names. Returns the masks of the atoms
    whose elements have changed, and of those of water."""
    changed = np.zeros(len(named.name), bool)
    symbols, indices, waters = _core._correct_elements(*_residue_columns(named, slice(None)), named.positions)
    named.element = np.array(symbols, str)
    changed[indices] = True
    return changed, np.array(waters, bool)


def atoms_named(named: Any, names: Iterable[tuple[str, str]]) -> Any:
    """Returns the indices of the atoms with these pairs of names of residue and atom."""
    known = set(names)
    return np.array([i for i, pair in enumerate(zip(named.residue.tolist(), named.name.tolist())) if pair in known]
                    if known else [], np.int64)


def warn_about_residues(named: Any, keep: _Bools) -> None:
    """Warns of residues that are coarse-grained models or traces."""
    _core._warn_about_residues(*_residue_columns(named, keep), np.flatnonzero(keep))


def find_dummies(positions: Any, occupancies: Any) -> _Bools:
    """Marks the atoms without occupancy at 9999 angstrom, by which programs mark missing atoms. An unknown occupancy
    may be zero. Single precision in nanometres has errors below 0.001 angstrom."""
    are_dummies: _Bools = (positions >= 9999 - 0.001).all(axis=1)
    if occupancies is not None:
        are_dummies &= np.array(occupancies, float) == 0
    return are_dummies


def radii_by_bonds(residue: _Texts, name: _Texts, element: _Texts, chosen: _Bools) -> Any:
    """Returns ProtOr radii of the chosen atoms by element, number of bonds and number of hydrogens in the Chemical
    Component Dictionary; not a number for other atoms, and for those that the dictionary or ProtOr does not have."""
    info = _arguments.imported("biotite.structure.info", "radii='protor+ccd'")
    found: dict[tuple[str, str], float] = {}
    radii = np.full(len(name), np.nan)
    # Biotite takes the element from the first letter of the name.
    for i in np.flatnonzero(chosen & np.isin(element, ["C", "N", "O", "S"])).tolist():
        kind = str(residue[i]), str(name[i])
        if kind not in found:
            try:
                radius = info.vdw_radius_protor(*kind)
            except (KeyError, ValueError):
                radius = None
            found[kind] = np.nan if radius is None or kind[1][0] != element[i] else radius
        radii[i] = found[kind]
    return radii


def refuse_unknown(bad: _Bools, residue: _Texts, name: _Texts, element: _Texts, set_name: str) -> None:
    """Raises ValueError about atoms without a radius."""
    kinds = list(dict.fromkeys(f"{r} {n} ({e or 'element unknown'})".strip() for r, n, e in
                               zip(residue[bad], name[bad], element[bad])))
    more = f" and {len(kinds) - 10} more names" if len(kinds) > 10 else ""
    other = "" if set_name.startswith("bondi") else "radii='bondi', "
    raise ValueError(f"{int(bad.sum())} atoms without a radius in the set {set_name}: {', '.join(kinds[:10])}{more}; "
                     f"use unknown_radius=, {other}or an array of radii")
