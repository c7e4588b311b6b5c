"""Areas and volumes of a molecule as columns: atoms, residues and chains."""

from __future__ import annotations

import csv
import functools
import html
import os
from typing import Any, Iterable, Iterator, Optional, Union, overload

import numpy as np
import numpy.typing as npt

from . import _arguments, _core, _molecule
from ._files import output_path, write_structure
from ._locations import first_of_runs
from ._read_only import Counts, ReadOnly
from ._references import CLASSES, MAIN_CHAIN, REFERENCE_PROBE_RADIUS, REFERENCES, is_amino_acid
from ._paths import remember_files
from ._select import listed, remember_molecule

_Doubles = npt.NDArray[np.float64]
_Bools = npt.NDArray[np.bool_]
_Path = Union[str, bytes, os.PathLike[str], os.PathLike[bytes]]


class Table(ReadOnly):
    """Read-only numpy columns of one length, by name: ``table["sas"]``. ``len(table)`` is the number of
    rows, ``dict(table)`` has all columns."""

    def __init__(self, columns: dict[str, Any], files: Iterable[str] = ()) -> None:
        self._files = tuple(files)  # which save does not overwrite
        self._columns = {name: np.array(column) for name, column in columns.items()}
        for column in self._columns.values():
            column.flags.writeable = False

    def __getitem__(self, name: str) -> Any:
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"{name!r}; the columns are {', '.join(self._columns)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def __len__(self) -> int:
        return len(next(iter(self._columns.values())))

    def keys(self) -> list[str]:
        """Returns the names of the columns."""
        return list(self._columns)

    def __repr__(self) -> str:
        return f"<eses_blocks.Table: {len(self)} rows; {', '.join(self._columns)}>"

    def __reduce__(self) -> Any:
        return Table, (self._columns, self._files)

    def to_pandas(self) -> Any:
        """Returns a pandas.DataFrame with these columns. Raises ImportError without pandas."""
        pandas = _arguments.imported("pandas", "to_pandas")
        return pandas.DataFrame({name: column.copy() for name, column in self._columns.items()})

    def save(self, path: _Path) -> None:
        """Writes a CSV file with a line of column names, in which missing values are empty; or a Parquet
        file, if this is the suffix, which needs pandas and pyarrow. Raises ValueError for other suffixes, and
        if the table is of this file, which would be overwritten."""
        path = output_path(path, self._files)
        suffix = os.path.splitext(path)[1].lower()
        if suffix not in ("", ".csv", ".parquet"):
            raise ValueError(f"{path}: the suffix of a table must be .csv or .parquet")
        if _is_parquet(path):
            self.to_pandas().to_parquet(path, engine="pyarrow", index=False)
            return
        with open(path, "w", encoding="utf-8", newline="") as target:
            rows = csv.writer(target, lineterminator="\n")
            rows.writerow(self._columns)
            columns = [["" if value != value else value for value in column.tolist()]
                       for column in self._columns.values()]
            rows.writerows(zip(*columns))

    def _repr_html_(self, limit: int = 20) -> str:
        def cell(value: Any) -> str:
            return "" if value != value else f"{value:.2f}" if isinstance(value, float) else html.escape(str(value))
        head = "".join(f"<th>{html.escape(name)}</th>" for name in self._columns)
        rows = zip(*(column[:limit].tolist() for column in self._columns.values()))
        body = "".join(f"<tr>{''.join(f'<td>{cell(value)}</td>' for value in row)}</tr>" for row in rows)
        rest = f"<p>{len(self) - limit} more rows</p>" if len(self) > limit else ""
        return f"<table><tr>{head}</tr>{body}</table>{rest}"


def _is_parquet(path: str) -> bool:
    return os.path.splitext(path)[1].lower() == ".parquet"


def _starts_of(molecule: _molecule.Molecule) -> npt.NDArray[np.int64]:
    """Returns the first atom of each residue."""
    return first_of_runs(molecule.chain, molecule.residue_number, molecule.icode, molecule.residue)


