"""Areas that the parts of a complex bury of each other."""

from __future__ import annotations

import functools
import os
from typing import Any, Iterable, Iterator, Optional, Sequence, Union, overload

import numpy as np

from . import _arguments, _core, _molecule
from ._files import output_path, write_structure
from ._locations import first_of_runs
from ._measurement import _Path, Table, _polar_atoms, _starts_of
from ._read_only import ReadOnly
from ._select import Selector, is_gemmi_selection


class Interface(ReadOnly):
    """The interface between two parts of a complex: the areas that each loses by the other, in square
    angstrom. The interface area is half of what both lose. SES areas can be negative by atom, because
    saddle and concave patches between the parts belong to both."""

    def __init__(self, molecule: _molecule.Molecule, first: str, second: str, side: Any, polar: Any,
                 atoms: Any, sas_lost: Any, ses_lost: Any, residue_cutoff: float = 0.0) -> None:
        self._molecule, self._polar, self._residue_cutoff = molecule, polar, residue_cutoff
        self._side, self._atoms, self._sas, self._ses = side, atoms, sas_lost, ses_lost
        self._first, self._second = first, second

    @property
    def first(self) -> str:
        """The name of the first part."""
        return self._first

    @property
    def second(self) -> str:
        """The name of the second part."""
        return self._second

    def _lost(self, areas: Any) -> tuple[float, float]:
        return float(areas[self._side == 0].sum()), float(areas[self._side == 1].sum())

    @property
    def sas_lost(self) -> tuple[float, float]:
        """SAS areas that the first and the second part lose."""
        return self._lost(self._sas)

    @property
    def ses_lost(self) -> tuple[float, float]:
        """SES areas that the first and the second part lose."""
        return self._lost(self._ses)

    @property
    def sas_area(self) -> float:
        """Interface area: half of the SAS area that both lose."""
        return sum(self.sas_lost) / 2

    @property
    def ses_area(self) -> float:
        """Half of the SES area that both lose."""
        return sum(self.ses_lost) / 2

    @property
    def polar(self) -> float:
        """The part of `sas_area` of polar atoms; see `Measurement.classes`."""
        return float(self._sas[self._polar].sum()) / 2

    @property
    def apolar(self) -> float:
        """The part of `sas_area` of apolar atoms."""
        return float(self._sas[~self._polar].sum()) / 2

    @functools.cached_property
    def atoms(self) -> Table:
        """A row for each atom whose areas differ: ``index`` in the molecule from 0, ``side`` (0 or 1),
        ``chain``, ``residue_number``, ``icode``, ``residue``, ``name``, ``element``, ``sas_lost``,
        ``ses_lost``, ``is_polar``."""
        molecule, index = self._molecule, self._atoms
        names = {name: getattr(molecule, name)[index] for name in
                 ("chain", "residue_number", "icode", "residue", "name", "element")}
        return Table({"index": index, "side": self._side, **names, "sas_lost": self._sas,
                      "ses_lost": self._ses, "is_polar": self._polar}, molecule.files)

    @functools.cached_property
    def residues(self) -> Table:
        """A row for each residue with such an atom that loses at least `residue_cutoff` of its SAS area: ``side``,
        ``chain``, ``residue_number``, ``icode``, ``residue``, ``sas_lost``, ``ses_lost``. ChimeraX lists those
        that lose 15 square angstrom."""
        atoms = self.atoms
        keys = ("side", "chain", "residue_number", "icode", "residue")
        starts = first_of_runs(*(atoms[key] for key in keys)) if len(atoms) else np.zeros(0, np.int64)
        columns = {key: atoms[key][starts] for key in keys}
        for column in ("sas_lost", "ses_lost"):
            columns[column] = np.add.reduceat(atoms[column], starts) if len(starts) else atoms[column]
        is_shown = columns["sas_lost"] >= (self._residue_cutoff or -np.inf)
        return Table({name: column[is_shown] for name, column in columns.items()}, self._molecule.files)

    @property
    def molecule(self) -> _molecule.Molecule:
        """The atoms, with their set of radii."""
        return self._molecule

    def save(self, path: _Path, column: str = "sas_lost", level: str = "atom") -> None:
        """Write the kept atoms as ``.pdb`` or ``.cif`` with ``sas_lost`` or ``ses_lost`` in the column of
        the B-factor, or the table of atoms or residues (``level='residue'``) as ``.csv`` or ``.parquet``. Raises
        ValueError as `Measurement.save`."""
        _save([self], self._molecule, path, column, level, {"atom": "atoms", "residue": "residues"}, self)

    def __repr__(self) -> str:
        return (f"<eses_blocks.Interface: {self.first} and {self.second}, SAS interface area {self.sas_area:.6g}, "
                f"lost {self.sas_lost[0]:.6g} and {self.sas_lost[1]:.6g}>")

    def _repr_html_(self) -> str:
        return Interfaces([self]).table._repr_html_()


