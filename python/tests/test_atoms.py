"""Tests of reading files."""

import gzip
import io
import os
import pathlib
import pickle

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA


def test_xyzr_file_has_the_numbers_of_its_lines():
    rows = np.loadtxt(DATA / "1ubq.xyzr")
    atoms = eses.read_atoms(DATA / "1ubq.xyzr")
    assert len(atoms) == len(rows) == 602
    assert atoms.centers.shape == (602, 3) and atoms.centers.dtype == np.float64
    assert atoms.radii.shape == (602,) and atoms.radii.dtype == np.float64
    assert np.array_equal(atoms.centers, rows[:, :3])
    assert np.array_equal(atoms.radii, rows[:, 3])
    assert np.array_equal(atoms.lines, np.arange(1, 603))
    assert atoms.labels is None
    assert repr(atoms) == "<eses_blocks.Atoms: 602 atoms>"


def test_pqr_file_has_labels():
    lines = [line.split() for line in (DATA / "fas2.pqr").read_text().splitlines()
             if line.startswith("ATOM")]
    atoms = eses.read_atoms(DATA / "fas2.pqr")
    assert len(atoms) == len(lines)
    assert len(atoms.labels) == len(lines)
    assert list(atoms.labels.atom_name) == [fields[2] for fields in lines]
    assert list(atoms.labels.residue) == [fields[3] for fields in lines]
    assert list(atoms.labels.residue_number) == [fields[4] for fields in lines]
    assert set(atoms.labels.chain) == {""}
    assert atoms.labels.residue.dtype.kind == "U"


@pytest.mark.parametrize("as_path", [str, pathlib.Path, os.fspath])
def test_any_kind_of_path_is_accepted(as_path):
    assert len(eses.read_atoms(as_path(DATA / "c60.xyzr"))) == 60


def test_open_files_and_bytes_are_taken(tmp_path):
    path = tmp_path / "two.pqr.gz"
    path.write_bytes(gzip.compress((DATA / "fas2.pqr").read_bytes()))
    expected = eses.read_atoms(DATA / "fas2.pqr")
    area = eses.measure(DATA / "fas2.pqr").sas_area
    for found in (os.fsencode(path), os.fsencode(DATA / "fas2.pqr")):
        atoms = eses.read_atoms(found)
        assert np.array_equal(atoms.centers, expected.centers) and np.array_equal(atoms.radii, expected.radii)
        assert eses.measure(found).sas_area == area
    for mode in ("r", "rb"):
        with open(DATA / "fas2.pqr", mode) as opened:
            atoms = eses.read_atoms(opened)
            opened.seek(0)
            assert eses.measure(opened).sas_area == area
        assert np.array_equal(atoms.radii, expected.radii) and np.array_equal(atoms.charge, expected.charge)
    assert len(eses.read_atoms(io.BytesIO(b"0 0 0 1\n"))) == 1
    assert len(eses.read_atoms(io.StringIO("0 0 0 1\n"), format="xyzr")) == 1
    with pytest.raises(TypeError, match="^path must be a str, bytes, os.PathLike or an open file, not int"):
        eses.read_atoms(5)
    with pytest.raises(ValueError, match="text:1:"):
        eses.read_atoms(io.StringIO("no numbers\n"))


def test_gzipped_file_and_format_are_accepted(tmp_path):
    text = b"0 0 0 1.5\n3 0 0 1.2\n"
    (tmp_path / "two.pqr.gz").write_bytes(gzip.compress(text))
    atoms = eses.read_atoms(tmp_path / "two.pqr.gz", format="xyzr")
    assert atoms.radii.tolist() == [1.5, 1.2]


PDB = """\
ATOM      1  N   GLY A   1       1.000   2.000   3.000  1.00  0.00           N
ATOM      2  CA  GLY A   1       2.400   2.000   3.000  1.00  0.00           C
ATOM      3  H   GLY A   1       0.500   2.800   3.000  1.00  0.00           H
ATOM      4  CA  GLY B   2       9.000   2.000   3.000  1.00  0.00           C
HETATM    5 XE   XE  A   3      20.000   2.000   3.000  1.00  0.00          XE
HETATM    6  O   HOH A   4      30.000   2.000   3.000  1.00  0.00           O
END
"""


