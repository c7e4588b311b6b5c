"""Molecules of other libraries as columns of atoms.

An adaptor is a function from an object to its `Columns`. `ADAPTORS` has one for each library, by the
name of the library's top-level module, so that no library is imported or needed. To make another
library known, add its adaptor:

    eses.adaptors.ADAPTORS["mylibrary"] = lambda molecule, frame: eses.adaptors.Columns(
        centers=molecule.xyz, elements=[atom.symbol for atom in molecule.atoms])
"""

from __future__ import annotations

import dataclasses
import importlib
import warnings
from typing import Any, Callable, Optional, Sequence

import numpy as np

__all__ = ["ADAPTORS", "Columns", "columns_of", "find_adaptor"]


@dataclasses.dataclass
class Columns:
    """The atoms of an object in its order, a value for each atom.

    Only `centers` is required. Names that an object does not have are None. Empty elements follow
    from the names.
    """

    centers: Any
    """(N, 3) numbers in angstrom."""
    elements: Optional[Sequence[str]] = None
    """Element symbols, such as Cl."""
    names: Optional[Sequence[str]] = None
    """Atom names, such as CA."""
    residues: Optional[Sequence[str]] = None
    """Residue names, such as ALA."""
    numbers: Optional[Sequence[int]] = None
    """Residue numbers."""
    icodes: Optional[Sequence[str]] = None
    """Insertion codes."""
    chains: Optional[Sequence[str]] = None
    """Chain names; those of the authors where a library has two."""
    label_chains: Optional[Sequence[str]] = None
    """The other chain names of mmCIF files (label_asym_id), where a library has two."""
    auth_chains: Optional[Sequence[str]] = None
    """The chain names of the authors, if ``chains`` has others."""
    altlocs: Optional[Sequence[str]] = None
    """Alternate locations; empty for atoms with one location."""
    occupancies: Optional[Sequence[float]] = None
    radii: Any = None
    """(N,) radii in angstrom, if the object has radii of its own."""
    virtual: Optional[Sequence[bool]] = None
    """Whether an atom is a virtual site, which has no radius."""
    lacks_hydrogens: bool = False
    """Whether hydrogens of the molecule are no atoms."""
    select: Optional[Callable[[Any], Any]] = None
    """Returns the mask of the atoms of a selection in the library's own language; for MDAnalysis also that of one of its
    objects, such as an AtomGroup."""
    syntax: str = ""
    """The name of this language with an example, for messages."""


Adaptor = Callable[[Any, int], Columns]


def _mask(count: int, indices: Any) -> np.ndarray[Any, np.dtype[np.bool_]]:
    mask = np.zeros(count, bool)
    mask[np.asarray(indices, int)] = True
    return mask


def _one_frame(count: int, frame: int, what: str) -> None:
    if count == 0:
        raise ValueError(f"the {what} is empty")
    if not -count <= frame < count:
        raise ValueError(f"the {what} has {count} frame{'s' * (count != 1)}, counted from 0; there is no frame {frame}")


def _from_gemmi(found: Any, frame: int) -> Columns:
    kind = type(found).__name__
    if kind == "Structure":
        _one_frame(len(found), frame, "structure")
        found = found[frame]
    if kind in ("Structure", "Model"):
        chains = list(found)
    elif kind == "Chain":
        chains = [found]
    elif kind not in ("Residue", "ResidueSpan", "ResidueGroup"):
        raise TypeError(f"gemmi.{kind} is not a molecule; give a Structure, Model, Chain, ResidueSpan or Residue")
    parts = [("", [found] if kind == "Residue" else found)] if kind.startswith("Residue") else [(chain.name, chain) for chain in chains]
    rows = [(name, residue, atom) for name, residues in parts for residue in residues for atom in residue]
    numbers = [residue.seqid.num for _, residue, _ in rows]  # None if an mmCIF file has none
    return Columns(
        centers=[atom.pos.tolist() for _, _, atom in rows],
        elements=["" if atom.element.name == "X" else atom.element.name for _, _, atom in rows],
        names=[atom.name for _, _, atom in rows], residues=[residue.name for _, residue, _ in rows],
        numbers=[0 if number is None else number for number in numbers],
        icodes=[residue.seqid.icode.strip() for _, residue, _ in rows],
        chains=[chain for chain, _, _ in rows], label_chains=[residue.subchain for _, residue, _ in rows],
        altlocs=[atom.altloc.strip("\0 ") for _, _, atom in rows],
        occupancies=[atom.occ for _, _, atom in rows])


