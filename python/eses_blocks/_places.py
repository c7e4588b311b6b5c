"""Cavities and pockets of a surface at atoms of its molecule, or at another molecule."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from . import _core, _molecule, adaptors
from ._references import is_polymer
from ._select import find_points, is_gemmi_selection, molecule_of


def names_atoms(at: Any) -> bool:
    """Whether a place is a selection, a mask, or a part of a molecule, and no point or box."""
    if isinstance(at, str) or adaptors.find_adaptor(at) is not None:
        return True
    return isinstance(at, (list, np.ndarray)) and len(at) > 0 and isinstance(at[0], (bool, np.bool_))


def atoms_of_selection(surface: _core.Surface, at: Any) -> tuple[Any, bool]:
    """Returns the mask of a selection among the atoms of the surface, and whether it is that of ligands."""
    molecule = molecule_of(surface)
    if molecule is None:
        raise ValueError(f"at={at!r:.40}: the surface has no names of atoms; make it from a file or a molecule, or give "
                         "a point, atoms= or balls=")
    kept, selector = molecule
    chosen = selector.mask(at, "at")[kept]
    if not chosen.any():
        raise ValueError(f"at: all atoms of {at!r:.40} are left out of the surface")
    return chosen, isinstance(at, str) and selector.ligand(at)


def _find_at_part(surface: _core.Surface, method: str, part: Any, options: dict[str, Any]) -> list[dict[str, Any]]:
    """Returns what is at a part of the molecule, or at another molecule."""
    columns = adaptors.columns_of(part)
    found = find_points(surface.centers, np.array(columns.centers, float).reshape(-1, 3))
    chosen = np.zeros(len(surface), bool)
    chosen[found[found >= 0]] = True
    if chosen.any():
        is_ligand = not any(is_polymer(str(name)) for name in columns.residues or ())
        return _find_at_atoms(surface, method, chosen, is_ligand, part, options)
    molecule = _molecule.read_molecule(part)
    return getattr(surface, method)(balls=(molecule.centers, molecule.radii), **options)  # type: ignore[no-any-return]


def _find_at_atoms(surface: _core.Surface, method: str, chosen: Any, is_ligand: bool, at: Any,
                   options: dict[str, Any]) -> list[dict[str, Any]]:
    """Returns what is at atoms of the surface. Ligands are left out of it."""
    if not is_ligand:
        return getattr(surface, method)(atoms=np.flatnonzero(chosen), **options)  # type: ignore[no-any-return]
    others = np.flatnonzero(~chosen)
    if not len(others):
        raise ValueError(f"at: there are no atoms besides {at!r:.40}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the surface has already warned of its atoms
        rest = _core.Surface(surface.centers[others], surface.radii[others], surface.probe_radius,
                             fill_cavities=surface.fill_cavities, threads=options["threads"])
    found: list[dict[str, Any]] = getattr(rest, method)(balls=(surface.centers[chosen], surface.radii[chosen]), **options)
    for each in found:
        each["atoms"] = others[each["atoms"]]
    return found


def find_at(surface: _core.Surface, method: str, at: Any, options: dict[str, Any]) -> list[dict[str, Any]]:
    """Returns the cavities or pockets at a selection or a part of a molecule."""
    if adaptors.find_adaptor(at) and not is_gemmi_selection(at):
        return _find_at_part(surface, method, at, options)
    chosen, is_ligand = atoms_of_selection(surface, at)
    return _find_at_atoms(surface, method, chosen, is_ligand, at, options)