@pytest.mark.usefixtures("needs_gemmi")
def test_pdb_file_is_read_with_bondi_radii(tmp_path):
    path = tmp_path / "five.pdb"
    path.write_text(PDB)
    # Bondi (1964): N 1.55, C 1.70, O 1.52, Xe 2.16; H 1.10 of Rowland and Taylor (1996) or 1.20.
    atoms = eses.read_atoms(path, radii="bondi")
    assert atoms.radii[[0, 1, 3, 4]].tolist() == [1.55, 1.7, 1.7, 2.16]
    assert 1.0 <= atoms.radii[2] <= 1.2
    assert list(atoms.labels.atom_name) == ["N", "CA", "H", "CA", "XE"]
    assert list(atoms.labels.chain) == ["A", "A", "A", "B", "A"]
    assert atoms.centers[3].tolist() == [9, 2, 3]
    numbers = {"waters": True, "hetatm": False, "hydrogens": "drop", "chains": ["B"],
               "select": "//A"}
    counts = [len(eses.read_atoms(path, radii="bondi", **{name: value}))
              for name, value in numbers.items()]
    assert counts == [6, 4, 4, 1, 4]
    assert len(eses.read_atoms(path, radii="protor", hetatm=False)) == 3
    with pytest.raises(ValueError, match="hydrogens must be"):
        eses.read_atoms(path, hydrogens="some")
    with pytest.raises(ValueError, match="five.pdb"):
        eses.read_atoms(path, radii="bondi", model=7)


@pytest.mark.usefixtures("needs_gemmi")
def test_diagnostics_follow_from_names(tmp_path):
    path = tmp_path / "trace.pdb"
    lines = PDB.splitlines(keepends=True)
    path.write_text(lines[1] + lines[3])  # two residues with one atom each
    found, = eses.read_atoms(path).diagnostics
    assert (found.kind, found.count, found.examples) == ("one_atom_residue", 2, [(0, 0), (1, 1)])
    assert not found.is_usual
    path = tmp_path / "wet.pqr"
    path.write_text("ATOM 1 N ALA 1 0 0 0 0.1 1.5\nATOM 2 O HOH 2 9 0 0 -0.8 1.6\n")
    found, = eses.read_atoms(path).diagnostics
    assert (found.kind, found.count, found.examples) == ("water", 1, [(1, 1)])
    assert found.is_usual
    assert eses.read_atoms(DATA / "fas2.pqr").diagnostics == []
PQR = """\
ATOM 1 CA ALA A 7 0 0 0 -0.25 1.5
ATOM 2 1HB ALA A 7 1 0 0 0.5 1.0
HETATM 3 CL1 LIG B 1A 9 0 0 -1 1.75
HETATM 4 BR LIG B 1A 18 0 0 0 1.85
HETATM 5 CA CA B 2 27 0 0 2 1.2
HETATM 6 X1 LIG B 3 36 0 0 0 1.2 ZN
HETATM 7 X2 LIG B 3 40 0 0 0 1.2
"""
ELEMENTS = ["C", "H", "Cl", "Br", "Ca", "Zn", ""]


def test_pqr_file_has_elements_and_charges(tmp_path):
    path = tmp_path / "seven.pqr"
    path.write_text(PQR)
    atoms = eses.read_atoms(path)
    assert atoms.element.tolist() == ELEMENTS
    assert atoms.charge.tolist() == [-0.25, 0.5, -1, 0, 2, 0, 0]
    assert atoms.charge.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        atoms.charge[0] = 0
    # The array outlives the atoms.
    charge = atoms.charge
    del atoms
    assert charge.sum() == 1.25


@pytest.mark.usefixtures("needs_gemmi")
def test_pdb_file_has_elements(tmp_path):
    path = tmp_path / "five.pdb"
    path.write_text(PDB)
    atoms = eses.read_atoms(path, radii="bondi")
    assert atoms.element.tolist() == ["N", "C", "H", "C", "Xe"]
    assert atoms.charge is None


@pytest.mark.usefixtures("needs_gemmi")
def test_mmcif_file_has_partial_charges(tmp_path):
    names = "group_PDB id type_symbol label_atom_id label_comp_id auth_asym_id auth_seq_id Cartn_x Cartn_y Cartn_z"
    path = tmp_path / "two.cif"
    path.write_text("data_two\nloop_\n" + "".join(f"_atom_site.{name}\n" for name in [*names.split(), "partial_charge"])
                    + "ATOM 1 N N ALA A 1 0 0 0 -0.5\nATOM 2 C CA ALA A 1 1.5 0 0 ?\n")
    atoms = eses.read_atoms(path)
    assert atoms.charge[0] == -0.5 and np.isnan(atoms.charge[1])
    assert np.array_equal(pickle.loads(pickle.dumps(atoms)).charge, atoms.charge, equal_nan=True)


def test_xyzr_file_has_neither_elements_nor_charges():
    atoms = eses.read_atoms(DATA / "c60.xyzr")
    assert atoms.element.tolist() == [""] * 60
    assert atoms.charge is None


