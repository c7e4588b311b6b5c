"""Solvent excluded surface of molecules on Cartesian grids.

Lengths are in angstrom, areas in square angstrom, volumes in cubic angstrom. Indices start from 0.

Examples
--------
>>> import eses_blocks as eses
>>> atoms = eses.read_atoms("1ubq.xyzr")
>>> surface = eses.Surface(atoms.centers, atoms.radii, probe_radius=1.4)
>>> grid = surface.grid(spacing=0.5, margin=1.0)
>>> result = surface.compute(grid)
>>> result.inside.shape == grid.shape
True
"""

from ._core import (
    AtomAreas,
    Atoms,
    Block,
    BlockIterator,
    Crossings,
    Diagnostic,
    FrameMeasures,
    Gradient,
    Gradients,
    Grid,
    Labels,
    Measures,
    Mesh,
    Result,
    Surface,
    __version__,
    measure_frames,
    read_atoms,
    read_grid,
)
from ._shown import add_methods

add_methods(Mesh, Result, Surface)
del add_methods

__all__ = [
    "AtomAreas",
    "Atoms",
    "Block",
    "BlockIterator",
    "Crossings",
    "Diagnostic",
    "FrameMeasures",
    "Gradient",
    "Gradients",
    "Grid",
    "Labels",
    "Measures",
    "Mesh",
    "Result",
    "Surface",
    "__version__",
    "measure_frames",
    "read_atoms",
    "read_grid",
]
