"""Molecules from files, texts, arrays and objects of other libraries, with their radii."""

from __future__ import annotations

import dataclasses
import inspect
import io
import os
import re
import warnings
from typing import Any, Callable, Iterable, Optional, TypeVar

import numpy as np
import numpy.typing as npt

from . import _arguments, _core, _foreign, adaptors
from ._files import RowsOfFile, model_numbers, notes_of, values_in_lines
from ._locations import other_locations
from ._paths import files_of, format_of, is_file, is_path, name_of, read_content, read_opened, remember_files
from ._radii import (SOURCES, atoms_named, correct_elements, find_dummies, find_radii, radii_by_bonds, refuse_unknown,
                     warn_about_residues, without_ccd)
from ._read_only import Counts
from ._references import is_polymer
from ._select import Selector, molecule_of

_Texts = npt.NDArray[np.str_]
_Bools = npt.NDArray[np.bool_]


@dataclasses.dataclass(frozen=True)
class Radii:
    """The set of radii of a molecule, and the atoms whose radius or element was guessed."""

    name: str
    """``protor``, ``protor+ccd``, ``bondi``, ``msms``, ``naccess``, ``oons``, also with ``+shannon``, the name in a configuration file,
    ``file`` or ``given``."""
    source: str
    """The publication with its DOI, or where the radii come from."""
    guessed: npt.NDArray[np.int64]
    """Indices of the atoms whose radius is that of their element, because the set does not name them,
    and of those whose element follows from their name."""
    unknown: npt.NDArray[np.int64]
    """Indices of the atoms that have ``unknown_radius``."""

    def __repr__(self) -> str:
        notes = [f"{len(atoms)} {what}" for atoms, what in ((self.guessed, "guessed"), (self.unknown, "unknown"))
                 if len(atoms)]
        return f"<radii: {self.name}{', ' if notes else ''}{', '.join(notes)}>"


@dataclasses.dataclass(frozen=True)
class Molecule:
    """The atoms of a molecule in the order of the object that they come from.

    The columns have a value for each of the N atoms of the object. `kept` names the M atoms that make
    up the surface; `centers` and `radii` are theirs.
    """

    centers: npt.NDArray[np.float64]
    """(M, 3) centres of the kept atoms, in angstrom."""
    radii: npt.NDArray[np.float64]
    """(M,) van der Waals radii of the kept atoms, in angstrom."""
    kept: npt.NDArray[np.int64]
    """(M,) indices of the kept atoms in the object."""
    left_out: Counts
    """Numbers of the atoms that are not kept, by their kind: ``selection``, ``water``, ``hydrogen``, ``altloc``,
    ``virtual``; for files those of ``Atoms.left_out``, which are no rows of the columns."""
    positions: npt.NDArray[np.float64]
    """(N, 3) centres of all atoms."""
    chain: _Texts
    residue: _Texts
    residue_number: npt.NDArray[np.int64]
    icode: _Texts
    name: _Texts
    element: _Texts
    set: Radii
    """The set of radii."""
    are_named: bool
    """Whether the atoms have names of residues."""
    label_chain: _Texts
    """The chain names label_asym_id of mmCIF files, where `chain` has auth_asym_id; empty for other sources."""
    auth_chain: _Texts
    """The chain names auth_asym_id of mmCIF files, where `chain` has label_asym_id; else empty."""
    classes: npt.NDArray[np.uint8]
    """The class of each atom in the set of radii: 1 polar, 2 apolar, 0 for the class of its element."""
    files: tuple[str, ...] = ()
    """The paths of the files that were read, which `save` does not overwrite."""
    notes: tuple[str, ...] = ()
    """What a PDB or mmCIF file has besides these atoms: other models, and assemblies with several copies."""

    def __len__(self) -> int:
        return len(self.positions)

    def __repr__(self) -> str:
        out = "".join(f", {count} {what} left out" for what, count in self.left_out.items())
        return f"<eses_blocks.Molecule: {len(self)} atoms{out}, {self.set}>"


