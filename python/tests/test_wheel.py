"""Tests the package in a fresh virtual environment: a wheel that pip builds from the sources, and the
module of the build tree with the newest numpy.

The tests are skipped if neither PyPI nor a mirror of it can be reached.
"""

import os
import subprocess
import sys
import zipfile

import pytest

from conftest import DATA, PROJECT

PROGRAM = f"""
import eses_blocks as eses
atoms = eses.read_atoms({str(DATA / "c60.xyzr")!r})
surface = eses.Surface(atoms.centers, atoms.radii)
result = surface.compute(surface.grid(0.5))
print(eses.__file__, len(result.crossings) > 1000, eses._core.__file__)
"""


def run(*command, **how):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True,
                          check=False, **how)


@pytest.fixture(name="environment")
def fixture_environment(tmp_path):
    folder = tmp_path / "environment"
    if run(sys.executable, "-m", "venv", folder).returncode != 0:
        pytest.skip("no virtual environments: python3-venv is not installed")
    done = run(folder / "bin/pip", "download", "--no-cache-dir", "--no-deps", "-d", tmp_path,
               "scikit-build-core")
    if done.returncode != 0:
        pytest.skip("PyPI cannot be reached")
    return folder


def files_of_checkout():
    return [sorted(path.name for path in (PROJECT / folder).iterdir())
            for folder in (".", "python", "python/eses_blocks", "python/eses")]


def test_wheel_is_built_and_installed(environment, tmp_path):
    before = files_of_checkout()
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    clean["TMPDIR"] = str(tmp_path)
    pip = environment / "bin/pip"
    done = run(pip, "wheel", "--no-cache-dir", "--no-deps", "-w", tmp_path / "wheels", PROJECT, env=clean)
    assert done.returncode == 0, done.stdout + done.stderr
    assert files_of_checkout() == before

    [wheel] = (tmp_path / "wheels").iterdir()
    assert wheel.name.startswith("eses_blocks-")
    names = zipfile.ZipFile(wheel).namelist()
    assert all(name.startswith(("eses/", "eses_blocks/", "eses_blocks-")) for name in names), names
    assert {f"eses_blocks/{name}" for name in ("__init__.py", "_core.pyi", "_page.py", "_shown.py", "py.typed",
                                               "head.html", "viewer/viewer.js")} < set(names)
    assert "eses/__init__.py" in names

    done = run(pip, "install", "--no-cache-dir", wheel, env=clean)
    assert done.returncode == 0, done.stdout + done.stderr
    done = run(environment / "bin/python", "-c", PROGRAM, cwd=tmp_path, env=clean)
    assert done.returncode == 0, done.stderr
    package, is_right, module = done.stdout.split()
    assert is_right == "True"
    assert package.startswith(str(environment)) and module.startswith(str(environment))


def test_module_of_the_build_tree_works_with_the_newest_numpy(environment, tmp_path):
    """Old versions of pybind11 do not know the types of numpy 2."""
    done = run(environment / "bin/pip", "install", "--no-cache-dir", "numpy", "pytest")
    assert done.returncode == 0, done.stderr
    names = ("cavities", "grid", "measure", "result")
    done = run(environment / "bin/python", "-m", "pytest", "-p", "no:cacheprovider", "-q",
               *(PROJECT / f"python/tests/test_{name}.py" for name in names), cwd=tmp_path,
               env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"})
    assert done.returncode == 0, done.stdout
