"""Selections of atoms: chains, ligands, gemmi's syntax, and the languages of other libraries."""

from __future__ import annotations

import re
import warnings
import weakref
from typing import Any, Callable, Iterable, NamedTuple, Optional

import numpy as np
import numpy.typing as npt

from . import _core
from ._references import is_polymer

_Bools = npt.NDArray[np.bool_]
_LIGAND = "ligand:"


def _listed(names: Iterable[str], limit: int = 10) -> str:
    known = list(dict.fromkeys(names))
    shown = ", ".join(name or "(blank)" for name in known[:limit])
    return shown + (f" and {len(known) - limit} more" if len(known) > limit else "")


class _Names(NamedTuple):
    """The columns that selections need. A surface of a molecule keeps them."""

    chain: npt.NDArray[np.str_]
    residue: npt.NDArray[np.str_]
    residue_number: npt.NDArray[np.int64]
    icode: npt.NDArray[np.str_]
    name: npt.NDArray[np.str_]
    element: npt.NDArray[np.str_]


class Selector:
    """Selections of the atoms of a molecule by its columns of names, a value for each atom. `own` returns the
    mask of a selection in gemmi's syntax or, with `has_own_syntax`, in the language of the molecule's library."""

    def __init__(self, names: Any, own: Optional[Callable[[Any], Any]] = None, has_own_syntax: bool = False) -> None:
        self._names = _Names(names.chain, names.residue, names.residue_number, names.icode, names.name, names.element)
        self._own, self._has_own_syntax = own, has_own_syntax and own is not None

    def mask(self, chosen: Any, what: str) -> _Bools:
        """Returns the mask of a selection, an AtomGroup, a mask or indices. Raises ValueError, which begins with
        `what`, if the selection is not valid or has no atoms."""
        if isinstance(chosen, str):
            mask = self._of_text(chosen, what)
        elif hasattr(chosen, "ix"):  # an AtomGroup of MDAnalysis
            if not self._has_own_syntax or self._own is None:
                raise ValueError(f"{what}: the molecule is not of MDAnalysis; give a selection, a mask or indices")
            mask = np.asarray(self._own(chosen), bool)
        else:
            mask = self._of_numbers(chosen, what)
        if not mask.any():
            raise ValueError(f"{what}: no atoms" + (f" in {chosen!r}; {self._contents()}" if isinstance(chosen, str)
                                                    else " are selected"))
        mask.flags.writeable = False
        return mask

    def without_file(self) -> Selector:
        """Returns a selector by the columns of names, or by the library of the molecule."""
        return self if self._has_own_syntax else Selector(self._names)

    def ligand(self, text: str) -> bool:
        """Whether a selection is that of ligands by their names, or of all."""
        return text.startswith(_LIGAND) or (text == "ligand" and text not in self._names.chain)

    def _of_numbers(self, chosen: Any, what: str) -> _Bools:
        count = len(self._names.name)
        given = np.asarray(chosen)
        if given.dtype == bool:
            if given.shape != (count,):
                raise ValueError(f"{what}: a mask must have shape ({count},), one value for each atom, not {given.shape}")
            return given.copy()
        if given.size and given.dtype.kind not in "iu":
            raise TypeError(f"{what} must be a selection, a mask or indices of atoms, not {chosen!r:.80}")
        mask = np.zeros(count, bool)
        try:
            mask[given.astype(np.int64) if given.size else []] = True
        except IndexError as error:
            raise ValueError(f"{what}: {error}") from None
        return mask

    def _of_text(self, text: str, what: str) -> _Bools:
        names = self._names
        if text.startswith(_LIGAND):
            return self._of_residue(text.removeprefix(_LIGAND), what)
        chains = [name.strip() for name in re.split("[+,]", text)]
        known = set(names.chain.tolist()) - {""}
        if set(chains) <= known:
            return np.isin(names.chain, chains)
        if self._own is None and not (names.residue != "").any() and not known:
            raise ValueError(f"{what}: the atoms have no names of chains and residues; give a mask or indices")
        try:
            if text == "ligand":
                return self._of_gemmi(None)
            if self._has_own_syntax or re.search(r"[/(\[;:*]|^-?\d", text):
                return np.array(self._own(text), bool) if self._own else self._of_gemmi(text)
        except (OSError, MemoryError):
            raise
        except Exception as error:  # those of other libraries
            if text.isdigit():
                raise ValueError(f"{what}: no chain or residue {text!r}; {self._contents()}") from error
            message = str(error).removeprefix("selection: ").replace(": selection: ", ": ")
            raise ValueError(f"{what}: {message}") from error
        missing = next(name for name in chains if name not in known)
        where = np.flatnonzero(names.residue == missing)
        advice = f"; residue {missing} is ligand:{missing}" if len(where) else ""
        raise ValueError(f"{what}: no chain {missing!r}; {self._contents()}{advice}")

    def _of_residue(self, name: str, what: str) -> _Bools:
        chain, slash, residue = name.rpartition("/")
        names = self._names
        mask: _Bools = names.residue == residue
        if slash:  # CHAIN/NUMBER or CHAIN/NAME
            numbers = np.char.add(names.residue_number.astype(str), names.icode)
            mask = (names.chain == chain) & (mask | (numbers == residue))
        if not mask.any():
            residues = sorted(dict.fromkeys(self._names.residue.tolist()), key=is_polymer)  # ligands first
            raise ValueError(f"{what}: no residue {name!r}; the residues are {_listed(residues)}")
        return mask

    def _of_gemmi(self, text: Optional[str]) -> _Bools:
        """Returns the mask of a selection in gemmi's syntax; without one, that of all ligands."""
        names = self._names
        numbers = [f"{number}{icode}" for number, icode in zip(names.residue_number.tolist(), names.icode.tolist())]
        rows = list(zip(names.chain.tolist(), names.residue.tolist(), numbers, names.name.tolist(),
                        names.element.tolist()))
        return np.array(_core._select_atoms(rows, text), bool)

    def _contents(self) -> str:
        """Returns the chains with their residues, for messages."""
        names = self._names
        texts = []
        for chain in dict.fromkeys(names.chain.tolist()):
            numbers = names.residue_number[names.chain == chain]
            texts.append(f"{chain or '(blank)'} (residues {numbers.min()} to {numbers.max()})")
        return f"the chains are {_listed(texts)}"