@dataclasses.dataclass
class _Source:
    """Columns with their origin. `select` returns the mask of a selection in the language of their library."""

    columns: adaptors.Columns
    are_read: bool = False  # by the library, which has left out atoms and assigned radii
    set_name: str = ""
    left_out: dict[str, int] = dataclasses.field(default_factory=dict)  # by the library
    select: Any = None
    chosen: Any = None  # the selection of the atoms that are read
    files: tuple[str, ...] = ()  # paths of those that were read
    guessed_names: Any = ()  # pairs of residue and atom whose elements follow from the names in a file
    notes: tuple[str, ...] = ()
    classes: Any = None  # in the set of radii, as Molecule.classes


# ------------------------------------------------------------------------------------------ files

_Result = TypeVar("_Result")
_FILE_OPTIONS: dict[str, Any] = {"format": "auto", "model": 0, "altloc": "", "hetatm": True, "chains": (), "select": "",
                                 "assembly": "", "chain_names": "auth"}


def require_known(options: dict[str, Any], caller: Callable[..., Any], known: Iterable[str] = ()) -> None:
    """Raises TypeError for an argument that files do not have, or of a wrong type. The message names a similar argument
    of the caller, whose first parameter is the molecule and whose last one is ``options``, or one of `known`."""
    for name in sorted(set(options) - set(_FILE_OPTIONS) - set(known)):
        _arguments.refuse_unknown(name, [*list(inspect.signature(caller).parameters)[1:-1], *known, *_FILE_OPTIONS])
    _arguments.require_types(_FILE_OPTIONS, {name: value for name, value in options.items() if name != "select"})


def each_model(function: Callable[..., _Result], arguments: dict[str, Any]) -> list[_Result]:
    """Returns the results of a function for several models of a file, whose content is read once. `arguments` are all
    those of the function by their names, with ``molecule``, ``models`` and ``options``."""
    options = {**arguments, **arguments["options"]}
    found, models, _ = (options.pop(name) for name in ("molecule", "models", "options"))
    if "model" in options:
        raise TypeError("give model or models, not both")
    if not is_file(found):
        raise TypeError("models: only PDB, mmCIF and PQR files have models; use frame= for one of several models or frames")
    text, name, layout = read_content(found, options.get("format", "auto"))
    if (isinstance(models, str) and models != "all") or not hasattr(models, "__iter__"):
        raise ValueError(f"models must be 'all' or numbers, not {models!r}")
    numbers = model_numbers(text, layout) if isinstance(models, str) else list(models)
    for number in numbers:
        _arguments.check(function, model=number)
    results = []
    for number in numbers:
        opened = io.BytesIO(text)
        opened.name = name  # for messages, and so that save does not overwrite the file
        results.append(function(opened, **{**options, "format": layout, "model": number}))
    return results


def _read_file(found: Any, chosen_radii: Any, unknown: Optional[float], waters: bool, hydrogens: str,
               options: dict[str, Any]) -> _Source:
    """Reads a path, an open file, or the bytes or text of a file. PDB and mmCIF files have ProtOr radii unless others
    are chosen."""
    given = _FILE_OPTIONS | options
    radii = os.fspath(chosen_radii or "protor")
    chosen, given["select"] = given["select"], ""
    data: Any = None
    if is_path(found):
        name = name_of(found)
        layout = format_of(b"", os.fspath(found)) if given["format"] == "auto" else given["format"]
    else:
        data, name, layout = read_opened(found, given["format"])

    def read(select: str) -> _core.Atoms:
        reading = _core._ReadOptions(given["format"] if data is None else layout, radii, unknown, given["model"],
                                     given["altloc"], waters, given["hetatm"], hydrogens, list(given["chains"]), select,
                                     given["assembly"], given["chain_names"])
        return _core._read_atoms(found, reading) if data is None else _core._parse_atoms(data, name, reading)

    is_structure = layout not in ("xyzr", "pqr")
    if not is_structure:
        _refuse_structure_options(name, layout, chosen_radii, given)
    is_read = is_structure and isinstance(chosen, str)  # the selection, which may name models, B-factors and others
    atoms = read(chosen if is_read else "")
    _core._warn_about(atoms, name)
    source = _of_atoms(atoms, is_model_chosen=given["model"] > 0)
    source.chosen = None if is_read else chosen
    remember_files(atoms, name, radii, re.sub(r"(?i)\+shannon$", "", radii))
    source.files = files_of(atoms)
    if layout == "mmcif" and atoms.labels is not None:
        text = data if data is not None else read_content(found, layout)[0]
        lines = atoms.lines.tolist()
        source.columns.label_chains = values_in_lines(text, b"label_asym_id", lines)
        if given["chain_names"] == "label":
            source.columns.auth_chains = values_in_lines(text, b"auth_asym_id", lines)

    rows = RowsOfFile(atoms)

    def choose(text: str) -> _Bools:
        chosen: _Bools = rows.marks(read(text))
        return chosen

    if is_structure:
        source.select = choose
    return source