def test_atoms_become_a_data_frame(tmp_path):
    pandas = pytest.importorskip("pandas")
    path = tmp_path / "seven.pqr"
    path.write_text(PQR)
    atoms = eses.read_atoms(path)
    frame = atoms.to_dataframe()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == ["serial", "name", "residue", "residue_number", "chain", "element", "x", "y", "z",
                                   "radius", "charge"]
    assert frame.index.tolist() == list(range(7))
    assert frame.serial.tolist() == [1, 2, 3, 4, 5, 6, 7]
    assert frame.element.tolist() == ELEMENTS
    assert frame.loc[2].tolist() == [3, "CL1", "LIG", "1A", "B", "Cl", 9, 0, 0, 1.75, -1]
    frame.loc[0, "radius"] = 7  # does not change the atoms
    assert atoms.radii[0] == 1.5
    plain = eses.read_atoms(DATA / "c60.xyzr").to_dataframe()
    assert "charge" not in plain.columns and len(plain) == 60
    assert set(plain.name) == set(plain.element) == {""}


def test_missing_file_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError, match="nowhere.xyzr"):
        eses.read_atoms(tmp_path / "nowhere.xyzr")
    with pytest.raises(OSError):
        eses.read_atoms(tmp_path)


def test_wrong_text_is_a_value_error(tmp_path):
    path = tmp_path / "bad.xyzr"
    path.write_text("0 0 0 1\n0 0 x 1\n")
    with pytest.raises(ValueError, match=r"bad\.xyzr:2: field 3 .*x"):
        eses.read_atoms(path)
    path.write_text("# nothing\n")
    with pytest.raises(ValueError, match="no atoms found"):
        eses.read_atoms(path)


def test_wrong_arguments_are_refused():
    with pytest.raises(ValueError, match="format must be"):
        eses.read_atoms(DATA / "c60.xyzr", format="mol2")
    with pytest.raises(TypeError):
        eses.read_atoms(DATA / "c60.xyzr", "xyzr")
    with pytest.raises(TypeError):
        eses.read_atoms(3)
    with pytest.raises(ValueError, match="'-'"):
        eses.read_atoms("-")


def test_names_with_a_null_character_are_a_value_error():
    for name in ("a\0b.xyzr", b"a\0b.xyzr", pathlib.Path("a\0b.xyzr")):
        for read in (eses.read_atoms, eses.measure, eses.read_grid):
            with pytest.raises(ValueError, match="the path is no name of a file|null"):
                read(name)


@pytest.mark.usefixtures("needs_gemmi")
def test_names_of_files_need_not_be_utf8(tmp_path):
    path = os.fsdecode(os.fsencode(tmp_path) + b"/caf\xe9.xyzr")
    with pytest.raises(FileNotFoundError, match="caf\udce9.xyzr"):
        eses.read_atoms(path)
    with open(path, "w", encoding="ascii") as file:
        file.write("0 0 0 1\n0 0 x 1\n")
    with pytest.raises(ValueError, match=r"caf\udce9\.xyzr:2: field 3"):
        eses.read_atoms(path)
    with pytest.raises(ValueError, match="caf\udce9.xyzr"):
        eses.read_grid(path)
    radii = tmp_path / os.fsdecode(b"caf\xe9.config")
    radii.write_text("types:\nT 3.5 apolar\natoms:\nANY CA T\n")
    (tmp_path / "one.pdb").write_text(PDB.splitlines()[1])
    for name in (radii, str(radii)):
        assert eses.read_atoms(tmp_path / "one.pdb", radii=name).radii.tolist() == [3.5]


@pytest.mark.usefixtures("needs_gemmi")
def test_unknown_radii_are_refused(tmp_path):
    (tmp_path / "one.pdb").write_text(PDB.splitlines()[1])
    for name in ("bondy", "A" * 300, "no/such/file"):
        with pytest.raises(ValueError, match=r"radii: expected protor, bondi, msms, naccess, oons, one of them with \+shannon, occupancy, or a file"):
            eses.read_atoms(tmp_path / "one.pdb", radii=name)


def test_names_that_are_not_utf8_are_latin_1(tmp_path):
    path = tmp_path / "latin.pqr"
    path.write_bytes(b"ATOM 1 C\xe9 R\xe4T 1 0 0 0 0.5 1.5\n"
                     + "ATOM 2 C\u00e9 RAT 1 4 0 0 0.5 1.5\n".encode())
    labels = eses.read_atoms(path).labels
    assert labels.atom_name.tolist() == ["C\u00e9", "C\u00e9"]
    assert labels.residue.tolist() == ["R\u00e4T", "RAT"]


def test_arrays_outlive_the_atoms():
    centers, residues = (lambda atoms: (atoms.centers, atoms.labels))(
        eses.read_atoms(DATA / "fas2.pqr"))
    assert centers[0].tolist() == [-13.336, 3.045, 35.885]
    assert residues.residue[0] == "NTE"
    with pytest.raises(ValueError, match="read-only"):
        centers[0] = 0