def _from_mdanalysis(found: Any, frame: int) -> Columns:
    if frame != 0:
        raise ValueError("a universe has a current frame: call universe.trajectory[i] in place of frame=i")
    group = found.atoms

    def column(*names: str) -> Optional[list[Any]]:
        for name in names:
            try:
                values = list(getattr(group, name))
            except AttributeError:  # MDAnalysis's NoDataError, too
                continue
            if any(values):
                return values
        return None

    def select(chosen: Any) -> Any:
        atoms = group.select_atoms(chosen) if isinstance(chosen, str) else getattr(chosen, "atoms", chosen)
        if atoms.universe is not group.universe:
            raise ValueError("the atoms are those of another universe")
        return np.isin(group.ix, atoms.ix)

    return Columns(centers=group.positions, elements=column("elements"), names=column("names"),
                   residues=column("resnames"), numbers=column("resnums", "resids"), icodes=column("icodes"),
                   chains=column("chainIDs", "segids"), altlocs=column("altLocs"),
                   occupancies=column("occupancies"), select=select, syntax="MDAnalysis, such as 'resid 57 and name CA'")


def _from_mdtraj(found: Any, frame: int) -> Columns:
    _one_frame(found.n_frames, frame, "trajectory")
    atoms = list(found.topology.atoms)
    symbols = ["VS" if atom.element is None else atom.element.symbol for atom in atoms]

    def chain_name(chain: Any) -> str:
        return getattr(chain, "chain_id", None) or str(chain.index)

    return Columns(
        centers=10.0 * found.xyz[frame].astype(float),  # nanometres
        elements=["" if symbol == "VS" else symbol for symbol in symbols], names=[atom.name for atom in atoms],
        residues=[atom.residue.name for atom in atoms], numbers=[atom.residue.resSeq for atom in atoms],
        chains=[chain_name(atom.residue.chain) for atom in atoms],
        virtual=[symbol == "VS" for symbol in symbols],
        select=lambda text: _mask(len(atoms), found.topology.select(text)),
        syntax="MDTraj, such as 'resSeq 57 and name CA'")


def _from_biopython(found: Any, frame: int) -> Columns:
    if getattr(found, "level", None) == "S":
        models = list(found)
        _one_frame(len(models), frame, "structure")
        found = models[frame]
    atoms = list(found.get_atoms())  # of alternate locations the selected one
    residues = [atom.get_parent() for atom in atoms]
    return Columns(
        centers=[atom.coord for atom in atoms],
        elements=["" if atom.element in (None, "X") else atom.element for atom in atoms],
        names=[atom.name for atom in atoms], residues=[residue.resname.strip() for residue in residues],
        numbers=[residue.id[1] for residue in residues], icodes=[residue.id[2].strip() for residue in residues],
        chains=[residue.get_parent().id if residue.get_parent() else "" for residue in residues],
        occupancies=[1.0 if atom.occupancy is None else atom.occupancy for atom in atoms])


def _from_biotite(found: Any, frame: int) -> Columns:
    if found.coord.ndim == 3:
        _one_frame(found.stack_depth(), frame, "stack")
        found = found[frame]

    def column(name: str) -> Optional[list[Any]]:
        return found.get_annotation(name).tolist() if name in found.get_annotation_categories() else None

    return Columns(centers=found.coord, elements=found.element.tolist(), names=found.atom_name.tolist(),
                   residues=found.res_name.tolist(), numbers=found.res_id.tolist(), icodes=column("ins_code"),
                   chains=found.chain_id.tolist(), occupancies=column("occupancy"))


