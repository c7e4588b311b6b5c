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