def _save(interfaces: Sequence[Interface], molecule: Optional[_molecule.Molecule], path: _Path, column: str, level: str,
          tables: dict[str, str], owner: Any) -> None:
    """Writes a table of the owner, or the atoms of the molecule with the areas that they lose in all interfaces."""
    _arguments.check(Interface.save, path=path, column=column, level=level)
    if column not in ("sas_lost", "ses_lost"):
        raise ValueError(f"column must be sas_lost or ses_lost, not {column!r}")
    if level not in tables:
        raise ValueError(f"level must be one of {', '.join(tables)}, not {level!r}")
    name = output_path(path, molecule.files if molecule else ())
    if os.path.splitext(name)[1].lower() in (".csv", ".parquet"):
        getattr(owner, tables[level]).save(name)
        return
    if molecule is None:
        raise ValueError("there are no interfaces, and no atoms to write")
    values = np.full(len(molecule), np.nan)
    values[molecule.kept] = 0
    for each in interfaces:
        values[each.atoms["index"]] += each.atoms[column]
    write_structure(name, molecule, values)


class Interfaces(ReadOnly, Sequence[Interface]):
    """Interfaces, the largest first. ``table`` has a row for each."""

    def __init__(self, interfaces: Sequence[Interface], molecule: Optional[_molecule.Molecule] = None) -> None:
        self._interfaces = tuple(interfaces)
        self._molecule = molecule or (self._interfaces[0].molecule if self._interfaces else None)
        self._files = self._molecule.files if self._molecule else ()

    def __len__(self) -> int:
        return len(self._interfaces)

    @overload
    def __getitem__(self, index: int) -> Interface: ...
    @overload
    def __getitem__(self, index: slice) -> Interfaces: ...

    def __getitem__(self, index: Any) -> Any:
        found = self._interfaces[index]
        return Interfaces(found, self._molecule) if isinstance(index, slice) else found

    def __iter__(self) -> Iterator[Interface]:
        return iter(self._interfaces)

    @property
    def table(self) -> Table:
        """A row for each interface: ``first``, ``second``, ``sas_area``, ``sas_lost_first``,
        ``sas_lost_second``, ``polar``, ``apolar``, ``ses_area``, ``ses_lost_first``,
        ``ses_lost_second`` and the numbers of ``residues`` and ``atoms``."""
        rows = [(each.first, each.second, each.sas_area, *each.sas_lost, each.polar, each.apolar, each.ses_area,
                 *each.ses_lost, len(each.residues), len(each.atoms)) for each in self]
        types = {"first": str, "second": str, "residues": np.int64, "atoms": np.int64}
        names = ("first", "second", "sas_area", "sas_lost_first", "sas_lost_second", "polar", "apolar", "ses_area",
                 "ses_lost_first", "ses_lost_second", "residues", "atoms")
        return Table({name: np.array([row[k] for row in rows], types.get(name, float)) for k, name in enumerate(names)},
                     self._files)

    def to_pandas(self) -> Any:
        """Returns `table` as a pandas.DataFrame."""
        return self.table.to_pandas()

    def _joined(self, name: str) -> Table:
        """Returns the rows of a table of all interfaces, with the names of the parts."""
        found = self._interfaces or ((_without_contact(self._molecule, "", ""),) if self._molecule else ())
        tables = [getattr(each, name) for each in found]
        columns = {key: np.array([getattr(each, key) for each, table in zip(found, tables) for _ in range(len(table))], str)
                   for key in ("first", "second")}
        for key in tables[0] if tables else ():
            columns[key] = np.concatenate([table[key] for table in tables])
        return Table(columns, self._files)

    @property
    def residues(self) -> Table:
        """The residues of all interfaces: ``first`` and ``second``, and the columns of `Interface.residues`."""
        return self._joined("residues")

    @property
    def atoms(self) -> Table:
        """The atoms of all interfaces: ``first`` and ``second``, and the columns of `Interface.atoms`."""
        return self._joined("atoms")

    def save(self, path: _Path, column: str = "sas_lost", level: str = "interface") -> None:
        """Write the atoms as ``.pdb`` or ``.cif`` with the areas that they lose in all interfaces in the column of
        the B-factor, or `table`, `residues` or `atoms` (``level`` is ``interface``, ``residue`` or ``atom``) as ``.csv`` or
        ``.parquet``. Raises ValueError as `Measurement.save`."""
        _save(self, self._molecule, path, column, level, {"interface": "table", "residue": "residues", "atom": "atoms"},
              self)

    def __repr__(self) -> str:
        shown = [f"{each.first} and {each.second} {each.sas_area:.6g}" for each in self[:10]]
        more = f", {len(self) - 10} more" if len(self) > 10 else ""
        text = f"; SAS interface areas: {', '.join(shown)}{more}" if shown else ""
        return f"<eses_blocks.Interfaces: {len(self)}{text}>"

    def _repr_html_(self) -> str:
        return self.table._repr_html_()