def _from_rdkit(found: Any, frame: int) -> Columns:
    if found.GetNumConformers() == 0:
        raise ValueError("the molecule has no coordinates; make some with AllChem.EmbedMolecule")
    _one_frame(found.GetNumConformers(), frame, "molecule")
    conformer = list(found.GetConformers())[frame]
    labels = [atom.GetPDBResidueInfo() for atom in found.GetAtoms()]
    if not conformer.Is3D() and not all(labels):  # atoms of a PDB file may lie in a plane
        raise ValueError("the molecule has coordinates of a drawing; make others with AllChem.EmbedMolecule")
    atoms = list(found.GetAtoms())
    columns = Columns(centers=conformer.GetPositions(), elements=[atom.GetSymbol() for atom in atoms],
                      names=[f"{atom.GetSymbol()}{atom.GetIdx() + 1}" for atom in atoms],
                      virtual=[atom.GetAtomicNum() == 0 for atom in atoms],
                      lacks_hydrogens=any(atom.GetTotalNumHs() > 0 for atom in atoms))
    if all(labels):
        columns.names = [label.GetName().strip() for label in labels]
        columns.residues = [label.GetResidueName().strip() for label in labels]
        columns.numbers = [label.GetResidueNumber() for label in labels]
        columns.icodes = [label.GetInsertionCode().strip() for label in labels]
        columns.chains = [label.GetChainId().strip() for label in labels]
        columns.occupancies = [label.GetOccupancy() for label in labels]
    return columns


def _from_ase(found: Any, frame: int) -> Columns:
    if frame != 0:
        raise ValueError("ase.Atoms is a single frame; give the frame itself")
    if any(found.pbc):
        warnings.warn("the molecule is measured without its periodic images", stacklevel=7)
    arrays = found.arrays
    symbols = found.get_chemical_symbols()

    def column(name: str) -> Optional[list[Any]]:
        return arrays[name].tolist() if name in arrays else None

    return Columns(centers=found.positions, elements=["" if symbol == "X" else symbol for symbol in symbols],
                   names=column("atomtypes") or symbols, residues=column("residuenames"),
                   numbers=column("residuenumbers"), occupancies=column("occupancy"),
                   virtual=[symbol == "X" for symbol in symbols])


def _from_parmed(found: Any, frame: int) -> Columns:
    frames = found.get_coordinates()
    if frames is None:
        raise ValueError("the structure has no coordinates; load them with parmed.load_file(..., xyz=...)")
    _one_frame(len(frames), frame, "structure")
    atoms = list(found.atoms)
    is_virtual = [type(atom).__name__ == "ExtraPoint" for atom in atoms]
    return Columns(
        centers=frames[frame],
        elements=["" if atom.atomic_number <= 0 else atom.element_name for atom in atoms],
        names=[atom.name for atom in atoms], residues=[atom.residue.name for atom in atoms],
        numbers=[atom.residue.number for atom in atoms],
        icodes=[atom.residue.insertion_code.strip() for atom in atoms],
        chains=[atom.residue.chain or atom.residue.segid or "" for atom in atoms],
        occupancies=[atom.occupancy for atom in atoms], virtual=is_virtual)


