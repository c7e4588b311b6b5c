"""Fixtures of the tests."""

import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import eses_blocks as eses

PROJECT = pathlib.Path(__file__).resolve().parents[2]
DATA = PROJECT / "data"

# A dipeptide with an ion, a water, an insertion code, and a side chain in two locations.
PDB = """\
ATOM      1  N   ALA A  10      11.104   6.134  -6.504  1.00  0.00           N
ATOM      2  CA  ALA A  10      11.639   6.071  -5.147  1.00  0.00           C
ATOM      3  C   ALA A  10      10.594   5.544  -4.167  1.00  0.00           C
ATOM      4  O   ALA A  10       9.393   5.761  -4.333  1.00  0.00           O
ATOM      5  CB  ALA A  10      12.123   7.449  -4.716  1.00  0.00           C
ATOM      6  N   SER A  10A     11.068   4.851  -3.135  1.00  0.00           N
ATOM      7  CA  SER A  10A     10.189   4.299  -2.111  1.00  0.00           C
ATOM      8  C   SER A  10A     10.984   3.907  -0.868  1.00  0.00           C
ATOM      9  O   SER A  10A     12.210   3.805  -0.909  1.00  0.00           O
ATOM     10  CB ASER A  10A      9.440   3.081  -2.642  0.40  0.00           C
ATOM     11  CB BSER A  10A      9.240   3.281  -2.742  0.60  0.00           C
ATOM     12  OG ASER A  10A     10.317   2.170  -3.270  0.40  0.00           O
ATOM     13  OG BSER A  10A      9.917   2.470  -3.670  0.60  0.00           O
TER      14      SER A  10A
HETATM   15 ZN    ZN B   1       5.104   2.134  -3.504  1.00  0.00          ZN
HETATM   16  O   HOH B   2       2.104   1.134  -1.504  1.00  0.00           O
END
"""

KEPT = [0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 13]  # of the 15 atoms of PDB: location B, no water

sys.path.append(str(PROJECT / "scripts/lib"))  # for notebook_page


@pytest.fixture
def needs_gemmi(tmp_path):
    """Skips a test in a build without gemmi, which does not read PDB and mmCIF files."""
    path = tmp_path / "empty.pdb"
    path.write_text("")
    with pytest.raises(ValueError) as error:
        eses.read_atoms(path)
    if "this build reads" in str(error.value):
        pytest.skip("this build has no gemmi")


@pytest.fixture(name="pdb")
def fixture_pdb(tmp_path):
    path = tmp_path / "two.pdb"
    path.write_text(PDB)
    return path


@pytest.fixture(name="expected")
def fixture_expected(pdb):
    """Returns the areas by the program's own reader."""
    atoms = eses.read_atoms(pdb)
    assert len(atoms) == len(KEPT)
    return eses.Surface(atoms.centers, atoms.radii).measure(by_atom=True)


@pytest.fixture(scope="session")
def program():
    """Returns the path of the command-line program."""
    path = os.environ.get("ESES_BINARY")
    if not path:
        pytest.skip("ESES_BINARY does not name the program")
    return path


@pytest.fixture(scope="session")
def run_program(program):
    """Returns a function that runs the program with arguments."""

    def run(*arguments):
        subprocess.run([program, *map(str, arguments)], check=True, capture_output=True)

    return run


@pytest.fixture(scope="session")
def ubiquitin():
    return eses.read_atoms(DATA / "1ubq.xyzr")


@pytest.fixture(scope="session")
def ubiquitin_surface(ubiquitin):
    return eses.Surface(ubiquitin.centers, ubiquitin.radii)


@pytest.fixture(scope="session")
def fasciculin():
    """Returns atoms with names."""
    return eses.read_atoms(DATA / "fas2.pqr")


@pytest.fixture(scope="session")
def fasciculin_surface(fasciculin):
    return eses.Surface(fasciculin.centers, fasciculin.radii)


@pytest.fixture(scope="session")
def chain():
    """Returns the centres and radii of twelve atoms along a helix."""
    step = np.arange(12)
    centers = np.stack([2.3 * np.cos(1.7 * step), 2.3 * np.sin(1.7 * step), 1.1 * step], axis=1)
    return centers, 1.4 + 0.05 * (step % 5)


@pytest.fixture(scope="session")
def lattice():
    """Returns the centres and radii of n^3 atoms whose surface fills space."""

    def make(n):
        centers = np.stack(np.meshgrid(*[3.9 * np.arange(n)] * 3, indexing="ij"), axis=-1)
        return centers.reshape(-1, 3), np.full(n**3, 1.7)

    return make