def _measure(molecule: _molecule.Molecule, parts: Any, names: Sequence[str], probe_radius: float,
             threads: int, residue_cutoff: float) -> list[Interface]:
    """Measures the interfaces of parts, whose numbers are those of all atoms of the molecule."""
    surface = _core.Surface(molecule.centers, molecule.radii, probe_radius, threads=threads)
    _core._warn_about_stray_atoms(surface, molecule.kept)
    polar = _polar_atoms(molecule, _starts_of(molecule))
    interfaces = []
    for first, second, atoms, sas_lost, ses_lost in _core._measure_interfaces(
            surface, parts[molecule.kept], threads):
        index = molecule.kept[atoms]
        interfaces.append(Interface(molecule, names[first], names[second], (parts[index] == second).astype(np.int64),
                                    polar[index], index, sas_lost, ses_lost, residue_cutoff))
    return interfaces


def _without_contact(molecule: _molecule.Molecule, first: str, second: str) -> Interface:
    """Returns the interface of parts that do not touch."""
    nothing = np.zeros(0)
    return Interface(molecule, first, second, nothing.astype(np.int64), nothing.astype(bool), nothing.astype(np.int64),
                     nothing, nothing)


def _gives_ligands_to(part: Any, other: Any, select: Selector) -> bool:
    """Whether a part of chains leaves atoms to another part, as its ligands."""
    names_chains = isinstance(part, str) and not set("/([;!") & set(part) and not select.ligand(part)
    return names_chains and isinstance(other, str) and select.ligand(other)


@overload
def interface(molecule: Any, first: Any, second: Any = None, radii: Any = None, *, models: None = None,
              **options: Any) -> Interface: ...
@overload
def interface(molecule: Any, first: Any, second: Any = None, radii: Any = None, *, models: Union[str, Iterable[int]],
              **options: Any) -> list[Interface]: ...


