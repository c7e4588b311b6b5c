"""Draws small pictures of surfaces with scripts/render, for the pages of many structures."""

import base64
import fnmatch
import pathlib
import subprocess

from common import Failed

RENDER = pathlib.Path(__file__).resolve().parents[1] / "render"
WIDTH = 320  # pixels
HELP = ("draw a small picture of the structures whose {} match, such as '1a*,2b*'; needs "
        "python3-vtk9, and xvfb if there is no display")


def patterns_of(text):
    return [pattern for pattern in text.split(",") if pattern]


def is_chosen(name, patterns):
    return any(fnmatch.fnmatchcase(str(name), pattern) for pattern in patterns)


def require_renderer():
    """Fails now if scripts/render could not draw later."""
    interpreter = RENDER.read_text(encoding="utf-8").partition("\n")[0].removeprefix("#!")
    if subprocess.run([interpreter, "-c", "import vtk"], stdin=subprocess.DEVNULL,
                      capture_output=True, check=False).returncode != 0:
        raise Failed("--pictures: install python3-vtk9")


def draw(run, command, scratch, picture):
    """Draws the surface that a command of eses-blocks computes, in the colours of patches. Throws
    Failed if that is not possible.

    `run(command, **how)` returns the exit code and other values; `how` is passed to Popen.
    """
    mesh = scratch / "surface.ply"
    for step in ([*command, "--write", "none", "--quiet", "--output-dir", scratch, "--mesh", mesh,
                  "--color", "patch"],
                 [RENDER, mesh, "-o", picture, "--size", WIDTH, "--no-legend"]):
        with open(scratch / "picture.log", "w+", encoding="utf-8", errors="replace") as log:
            code = run(list(map(str, step)), stdout=subprocess.DEVNULL, stderr=log)[0]
            log.seek(0)
            if code != 0:
                raise Failed(f"no picture: {log.read().strip() or f'exit code {code}'}")


def uri(picture):
    """Returns the address with which a page contains the picture."""
    return "data:image/png;base64," + base64.b64encode(picture.read_bytes()).decode("ascii")