def _from_openmm(found: Any, frame: int) -> Columns:
    """Takes (topology, positions), or an object with both, such as a Modeller or a PDBFile."""
    topology, positions = (found if isinstance(found, tuple) else
                           (getattr(found, "topology", found), getattr(found, "positions", None)))
    if positions is None:
        raise TypeError("a topology of OpenMM has no positions; give the pair (topology, positions)")
    if frame != 0:
        raise ValueError("give the positions of the frame")
    if hasattr(positions, "value_in_unit_system"):
        unit: Any = importlib.import_module("openmm.unit")  # the library of the object, which is imported already
        positions = positions.value_in_unit(unit.angstrom)
    else:
        positions = 10.0 * np.asarray(positions, float)  # OpenMM's numbers without units are nanometres
    atoms = list(topology.atoms())
    numbers = [atom.residue.id for atom in atoms]
    # A virtual site belongs to the other atoms of its residue. An ion may lack its element, too.
    is_alone = {residue: sum(1 for _ in residue.atoms()) == 1 for residue in topology.residues()}
    return Columns(
        centers=np.array([tuple(position) for position in positions]),
        elements=["" if atom.element is None else atom.element.symbol for atom in atoms],
        names=[atom.name for atom in atoms], residues=[atom.residue.name for atom in atoms],
        numbers=[int(number) if str(number).lstrip("-").isdigit() else atom.residue.index + 1
                 for number, atom in zip(numbers, atoms)],
        icodes=[atom.residue.insertionCode.strip() for atom in atoms],
        chains=[atom.residue.chain.id for atom in atoms],
        virtual=[atom.element is None and not is_alone[atom.residue] for atom in atoms])


def _from_prody(found: Any, frame: int) -> Columns:
    frames = found.getCoordsets()
    if frames is None:
        raise ValueError("the atoms have no coordinates")
    _one_frame(len(frames), frame, "atom group")

    def column(name: str) -> Optional[list[Any]]:
        values = getattr(found, name)()
        return None if values is None else list(values)

    def select(text: str) -> Any:
        chosen = found.select(text)
        indices = found.getIndices() if hasattr(found, "getIndices") else np.arange(len(frames[frame]))
        return np.isin(indices, [] if chosen is None else chosen.getIndices())

    return Columns(centers=frames[frame], elements=column("getElements"), names=column("getNames"),
                   residues=column("getResnames"), numbers=column("getResnums"), icodes=column("getIcodes"),
                   chains=column("getChids"), altlocs=column("getAltlocs"), occupancies=column("getOccupancies"),
                   select=select, syntax="ProDy, such as 'resnum 57 and name CA'")


ADAPTORS: dict[str, Adaptor] = {
    "Bio": _from_biopython,
    "MDAnalysis": _from_mdanalysis,
    "ase": _from_ase,
    "biotite": _from_biotite,
    "gemmi": _from_gemmi,
    "mdtraj": _from_mdtraj,
    "openmm": _from_openmm,
    "parmed": _from_parmed,
    "prody": _from_prody,
    "rdkit": _from_rdkit,
}


def find_adaptor(found: Any) -> Optional[Adaptor]:
    """Returns the adaptor of an object's library, or None.

    The library is the top-level module of the object's class, or of a class that it inherits. For a
    tuple, it is that of its first item.
    """
    owner = found[0] if isinstance(found, tuple) and found else found
    for kind in type(owner).__mro__:
        adaptor = ADAPTORS.get(kind.__module__.partition(".")[0])
        if adaptor:
            return adaptor
    return None


def columns_of(found: Any, frame: int = 0) -> Columns:
    """Returns the atoms of an object of a known library. Raises TypeError for other objects."""
    adaptor = find_adaptor(found)
    kind = type(found)
    name = kind.__qualname__ if kind.__module__ == "builtins" else f"{kind.__module__}.{kind.__qualname__}"
    if found is None:
        name = "None, which libraries return for what they cannot read or select,"
    if adaptor is None:
        raise TypeError(f"{name} is not a known molecule; give a path, (centers, radii), or an object of "
                        f"{', '.join(sorted(ADAPTORS))}")
    try:
        return adaptor(found, frame)
    except AttributeError as error:  # such as a single atom, or a topology without coordinates
        raise TypeError(f"{name} is not a molecule with coordinates: {str(error).rstrip('. ')}") from error
