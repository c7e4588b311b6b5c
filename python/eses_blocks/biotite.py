"""Areas with the arguments of Biotite. The areas are exact, without sampling."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from . import _arguments, _core

__all__ = ["sasa"]


def sasa(array: Any, probe_radius: float = 1.4, atom_filter: Any = None, ignore_ions: bool = True,
         point_number: int = 1000, point_distr: Any = "Fibonacci", vdw_radii: Any = "ProtOr", *,
         surface: str = "sas", threads: int = 0) -> Any:
    """Compute areas as biotite.structure.sasa, in closed form.

    Parameters
    ----------
    array : AtomArray or AtomArrayStack
        The atoms. Waters, and hydrogens with ``ProtOr``, do not block.
    probe_radius : float, optional
        Radius of the probe, in angstrom.
    atom_filter : array_like, optional
        Mask of the atoms whose areas are computed, while all block.
    ignore_ions : bool, optional
        Whether ions of one atom are left out.
    point_number, point_distr : optional
        Not used.
    vdw_radii : {'ProtOr', 'Single'} or array_like, optional
        Radii as in Biotite, in angstrom.
    surface : {'sas', 'ses'}, optional
        The surface.
    threads : int, optional
        Number of threads; 0 for all.

    Returns
    -------
    ndarray
        (N,) areas, or (frames, N) for a stack; nan for atoms without an area.
    """
    _arguments.check(sasa, probe_radius=probe_radius, ignore_ions=ignore_ions, threads=threads)
    _arguments.require_choice("surface", surface, "sas", "ses")
    _arguments.require_object("array", array, ("coord", "res_name", "array_length"), "an AtomArray or AtomArrayStack of Biotite")
    count = array.array_length()
    structure: Any = importlib.import_module("biotite.structure")
    blocks = ~structure.filter_solvent(array)
    if ignore_ions:
        blocks &= ~structure.filter_monoatomic_ions(array)
    if isinstance(vdw_radii, str):
        if vdw_radii not in ("ProtOr", "Single"):
            raise KeyError(f"vdw_radii must be 'ProtOr', 'Single' or an array of radii, not {vdw_radii!r}")
        info: Any = importlib.import_module("biotite.structure.info")
        if vdw_radii == "ProtOr":  # of united atoms
            blocks &= structure.filter_heavy(array)
        radii = np.full(count, np.nan)
        for i in np.flatnonzero(blocks):
            found = (info.vdw_radius_protor(array.res_name[i], array.atom_name[i]) if vdw_radii == "ProtOr"
                     else info.vdw_radius_single(array.element[i]))
            radii[i] = 1.8 if found is None else found  # Biotite's default
    else:
        radii = _radii_of(vdw_radii, blocks)
    shown = blocks if atom_filter is None else blocks & _arguments.require_mask("atom_filter", atom_filter, count)
    coord = np.asarray(array.coord, float)
    frames = coord if coord.ndim == 3 else coord[None]
    areas = np.full(frames.shape[:2], np.nan)
    if shown.any():
        measures = _core.measure_frames(frames[:, blocks], radii[blocks], probe_radius, ses=surface == "ses",
                                        by_atom=True, threads=threads)
        assert measures.by_atom is not None
        areas[:, blocks] = getattr(measures.by_atom, surface)
        areas[:, ~shown] = np.nan
    return areas if coord.ndim == 3 else areas[0]


def _radii_of(given: Any, blocks: Any) -> Any:
    """Returns the radii that the caller gives, of which those of the atoms that block must be numbers."""
    try:
        radii = np.array(given, float)
    except (TypeError, ValueError):
        raise TypeError(f"vdw_radii must be 'ProtOr', 'Single' or an array of radii, not {given!r:.80}") from None
    if radii.shape != blocks.shape:
        raise ValueError(f"vdw_radii must have shape {blocks.shape}, one for each atom, not {radii.shape}")
    for i in np.flatnonzero(blocks & ~((radii >= 0) & (radii < np.inf))).tolist():
        raise ValueError(f"vdw_radii: atom {i} (counted from 0) has radius {radii[i]:g}; give a finite number that is not negative")
    return radii