def _refuse_structure_options(name: str, layout: str, radii: Any, given: dict[str, Any]) -> None:
    """Raises ValueError for options that only PDB and mmCIF files have."""
    given = given | {"chains": tuple(given["chains"])}
    chosen = [option for option in ("altloc", "hetatm", "chains", "assembly", "chain_names")
              if given[option] != _FILE_OPTIONS[option]]
    if radii is not None:
        chosen.append(f"radii={radii!r:.40}")
    if chosen:
        raise ValueError(f"{chosen[0]} needs a PDB or mmCIF file; {name} is read as {layout} (use format='pdb' or "
                         "format='mmcif' if it is one)")


def _of_atoms(atoms: _core.Atoms, is_model_chosen: bool = False) -> _Source:
    columns = adaptors.Columns(centers=atoms.centers, elements=atoms.element.tolist(), radii=atoms.radii)
    labels = atoms.labels
    if labels is not None:
        parts = [re.fullmatch(r"(-?\d+)?(.*)", number) for number in labels.residue_number.tolist()]
        columns.names, columns.residues = labels.atom_name.tolist(), labels.residue.tolist()
        columns.chains = labels.chain.tolist()
        columns.numbers = [int(part[1] or 0) for part in parts if part]
        columns.icodes = [part[2] for part in parts if part]
    return _Source(columns, are_read=True, set_name="file", left_out=atoms.left_out,
                   guessed_names=_core._guessed_names(atoms), notes=notes_of(_core._noted(atoms), is_model_chosen),
                   classes=_core._classes_of(atoms))


def _source_of(found: Any, radii: Any, unknown: Optional[float], waters: bool, hydrogens: str, frame: int,
               options: dict[str, Any]) -> _Source:
    files: tuple[str, ...] = ()
    if is_path(found):
        found = os.fsdecode(found)
        if _foreign.is_foreign(found):
            files = (os.path.abspath(found),)
            found, frame = _foreign.read(found, frame), 0
    if not is_file(found):
        if others := sorted(set(options) - {"select"}):
            advice = "; use frame= for one of several models or frames" if "model" in others else ""
            raise TypeError(f"{', '.join(others)}: only PDB, mmCIF and PQR files have these arguments{advice}")
        source = _object_source(found, radii, frame)
        source.files, source.chosen = source.files or files, options.get("select")
        return source
    if frame:
        raise TypeError("frame: use model= for a file")
    if radii is not None and not isinstance(radii, (str, os.PathLike)):
        raise TypeError(f"radii: a file needs the name of a set of radii, not {type(radii).__name__}")
    source = _read_file(found, radii, unknown, waters, hydrogens, options)
    if _radii_are_assigned(source, found) and radii != "occupancy":
        source.set_name = os.fspath(radii or "protor")
    return source


