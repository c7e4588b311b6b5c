"""Loads meshes of eses-blocks into PyMOL, with their colours and normals.

    run /usr/share/eses-blocks/eses_pymol.py
    eses_load surface.ply

PyMOL itself does not read binary PLY files. `eses-blocks FILE --mesh surface.ply --color patch`
writes such a file; without --color the surface is grey. The folder eses_tools must be beside this script.
"""

import os
import pathlib
import sys

import numpy as np
from pymol import CmdException, cgo, cmd

# PyMOL names a script that it runs in __script__, and a plugin in __file__.
sys.path.insert(0, os.path.dirname(os.path.realpath(globals().get("__script__") or __file__)))
from eses_tools import common, meshes


def triangle_list(mesh):
    """Returns the triangles as a compiled graphics object: numbers in one list."""
    count = len(mesh.points)
    color = mesh.values["color"] / 255 if "color" in mesh.values else np.full((count, 3), 0.7)
    rows = np.concatenate([np.full((count, 1), cgo.COLOR), color, np.full((count, 1), cgo.NORMAL), mesh.normals,
                           np.full((count, 1), cgo.VERTEX), mesh.points], axis=1)
    return [cgo.BEGIN, cgo.TRIANGLES, *rows[mesh.triangles.ravel()].ravel().tolist(), cgo.END]


def eses_load(filename, name=""):
    """
DESCRIPTION

    "eses_load" loads a surface that eses-blocks wrote with --mesh.

USAGE

    eses_load filename [, name ]
    """
    path = pathlib.Path(cmd.exp_path(filename))
    try:
        graphics = triangle_list(meshes.read_mesh(path))
    except OSError as error:
        raise CmdException(f"{filename}: {error.strerror}") from None
    except common.Failed as error:
        raise CmdException(str(error)) from None
    cmd.load_cgo(graphics, name or path.stem)


cmd.extend("eses_load", eses_load)
