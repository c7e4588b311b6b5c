"""Maximum areas of residues on the SAS, for relative areas, and classes of atoms."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterable

from . import _core

NAMES = "ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL".split()
NUCLEOTIDES = frozenset("A C G U I DA DC DG DT DU DI".split())


@dataclasses.dataclass(frozen=True)
class Reference:
    """Maximum SAS areas of residues in square angstrom, and their publication."""

    name: str
    source: str
    areas: dict[str, float]

    def maximum(self, residue: str, names: Iterable[str] = ()) -> float:
        """Returns the maximum area of a residue with atoms of these names, also by its name in a force field; not a
        number if it has none."""
        return _maximum(self.name, residue, tuple(names))


@functools.lru_cache(maxsize=4096)
def _maximum(reference: str, residue: str, names: tuple[str, ...] = ()) -> float:
    area = _core._maximum_area(reference, residue, names)
    return float("nan") if area is None else area


def is_amino_acid(residue: str) -> bool:
    """Whether a name is that of a standard amino acid, also in a force field, such as HIE."""
    return _maximum("tien", residue) > 0


def is_polymer(residue: str) -> bool:
    """Whether a name is that of a standard nucleotide or amino acid, also in a force field."""
    return residue in NUCLEOTIDES or is_amino_acid(residue)


def _reference(name: str) -> Reference:
    return Reference(name, _core._source_of_reference(name), {residue: _maximum(name, residue) for residue in NAMES})


REFERENCE_PROBE_RADIUS = _core._reference_probe_radius  # angstrom
REFERENCES = {name: _reference(name) for name in ("tien", "miller", "sander")}
REFERENCES["wilke"] = REFERENCES["tien"]  # the name of Biopython for the same values

CLASSES = ("carbon, boron, silicon, and halogens that are not alone in their residue are apolar, all others polar (nitrogen, "
           "oxygen, sulphur, phosphorus and selenium as in ProtOr), also ions; with the radii of NACCESS sulphur, phosphorus "
           "and selenium are apolar, with those of OONS the carbon of carbonyl and carboxyl groups is polar, and a "
           "configuration file has classes of its own, as in FreeSASA; a hydrogen belongs to the class of the nearest other "
           "atom of its residue")
MAIN_CHAIN = frozenset("N CA C O OXT OT1 OT2 H HN H1 H2 H3 HA HA2 HA3".split())
