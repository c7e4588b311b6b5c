#!/usr/bin/env python3
"""Prints the surface area and volume of each frame of a trajectory as CSV.

    trajectory.py ATOMS FRAMES [--spacing ANGSTROM] [--threads N]

ATOMS is a file with the radii of the atoms, xyzr or PQR. FRAMES has the centres, in angstrom: an array
of shape (frames, atoms, 3) in a file NAME.npy, or any trajectory that MDAnalysis reads.
"""

import argparse
import sys

import numpy as np

import eses_blocks as eses


def read_frames(path):
    """Yields an array (atoms, 3) for each frame."""
    if path.endswith(".npy"):
        yield from np.load(path, mmap_mode="r")
        return
    import MDAnalysis  # pylint: disable=import-outside-toplevel
    universe = MDAnalysis.Universe(path)
    for frame in universe.trajectory:
        yield frame.positions


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("atoms", metavar="ATOMS", help="xyzr or PQR file with the radii")
    parser.add_argument("frames", metavar="FRAMES", help=".npy file, or a file for MDAnalysis")
    parser.add_argument("--spacing", type=float, default=0.5, metavar="ANGSTROM")
    parser.add_argument("--threads", type=int, default=0, metavar="N")
    arguments = parser.parse_args()

    radii = eses.read_atoms(arguments.atoms).radii
    print("frame,area,volume")
    for number, centers in enumerate(read_frames(arguments.frames)):
        surface = eses.Surface(centers, radii)
        grid = surface.grid(arguments.spacing, margin=2 * arguments.spacing)
        # Totals need no arrays.
        result = surface.compute(grid, threads=arguments.threads, inside=False, crossings=False)
        print(f"{number},{result.area:.6g},{result.volume:.6g}")


if __name__ == "__main__":
    try:
        main()
    except (OSError, ValueError) as error:
        sys.exit(f"trajectory.py: {error}")