def _object_source(found: Any, radii: Any, frame: int) -> _Source:
    """Returns the columns of an object."""
    if isinstance(found, (_core.Atoms, _core.Surface)) and radii is not None:
        raise TypeError(f"radii: {type(found).__name__} have radii already; give them when the file is read")
    if isinstance(found, _core.Atoms):
        source = _of_atoms(found)
        source.files = files_of(found)
        if (name := _core._set_of(found).lower()) in SOURCES:  # others are configuration files
            source.set_name = name
        return source
    if isinstance(found, _core.Surface):
        columns = adaptors.Columns(centers=found.centers, radii=found.radii)
        if known := molecule_of(found):
            kept, selector = known
            names = selector.names
            columns.names, columns.residues, columns.chains, columns.icodes, columns.numbers, columns.elements = (
                column[kept].tolist() for column in (names.name, names.residue, names.chain, names.icode, names.residue_number,
                                                     names.element))
        return _Source(columns, are_read=True, set_name="given", files=files_of(found))
    if adaptors.find_adaptor(found):
        columns = adaptors.columns_of(found, frame)
        return _Source(columns, select=columns.select)
    if isinstance(found, tuple) and len(found) == 2:
        if radii is not None:
            raise ValueError("radii: (centers, radii) has radii already; leave out "
                             f"radii={radii!r:.40}, or give a molecule with elements or names for a set of radii")
        return _Source(adaptors.Columns(centers=found[0], radii=found[1]), are_read=True, set_name="given")
    if radii is not None and not isinstance(radii, (str, os.PathLike)):
        return _Source(adaptors.Columns(centers=found, radii=radii), are_read=True, set_name="given")
    if isinstance(found, (list, tuple)) and found and is_molecule(found[0]):
        raise TypeError(f"several {'files' if is_file(found[0]) else 'molecules'}: measure each by itself")
    if isinstance(found, (np.ndarray, list, tuple)):
        raise TypeError("an array of centres needs radii: give (centers, radii)")
    return _Source(adaptors.columns_of(found, frame))  # an error that names the known libraries


def _radii_are_assigned(source: _Source, found: Any) -> bool:
    """Whether the radii of a file are those of a set: xyzr and PQR files have their own."""
    names = source.columns.names
    name = str(getattr(found, "name", found) if not isinstance(found, (bytes, bytearray)) else "").lower()
    return names is not None and not name.removesuffix(".gz").endswith(".pqr")


# ------------------------------------------------------------------------------------------ radii


def _column(values: Any, count: int, what: str) -> _Texts:
    if values is None:
        return np.zeros(count, "U1")
    texts = np.array(["" if value is None else str(value) for value in values], str)
    if len(texts) != count:
        raise ValueError(f"{count} atoms have centres, but {len(texts)} have {what}")
    return texts.astype("U1") if texts.dtype.itemsize == 0 else texts


def read_molecule(molecule: Any, radii: Any = None, *, waters: bool = False, hydrogens: str = "auto",
                  unknown_radius: Optional[float] = None, frame: int = 0, **options: Any) -> Molecule:
    """Read the atoms of a file or of an object of another library, and assign their radii.

    Parameters
    ----------
    molecule : object
        A path (``str``, ``bytes`` or ``os.PathLike``), also of BinaryCIF files, which Biotite reads, and of SDF, MOL
        and MOL2 files, which RDKit reads; an open file, the bytes or the text of a file,
        ``(centers, radii)``, ``Atoms``, ``Surface``, a ``Molecule`` that was read before, or an object of one of the libraries in
        ``adaptors.ADAPTORS``: gemmi Structure, Model, Chain, ResidueSpan, Residue; MDAnalysis Universe, AtomGroup; MDTraj
        Trajectory; Biopython Structure, Model, Chain, Residue; Biotite AtomArray, AtomArrayStack; RDKit
        Mol; ASE Atoms; ParmEd Structure; ProDy AtomGroup, Selection; an object of OpenMM with topology
        and positions, or the pair.
    radii : str, os.PathLike or array_like, optional
        ``protor``, ``bondi``, ``msms``, ``naccess``, ``oons``, the path of a file in FreeSASA's
        configuration format, or N radii in angstrom; ``occupancy`` for a PDB or mmCIF file that has radii as its occupancies.
        ``protor+ccd`` is ``protor`` with radii of ligands that follow from their bonds in the Chemical
        Component Dictionary, which needs Biotite. ``+shannon`` after the name of a set, such as ``protor+shannon`` or
        ``protor+ccd+shannon``, is the set with Shannon's radii of ions. By default ``protor`` for molecules with names of
        residues, whose hydrogens then belong to the united atoms, and ``bondi`` for others. PQR and
        xyzr files and ``(centers, radii)`` have radii of their own, and take no set.
    waters : bool, optional
        Whether waters are kept.
    hydrogens : {'auto', 'keep', 'drop'}, optional
        Whether hydrogens are kept; ``auto`` drops them if the radii are those of united atoms.
    unknown_radius : float, optional
        Radius of atoms for which the set has none, in angstrom. Without it such atoms are an error.
    frame : int, optional
        Frame, model or conformer of an object that has several.
    **options
        ``select``, the atoms that make up the surface, as ``report`` of ``measure``; and further arguments of
        ``read_atoms``, for files: ``format``, ``model``, ``altloc``, ``hetatm``, ``chains``, ``assembly``, ``chain_names``.

    Returns
    -------
    Molecule
        The columns of all atoms, and centres and radii of those that are kept.

    Raises
    ------
    TypeError
        If the object is not known.
    ValueError
        If it has no coordinates, if an atom has no radius, or if the content of a file is not valid.
    """
    require_known(options, read_molecule)
    return _read(molecule, radii, waters, hydrogens, unknown_radius, frame, options)[0]


