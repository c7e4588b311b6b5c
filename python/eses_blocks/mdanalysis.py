"""An analysis of MDAnalysis: areas of each frame. The areas are exact, without sampling."""

from __future__ import annotations

import importlib
import warnings
from typing import Any, Optional

import numpy as np

from . import _arguments
from ._measurement import measure
from ._select import listed

__all__ = ["SASAAnalysis"]

AnalysisBase: Any = importlib.import_module("MDAnalysis.analysis.base").AnalysisBase
SelectionError: Any = importlib.import_module("MDAnalysis.exceptions").SelectionError


_OPTIONS = ("radii", "probe_radius", "waters", "hydrogens", "unknown_radius", "fill_cavities", "threads")


def _selected(group: Any, text: Any, what: str) -> Any:
    if not isinstance(text, str):
        raise TypeError(f"{what} must be a text such as 'protein', not {text!r:.80}")
    try:
        return group.select_atoms(text)
    except (AttributeError, ValueError, SelectionError) as error:  # such as names that the universe does not have
        raise ValueError(f"{what}: {error}") from None


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
    verbose : bool, optional
        Whether ``run()`` shows its progress.
    **options
        ``radii``, ``probe_radius``, ``waters``, ``hydrogens``, ``unknown_radius``, ``fill_cavities`` and ``threads`` of
        ``eses_blocks.measure``.

    ``results`` has, after ``run()``: ``total_area`` (frames,), ``residue_area`` (frames, residues of the
    selection), ``mean_total_area`` and ``mean_residue_area``, in square angstrom.
    """

    @classmethod
    def get_supported_backends(cls) -> Any:
        return ("serial", "multiprocessing", "dask")

    _analysis_algorithm_is_parallelizable = True

    def __init__(self, universe_or_atomgroup: Any, select: str = "all", block: Optional[str] = None,
                 surface: str = "sas", verbose: bool = False, **options: Any) -> None:
        _arguments.require_object("universe_or_atomgroup", universe_or_atomgroup, ("atoms", "universe"),
                                  "a Universe or AtomGroup of MDAnalysis")
        group = universe_or_atomgroup.atoms
        self.universe = group.universe
        super().__init__(group.universe.trajectory, verbose=verbose)
        _arguments.require_choice("surface", surface, "sas", "ses")
        for name in options:
            if name not in _OPTIONS:
                _arguments.refuse_unknown(name, ["select", "block", "surface", "verbose", *_OPTIONS])
        _arguments.check(measure, **options)
        self.atomgroup = _selected(group, select, "select")
        self._block = self.atomgroup if block is None else _selected(group, block, "block") | self.atomgroup
        if not self.atomgroup:
            raise ValueError(f"select: no atoms in {select!r}; the residues are {listed(group.residues.resnames)}")
        if block not in (None, select) and len(self._block) == len(self.atomgroup):
            warnings.warn(f"block={block!r} adds no atoms to select={select!r}, so that nothing else blocks; the residues of other atoms "
                          f"are {listed((group - self.atomgroup).residues.resnames)}", stacklevel=2)
        self._mask = np.isin(self._block.ix, self.atomgroup.ix)
        self._surface, self._options = surface, {**options, "surfaces": surface}

    def _prepare(self) -> None:
        self.results.total_area = []
        self.results.residue_area = []

    def _single_frame(self) -> None:
        result: Any = measure(self._block, report=self._mask, **self._options)
        areas = np.nan_to_num(result.atoms[self._surface][self._mask])
        rows = np.searchsorted(self.atomgroup.residues.ix, self.atomgroup.resindices)
        self.results.total_area.append(float(areas.sum()))
        self.results.residue_area.append(np.bincount(rows, areas, len(self.atomgroup.residues)))

    def _conclude(self) -> None:
        if self.n_frames == 0:
            count = len(self.atomgroup.universe.trajectory)
            raise ValueError(f"no frames are analysed; the trajectory has {count} frame{'s' * (count != 1)}, counted from 0")
        self.results.total_area = np.array(self.results.total_area)
        self.results.residue_area = np.array(self.results.residue_area)
        self.results.mean_total_area = self.results.total_area.mean()
        self.results.mean_residue_area = self.results.residue_area.mean(axis=0)

    def _get_aggregator(self) -> Any:
        ResultsGroup: Any = importlib.import_module("MDAnalysis.analysis.results").ResultsGroup  # MDAnalysis 2.8
        join = ResultsGroup.flatten_sequence
        return ResultsGroup(lookup={"total_area": join, "residue_area": join})
