"""Areas that the parts of a complex bury of each other."""

from __future__ import annotations

import functools
import os
from typing import Any, Iterator, Optional, Sequence, overload

import numpy as np

from . import _core, _molecule
from ._files import output_path, write_structure
from ._measurement import _Path, Table, _polar_atoms, _starts_of
from ._select import Selector


class Interface:
    """The interface between two parts of a complex: the areas that each loses by the other, in square
    angstrom. The interface area is half of what both lose. SES areas can be negative by atom, because
    saddle and concave patches between the parts belong to both."""

    def __init__(self, molecule: _molecule.Molecule, first: str, second: str, side: Any, polar: Any,
                 atoms: Any, sas_lost: Any, ses_lost: Any) -> None:
        self._molecule, self._polar = molecule, polar
        self._side, self._atoms, self._sas, self._ses = side, atoms, sas_lost, ses_lost
        #: The names of the two parts.
        self.first, self.second = first, second

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
        """A row for each residue with such an atom: ``side``, ``chain``, ``residue_number``, ``icode``,
        ``residue``, ``sas_lost``, ``ses_lost``. ChimeraX lists those that lose 15 square angstrom."""
        atoms = self.atoms
        keys = ("side", "chain", "residue_number", "icode", "residue")
        starts = _molecule._runs(*(atoms[key] for key in keys)) if len(atoms) else np.zeros(0, np.int64)
        columns = {key: atoms[key][starts] for key in keys}
        for column in ("sas_lost", "ses_lost"):
            columns[column] = np.add.reduceat(atoms[column], starts) if len(starts) else atoms[column]
        return Table(columns, self._molecule.files)

    def save(self, path: _Path, column: str = "sas_lost") -> None:
        """Write the kept atoms as ``.pdb`` or ``.cif`` with ``sas_lost`` or ``ses_lost`` in the column of
        the B-factor, or the table of atoms as ``.csv``. Raises ValueError as `Measurement.save`."""
        if column not in ("sas_lost", "ses_lost"):
            raise ValueError(f"column must be sas_lost or ses_lost, not {column!r}")
        path = output_path(path, self._molecule.files)
        if os.path.splitext(path)[1].lower() == ".csv":
            self.atoms.save(path)
            return
        values = np.full(len(self._molecule), np.nan)
        values[self._molecule.kept] = 0
        values[self._atoms] = self.atoms[column]
        write_structure(path, self._molecule, values)

    def __repr__(self) -> str:
        return (f"<eses_blocks.Interface: {self.first} and {self.second}, SAS interface area {self.sas_area:.6g}, "
                f"lost {self.sas_lost[0]:.6g} and {self.sas_lost[1]:.6g}>")

    def _repr_html_(self) -> str:
        return Interfaces([self]).table._repr_html_()


class Interfaces(Sequence[Interface]):
    """Interfaces, the largest first. ``table`` has a row for each."""

    def __init__(self, interfaces: Sequence[Interface], files: tuple[str, ...] = ()) -> None:
        self._interfaces, self._files = tuple(interfaces), files

    def __len__(self) -> int:
        return len(self._interfaces)

    @overload
    def __getitem__(self, index: int) -> Interface: ...
    @overload
    def __getitem__(self, index: slice) -> Interfaces: ...

    def __getitem__(self, index: Any) -> Any:
        found = self._interfaces[index]
        return Interfaces(found, self._files) if isinstance(index, slice) else found

    def __iter__(self) -> Iterator[Interface]:
        return iter(self._interfaces)

    @property
    def table(self) -> Table:
        """A row for each interface: ``first``, ``second``, ``sas_area``, ``sas_lost_first``,
        ``sas_lost_second``, ``polar``, ``apolar``, ``ses_area``, ``ses_lost_first``,
        ``ses_lost_second`` and the numbers of ``residues`` and ``atoms``."""
        rows = [(each.first, each.second, each.sas_area, *each.sas_lost, each.polar, each.apolar, each.ses_area,
                 *each.ses_lost, len(each.residues), len(each.atoms)) for each in self]
        names = ("first", "second", "sas_area", "sas_lost_first", "sas_lost_second", "polar", "apolar", "ses_area",
                 "ses_lost_first", "ses_lost_second", "residues", "atoms")
        return Table({name: np.array([row[k] for row in rows]) for k, name in enumerate(names)}, self._files)

    def to_pandas(self) -> Any:
        """Returns `table` as a pandas.DataFrame."""
        return self.table.to_pandas()

    def __repr__(self) -> str:
        return f"<eses_blocks.Interfaces: {len(self)}>"

    def _repr_html_(self) -> str:
        return self.table._repr_html_()


