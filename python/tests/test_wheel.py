"""Tests the package in a fresh virtual environment: a wheel that pip builds from the source package,
and the module of the build tree with the newest numpy.

The tests are skipped if neither PyPI nor a mirror of it can be reached.
"""

import os
import pathlib
import re
import subprocess
import sys
import zipfile

import pytest

from conftest import DATA, PROJECT

TOOLS = ("apbs", "assemble", "pdbbind", "render", "report", "traj", "view")
TESTS = PROJECT / "python/tests"
# These need no new module; interrupts and leaks measure time and memory.
NOT_AGAIN = ("test_wheel.py", "test_interrupts.py", "test_leaks.py")
SYSTEM_LIBRARIES = {"linux-vdso.so", "ld-linux-x86-64.so", "ld-linux-aarch64.so", "libc.so", "libm.so", "libdl.so",
                    "libpthread.so", "librt.so"}


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
            for folder in (".", "python", "python/eses_blocks", "python/eses", "scripts/eses_tools")]


@pytest.fixture(name="installed")
def fixture_installed(environment, tmp_path):
    """Returns an environment with the wheel, and the names of the wheel's files."""
    before = files_of_checkout()
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    clean["TMPDIR"] = str(tmp_path)
    python = environment / "bin/python"
    done = run(python, "-m", "pip", "install", "--no-cache-dir", "scikit-build-core", "pybind11")
    assert done.returncode == 0, done.stderr
    done = run(python, "-c", f"from scikit_build_core.build import build_sdist; build_sdist({str(tmp_path)!r})",
               cwd=PROJECT, env=clean)
    assert done.returncode == 0, done.stderr
    [source] = tmp_path.glob("eses_blocks-*.tar.gz")
    done = run(python, "-m", "pip", "wheel", "--no-cache-dir", "--no-deps", "-w", tmp_path / "wheels", source,
               env=clean)
    assert done.returncode == 0, done.stdout + done.stderr
    assert files_of_checkout() == before
    [wheel] = (tmp_path / "wheels").iterdir()
    assert wheel.name.startswith("eses_blocks-")
    done = run(python, "-m", "pip", "install", "--no-cache-dir", wheel, "pytest", env=clean)
    assert done.returncode == 0, done.stderr
    return environment, zipfile.ZipFile(wheel).namelist()


def check_names(names):
    assert all(name.startswith(("eses/", "eses_blocks/", "eses_tools/", "eses_blocks-")) for name in names), names
    assert {f"eses_blocks/{name}" for name in ("__init__.py", "__main__.py", "_core.pyi", "_shown.py", "py.typed")
            } < set(names)
    assert {"eses/__init__.py", "eses_tools/pages/head.html", "eses_tools/pages/viewer/viewer.js"} < set(names)
    assert not [name for name in names if name.endswith((".pyc", ".md"))]


def check_program(folder, tmp_path):
    """The program and the tools are in PATH, and find each other."""
    program = folder / "eses-blocks"
    clean = {"PATH": f"{folder}:{os.defpath}", "HOME": str(tmp_path)}
    for command in ([program], [folder / "python", "-m", "eses_blocks"]):
        done = run(*command, DATA / "c60.xyzr", "--write", "none", "-q", cwd=tmp_path, env=clean)
        assert done.returncode == 0 and "surface area: " in done.stdout, done.stderr
    libraries = set(re.findall(r"^\s*(?:\S*/)?([\w-]+\.so)", run("ldd", program).stdout, re.M))
    assert libraries <= SYSTEM_LIBRARIES, libraries
    for tool in TOOLS:
        done = run(folder / f"eses-{tool}", "--help", cwd=tmp_path, env=clean)
        assert done.returncode == 0 and f"usage: eses-{tool}" in done.stdout, done.stderr
    done = run("eses-view", DATA / "c60.xyzr", "-o", tmp_path / "page.html", cwd=tmp_path, env=clean)
    assert done.returncode == 0, done.stderr
    done = run("eses-assemble", DATA / "c60.xyzr", "--copies", "2", "--rings", "1", "-o", tmp_path / "two.xyzr",
               cwd=tmp_path, env=clean)
    assert done.returncode == 0, done.stderr
    done = run("eses-msms", "-if", DATA / "c60.xyzr", "-of", tmp_path / "c60", cwd=tmp_path, env=clean)
    assert done.returncode == 0 and (tmp_path / "c60.vert").is_file(), done.stderr
    for name in ("pdb_to_xyzr", "pdb_to_xyzrn"):
        done = run(f"eses-{name}", "--help", cwd=tmp_path, env=clean)
        assert done.returncode == 0 and name in done.stdout, done.stderr


def test_wheel_has_module_program_and_tools(installed, tmp_path):
    environment, names = installed
    check_names(names)
    check_program(environment / "bin", tmp_path)
    # All tests, with the installed module and program.
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    clean |= {"ESES_BINARY": str(environment / "bin/eses-blocks"), "PYTHONDONTWRITEBYTECODE": "1"}
    done = run(environment / "bin/python", "-m", "pytest", "-p", "no:cacheprovider", "-q",
               *sorted(path for path in TESTS.glob("test_*.py") if path.name not in NOT_AGAIN),
               cwd=tmp_path, env=clean)
    assert done.returncode == 0, done.stdout
    where = run(environment / "bin/python", "-c", "import eses_blocks; print(eses_blocks._core.__file__)",
                cwd=tmp_path, env=clean).stdout
    assert pathlib.Path(where).is_relative_to(environment)


def test_module_of_the_build_tree_works_with_the_newest_numpy(environment, tmp_path):
    """Old versions of pybind11 do not know the types of numpy 2."""
    done = run(environment / "bin/pip", "install", "--no-cache-dir", "numpy", "pytest")
    assert done.returncode == 0, done.stderr
    names = ("cavities", "grid", "measure", "result")
    done = run(environment / "bin/python", "-m", "pytest", "-p", "no:cacheprovider", "-q",
               *(PROJECT / f"python/tests/test_{name}.py" for name in names), cwd=tmp_path,
               env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"})
    assert done.returncode == 0, done.stdout
