#!/usr/bin/env python3
"""Prints surface areas of a protein and its ligand, per residue and element, as CSV.

    ligand_features.py PROTEIN.pqr LIGAND.pqr [--spacing ANGSTROM]

The area of a row is that of the protein alone or the ligand alone. The buried area is the area that
it loses in the complex. All three surfaces are computed on the grid of the complex, so that atoms
far from the interface lose exactly nothing.
"""

import argparse
import collections
import sys

import numpy as np

import eses_blocks as eses


def areas_on(grid, centers, radii):
    return eses.Surface(centers, radii).compute(grid, inside=False, crossings=False).atom_areas


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("protein", metavar="PROTEIN.pqr")
    parser.add_argument("ligand", metavar="LIGAND.pqr")
    parser.add_argument("--spacing", type=float, default=0.5, metavar="ANGSTROM")
    arguments = parser.parse_args()

    parts = {"protein": eses.read_atoms(arguments.protein, format="pqr"),
             "ligand": eses.read_atoms(arguments.ligand, format="pqr")}
    centers = np.concatenate([atoms.centers for atoms in parts.values()])
    radii = np.concatenate([atoms.radii for atoms in parts.values()])
    grid = eses.Surface(centers, radii).grid(arguments.spacing, margin=2 * arguments.spacing)
    in_complex = areas_on(grid, centers, radii)

    sums = collections.defaultdict(lambda: np.zeros(2))
    first = 0
    for part, atoms in parts.items():
        alone = areas_on(grid, atoms.centers, atoms.radii)
        buried = alone - in_complex[first:first + len(atoms)]
        first += len(atoms)
        labels = atoms.labels
        for chain, residue, number, element, *areas in zip(
                labels.chain, labels.residue, labels.residue_number, atoms.element, alone, buried):
            key = part, f"{chain}{' ' if chain else ''}{residue} {number}", element
            sums[key] += areas

    print("part,residue,element,area,buried_area")
    for (part, residue, element), (area, buried_area) in sums.items():
        print(f"{part},{residue},{element},{area:.4f},{buried_area:.4f}")


if __name__ == "__main__":
    try:
        main()
    except (OSError, ValueError) as error:
        sys.exit(f"ligand_features.py: {error}")