def interface(molecule: Any, first: Any, second: Any = None, radii: Any = None, *, probe_radius: float = 1.4,
              waters: bool = False, hydrogens: str = "auto", unknown_radius: Optional[float] = None, frame: int = 0,
              residue_cutoff: float = 0.0, threads: int = 0, models: Optional[Union[str, Iterable[int]]] = None,
              **options: Any) -> Union[Interface, list[Interface]]:
    """Measure the areas that two parts of a complex bury of each other.

    The parts are measured together, without all other atoms, and each alone. The interface area is
    half of the SAS area that both lose (Chothia and Janin, Nature 256, 705, 1975).

    Parameters
    ----------
    molecule : object
        See ``read_molecule``, which also describes the further arguments.
    first, second : str or array_like
        The parts: names of chains, such as ``"A"`` or ``"A+B"``, ligands, such as ``"ligand:STI"``,
        selections, masks or indices as ``report`` of ``measure``. Without ``second``, it is all other atoms.
    probe_radius : float, optional
        Radius of the probe, in angstrom.
    residue_cutoff : float, optional
        SAS area that a residue loses at least to be listed in ``residues``, in square angstrom.
    models : 'all' or iterable of int, optional
        The models of a file to measure, each by itself, such as those of an NMR structure.

    Returns
    -------
    Interface
        Lost areas by part, residue and atom. They are 0 if the parts do not touch. With ``models``, a list of
        interfaces, one for each.

    Raises
    ------
    TypeError
        If the object is not known.
    ValueError
        If a part has no atoms, if the parts share atoms, or as ``measure``.
    """
    _molecule.require_known(options, interface)
    if models is not None:
        return _molecule.each_model(interface, locals())
    _arguments.check(interface, probe_radius=probe_radius, threads=threads, residue_cutoff=residue_cutoff)
    _arguments.require_not_negative(residue_cutoff=residue_cutoff)
    found, select = _molecule._read(molecule, radii, waters, hydrogens, unknown_radius, frame, options)
    masks = [select.mask(first, "first")]
    masks.append(~masks[0] if second is None else select.mask(second, "second"))
    for part, other in ((0, 1), (1, 0)):
        if _gives_ligands_to((first, second)[part], (first, second)[other], select):
            masks[part] = masks[part] & ~masks[other]
    if (masks[0] & masks[1]).any():
        raise ValueError(f"{int((masks[0] & masks[1]).sum())} atoms belong to both parts")
    for mask, name in zip(masks, ("first", "second")):
        if not mask[found.kept].any():
            raise ValueError(f"{name}: the part has no atoms")
    parts = np.full(len(found), -1, np.int64)
    parts[masks[0]], parts[masks[1]] = 0, 1
    names = [part if isinstance(part, str) else part.str() if is_gemmi_selection(part) else "all other atoms" if part is None else f"{int(mask[found.kept].sum())} atoms"
             for part, mask in zip((first, second), masks)]
    measured = _measure(found, parts, names, probe_radius, threads, residue_cutoff)
    return measured[0] if measured else _without_contact(found, names[0], names[1])


@overload
def interfaces(molecule: Any, radii: Any = None, *, models: None = None, **options: Any) -> Interfaces: ...
@overload
def interfaces(molecule: Any, radii: Any = None, *, models: Union[str, Iterable[int]],
               **options: Any) -> list[Interfaces]: ...


def interfaces(molecule: Any, radii: Any = None, *, probe_radius: float = 1.4, waters: bool = False,
               hydrogens: str = "auto", unknown_radius: Optional[float] = None, frame: int = 0,
               area_cutoff: float = 0.0, residue_cutoff: float = 0.0, threads: int = 0,
               models: Optional[Union[str, Iterable[int]]] = None,
               **options: Any) -> Union[Interfaces, list[Interfaces]]:
    """Measure the interfaces of all pairs of chains that touch.

    Parameters
    ----------
    molecule, radii, probe_radius, waters, hydrogens, unknown_radius, frame, residue_cutoff, threads, models, **options
        See ``interface``.
    area_cutoff : float, optional
        Interfaces with less SAS interface area are left out, in square angstrom.

    Returns
    -------
    Interfaces
        The interfaces, in descending order of their areas. Each pair is measured without the others. With
        ``models``, a list of them, one for each model.

    Raises
    ------
    TypeError, ValueError
        As ``measure``.
    """
    _molecule.require_known(options, interfaces)
    if models is not None:
        return _molecule.each_model(interfaces, locals())
    _arguments.check(interfaces, probe_radius=probe_radius, threads=threads, area_cutoff=area_cutoff,
                     residue_cutoff=residue_cutoff)
    _arguments.require_not_negative(area_cutoff=area_cutoff, residue_cutoff=residue_cutoff)
    found, _ = _molecule._read(molecule, radii, waters, hydrogens, unknown_radius, frame, options)
    names = list(dict.fromkeys(found.chain.tolist()))
    numbers = {name: k for k, name in enumerate(names)}
    parts = np.array([numbers[name] for name in found.chain.tolist()], np.int64)
    measured = _measure(found, parts, names, probe_radius, threads, residue_cutoff)
    kept = [each for each in measured if each.sas_area >= area_cutoff]
    return Interfaces(sorted(kept, key=lambda each: -each.sas_area), found)
