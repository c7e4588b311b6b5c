"""Loads meshes of eses-blocks into PyMOL, with their colours and normals.

    run /usr/share/eses-blocks/eses_pymol.py
    eses_load surface.ply

PyMOL itself does not read binary PLY files. `eses-blocks FILE --mesh surface.ply --color patch`
writes such a file; without --color the surface is grey.
"""

import os

import numpy as np
from pymol import CmdException, cgo, cmd

TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
         "float": "f4", "double": "f8"}
BYTE_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": "="}


def read_header(file):
    """Returns the byte order, or "=" for text, and for each element its count and numpy type."""
    order, elements, fields = None, {}, []
    while (line := file.readline()).strip() != b"end_header":
        words = line.decode("ascii", "replace").split()
        if not line:
            raise ValueError("the header of the PLY file has no end")
        if words[:1] == ["format"]:
            order = BYTE_ORDERS[words[1]]
        elif words[:1] == ["element"]:
            fields = []
            elements[words[1]] = int(words[2]), fields
        elif words[:2] == ["property", "list"]:
            # The mesh has only triangles.
            fields += [("corner_count", order + TYPES[words[2]]),
                       (words[4], order + TYPES[words[3]], (3,))]
        elif words[:1] == ["property"]:
            fields.append((words[2], order + TYPES[words[1]]))
    return order, elements


def read_ply(path):
    """Returns the vertices and the triangles as structured arrays."""
    with open(path, "rb") as file:
        if file.readline().strip() != b"ply":
            raise ValueError("not a PLY file")
        order, elements = read_header(file)
        arrays = []
        for name in ("vertex", "face"):
            count, fields = elements[name]
            if order == "=":
                array = np.loadtxt(file, dtype=fields, max_rows=count, ndmin=1) if count else \
                    np.empty(0, fields)
            else:
                array = np.fromfile(file, fields, count)
            if len(array) != count:
                raise ValueError("the file is truncated")
            arrays.append(array)
    return arrays


def columns(vertices, *names):
    return np.stack([vertices[name] for name in names], axis=-1).astype(float)


def triangle_list(vertices, faces):
    """Returns the triangles as a compiled graphics object: numbers in one list."""
    count = len(vertices)
    is_colored = "red" in vertices.dtype.names
    color = columns(vertices, "red", "green", "blue") / 255 if is_colored else np.full((count, 3), 0.7)
    rows = np.concatenate([
        np.full((count, 1), cgo.COLOR), color,
        np.full((count, 1), cgo.NORMAL), columns(vertices, "nx", "ny", "nz"),
        np.full((count, 1), cgo.VERTEX), columns(vertices, "x", "y", "z")], axis=1)
    corners = rows[faces["vertex_indices"].ravel()]
    return [cgo.BEGIN, cgo.TRIANGLES, *corners.ravel().tolist(), cgo.END]


def eses_load(filename, name=""):
    """
DESCRIPTION

    "eses_load" loads a surface that eses-blocks wrote as a PLY file.

USAGE

    eses_load filename [, name ]
    """
    path = cmd.exp_path(filename)
    try:
        graphics = triangle_list(*read_ply(path))
    except OSError as error:
        raise CmdException(f"{filename}: {error.strerror}") from None
    except (IndexError, KeyError, TypeError, ValueError) as error:
        raise CmdException(f"{filename}: not a mesh of eses-blocks ({error})") from None
    cmd.load_cgo(graphics, name or os.path.splitext(os.path.basename(path))[0])


cmd.extend("eses_load", eses_load)
