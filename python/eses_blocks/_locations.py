"""Alternate locations of the atoms of objects."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import adaptors

_Bools = npt.NDArray[np.bool_]


def first_of_runs(*columns: Any) -> npt.NDArray[np.int64]:
    """Returns the first atom of each run of atoms with equal values."""
    first = np.ones(len(columns[0]), bool)
    first[1:] = np.any([column[1:] != column[:-1] for column in columns], axis=0)
    return np.flatnonzero(first)


def other_locations(columns: adaptors.Columns, named: Any, keep: _Bools) -> _Bools:
    """Marks the kept atoms of alternate locations other than that of the highest mean occupancy in the
    residue. `named` has the names of all atoms, and `keep` is the mask of the kept ones. An atom that lacks this location keeps its own of the highest occupancy. Of residues with one
    number and several names, those without this location are marked as a whole."""
    result = np.zeros(len(keep), bool)
    locations = np.array(["" if one is None else str(one).strip() for one in columns.altlocs or ()], str)
    if not (locations != "").any() or not keep.any():
        return result
    occupancy = np.array([1.0] * len(keep) if columns.occupancies is None else columns.occupancies, float)[keep]
    locations, residue, name = locations[keep], named.residue[keep], named.name[keep]
    starts = first_of_runs(named.chain[keep], named.residue_number[keep], named.icode[keep])
    dropped = np.zeros(len(name), bool)
    for begin, end in zip(starts, np.append(starts[1:], len(name))):
        here = locations[begin:end]
        letters = sorted(set(here) - {""})
        if not letters:
            continue
        chosen = max(letters, key=lambda letter: float(occupancy[begin:end][here == letter].mean()))
        # The residues that have atoms of the chosen location or of all locations.
        shown = set(residue[begin:end][(here == chosen) | (here == "")].tolist())
        by_name: dict[tuple[str, str], list[int]] = {}
        for i in range(begin, end):
            by_name.setdefault((residue[i], name[i]), []).append(i)
        for (kind, _), atoms in by_name.items():
            lettered = [i for i in atoms if locations[i]]
            # A location without a letter is an alternative, unless the occupancies add up to more than 1.
            occupancies = {locations[i]: occupancy[i] for i in reversed(atoms)}
            others = atoms if sum(occupancies.values()) <= 1.01 else lettered
            have_letters = len(others) == len(lettered)
            if lettered:
                best = max(others, key=lambda k: (have_letters and locations[k] == chosen, occupancy[k], -k))
                dropped[others] = [kind not in shown or locations[i] != locations[best] for i in others]
    result[keep] = dropped
    return result
