"""Reading of files."""

import gzip
import os
import pathlib

import numpy as np
import pytest

import eses
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
    assert repr(atoms) == "<eses.Atoms: 602 atoms>"


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
def test_any_kind_of_path(as_path):
    assert len(eses.read_atoms(as_path(DATA / "c60.xyzr"))) == 60


def test_gzipped_file_and_format(tmp_path):
    text = b"0 0 0 1.5\n3 0 0 1.2\n"
    (tmp_path / "two.pqr.gz").write_bytes(gzip.compress(text))
    atoms = eses.read_atoms(tmp_path / "two.pqr.gz", format="xyzr")
    assert atoms.radii.tolist() == [1.5, 1.2]


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


def test_wrong_arguments():
    with pytest.raises(ValueError, match="format must be"):
        eses.read_atoms(DATA / "c60.xyzr", format="xyz")
    with pytest.raises(TypeError):
        eses.read_atoms(DATA / "c60.xyzr", "xyzr")
    with pytest.raises(TypeError):
        eses.read_atoms(3)
    with pytest.raises(ValueError, match="'-'"):
        eses.read_atoms("-")


def test_arrays_outlive_the_atoms():
    centers, residues = (lambda atoms: (atoms.centers, atoms.labels))(
        eses.read_atoms(DATA / "fas2.pqr"))
    assert centers[0].tolist() == [-13.336, 3.045, 35.885]
    assert residues.residue[0] == "NTE"
    with pytest.raises(ValueError, match="read-only"):
        centers[0] = 0
