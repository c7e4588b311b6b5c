"""Selections of atoms: chains, ligands, gemmi's syntax, and the languages of other libraries."""

from __future__ import annotations

import re
import weakref
from typing import Any, Callable, Iterable, NamedTuple, Optional

import numpy as np
import numpy.typing as npt

from . import _arguments, _core, adaptors

_Bools = npt.NDArray[np.bool_]
_LIGAND = "ligand:"


def listed(names: Iterable[str], limit: int = 10) -> str:
    """Returns the names without repetitions as a text, with the number of those beyond a limit."""
    known = list(dict.fromkeys(names))
    shown = ", ".join(name or "(blank)" for name in known[:limit])
    return shown + (f" and {len(known) - limit} more" if len(known) > limit else "")


class _Names(NamedTuple):
    """The columns that selections need. A surface of a molecule keeps them."""

    positions: npt.NDArray[np.float64]
    chain: npt.NDArray[np.str_]
    residue: npt.NDArray[np.str_]
    residue_number: npt.NDArray[np.int64]
    icode: npt.NDArray[np.str_]
    name: npt.NDArray[np.str_]
    element: npt.NDArray[np.str_]


def find_points(positions: npt.NDArray[np.float64], points: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
    """Returns the index of the position at each point; -1 if there is none within the precision of a file."""
    tolerance = 0.002  # angstrom
    order = np.argsort(positions[:, 0], kind="stable")
    sorted_x = positions[order, 0]
    first = np.searchsorted(sorted_x, points[:, 0] - tolerance)
    last = np.searchsorted(sorted_x, points[:, 0] + tolerance, "right")
    found = np.full(len(points), -1, np.int64)
    for k, point in enumerate(points):
        near = order[first[k]:last[k]]
        distances = np.abs(positions[near] - point).max(axis=1) if len(near) else np.zeros(0)
        if len(near) and distances.min() <= tolerance:
            found[k] = near[distances.argmin()]
    return found


def is_gemmi_selection(chosen: Any) -> bool:
    """Whether a selection is a gemmi.Selection, which is a text and no part of a molecule."""
    kind = type(chosen)
    return kind.__module__.partition(".")[0] == "gemmi" and kind.__name__ == "Selection"


def _may_be_left_out(columns: adaptors.Columns) -> _Bools:
    """Marks the atoms of an object that are left out when a file is read: hydrogens, waters and alternate locations."""
    centers = np.array(columns.centers, float)
    count = len(centers)
    residues, names, elements, altlocs = ([str(value or "") for value in column or [""] * count] for column in (
        columns.residues, columns.names, columns.elements, columns.altlocs))
    keys = list(zip(columns.chains or [""] * count, columns.numbers or range(count), columns.icodes or [""] * count, residues))
    order = {key: k for k, key in enumerate(dict.fromkeys(keys))}
    symbols, _, waters = _core._correct_elements([order[key] for key in keys], residues, names, elements, centers)
    marks: _Bools = np.isin(symbols, ["H", "D"]) | np.array(waters, bool) | [bool(text.strip()) for text in altlocs]
    return marks


class Selector:
    """Selections of the atoms of a molecule by its columns of names, a value for each atom. `own` returns the
    mask of a selection in gemmi's syntax or, with `syntax`, in the language of the molecule's library, which
    `syntax` names with an example."""

    def __init__(self, names: Any, own: Optional[Callable[[Any], Any]] = None, syntax: str = "") -> None:
        self.names = _Names(*(getattr(names, name) for name in _Names._fields))
        self._own, self._syntax = own, syntax if own is not None else ""

    def __reduce__(self) -> Any:
        return Selector, (self.names,)  # without the library's objects and the file

    def mask(self, chosen: Any, what: str) -> _Bools:
        """Returns the mask of a selection, a part of a molecule as an object of a library, a mask or indices.
        Raises ValueError, which begins with `what`, if the selection is not valid or has no atoms."""
        selector = self
        if is_gemmi_selection(chosen):  # of gemmi's syntax also if the library of the molecule has another one
            selector, chosen = Selector(self.names) if self._syntax else self, chosen.str()
        if isinstance(chosen, str):
            mask = selector._of_text(chosen, what)
        elif self._syntax.startswith("MDAnalysis") and hasattr(chosen, "universe"):  # such as an AtomGroup
            mask = self._of_own(chosen, what)
        elif adaptors.find_adaptor(chosen):
            mask = self._of_part(chosen, what)
        else:
            mask = self._of_numbers(chosen, what)
        if not mask.any():
            raise ValueError(f"{what}: no atoms" + (f" in {chosen!r}; {self._contents()}" if isinstance(chosen, str)
                                                    else " are selected"))
        mask.flags.writeable = False
        return mask

    def without_file(self) -> Selector:
        """Returns a selector by the columns of names, or by the library of the molecule."""
        return self if self._syntax else Selector(self.names)

    def ligand(self, text: str) -> bool:
        """Whether a selection is that of ligands by their names, or of all."""
        return text.startswith(_LIGAND) or (text == "ligand" and text not in self.names.chain)

    def _of_own(self, chosen: Any, what: str) -> _Bools:
        try:
            return np.array(self._own(chosen), bool) if self._own else np.zeros(0, bool)
        except ValueError as error:
            raise ValueError(f"{what}: {error}") from None

    def _of_part(self, part: Any, what: str) -> _Bools:
        """Returns the mask of the atoms at the positions of a part of the molecule."""
        columns = adaptors.columns_of(part)
        found = find_points(self.names.positions, np.array(columns.centers, float).reshape(-1, 3))
        is_known = found >= 0
        missing = ~is_known
        if is_known.any() and missing.any():
            missing &= ~_may_be_left_out(columns)
        if missing.any():
            raise ValueError(f"{what}: {int(missing.sum())} of {len(found)} atoms of the given "
                             f"{type(part).__name__} are not at the positions of atoms of the molecule")
        mask = np.zeros(len(self.names.name), bool)
        mask[found[is_known]] = True
        return mask

    def _of_numbers(self, chosen: Any, what: str) -> _Bools:
        count = len(self.names.name)
        given = np.asarray(chosen)
        if given.dtype == bool:
            return _arguments.require_mask(what, given, count)
        if given.size and given.dtype.kind not in "iu":
            is_list = isinstance(chosen, (list, tuple)) and all(isinstance(each, str) for each in chosen)
            advice = f"; give chains as one text, {'+'.join(chosen)!r:.40}" if is_list else ""
            raise TypeError(f"{what} must be a selection, a mask or indices of atoms, not {chosen!r:.80}{advice}")
        mask = np.zeros(count, bool)
        try:
            mask[given.astype(np.int64) if given.size else []] = True
        except IndexError as error:
            raise ValueError(f"{what}: {error}") from None
        return mask

    def _of_text(self, text: str, what: str) -> _Bools:
        names = self.names
        chains = [name.strip() for name in re.split("[+,]", text)]
        known = set(names.chain.tolist()) - {""}
        if set(chains) <= known:
            return np.isin(names.chain, chains)
        if self._own is None and not (names.residue != "").any() and not known:
            raise ValueError(f"{what}: the atoms have no names of chains and residues; give a mask or indices")
        if text == "ligand" or text.startswith(_LIGAND):
            try:
                return self._of_gemmi(text)
            except ValueError as error:
                raise ValueError(f"{what}: {str(error).removeprefix('selection: ')}") from None
        try:
            if self._syntax or re.search(r"[/(\[;:*!]|^-?\d", text):
                return np.array(self._own(text), bool) if self._own else self._of_gemmi(text)
        except (OSError, MemoryError):
            raise
        except Exception as error:  # those of other libraries
            if text.isdigit():
                kind = "chain" if self._syntax else "chain or residue"
                advice = f"; selections have the syntax of {self._syntax}" if self._syntax else ""
                raise ValueError(f"{what}: no {kind} {text!r}; {self._contents()}{advice}") from error
            one_line = " ".join(str(error).replace("^", " ").split())
            message = re.sub("^selection: |(?<=: )selection: ", "", one_line).rstrip(". ")
            raise ValueError(f"{what}: {message}{self._hint(text)}") from error
        missing = next(name for name in chains if name not in known)
        where = np.flatnonzero(names.residue == missing)
        advice = f"; residue {missing} is ligand:{missing}" if len(where) else self._hint(text)
        raise ValueError(f"{what}: no chain {missing!r}; {self._contents()}{advice}")

    def _hint(self, text: str) -> str:
        """Returns the language of selections, for messages about a text that may be in another one."""
        if self._syntax:
            return f"; selections have the syntax of {self._syntax}, and not gemmi's" if set(text) & set("/([;!") else ""
        is_other = " " in text.strip() or text in ("protein", "nucleic", "water", "backbone", "all", "hetero")
        return "; selections have gemmi's syntax, such as //A/57/CA, (HEM) or ;polymer" if is_other else ""

    def _of_gemmi(self, text: str) -> _Bools:
        """Returns the mask of a selection in gemmi's syntax, ``ligand`` or a text such as ``ligand:STI``."""
        names = self.names
        numbers = [f"{number}{icode}" for number, icode in zip(names.residue_number.tolist(), names.icode.tolist())]
        rows = list(zip(names.chain.tolist(), names.residue.tolist(), numbers, names.name.tolist(),
                        names.element.tolist()))
        return np.array(_core._select_atoms(rows, text), bool)

    def _contents(self) -> str:
        """Returns the chains with their residues, for messages."""
        names = self.names
        texts = []
        for chain in dict.fromkeys(names.chain.tolist()):
            numbers = names.residue_number[names.chain == chain]
            texts.append(f"{chain or '(blank)'} (residues {numbers.min()} to {numbers.max()})")
        return f"the chains are {listed(texts)}"


# The molecules of surfaces: the kept atoms of all, and the selector.
_molecule_of: weakref.WeakKeyDictionary[_core.Surface, tuple[Any, Selector]] = weakref.WeakKeyDictionary()


def remember_molecule(surface: _core.Surface, kept: Any, selector: Selector) -> None:
    """Remembers the molecule of a surface, whose atoms are the kept ones. Its selections do not read a file again."""
    _molecule_of[surface] = (kept, selector.without_file())


def molecule_of(surface: _core.Surface) -> Optional[tuple[Any, Selector]]:
    """Returns the kept atoms and the selector of a surface, if it is of a molecule."""
    return _molecule_of.get(surface)
