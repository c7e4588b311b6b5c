"""Reads meshes that eses-blocks --mesh has written, in all of its formats."""

import collections
import json
import re
import struct
import xml.etree.ElementTree

try:
    import numpy
except ImportError:
    numpy = None  # the names of the formats need none

from eses_tools.common import Failed, require_file

PLY_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
             "float": "f4", "double": "f8"}
VTK_TYPES = {"Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2", "Int32": "i4",
             "UInt32": "u4", "Int64": "i8", "UInt64": "u8", "Float32": "f4", "Float64": "f8"}

# values: a dictionary from names to arrays with a row for each vertex: patch, atom, chain, residue,
# component, color and potential (kT/e), if the file has them. chains, residues: names by number.
Mesh = collections.namedtuple("Mesh", "points normals triangles values chains residues")


def stack(columns, *names):
    return numpy.stack([columns[name] for name in names], axis=1)


# ------------------------------------------------------------------------------------------- PLY


def ply_header(source):
    header = []
    while not header or header[-1] != "end_header":
        line = source.readline()
        if not line or (not header and line.strip() != b"ply"):
            raise ValueError
        header.append(line.decode("utf-8", "replace").strip())
    return header


def numbered_names(header, kind):
    """Returns the names in the comments `comment KIND NUMBER NAME`."""
    start = f"comment {kind} "
    return [line[len(start):].partition(" ")[2] for line in header
            if re.match(rf"{start}\d+( |$)", line)]


def read_ply(path):
    with open(path, "rb") as source:
        header = ply_header(source)
        data = source.read()
    words = [line.split() for line in header]
    counts = {line[1]: int(line[2]) for line in words if line[0] == "element"}
    fields = [(line[2], PLY_TYPES[line[1]]) for line in words
              if line[0] == "property" and line[1] != "list"]
    order = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}[words[1][1]]
    if order:
        columns = numpy.frombuffer(data, [(name, order + kind) for name, kind in fields],
                                   counts["vertex"])
        faces = numpy.frombuffer(data, [("count", "u1"), ("corners", order + "i4", 3)],
                                 counts["face"], columns.nbytes)["corners"]
    else:
        lines = data.decode("ascii").splitlines()
        columns = numpy.array([tuple(line.split()) for line in lines[:counts["vertex"]]], fields)
        faces = numpy.array([line.split()[1:] for line in
                             lines[counts["vertex"]:counts["vertex"] + counts["face"]]], "i4")
    names = [name for name, _ in fields]
    values = {name: columns[name] for name in ("patch", "atom", "chain", "residue", "component",
                                               "potential") if name in names}
    if "red" in names:
        values["color"] = stack(columns, "red", "green", "blue")
    return Mesh(stack(columns, "x", "y", "z"), stack(columns, "nx", "ny", "nz"), faces, values,
                numbered_names(header, "chain"), numbered_names(header, "residue"))


# ------------------------------------------------------------------------------------------- VTP


def read_vtp(path):
    data = path.read_bytes()
    head, mark, rest = data.partition(b'<AppendedData encoding="raw">')
    if not mark:
        raise ValueError
    start = len(head) + len(mark) + rest.index(b"_") + 1
    tree = xml.etree.ElementTree.fromstring(head + b"</VTKFile>")
    order = "<" if tree.get("byte_order") == "LittleEndian" else ">"

    def array(item):
        place = start + int(item.get("offset"))
        size = int(numpy.frombuffer(data, order + "u8", 1, place)[0])
        kind = numpy.dtype(order + VTK_TYPES[item.get("type")])
        values = numpy.frombuffer(data, kind, size // kind.itemsize, place + 8)
        columns = int(item.get("NumberOfComponents", 1))
        return values.reshape(-1, columns) if columns > 1 else values

    def names(name):
        for item in tree.iter("DataArray"):
            if item.get("Name") == name and item.get("type") == "String":
                codes = bytes(map(int, (item.text or "").split()))
                return [text.decode("utf-8", "replace") for text in codes.split(b"\0")[:-1]]
        return []

    values = {item.get("Name").lower(): array(item) for item in tree.iter("DataArray")
              if item.get("type") != "String"}
    return Mesh(values.pop("points"), values.pop("normals"),
                values.pop("connectivity").reshape(-1, 3), values, names("chain_name"),
                names("residue_name"))


# -------------------------------------------------------------------- OBJ, OFF, STL, GLB and MSMS


def read_obj(path):
    rows = collections.defaultdict(list)
    with open(path, encoding="utf-8", errors="replace") as source:
        for line in source:
            kind, _, rest = line.partition(" ")
            rows[kind].append(rest)

    def numbers(kind):
        return numpy.array([row.split() for row in rows[kind]], float)

    faces = numpy.array([[corner.partition("/")[0] for corner in row.split()] for row in rows["f"]],
                        int) - 1
    vertices = numbers("v")  # x y z, or x y z r g b
    points = vertices[:, :3]
    normals = numbers("vn") if rows["vn"] else vertex_normals(points, faces)
    values = {"color": color_bytes(vertices[:, 3:])} if vertices.shape[1] == 6 else {}
    return Mesh(points, normals, faces, values, [], [])


def read_off(path):
    with open(path, encoding="ascii") as source:
        words = [word for line in source for word in line.partition("#")[0].split()]
    if not words or words[0] != "OFF":
        raise ValueError
    vertices, faces = int(words[1]), int(words[2])
    points = numpy.array(words[4:4 + 3 * vertices], float).reshape(-1, 3)
    corners = numpy.array(words[4 + 3 * vertices:4 + 3 * vertices + 4 * faces], int)
    triangles = corners.reshape(-1, 4)[:, 1:]
    return Mesh(points, vertex_normals(points, triangles), triangles, {}, [], [])


def read_stl(path):
    data = path.read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    rows = numpy.frombuffer(data, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)),
                                   ("rest", "<u2")], count, 84)
    points, index = numpy.unique(rows["corners"].reshape(-1, 3), axis=0, return_inverse=True)
    triangles = index.reshape(-1, 3)
    return Mesh(points, vertex_normals(points, triangles), triangles, {}, [], [])


