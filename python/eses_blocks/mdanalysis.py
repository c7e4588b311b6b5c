"""An analysis of MDAnalysis: areas of each frame. The areas are exact, without sampling."""

from __future__ import annotations

import importlib
import warnings
from typing import Any, Optional

import numpy as np

from ._measurement import measure
from ._select import listed

__all__ = ["SASAAnalysis"]

AnalysisBase: Any = importlib.import_module("MDAnalysis.analysis.base").AnalysisBase


class SASAAnalysis(AnalysisBase):  # type: ignore[misc]
    """Areas of a selection in each frame of a trajectory, while other atoms may block.

    Parameters
    ----------
    universe_or_atomgroup : MDAnalysis.Universe or AtomGroup
        The molecule.
    select : str, optional
        The atoms whose areas are reported.
    block : str, optional
        The atoms that make up the surface, beside those of ``select``; by default only these. Without another
        atom, a warning names the residues.
    surface : {'sas', 'ses'}, optional
        The surface.
    **options
        Further arguments of ``eses_blocks.measure``, such as ``radii`` and ``waters``.

    ``results`` has, after ``run()``: ``total_area`` (frames,), ``residue_area`` (frames, residues of the
    selection), ``mean_total_area`` and ``mean_residue_area``, in square angstrom.
    """

    @classmethod
    def get_supported_backends(cls) -> Any:
        return ("serial", "multiprocessing", "dask")

    _analysis_algorithm_is_parallelizable = True

    def __init__(self, universe_or_atomgroup: Any, select: str = "all", block: Optional[str] = None,
                 surface: str = "sas", **options: Any) -> None:
        group = universe_or_atomgroup.atoms
        super().__init__(group.universe.trajectory)
        if surface not in ("sas", "ses"):
            raise ValueError(f"surface must be 'sas' or 'ses', not {surface!r}")
        self.atomgroup = group.select_atoms(select)
        self._block = self.atomgroup if block is None else group.select_atoms(block) | self.atomgroup
        if block not in (None, select) and len(self._block) == len(self.atomgroup):
            warnings.warn(f"block={block!r} adds no atoms to select={select!r}, so that nothing else blocks; the residues of other atoms "
                          f"are {listed((group - self.atomgroup).residues.resnames)}", stacklevel=2)
        self._mask = np.isin(self._block.ix, self.atomgroup.ix)
        self._surface, self._options = surface, options

    def _prepare(self) -> None:
        self.results.total_area = []
        self.results.residue_area = []

    def _single_frame(self) -> None:
        result = measure(self._block, report=self._mask, **self._options)
        areas = np.nan_to_num(result.atoms[self._surface][self._mask])
        rows = np.searchsorted(self.atomgroup.residues.ix, self.atomgroup.resindices)
        self.results.total_area.append(float(areas.sum()))
        self.results.residue_area.append(np.bincount(rows, areas, len(self.atomgroup.residues)))

    def _conclude(self) -> None:
        self.results.total_area = np.array(self.results.total_area)
        self.results.residue_area = np.array(self.results.residue_area)
        self.results.mean_total_area = self.results.total_area.mean()
        self.results.mean_residue_area = self.results.residue_area.mean(axis=0)

    def _get_aggregator(self) -> Any:
        ResultsGroup: Any = importlib.import_module("MDAnalysis.analysis.results").ResultsGroup  # MDAnalysis 2.8
        join = ResultsGroup.flatten_sequence
        return ResultsGroup(lookup={"total_area": join, "residue_area": join})
