"""Surfaces of molecules: solvent excluded, solvent accessible, van der Waals.

Lengths are in angstrom, areas in square angstrom, volumes in cubic angstrom. Indices start from 0.

Examples
--------
>>> import eses_blocks as eses
>>> result = eses.measure("fas2.pqr")
>>> print(f"{result.ses_area:.1f} {result.ses_volume:.1f} {result.sas_area:.1f}")
3663.1 8209.7 4525.8
>>> atoms = eses.read_atoms("1ubq.xyzr")
>>> surface = eses.Surface(atoms.centers, atoms.radii, probe_radius=1.4)
>>> grid = surface.grid(spacing=0.5, margin=1.0)
>>> result = surface.compute(grid)
>>> result.inside.shape == grid.shape
True
"""


def _load_core() -> None:
    """Loads the compiled module. The OpenMP of g++ reads the environment then. By default, its threads spin while
    they wait for each other: where other programs use the processors, two threads take twice the CPU time of one."""
    import importlib
    import os

    is_chosen = "OMP_WAIT_POLICY" in os.environ
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    try:
        importlib.import_module("._core", __name__)
    finally:
        if not is_chosen:
            del os.environ["OMP_WAIT_POLICY"]


_load_core()
del _load_core

from typing import TYPE_CHECKING

from . import adaptors
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
from ._interface import Interface, Interfaces, interface, interfaces
from ._measurement import Measurement, Table, measure
from ._molecule import Molecule, Radii, read_molecule
from ._shown import add_methods

if TYPE_CHECKING:
    from . import biopython, biotite, mdanalysis, mdtraj
else:

    def __getattr__(name):
        """Imports a module in place of functions of another library when it is first used."""
        import importlib

        if name in ("biopython", "biotite", "mdanalysis", "mdtraj"):
            return importlib.import_module(f"{__name__}.{name}")
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


add_methods(Atoms, Mesh, Result, Surface)
del add_methods
for _each in (Interface, Interfaces, Measurement, Molecule, Radii, Table, interface, interfaces, measure, read_molecule):
    _each.__module__ = __name__  # where users find it
del _each

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
    "Interface",
    "Interfaces",
    "Labels",
    "Measurement",
    "Measures",
    "Mesh",
    "Molecule",
    "Radii",
    "Result",
    "Surface",
    "Table",
    "__version__",
    "adaptors",
    "interface",
    "interfaces",
    "measure",
    "measure_frames",
    "read_atoms",
    "read_grid",
    "read_molecule",
]