def _polar_atoms(molecule: _molecule.Molecule, starts: npt.NDArray[np.int64]) -> _Bools:
    """Marks the polar atoms; CLASSES describes them."""
    residues = np.zeros(len(molecule), np.int64)
    residues[starts[1:]] = 1
    return np.array(_core._find_polar(molecule.positions, molecule.element.tolist(), np.cumsum(residues),
                                      molecule.classes.tolist()), bool)


class Measurement(ReadOnly):
    """Areas and volumes of a molecule in closed form, in angstrom.

    ``atoms``, ``residues`` and ``chains`` are tables of numpy columns in the order of the molecule.
    Atoms that are left out or not reported have areas that are not a number (nan).
    """

    def __init__(self, molecule: _molecule.Molecule, surface: _core.Surface, measures: _core.Measures,
                 reported: Optional[_Bools], reference: str) -> None:
        self._molecule, self._surface, self._measures = molecule, surface, measures
        self._reported, self._reference = reported, reference
        by_atom = measures.by_atom
        assert by_atom is not None
        self._sas, self._ses = (self._spread(column) for column in (by_atom.sas, by_atom.ses))

    def _spread(self, areas: _Doubles) -> _Doubles:
        """Returns areas of kept atoms as a column of all atoms."""
        column = np.full(len(self._molecule), np.nan)
        column[self._molecule.kept] = areas
        if self._reported is not None:
            column[~self._reported] = np.nan
        column.flags.writeable = False
        return column

    @property
    def _has_ses(self) -> bool:
        """Whether the solvent excluded surface was measured."""
        return self._measures.ses_area == self._measures.ses_area

    def __reduce__(self) -> Any:
        return Measurement, (self._molecule, self._surface, self._measures, self._reported, self._reference)

    # ------------------------------------------------------------------------------- numbers

    @property
    def whole(self) -> _core.Measures:
        """Areas and volumes of all atoms that make up the surface, also those that are not reported."""
        return self._measures

    @property
    def ses_area(self) -> float:
        """Area of the reported atoms on the solvent excluded surface."""
        if self._reported is None or not self._has_ses:
            return self._measures.ses_area
        return float(np.nansum(self._ses))

    @property
    def sas_area(self) -> float:
        """Area of the reported atoms on the solvent accessible surface (SASA)."""
        return self._measures.sas_area if self._reported is None else float(np.nansum(self._sas))

    @property
    def ses_volume(self) -> float:
        """Volume inside the solvent excluded surface, of the whole molecule."""
        return self._measures.ses_volume

    @property
    def sas_volume(self) -> float:
        """Volume inside the solvent accessible surface, of the whole molecule."""
        return self._measures.sas_volume

    @property
    def vdw_area(self) -> Optional[float]:
        """Area of the van der Waals surface of the whole molecule, if it was chosen."""
        return self._measures.vdw_area

    @property
    def vdw_volume(self) -> Optional[float]:
        """Volume of the van der Waals spheres of the whole molecule, if it was chosen."""
        return self._measures.vdw_volume

    @property
    def polar(self) -> float:
        """Area of the reported polar atoms on the SAS; `classes` says which atoms are polar."""
        return float(np.nansum(self._sas[self._polar]))

    @property
    def apolar(self) -> float:
        """Area of the reported apolar atoms on the SAS."""
        return float(np.nansum(self._sas[~self._polar]))

    @property
    def classes(self) -> str:
        """Which atoms are polar."""
        return CLASSES

    @property
    def reference(self) -> str:
        """Publication of the maximum areas of residues, by which relative areas are divided."""
        return REFERENCES[self._reference].source

    @property
    def radii(self) -> _molecule.Radii:
        """The set of radii, its source, and the atoms whose radius or element was guessed."""
        return self._molecule.set

    @property
    def left_out(self) -> Counts:
        """Numbers of the atoms of the object that are not part of the surface, by their kind."""
        return self._molecule.left_out

    @property
    def notes(self) -> tuple[str, ...]:
        """What the file has besides the measured atoms: other models, and assemblies with several copies; and the modified
        amino acids without a relative area."""
        return self._molecule.notes + self._notes_on_areas

    @property
    def molecule(self) -> _molecule.Molecule:
        """The atoms."""
        return self._molecule

    @property
    def surface(self) -> _core.Surface:
        """The surface, with the atoms that are kept."""
        return self._surface

    @property
    def derivatives(self) -> Optional[_core.Gradients]:
        """Derivatives of areas and volumes of the whole molecule, if chosen, for the kept atoms."""
        return self._measures.gradients

    def cavities(self) -> list[dict[str, Any]]:
        """Returns the cavities, as ``Surface.cavities``; their atoms are indices of kept atoms."""
        return self._surface.cavities()

    # -------------------------------------------------------------------------------- tables

    @functools.cached_property
    def _starts(self) -> npt.NDArray[np.int64]:
        return _starts_of(self._molecule)

    @functools.cached_property
    def _polar(self) -> _Bools:
        return _polar_atoms(self._molecule, self._starts)

    @functools.cached_property
    def _are_amino_acids(self) -> _Bools:
        """Marks the residues with the name or the backbone of an amino acid."""
        molecule, starts = self._molecule, self._starts
        have_atoms = [np.logical_or.reduceat(molecule.name == name, starts) for name in ("N", "CA", "C")]
        found: _Bools = np.all(have_atoms, axis=0) | [is_amino_acid(name) for name in molecule.residue[starts].tolist()]
        return found

    @functools.cached_property
    def _maxima(self) -> _Doubles:
        """The maximum area of each residue; not a number if it has none."""
        molecule, starts = self._molecule, self._starts.tolist()
        reference = REFERENCES[self._reference]
        if self._surface.probe_radius != REFERENCE_PROBE_RADIUS:
            return np.full(len(starts), np.nan)
        return np.array([reference.maximum(str(molecule.residue[first]), molecule.name[first:end].tolist())
                         for first, end in zip(starts, [*starts[1:], len(molecule)])])

    @functools.cached_property
    def _notes_on_areas(self) -> tuple[str, ...]:
        if self._surface.probe_radius != REFERENCE_PROBE_RADIUS:
            return ()
        is_shown = np.logical_or.reduceat(~np.isnan(self._sas), self._starts)
        names = self._molecule.residue[self._starts][is_shown & self._are_amino_acids & np.isnan(self._maxima)]
        texts = [f"{name} ({count})" for name, count in zip(*np.unique(names, return_counts=True))]
        return (f"modified amino acids without a maximum area have no relative area: {listed(texts)}",) if texts else ()

    def _other_chain(self, rows: Any) -> dict[str, Any]:
        """Returns the column of the other chain names of an mmCIF file, if the molecule has them."""
        for name in ("auth_chain", "label_chain"):
            values = getattr(self._molecule, name)
            if (values != "").any():
                return {name: values[rows]}
        return {}

    @functools.cached_property
    def atoms(self) -> Table:
        """A row for each atom of the object: ``chain``, for mmCIF files ``label_chain`` (or ``auth_chain``), ``residue_number``,
        ``icode``, ``residue``, ``name``, ``element``, ``radius``, ``ses``, ``sas``, ``is_polar``,
        ``is_guessed``."""
        molecule = self._molecule
        radius = np.full(len(molecule), np.nan)
        radius[molecule.kept] = molecule.radii
        guessed = np.zeros(len(molecule), bool)
        guessed[molecule.set.guessed] = guessed[molecule.set.unknown] = True
        return Table({"chain": molecule.chain, **self._other_chain(slice(None)),
                      "residue_number": molecule.residue_number, "icode": molecule.icode, "residue": molecule.residue,
                      "name": molecule.name, "element": molecule.element,
                      "radius": radius, "ses": self._ses, "sas": self._sas, "is_polar": self._polar,
                      "is_guessed": guessed}, molecule.files)

    def _sums(self, starts: npt.NDArray[np.int64]) -> tuple[dict[str, Any], _Bools]:
        """Returns the columns of sums over runs of atoms, and the runs with a reported atom."""
        is_known = ~np.isnan(self._sas)
        sas, ses = np.nan_to_num(self._sas), np.nan_to_num(self._ses) if self._has_ses else self._ses

        def add(column: Any) -> Any:
            return np.add.reduceat(column, starts)

        count = add(is_known.astype(np.int64))
        return {"atoms": count, "ses": add(ses), "sas": add(sas), "sas_polar": add(np.where(self._polar, sas, 0)),
                "sas_apolar": add(np.where(self._polar, 0, sas))}, count > 0

    @functools.cached_property
    def residues(self) -> Table:
        """A row for each residue with a reported atom: ``chain``, for mmCIF files ``label_chain`` (or ``auth_chain``),
        ``residue_number``, ``icode``, ``residue``, the number of ``atoms``, ``ses``, ``sas``, ``sas_polar``, ``sas_apolar``,
        ``sas_main_chain``, ``sas_side_chain`` and ``relative_sas``.

        The last three are not a number for residues other than amino acids. The relative area is
        ``sas`` by the maximum area of the residue, whose source is `reference`. MSE and SEC have the maxima of
        MET and CYS, and D-amino acids those of their mirror images. It is not a number for other modified
        residues, which `notes` names, and for a probe radius other than 1.4, to which the maxima belong. It may exceed 1
        at the ends of chains and in unusual conformations, and does if atoms of neighbours are missing.
        """
        molecule, starts = self._molecule, self._starts
        sums, is_shown = self._sums(starts)
        names = molecule.residue[starts]
        is_main = np.isin(molecule.name, list(MAIN_CHAIN))
        main = np.add.reduceat(np.where(is_main, np.nan_to_num(self._sas), 0), starts)
        main[~self._are_amino_acids] = np.nan
        columns = {"chain": molecule.chain[starts], **self._other_chain(starts),
                   "residue_number": molecule.residue_number[starts], "icode": molecule.icode[starts], "residue": names, **sums, "sas_main_chain": main,
                   "sas_side_chain": sums["sas"] - main, "relative_sas": sums["sas"] / self._maxima}
        return Table({name: column[is_shown] for name, column in columns.items()}, molecule.files)

    @functools.cached_property
    def chains(self) -> Table:
        """A row for each chain with a reported atom: ``chain``, the numbers of ``residues`` and
        ``atoms``, ``ses``, ``sas``, ``sas_polar`` and ``sas_apolar``."""
        residues = self.residues
        names = list(dict.fromkeys(residues["chain"].tolist()))
        rows = [np.flatnonzero(residues["chain"] == name) for name in names]
        columns: dict[str, Any] = {"chain": np.array(names, str), "residues": [len(row) for row in rows]}
        for column in ("atoms", "ses", "sas", "sas_polar", "sas_apolar"):
            columns[column] = [residues[column][row].sum() for row in rows]
        return Table(columns, self._molecule.files)

    # ------------------------------------------------------------------------------- output

    def save(self, path: _Path, column: str = "sas", level: str = "atom") -> None:
        """Write the atoms with areas in the column of the B-factor, or a table.

        Parameters
        ----------
        path : str, bytes or os.PathLike
            ``.pdb`` and ``.cif`` are structures, ``.csv`` and ``.parquet`` are the table of atoms, residues
            or chains.
        column : str, optional
            The area of structures: ``sas``, ``ses`` or, by residue, ``relative_sas``.
        level : {'atom', 'residue', 'chain'}, optional
            Whose area an atom gets. Atoms without an area are not written.

        Raises
        ------
        ValueError
            If a number or a name is too wide for its column of a PDB file, if an argument is unknown,
            or if the file is one that was read.
        """
        _arguments.check(Measurement.save, column=column, level=level)
        path = output_path(path, self._molecule.files)
        tables = {"atom": self.atoms, "residue": self.residues, "chain": self.chains}
        if level not in tables:
            raise ValueError(f"level must be atom, residue or chain, not {level!r}")
        if os.path.splitext(path)[1].lower() == ".csv" or _is_parquet(path):
            tables[level].save(path)
            return
        if column not in tables[level] or tables[level][column].dtype.kind == "U":
            known = [name for name in tables[level] if tables[level][name].dtype.kind == "f"]
            raise ValueError(f"column must be one of {', '.join(known)}, not {column!r}")
        write_structure(path, self._molecule, self._values(column, level))

    def _values(self, column: str, level: str) -> Any:
        """Returns the value of each atom; not a number for atoms that are not reported."""
        values: Any = np.where(np.isnan(self._sas), np.nan, 0.0)
        if level == "atom":
            return values + self.atoms[column]
        if level == "chain":
            by_name = dict(zip(self.chains["chain"].tolist(), self.chains[column].tolist()))
            return values + np.array([by_name.get(name, np.nan) for name in self._molecule.chain.tolist()])
        count = len(self._molecule)
        index = np.zeros(count, np.int64)
        is_shown = self._sums(self._starts)[1]
        rows = np.full(len(self._starts), np.nan)
        rows[is_shown] = self.residues[column]
        index[self._starts[1:]] = 1
        return values + rows[np.cumsum(index)]

    def _facts(self) -> list[tuple[str, str]]:
        facts = [("SES area", f"{self.ses_area:.2f} Å²"), ("SES volume", f"{self.ses_volume:.2f} Å³")]
        if not self._has_ses:
            facts = []
        facts += [("SAS area", f"{self.sas_area:.2f} Å²"),
                 ("polar, apolar SAS area", f"{self.polar:.2f}, {self.apolar:.2f} Å²"),
                 ("radii", f"{self.radii.name}, {self.radii.source}"),
                 ("atoms", f"{len(self._molecule.kept)}")]
        if len(self.radii.guessed):
            facts.append(("guessed", f"{len(self.radii.guessed)} radii follow from the element"))
        if self.left_out:
            facts.append(("left out", ", ".join(f"{number} {what}" for what, number in self.left_out.items())))
        if self._reported is not None:
            facts.append(("reported", f"{int((~np.isnan(self._sas)).sum())} atoms; the volume is that of all"))
        return facts + [("note", note) for note in self.notes]

    def __repr__(self) -> str:
        ses = f"SES area {self.ses_area:.6g}, SES volume {self.ses_volume:.6g}, " if self._has_ses else ""
        notes = "".join(f"; {note}" for note in self._molecule.notes if note.startswith("model "))
        return f"<eses_blocks.Measurement: {ses}SAS area {self.sas_area:.6g}, radii {self.radii.name}{notes}>"

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><th>{name}</th><td>{html.escape(text)}</td></tr>" for name, text in self._facts())
        tables = self.chains._repr_html_() if self._molecule.are_named else ""
        return f"<table>{rows}</table>{tables}"


