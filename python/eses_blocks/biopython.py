"""Areas as attributes of Biopython's entities. The areas are exact, without sampling."""

from __future__ import annotations

import importlib
from typing import Any, Mapping, Optional

import numpy as np

from . import _arguments, _core

__all__ = ["compute"]

_LEVELS = "ARCMS"


def compute(entity: Any, level: str = "A", *, probe_radius: float = 1.4,
            radii_dict: Optional[Mapping[str, float]] = None, threads: int = 0) -> None:
    """Set the attributes ``sasa`` and ``ses``, as Bio.PDB.SASA.ShrakeRupley.compute sets ``sasa``.

    Parameters
    ----------
    entity : Bio.PDB.Entity
        A residue, chain, model or structure. All its atoms block, also waters and those of all models.
    level : {'A', 'R', 'C', 'M', 'S'}, optional
        The entities that get the attributes, beside the atoms: residues, chains, models or structure.
    probe_radius : float, optional
        Radius of the probe, in angstrom.
    radii_dict : mapping, optional
        Radii of elements in angstrom in place of those of Biopython.
    threads : int, optional
        Number of threads; 0 for all.
    """
    kind = getattr(entity, "level", None)
    if kind not in tuple(_LEVELS[1:]) or not hasattr(entity, "get_atoms"):
        raise ValueError(f"entity must be a Residue, Chain, Model or Structure of Biopython, not {entity!r:.80}")
    _arguments.require_choice("level", level, *_LEVELS)
    _arguments.check(compute, probe_radius=probe_radius, threads=threads)
    if _LEVELS.index(level) > _LEVELS.index(kind):
        raise ValueError(f"level must be that of the entity, {kind!r}, or one below it, not {level!r}")
    atoms = list(entity.get_atoms())
    if not atoms:
        raise ValueError("entity: it has no atoms")
    known: Any = importlib.import_module("Bio.PDB.SASA").ATOMIC_RADII
    given = _arguments.require_radii("radii_dict", radii_dict)
    radii = [given[atom.element] if atom.element in given else known[atom.element] for atom in atoms]
    surface = _core.Surface(np.array([atom.coord for atom in atoms], float), radii, probe_radius, threads=threads)
    by_atom = surface.measure(by_atom=True, threads=threads).by_atom
    assert by_atom is not None
    sums: dict[int, list[Any]] = {}
    for atom, sas, ses in zip(atoms, by_atom.sas.tolist(), by_atom.ses.tolist()):
        atom.sasa, atom.ses = sas, ses
        owner = atom
        for _ in range(_LEVELS.index(level)):
            owner = owner.get_parent()
        entry = sums.setdefault(id(owner), [owner, 0.0, 0.0])
        entry[1] += sas
        entry[2] += ses
    if level != "A":
        for owner, sas, ses in sums.values():
            owner.sasa, owner.ses = sas, ses