def read_glb(path):
    data = path.read_bytes()
    if data[:4] != b"glTF":
        raise ValueError
    (length,) = struct.unpack_from("<I", data, 12)  # of the description, which is the first chunk
    scene, start = json.loads(data[20:20 + length]), 28 + length

    def array(number, columns):
        accessor = scene["accessors"][number]
        view = scene["bufferViews"][accessor["bufferView"]]
        kind = numpy.dtype({5121: "u1", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]])
        place = start + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        stride = view.get("byteStride", columns * kind.itemsize)
        return numpy.ndarray((accessor["count"], columns), kind, data, place,
                             (stride, kind.itemsize))

    shape = scene["meshes"][0]["primitives"][0]
    columns = shape["attributes"]
    points = array(columns["POSITION"], 3) + numpy.array(scene["nodes"][0]["translation"], float)
    values = {}
    if "COLOR_0" in columns:  # linear intensities, converted to sRGB (IEC 61966-2-1)
        linear = array(columns["COLOR_0"], 4)[:, :3] / 255
        values["color"] = color_bytes(numpy.where(linear <= 0.0031308, 12.92 * linear,
                                                  1.055 * linear ** (1 / 2.4) - 0.055))
    return Mesh(points, array(columns["NORMAL"], 3), array(shape["indices"], 1).reshape(-1, 3),
                values, [], [])


def color_bytes(shares):
    return numpy.rint(255 * shares).astype("u1")


def read_msms(path):
    """Reads a pair of files, of which one is named."""
    def table(suffix, columns):
        name = path if path.suffix.lower() == suffix else path.with_suffix(suffix)
        with open(name, encoding="utf-8", errors="replace") as source:
            return numpy.array([line.split()[:columns] for line in list(source)[3:]], float)

    vertices, faces = table(".vert", 9), table(".face", 3)
    kinds = numpy.array([0, 2, 3, 1])[vertices[:, 8].astype(int)]  # toric, spheric, contact
    return Mesh(vertices[:, :3], vertices[:, 3:6], faces.astype(int) - 1,
                {"patch": kinds, "atom": vertices[:, 7].astype(int) - 1}, [], [])


def vertex_normals(points, triangles):
    """Returns normals for files without them: means of the triangles, weighted by area."""
    points = numpy.asarray(points, float)
    a, b, c = (points[corner] for corner in triangles.T)
    normals = numpy.zeros_like(points)
    for corner in triangles.T:
        numpy.add.at(normals, corner, numpy.cross(b - a, c - a))
    return normals / numpy.maximum(numpy.linalg.norm(normals, axis=1, keepdims=True), 1e-30)


READERS = {".ply": read_ply, ".vtp": read_vtp, ".obj": read_obj, ".off": read_off,
           ".stl": read_stl, ".glb": read_glb, ".vert": read_msms, ".face": read_msms}
SUFFIXES = tuple(READERS)


def is_mesh(path):
    return path.suffix.lower() in SUFFIXES


def read_mesh(path):
    """Returns the mesh of a file. Throws Failed if it is none of eses-blocks, or empty."""
    require_file(path)
    try:
        mesh = READERS[path.suffix.lower()](path)
        if len(mesh.triangles) and not 0 <= mesh.triangles.min() <= mesh.triangles.max() < len(
                mesh.points):
            raise ValueError
    except (IndexError, KeyError, TypeError, ValueError, struct.error, xml.etree.ElementTree.ParseError):
        raise Failed(f"{path}: not a mesh of eses-blocks") from None
    if len(mesh.triangles) == 0:
        raise Failed(f"{path}: no triangles")
    if not (numpy.isfinite(mesh.points).all() and numpy.isfinite(mesh.normals).all()):
        raise Failed(f"{path}: a coordinate or normal is no finite number")
    return mesh
