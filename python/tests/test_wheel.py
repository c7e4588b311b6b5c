"""Tests `pip install .` in a fresh virtual environment. Skipped if PyPI cannot be reached."""

import os
import socket
import subprocess
import sys

import pytest

from conftest import DATA, PROJECT

PROGRAM = f"""
import eses
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
    try:
        socket.create_connection(("pypi.org", 443), timeout=5).close()
    except OSError:
        # A mirror may replace PyPI.
        if run(sys.executable, "-m", "pip", "download", "--no-deps", "-q", "-d", tmp_path,
               "scikit-build-core").returncode != 0:
            pytest.skip("PyPI cannot be reached")
    folder = tmp_path / "environment"
    done = run(sys.executable, "-m", "venv", folder)
    if done.returncode != 0:
        pytest.skip("no virtual environments: python3-venv is not installed")
    return folder


def test_wheel_is_built_and_installed(environment, tmp_path):
    done = run(environment / "bin/pip", "install", "--no-cache-dir", PROJECT,
               env={**os.environ, "TMPDIR": str(tmp_path)})
    assert done.returncode == 0, done.stdout + done.stderr
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = run(environment / "bin/python", "-c", PROGRAM, cwd=tmp_path, env=clean)
    assert done.returncode == 0, done.stderr
    package, is_right, module = done.stdout.split()
    assert is_right == "True"
    assert package.startswith(str(environment)) and module.startswith(str(environment))
    files = run(environment / "bin/pip", "show", "--files", "eses-blocks").stdout
    for name in ("eses/__init__.py", "eses/_core.pyi", "eses/py.typed"):
        assert name in files
    for name in ("bin/eses-blocks", "libeses", "include/"):
        assert name not in files
