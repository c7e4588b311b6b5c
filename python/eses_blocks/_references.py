"""Maximum areas of residues on the SAS, for relative areas, and classes of atoms."""

from __future__ import annotations

import dataclasses

NAMES = "ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL".split()
# Names of force fields for other states of protonation.
SYNONYMS = {"ASH": "ASP", "CYM": "CYS", "CYX": "CYS", "GLH": "GLU", "HID": "HIS", "HIE": "HIS", "HIP": "HIS",
            "HSD": "HIS", "HSE": "HIS", "HSP": "HIS", "LYN": "LYS"}


@dataclasses.dataclass(frozen=True)
class Reference:
    """Maximum SAS areas of residues in square angstrom, and their publication."""

    name: str
    source: str
    areas: dict[str, float]

    def maximum(self, residue: str) -> float:
        """Returns the maximum area of a residue; not a number if it has none."""
        return self.areas.get(SYNONYMS.get(residue, residue), float("nan"))


def _reference(name: str, source: str, areas: str) -> Reference:
    return Reference(name, source, dict(zip(NAMES, map(float, areas.split()))))


REFERENCE_PROBE_RADIUS = 1.4  # angstrom

REFERENCES = {each.name: each for each in (
    _reference("tien", "Tien et al. 2013, theoretical values, doi:10.1371/journal.pone.0080635",
               "129 274 195 193 167 225 223 104 224 197 201 236 224 240 159 155 172 285 263 174"),
    _reference("miller", "Miller et al. 1987, doi:10.1016/0022-2836(87)90038-6",
               "113 241 158 151 140 189 183 85 194 182 180 211 204 218 143 122 146 259 229 160"),
    _reference("sander", "Rost and Sander 1994, doi:10.1002/prot.340200303",
               "106 248 157 163 135 198 194 84 184 169 164 205 188 197 136 130 142 227 222 142"))}
REFERENCES["wilke"] = REFERENCES["tien"]  # the name of Biopython for the same values

CLASSES = ("carbon, boron, silicon, and halogens that are not alone in their residue are apolar, all others polar (nitrogen, "
           "oxygen, sulphur, phosphorus and selenium as in ProtOr and OONS; NACCESS counts the last three as apolar), also "
           "ions; a hydrogen belongs to the class of the nearest other atom of its residue")
MAIN_CHAIN = frozenset("N CA C O OXT OT1 OT2 H HN H1 H2 H3 HA HA2 HA3".split())