def _surfaces_in(surfaces: Union[str, Iterable[str]]) -> set[str]:
    """Returns the surfaces of a choice, without repetitions."""
    known = {"ses", "sas", "vdw"}
    chosen: set[Any] = {surfaces} if isinstance(surfaces, str) or not hasattr(surfaces, "__iter__") else set(surfaces)
    if not chosen or not chosen <= known | {"all"}:
        raise ValueError(f"surfaces must be ses, sas, vdw or all, or several of them, not {surfaces!r}")
    return known if "all" in chosen else chosen


@overload
def measure(molecule: Any, radii: Any = None, *, models: None = None, **options: Any) -> Measurement: ...
@overload
def measure(molecule: Any, radii: Any = None, *, models: Union[str, Iterable[int]], **options: Any) -> list[Measurement]: ...


def measure(molecule: Any, radii: Any = None, *, probe_radius: float = 1.4, report: Any = None,
            waters: bool = False, hydrogens: str = "auto", unknown_radius: Optional[float] = None,
            frame: int = 0, reference: str = "tien", surfaces: Union[str, Iterable[str]] = ("ses", "sas"),
            van_der_waals: bool = False, derivatives: bool = False, fill_cavities: Union[bool, float] = False, threads: int = 0,
            models: Optional[Union[str, Iterable[int]]] = None, **options: Any) -> Union[Measurement, list[Measurement]]:
    """Measure the surfaces of a file or of a molecule of another library.

    Parameters
    ----------
    molecule : object
        See ``read_molecule``, which also describes ``radii``, ``waters``, ``hydrogens``,
        ``unknown_radius``, ``frame`` and the further arguments of files.
    radii : str, os.PathLike or array_like, optional
        A set of radii, or a radius for each atom.
    probe_radius : float, optional
        Radius of the probe, in angstrom.
    report : str or array_like, optional
        The atoms whose areas are reported, while all others still block: a mask, indices, chains such as
        ``A`` or ``A+B``, residues by their name (``ligand:STI``), ``ligand`` for all of several atoms
        that are no amino acids, nucleotides and waters, or a selection. Its syntax is that of the library
        for MDAnalysis, MDTraj and ProDy, and that of gemmi, such as ``//A/57``, for all others.
    waters, hydrogens, unknown_radius, frame : optional
        See ``read_molecule``.
    reference : {'tien', 'miller', 'sander', 'wilke'}, optional
        Maximum areas of residues for ``relative_sas``; ``wilke`` is another name of ``tien``.
    surfaces : str or iterable of str, optional
        The surfaces that are measured: ``ses``, ``sas``, ``vdw``, or ``all``. The SAS always is, and
        alone it takes a third of the time. Values of the SES are not a number (nan) without it.
    van_der_waals : bool, optional
        Whether the van der Waals surface is measured, too, as by ``vdw`` in `surfaces`.
    derivatives : bool, optional
        Whether derivatives of areas and volumes are computed.
    fill_cavities : bool or float, optional
        See ``Surface``.
    threads : int, optional
        Number of threads; 0 for all.
    models : 'all' or iterable of int, optional
        The models of a file to measure, each by itself, such as those of an NMR structure.
    **options
        See ``read_molecule``.

    Returns
    -------
    Measurement
        Areas, volumes, and tables of atoms, residues and chains in the order of the molecule. With
        ``models``, a list of them.

    Raises
    ------
    TypeError
        If the object is not known.
    ValueError
        If it has no coordinates, if an atom has no radius, or if an argument is not valid.
    """
    _molecule.require_known(options, measure)
    _arguments.check(measure, reference=reference)
    if reference not in REFERENCES:
        raise ValueError(f"reference must be one of {', '.join(REFERENCES)}, not {reference!r}")
    if models is not None:
        return _molecule.each_model(measure, locals())
    chosen = _surfaces_in(surfaces)
    _arguments.check(measure, probe_radius=probe_radius, threads=threads, derivatives=derivatives,
                     van_der_waals=van_der_waals)
    found, select = _molecule._read(molecule, radii, waters, hydrogens, unknown_radius, frame, options)
    reported = None if report is None else select.mask(report, "report")
    if reported is not None and not reported[found.kept].any():
        raise ValueError(f"report: all {int(reported.sum())} atoms are left out; see select, waters and hydrogens")
    surface = _core.Surface(found.centers, found.radii, probe_radius, fill_cavities=fill_cavities, threads=threads)
    _core._warn_about_stray_atoms(surface, found.kept)
    remember_files(surface, *found.files)
    remember_molecule(surface, found.kept, select)
    measures = surface.measure(ses="ses" in chosen, van_der_waals=van_der_waals or "vdw" in chosen, by_atom=True,
                               derivatives=derivatives, threads=threads)
    return Measurement(found, surface, measures, reported, reference)