@dataclasses.dataclass
class _Named:
    """The columns of all atoms as arrays."""

    positions: npt.NDArray[np.float64]
    chain: _Texts
    residue: _Texts
    residue_number: npt.NDArray[np.int64]
    icode: _Texts
    name: _Texts
    element: _Texts
    label_chain: _Texts
    auth_chain: _Texts


@dataclasses.dataclass
class _Choice:
    """The kept atoms and the radii of all atoms. The radius of a dropped atom may be not a number."""

    keep: _Bools
    set_name: str
    radii: Any
    guessed: Any
    unknown: Any
    by_element: Any
    classes: Any
    left_out: dict[str, int] = dataclasses.field(default_factory=dict)

    def drop(self, mask: Any, what: str) -> None:
        mask = np.asarray(mask, bool) & self.keep
        if mask.any():
            self.left_out[what] = int(mask.sum())
            self.keep[mask] = False


def _arrays_of(columns: adaptors.Columns) -> _Named:
    positions = np.array(columns.centers, dtype=float)
    if len(positions) == 0:
        raise ValueError("the molecule has no atoms")
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise ValueError(f"centers must have shape (N, 3), not {positions.shape}")
    count = len(positions)
    return _Named(
        positions, _column(columns.chains, count, "chains"), _column(columns.residues, count, "residues"),
        np.zeros(count, np.int64) if columns.numbers is None else np.array(columns.numbers, np.int64),
        _column(columns.icodes, count, "insertion codes"), _column(columns.names, count, "names"),
        _column(columns.elements, count, "elements"), _column(columns.label_chains, count, "label chains"),
        _column(columns.auth_chains, count, "auth chains"))


def _take_radii(named: _Named, radii: Any, set_name: str) -> _Choice:
    """Takes the radii that the object or the caller has, and keeps all atoms. The name of a set tells that the
    library has assigned them."""
    count, nothing = len(named.name), np.zeros(0, np.int64)
    try:
        values = np.array(radii, dtype=float)
    except (TypeError, ValueError) as error:
        kind = TypeError if isinstance(error, TypeError) else ValueError
        raise kind(f"radii must be an array of real numbers: {error}") from None
    if values.shape != (count,):
        raise ValueError(f"radii must have shape ({count},), one for each atom, not {values.shape}")
    choice = _Choice(np.ones(count, bool), set_name, values, nothing, nothing, np.zeros(count, bool),
                     np.zeros(count, np.uint8))
    if set_name not in ("given", "file"):
        choice.set_name, _, found, _, choice.by_element, _, _ = find_radii(
            named.residue, named.name, named.element, set_name)
        choice.guessed, choice.unknown = np.flatnonzero(choice.by_element), np.flatnonzero(np.isnan(found))
    return choice


