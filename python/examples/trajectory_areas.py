#!/usr/bin/env python3
"""Analyses a trajectory with MDAnalysis: prints areas and volumes of each frame as CSV.

    trajectory_areas.py TOPOLOGY [TRAJECTORY...] [--select SELECTION] [--radii FILE] [--probe-radius ANGSTROM]

TOPOLOGY and TRAJECTORY are any files that MDAnalysis reads. The radii are those of the topology, as in
PQR files, or of FILE, which has the selected atoms in the same order: xyzr, PQR, PDB or mmCIF. Other
programs can import the class SurfaceAreas.
"""

import argparse
import sys

import numpy as np
from MDAnalysis import Universe
from MDAnalysis.analysis.base import AnalysisBase

import eses_blocks as eses

BATCH = 64  # frames that are measured at a time, on all processors


class SurfaceAreas(AnalysisBase):
    """Areas and volumes of a group of atoms by frame, without a grid.

    After ``run``, ``results.ses_area``, ``results.ses_volume``, ``results.sas_area`` and
    ``results.sas_volume`` have a value for each frame, in square and cubic angstrom, and
    ``results.atom_sas_area`` has shape (frames, atoms).
    """

    NAMES = ("ses_area", "ses_volume", "sas_area", "sas_volume")

    def __init__(self, atoms, radii=None, probe_radius=1.4, **arguments):
        super().__init__(atoms.universe.trajectory, **arguments)
        self._atoms = atoms
        self._radii = atoms.radii if radii is None else np.asarray(radii)
        self._probe_radius = probe_radius

    def _prepare(self):
        for name in self.NAMES:
            self.results[name] = np.empty(self.n_frames)
        self.results.atom_sas_area = np.empty((self.n_frames, len(self._atoms)))
        self._positions = []

    def _single_frame(self):
        self._positions.append(self._atoms.positions)
        if len(self._positions) == BATCH:
            self._measure(self._frame_index + 1)

    def _conclude(self):
        if self._positions:
            self._measure(self.n_frames)

    def _measure(self, end):
        """Measures the frames that wait, of which the last one is the one before `end`."""
        frames = slice(end - len(self._positions), end)
        measures = eses.measure_frames(self._positions, self._radii, self._probe_radius, by_atom=True)
        for name in self.NAMES:
            self.results[name][frames] = getattr(measures, name)
        self.results.atom_sas_area[frames] = measures.by_atom.sas
        self._positions = []


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("topology", metavar="TOPOLOGY")
    parser.add_argument("trajectories", metavar="TRAJECTORY", nargs="*")
    parser.add_argument("--select", default="all", metavar="SELECTION",
                        help="atoms in the syntax of MDAnalysis (default: all)")
    parser.add_argument("--radii", metavar="FILE", help="file with the radii of the selected atoms")
    parser.add_argument("--probe-radius", type=float, default=1.4, metavar="ANGSTROM")
    arguments = parser.parse_args()

    atoms = Universe(arguments.topology, *arguments.trajectories).select_atoms(arguments.select)
    radii = eses.read_atoms(arguments.radii).radii if arguments.radii else None
    analysis = SurfaceAreas(atoms, radii, arguments.probe_radius).run()
    print("frame,time," + ",".join(SurfaceAreas.NAMES))
    for frame, time, *values in zip(analysis.frames, analysis.times,
                                    *(analysis.results[name] for name in SurfaceAreas.NAMES)):
        print(f"{frame},{time:.6g}," + ",".join(f"{value:.10g}" for value in values))


if __name__ == "__main__":
    try:
        main()
    except (AttributeError, OSError, ValueError) as error:
        sys.exit(f"trajectory_areas.py: {error}")
