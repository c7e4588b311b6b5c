"""The type stubs of the compiled module, compared with it by stubtest of mypy. Skipped where mypy is missing."""

import importlib.util
import pathlib
import subprocess
import sys

import pytest

import eses_blocks as eses

pytestmark = pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")


def test_stubtest(tmp_path):
    # No stub can tell the metaclass of pybind11, and the __init__ that it gives to classes without one.
    allowed = tmp_path / "allowed"
    allowed.write_text(r"eses_blocks\._core\.\w+(\.__init__)?" + "\n", encoding="ascii")
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "eses_blocks._core", "--allowlist", allowed,
                           "--ignore-unused-allowlist"], capture_output=True, text=True, check=False, cwd=tmp_path,
                          env={"PYTHONPATH": str(pathlib.Path(eses.__file__).parents[1])})
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_of_a_program(tmp_path):
    """A caller gets the types of the stubs: they hold, and a wrong use is found."""
    program = tmp_path / "program.py"
    program.write_text("""\
import eses_blocks as eses
import numpy as np
import numpy.typing as npt
atoms = eses.read_atoms("1ubq.xyzr")
surface = eses.Surface(atoms.centers, atoms.radii)
result = surface.compute(surface.grid(0.5))
inside: npt.NDArray[np.bool_] = result.inside
along_x: npt.NDArray[np.float64] = result.dielectric(2, 78.54)[0]
area: float = surface.measure().ses_area
areas: npt.NDArray[np.float64] = eses.measure_frames([atoms.centers], atoms.radii).ses_area
found = eses.measure("1ubq.pdb", "bondi", report=[1, 2], reference="miller")
volume: float = found.ses_volume
names: list[str] = found.residues.keys()
set_name: str = eses.read_molecule(atoms).set.name
by_atom: npt.NDArray[np.float64] = surface.measure(by_atom=True).by_atom.ses
by_frame: npt.NDArray[np.float64] = eses.measure_frames([atoms.centers], atoms.radii, by_atom=True).by_atom.sas
grid = surface.grid(0.5, center=np.zeros(3), shape=np.array([9, 9, 9]))
result = surface.compute(grid, threads=np.int64(1), region=((0, 0, 0), (np.int64(2), 2, 2)))
atoms = eses.read_atoms(b"1ubq.xyzr", model=np.int32(0))
eses.adaptors.ADAPTORS["mine"] = lambda molecule, frame: eses.adaptors.Columns(centers=molecule, elements=["C"])
wrong: str = result.area
""", encoding="utf-8")
    folder = pathlib.Path(eses.__file__).parents[1]
    is_installed = folder.name in ("site-packages", "dist-packages")  # mypy searches these, and refuses them here
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path / "cache", program],
                          capture_output=True, text=True, check=False, cwd=tmp_path,
                          env={} if is_installed else {"MYPYPATH": str(folder)})
    errors = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert len(errors) == 1 and "program.py:21:" in errors[0], done.stdout + done.stderr
