"""Areas with the arguments and units of MDTraj. The areas are exact, without sampling."""

from __future__ import annotations

import importlib
from typing import Any, Mapping, Optional

import numpy as np

from . import _arguments, _core
from ._select import listed

__all__ = ["shrake_rupley"]


def shrake_rupley(traj: Any, probe_radius: float = 0.14, n_sphere_points: int = 960, mode: str = "atom",
                  change_radii: Optional[Mapping[str, float]] = None, get_mapping: bool = False,
                  atom_indices: Any = None, *, surface: str = "sas", threads: int = 0) -> Any:
    """Compute areas as mdtraj.shrake_rupley, in closed form.

    Parameters
    ----------
    traj : mdtraj.Trajectory
        All its atoms block, also waters.
    probe_radius : float, optional
        Radius of the probe, in nanometres.
    n_sphere_points : int, optional
        Not used.
    mode : {'atom', 'residue'}, optional
        Whether areas are those of atoms or of residues.
    change_radii : mapping, optional
        Radii of elements in nanometres in place of those of MDTraj.
    get_mapping : bool, optional
        Whether the result is a pair of the areas and the index of the column of each atom.
    atom_indices : array_like, optional
        The atoms whose areas are computed, while all atoms block. Columns without such an atom are -1.
    surface : {'sas', 'ses'}, optional
        The surface.
    threads : int, optional
        Number of threads; 0 for all.

    Returns
    -------
    ndarray
        (frames, atoms or residues) areas in square nanometres.
    """
    _arguments.check(shrake_rupley, probe_radius=probe_radius, mode=mode, get_mapping=get_mapping, threads=threads)
    _arguments.require_choice("mode", mode, "atom", "residue")
    _arguments.require_choice("surface", surface, "sas", "ses")
    _arguments.require_object("traj", traj, ("topology", "xyz", "n_frames"), "a Trajectory of MDTraj")
    atoms = list(traj.topology.atoms)
    radii = importlib.import_module("mdtraj.geometry.sasa")._ATOMIC_RADII | _arguments.require_radii("change_radii", change_radii)
    if unknown := listed(symbol for atom in atoms if (symbol := atom.element.symbol) not in radii):
        raise KeyError(f"change_radii: MDTraj has no radii of {unknown}; give them")
    angstrom = 10.0
    measures = _core.measure_frames(
        angstrom * np.asarray(traj.xyz, float), [angstrom * radii[atom.element.symbol] for atom in atoms],
        angstrom * probe_radius, ses=surface == "ses", by_atom=True, threads=threads)
    assert measures.by_atom is not None
    areas = getattr(measures.by_atom, surface) / angstrom**2
    mapping = np.arange(len(atoms), dtype=np.int32)
    if mode == "residue":
        mapping = np.array([atom.residue.index for atom in atoms], np.int32)
    chosen = np.arange(len(atoms))
    if atom_indices is not None:
        chosen = _arguments.require_indices("atom_indices", atom_indices, len(atoms))
    counted = chosen[chosen >= 0]  # as in MDTraj, a negative index chooses a column, but no area
    result = np.full((traj.n_frames, traj.n_atoms if mode == "atom" else traj.n_residues), -1.0, np.float32)
    sums = np.zeros(result.shape)
    columns: Any = (slice(None), mapping[counted])
    np.add.at(sums, columns, areas[:, counted])
    result[:, mapping[chosen]] = sums[:, mapping[chosen]]
    return (result, mapping) if get_mapping else result
