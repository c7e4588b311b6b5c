"""Radii of named atoms, and the publications of the sets."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core

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


def find_radii(residue: _Texts, name: _Texts, element: _Texts, which: str) -> tuple[str, bool, Any, _Texts, Any, Any]:
    """Returns what _core._find_radii returns, asking for each kind of atom once."""
    kinds: dict[tuple[str, str, str], int] = {}
    index = np.array([kinds.setdefault(kind, len(kinds))
                      for kind in zip(residue.tolist(), name.tolist(), element.tolist())], int)
    columns = [list(column) for column in zip(*kinds)] or [[], [], []]
    set_name, are_united, radii, symbols, by_element, by_name = _core._find_radii(*columns, which)
    return (set_name, are_united, np.array(radii, float)[index], np.array(symbols, str)[index],
            np.array(by_element, bool)[index], np.array(by_name, bool)[index])


def radii_by_bonds(residue: _Texts, name: _Texts, element: _Texts, chosen: _Bools) -> Any:
    """Returns ProtOr radii of the chosen atoms by element, number of bonds and number of hydrogens in the Chemical
    Component Dictionary; not a number for other atoms, and for those that the dictionary or ProtOr does not have."""
    try:
        info: Any = importlib.import_module("biotite.structure.info")
    except ImportError as error:
        raise ImportError("radii='protor+ccd' needs Biotite; install it, for example with "
                          "`pip install biotite`") from error
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
    other = "" if set_name == "bondi" else "radii='bondi', "
    raise ValueError(f"{int(bad.sum())} atoms without a radius in the set {set_name}: {', '.join(kinds[:10])}{more}; "
                     f"use unknown_radius=, {other}or an array of radii")