def _choose_atoms(named: _Named, columns: adaptors.Columns, which: str, waters: bool, hydrogens: str,
                  unknown: Optional[float], selected: _Bools, corrected: _Bools, are_waters: _Bools) -> _Choice:
    """Assigns radii of a set and chooses the atoms that have them. Sets the elements that were derived from names.
    `corrected` and `are_waters` are the masks of `correct_elements`."""
    set_name, are_united, values, named.element, by_element, by_name, classes = find_radii(
        named.residue, named.name, named.element, which)
    choice = _Choice(np.ones(len(values), bool), set_name, values, None, None, by_element, classes)
    if columns.lacks_hydrogens and not are_united and hydrogens != "drop":
        warnings.warn("the molecule lacks hydrogens; add them with Chem.AddHs(molecule, addCoords=True), or choose radii of "
                      "united atoms", stacklevel=4)
    choice.drop(~selected, "selection")
    if columns.virtual is not None:
        choice.drop(columns.virtual, "virtual")
    choice.drop(find_dummies(named.positions, columns.occupancies), "dummy")
    if not waters:
        choice.drop(are_waters, "water")
    if hydrogens == "drop" or (hydrogens == "auto" and are_united):
        choice.drop(named.element == "H", "hydrogen")
    choice.drop(other_locations(columns, named, choice.keep), "altloc")  # by the occupancies of the atoms that are left
    is_unknown = np.isnan(values) & choice.keep
    if is_unknown.any():
        if unknown is None:
            refuse_unknown(is_unknown, named.residue, named.name, named.element, set_name)
        else:
            choice.radii = np.where(np.isnan(values), unknown, values)
    # The names of amino acids and nucleotides leave no doubt about the element.
    polymer = [name for name in set(named.residue.tolist()) if is_polymer(name)]
    is_guessed = by_element | ((by_name | corrected) & ~np.isin(named.residue, polymer))
    choice.guessed = np.flatnonzero(is_guessed & choice.keep & ~is_unknown)
    choice.unknown = np.flatnonzero(is_unknown)
    return choice


def _use_bonds(named: _Named, choice: _Choice) -> None:
    """Replaces radii by element alone by those of the bonds, where the dictionary has them."""
    of_bonds = radii_by_bonds(named.residue, named.name, named.element, choice.by_element & choice.keep)
    choice.radii = np.where(np.isnan(of_bonds), choice.radii, of_bonds)
    choice.set_name = choice.set_name.replace("protor", "protor+ccd")
    choice.guessed = choice.guessed[np.isnan(of_bonds[choice.guessed])]


def _read(found: Any, radii: Any, waters: bool, hydrogens: str, unknown: Optional[float], frame: int,
          options: dict[str, Any]) -> tuple[Molecule, Selector]:
    """Returns the molecule and its selector."""
    if isinstance(found, Molecule):
        return _select_again(found, {"radii": radii, "waters": waters or None, "unknown_radius": unknown,
                                     "hydrogens": None if hydrogens == "auto" else hydrogens, "frame": frame or None,
                                     **options})
    if hydrogens not in ("auto", "keep", "drop"):
        raise ValueError(f"hydrogens must be 'auto', 'keep' or 'drop', not {hydrogens!r}")
    _arguments.check(read_molecule, waters=waters, unknown_radius=unknown, frame=frame)
    radii, by_bonds = without_ccd(radii)
    source = _source_of(found, radii, unknown, waters, hydrogens, frame, options)
    named = _arrays_of(source.columns)
    marks = () if source.are_read else correct_elements(named)
    syntax = "" if source.are_read or source.select is None else source.columns.syntax or "the molecule's library"
    selector = Selector(named, source.select, syntax)
    selects_all = source.chosen is None or (isinstance(source.chosen, str) and not source.chosen)
    selected = np.ones(len(named.name), bool) if selects_all else selector.mask(source.chosen, "select")
    are_named = bool((named.residue != "").any())
    which = "protor" if are_named else "bondi"
    if isinstance(radii, (str, os.PathLike)):
        which = os.fspath(radii)
    elif isinstance(found, _core.Atoms):
        which = source.set_name
    if radii is not None and not isinstance(radii, (str, os.PathLike)):
        choice = _take_radii(named, radii, "given")
        choice.drop(~selected, "selection")
    elif source.are_read:
        choice = _take_radii(named, source.columns.radii, source.set_name)
        if source.set_name != "file":
            choice.guessed = np.union1d(choice.guessed, atoms_named(named, source.guessed_names))
        choice.classes = choice.classes if source.classes is None else source.classes
        choice.left_out = dict(source.left_out)
        choice.drop(~selected, "selection")
    else:
        choice = _choose_atoms(named, source.columns, which, waters, hydrogens, unknown, selected, *marks)
        warn_about_residues(named, choice.keep)
    if by_bonds:
        _use_bonds(named, choice)
    if not choice.keep.any():
        raise ValueError("no atoms are left" +
                         "".join(f"; {number} {what}" for what, number in choice.left_out.items()))
    _require_finite(named, choice.keep)
    molecule = _molecule_of(named, choice, which, are_named, source.files)
    return dataclasses.replace(molecule, notes=source.notes), selector


