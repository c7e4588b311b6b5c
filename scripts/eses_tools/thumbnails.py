"""Draws small pictures of surfaces with eses-render, for the pages of many structures."""

import base64
import contextlib
import fnmatch
import functools
import subprocess
import sys

from eses_tools import measuring
from eses_tools.common import FOLDER, Failed

WIDTH = 320  # pixels
HELP = ("draw a small picture of the structures whose {} match, such as '1a*,2b*'; needs VTK "
        "(Debian: python3-vtk9), and xvfb if there is no display")


def patterns_of(text):
    return [pattern for pattern in text.split(",") if pattern]


def is_chosen(name, patterns):
    return any(fnmatch.fnmatchcase(str(name), pattern) for pattern in patterns)


@functools.cache
def find_interpreter():
    """Returns an interpreter that has VTK: this one, or the system's with Debian's python3-vtk9."""
    for python in (sys.executable, "/usr/bin/python3"):
        with contextlib.suppress(OSError):
            if subprocess.run([python, "-c", "import vtk"], stdin=subprocess.DEVNULL,
                              capture_output=True, check=False).returncode == 0:
                return python
    return None


def require_renderer():
    """Fails now if eses-render could not draw later."""
    if find_interpreter() is None:
        raise Failed("--pictures: install VTK (Debian: python3-vtk9; pip: vtk)")


def draw(run, command, scratch, picture):
    """Draws the surface that a command of eses-blocks computes, in the colours of patches. Throws
    Failed if that is not possible.

    `run(command, **how)` returns the exit code and other values; `how` is passed to Popen.
    """
    mesh = scratch / "surface.ply"

    def call(step):
        code, text, *_ = measuring.run_quietly(list(map(str, step)), start=run)
        if code != 0:
            raise Failed(f"no picture: {text or f'exit code {code}'}")

    call([*command, "--write", "none", "--quiet", "--output-dir", scratch, "--mesh", mesh, "--color",
          "patch"])
    call([find_interpreter(), FOLDER, "render", mesh, "-o", picture, "--size", WIDTH, "--no-legend"])


def uri(picture):
    """Returns the address with which a page contains the picture."""
    return "data:image/png;base64," + base64.b64encode(picture.read_bytes()).decode("ascii")