def _measure(molecule: _molecule.Molecule, parts: Any, names: Sequence[str], probe_radius: float,
             threads: int) -> list[Interface]:
    """Measures the interfaces of parts, whose numbers are those of all atoms of the molecule."""
    surface = _core.Surface(molecule.centers, molecule.radii, probe_radius, threads=threads)
    polar = _polar_atoms(molecule, _starts_of(molecule))
    interfaces = []
    for first, second, atoms, sas_lost, ses_lost in _core._measure_interfaces(
            surface, parts[molecule.kept], threads):
        index = molecule.kept[atoms]
        interfaces.append(Interface(molecule, names[first], names[second], (parts[index] == second).astype(np.int64),
                                    polar[index], index, sas_lost, ses_lost))
    return interfaces


def _gives_ligands_to(part: Any, other: Any, select: Selector) -> bool:
    """Whether a part of chains leaves atoms to another part, as its ligands."""
    names_chains = isinstance(part, str) and not set("/([;") & set(part) and not select.ligand(part)
    return names_chains and isinstance(other, str) and select.ligand(other)


def interface(molecule: Any, first: Any, second: Any = None, radii: Any = None, *, probe_radius: float = 1.4,
              waters: bool = False, hydrogens: str = "auto", unknown_radius: Optional[float] = None, frame: int = 0,
              threads: int = 0, **options: Any) -> Interface:
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

    Returns
    -------
    Interface
        Lost areas by part, residue and atom. They are 0 if the parts do not touch.

    Raises
    ------
    TypeError
        If the object is not known.
    ValueError
        If a part has no atoms, if the parts share atoms, or as ``measure``.
    """
    _molecule.require_known(options, interface)
    for name, value in (("probe_radius", probe_radius), ("frame", frame), ("threads", threads)):
        _molecule.require_number(name, value)
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
    names = [part if isinstance(part, str) else f"{int(mask.sum())} atoms" for part, mask in zip((first, second), masks)]
    measured = _measure(found, parts, names, probe_radius, threads)
    nothing = np.zeros(0)
    return measured[0] if measured else Interface(found, names[0], names[1], nothing.astype(np.int64),
                                                  nothing.astype(bool), nothing.astype(np.int64), nothing, nothing)


def interfaces(molecule: Any, radii: Any = None, *, probe_radius: float = 1.4, waters: bool = False,
               hydrogens: str = "auto", unknown_radius: Optional[float] = None, frame: int = 0, threads: int = 0,
               **options: Any) -> Interfaces:
    """Measure the interfaces of all pairs of chains that touch.

    Parameters
    ----------
    molecule, radii, probe_radius, waters, hydrogens, unknown_radius, frame, threads, **options
        See ``interface``.

    Returns
    -------
    Interfaces
        The interfaces, in descending order of their areas. Each pair is measured without the others.

    Raises
    ------
    TypeError, ValueError
        As ``measure``.
    """
    _molecule.require_known(options, interfaces)
    for name, value in (("probe_radius", probe_radius), ("frame", frame), ("threads", threads)):
        _molecule.require_number(name, value)
    found, _ = _molecule._read(molecule, radii, waters, hydrogens, unknown_radius, frame, options)
    names = list(dict.fromkeys(found.chain.tolist()))
    numbers = {name: k for k, name in enumerate(names)}
    parts = np.array([numbers[name] for name in found.chain.tolist()], np.int64)
    measured = _measure(found, parts, names, probe_radius, threads)
    return Interfaces(sorted(measured, key=lambda each: -each.sas_area), found.files)