def _select_again(molecule: Molecule, options: dict[str, Any]) -> tuple[Molecule, Selector]:
    """Returns a molecule that was read, or its atoms in a selection."""
    if given := [name for name, value in options.items() if value is not None and name != "select"]:
        raise TypeError(f"{given[0]}: the molecule was read already; give it to read_molecule")
    selector = Selector(molecule)
    chosen = options.get("select")
    if chosen is None or (isinstance(chosen, str) and not chosen):
        return molecule, selector
    is_chosen = selector.mask(chosen, "select")[molecule.kept]
    if not is_chosen.any():
        raise ValueError("select: all atoms are left out of the molecule")
    left_out = dict(molecule.left_out)
    left_out["selection"] = left_out.get("selection", 0) + int((~is_chosen).sum())
    columns = {name: getattr(molecule, name)[is_chosen] for name in ("centers", "radii", "kept")}
    for column in columns.values():
        column.flags.writeable = False
    return dataclasses.replace(molecule, left_out=Counts(left_out), **columns), selector


def is_molecule(found: Any) -> bool:
    """Whether an object is a file, or a molecule of a class, and no array of centres."""
    if isinstance(found, np.ndarray):
        return False
    return (is_file(found) or isinstance(found, (Molecule, _core.Atoms, _core.Surface))
            or adaptors.find_adaptor(found) is not None)


def _require_finite(named: _Named, keep: _Bools) -> None:
    """Raises ValueError for coordinates that are no numbers, by the index of the atom in the object."""
    for i in np.flatnonzero(keep & ~np.isfinite(named.positions).all(axis=1)).tolist():
        names = [text for text in (named.chain[i], named.residue[i], named.name[i]) if text]
        raise ValueError(f"atom {i} (counted from 0{'; ' * bool(names)}{' '.join(names)}) has coordinates "
                         f"{named.positions[i].tolist()}; give finite numbers")


def read_with_selector(found: Any, radii: Any, options: dict[str, Any]) -> tuple[Molecule, Selector]:
    """Returns what `read_molecule` returns, and the selector, for the further arguments of a surface."""
    defaults: dict[str, Any] = {"waters": False, "hydrogens": "auto", "unknown_radius": None, "frame": 0}
    require_known(options, _core.Surface.__init__, defaults)
    others = {name: value for name, value in options.items() if name not in defaults}
    waters, hydrogens, unknown, frame = (options.get(name, default) for name, default in defaults.items())
    return _read(found, radii, waters, hydrogens, unknown, frame, others)


def _molecule_of(named: _Named, choice: _Choice, which: str, are_named: bool, files: tuple[str, ...]) -> Molecule:
    kept = np.flatnonzero(choice.keep)
    is_named = choice.set_name in ("file", "given") or "+ccd" in choice.set_name
    source_text = SOURCES.get(choice.set_name if is_named else which.lower(), f"the configuration file {which}")
    columns = {field.name: getattr(named, field.name) for field in dataclasses.fields(named)}
    molecule = Molecule(
        centers=named.positions[kept], radii=choice.radii[kept], kept=kept, left_out=Counts(choice.left_out),
        set=Radii(choice.set_name, source_text, choice.guessed, choice.unknown), are_named=are_named, files=files,
        classes=choice.classes, **columns)
    for column in (molecule.centers, molecule.radii, kept, choice.guessed, choice.unknown, choice.classes, *columns.values()):
        column.flags.writeable = False
    return molecule