# ------------------------------------------------------------------------------ places of a surface

# The molecules of surfaces: the kept atoms of all, and the selector.
_molecule_of: weakref.WeakKeyDictionary[_core.Surface, tuple[Any, Selector]] = weakref.WeakKeyDictionary()


def remember_molecule(surface: _core.Surface, kept: Any, selector: Selector) -> None:
    """Remembers the molecule of a surface, whose atoms are the kept ones. Its selections do not read a file again."""
    _molecule_of[surface] = (kept, selector.without_file())


def find_at(surface: _core.Surface, method: str, text: str, options: dict[str, Any]) -> list[dict[str, Any]]:
    """Returns the cavities or pockets at a selection. Ligands are left out of the surface."""
    if surface not in _molecule_of:
        raise ValueError(f"at={text!r}: the surface has no names of atoms; make it from a file or a molecule, or give "
                         "a point, atoms= or balls=")
    kept, selector = _molecule_of[surface]
    chosen = selector.mask(text, "at")[kept]
    if not chosen.any():
        raise ValueError(f"at: all atoms of {text!r} are left out of the surface")
    if not selector.ligand(text):
        return getattr(surface, method)(atoms=np.flatnonzero(chosen), **options)  # type: ignore[no-any-return]
    others = np.flatnonzero(~chosen)
    if not len(others):
        raise ValueError(f"at: there are no atoms besides {text!r}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the surface has already warned of its atoms
        rest = _core.Surface(surface.centers[others], surface.radii[others], surface.probe_radius,
                             fill_cavities=surface.fill_cavities, threads=options["threads"])
    found: list[dict[str, Any]] = getattr(rest, method)(balls=(surface.centers[chosen], surface.radii[chosen]), **options)
    for each in found:
        each["atoms"] = others[each["atoms"]]
    return found
