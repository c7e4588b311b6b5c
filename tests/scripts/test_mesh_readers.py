"""Tests that other libraries read meshes: VTK, trimesh, Biopython, Open3D and PyMOL, from
Debian's packages or from PyPI. Missing libraries are skipped."""

import json
import subprocess
import unittest

from support import DATA, PROGRAM, SCRIPTS, TestCase, python_with

VTK = """
import json, sys, vtk
from vtk.util.numpy_support import vtk_to_numpy
path = sys.argv[1]
reader = vtk.vtkPLYReader() if path.endswith(".ply") else vtk.vtkXMLPolyDataReader()
reader.SetFileName(path)
reader.Update()
mesh = reader.GetOutput()
edges = vtk.vtkFeatureEdges()
edges.SetInputData(mesh)
edges.FeatureEdgesOff()
edges.ManifoldEdgesOff()
edges.BoundaryEdgesOn()
edges.NonManifoldEdgesOn()
edges.Update()
mass = vtk.vtkMassProperties()
mass.SetInputData(mesh)
data = mesh.GetPointData()
arrays = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).tolist()
          for i in range(data.GetNumberOfArrays())}
field = mesh.GetFieldData()
names = {field.GetArrayName(i): [field.GetAbstractArray(i).GetValue(k) for k in
                                 range(field.GetAbstractArray(i).GetNumberOfValues())]
         for i in range(field.GetNumberOfArrays())}
cells = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
json.dump({"points": vtk_to_numpy(mesh.GetPoints().GetData()).tolist(),
           "triangles": cells.tolist(), "arrays": arrays, "names": names,
           "scalars": data.GetScalars().GetName() if data.GetScalars() else None,
           "has_normals": data.GetNormals() is not None,
           "open": edges.GetOutput().GetNumberOfCells(),
           "area": mass.GetSurfaceArea(), "volume": mass.GetVolume(),
           "version": vtk.VTK_VERSION}, sys.stdout)
"""
TRIMESH = """
import json, sys, trimesh
mesh = trimesh.load(sys.argv[1], process=False)
json.dump({"points": mesh.vertices.tolist(), "triangles": mesh.faces.tolist(),
           "open": 0 if mesh.is_watertight and mesh.is_winding_consistent else 1,
           "area": mesh.area, "volume": mesh.volume, "version": trimesh.__version__}, sys.stdout)
"""
# Also with normals and colours, and with the translation of the mesh.
GLTF = """
import json, sys, trimesh
loaded = trimesh.load(sys.argv[1], process=False, maintain_order=True, skip_materials=True)
mesh = loaded.to_mesh() if hasattr(loaded, "to_mesh") else loaded
# The translated mesh has other normals than those of the file.
original = next(iter(loaded.geometry.values())) if hasattr(loaded, "geometry") else loaded
json.dump({"points": mesh.vertices.tolist(), "triangles": mesh.faces.tolist(),
           "normals": original.vertex_normals.tolist(), "colors": mesh.visual.vertex_colors.tolist(),
           "open": 0 if mesh.is_watertight and mesh.is_winding_consistent else 1,
           "area": mesh.area, "volume": mesh.volume, "version": trimesh.__version__}, sys.stdout)
"""
OPEN3D = """
import json, sys, numpy, open3d
mesh = open3d.io.read_triangle_mesh(sys.argv[1])
json.dump({"points": numpy.asarray(mesh.vertices).tolist(),
           "triangles": numpy.asarray(mesh.triangles).tolist(),
           "open": 0 if mesh.is_watertight() and mesh.is_edge_manifold(False) else 1,
           "area": mesh.get_surface_area(), "volume": mesh.get_volume(),
           "version": open3d.__version__}, sys.stdout)
"""
# Bio.PDB.ResidueDepth reads the output of MSMS with this function.
BIOPYTHON = """
import json, sys, Bio, numpy
from Bio.PDB.ResidueDepth import _read_vertex_array, min_dist
surface = _read_vertex_array(sys.argv[1])
json.dump({"points": surface.tolist(), "version": Bio.__version__,
           "depth": float(min_dist(numpy.array([0.0, 0.0, 0.0]), surface))}, sys.stdout)
"""
PYMOL = """
import json, sys
from pymol import cmd
cmd.load(sys.argv[1], "mesh")
json.dump({"type": cmd.get_type("mesh"), "extent": cmd.get_extent("mesh"),
           "version": cmd.get_version()[0]}, sys.stdout)
"""
# Runs the commands of doc/meshes.md and finds the numbers of the graphics object in the session.
PYMOL_SCRIPT = f"""
import json, sys
from pymol import cmd
cmd.do("run {SCRIPTS}/eses_pymol.py; eses_load " + sys.argv[1], echo=0)
cmd.sync()
objects = {{entry[0]: entry[5] for entry in cmd.get_session()["names"] if entry}}
json.dump({{name: entry[2][0][0][1] for name, entry in objects.items()}}, sys.stdout)
"""


def linear(byte):
    """Converts sRGB to a linear intensity, both as 0 to 255."""
    value = byte / 255
    return round(255 * (value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4))


class MeshReaders(TestCase):
    def make(self, name, atoms, *options):
        """Writes a mesh and the text files with the same surface. Returns area and volume."""
        done = subprocess.run([PROGRAM, atoms, "--spacing", "0.4", "-o", self.folder, "--mesh",
                               self.folder / name, "-q", *options], capture_output=True, text=True,
                              check=False)
        self.assertDone(done)
        return {key: float(value) for key, value in
                (line.removeprefix("surface ").split(": ") for line in done.stdout.splitlines())}

    def read_back(self, module, program, name):
        python = python_with(module)
        if python is None:
            raise unittest.SkipTest(f"{module} is not installed")
        done = subprocess.run([python, "-c", program, self.folder / name], capture_output=True,
                              text=True, check=False)
        self.assertDone(done)
        # Open3D prints its progress before the output of the script.
        return json.loads(done.stdout[done.stdout.index("{"):])

    def crossings(self):
        """Returns position, normal and adjacent atoms of each line of intersection_info.txt."""
        lines = (self.folder / "intersection_info.txt").read_text(encoding="ascii").splitlines()
        rows = [line.split() for line in lines]
        return [([float(x) for x in row[6:9]], [float(x) for x in row[9:12]],
                 [int(x) for x in row[12:]]) for row in rows]

    def first_uses(self, name):
        """Numbers of the vertices of an OBJ file, from 0, in the order in which triangles use them."""
        lines = (self.folder / name).read_text(encoding="ascii").splitlines()
        return list(dict.fromkeys(int(corner.split("/")[0]) - 1 for line in lines
                                  if line.startswith("f ") for corner in line.split()[1:]))

    def check_points(self, found, places, order=None):
        crossings = self.crossings()
        if order is not None:
            self.assertEqual(sorted(order), list(range(len(crossings))))
            crossings = [crossings[i] for i in order]
        self.assertEqual(len(found["points"]), len(crossings))
        for point, (position, _, _) in zip(found["points"], crossings):
            for mine, theirs in zip(position, point):
                self.assertAlmostEqual(theirs, mine, places)

    def check_shape(self, found, measures):
        self.assertEqual(found["open"], 0)
        self.assertAlmostEqual(found["area"] / measures["area"], 1, delta=0.02)
        self.assertAlmostEqual(found["volume"] / measures["volume"], 1, delta=0.02)

    def check_whole_mesh(self, module, program, places):
        if python_with(module) is None:
            raise unittest.SkipTest(f"{module} is not installed")
        for name, *options in (("a.ply",), ("b.ply", "--ply-ascii"), ("a.off",), ("a.obj",)):
            with self.subTest(name=name):
                measures = self.make(name, DATA / "c60.xyzr", *options)
                found = self.read_back(module, program, name)
                # Some versions of Open3D number the vertices of OBJ files by their first use. The
                # first triangle of this file has other corners.
                is_renumbered = module == "open3d" and name == "a.obj" and \
                    found["triangles"][0] == [0, 1, 2]
                self.check_points(found, places, self.first_uses(name) if is_renumbered else None)
                self.check_shape(found, measures)

    def test_trimesh_reads_stl_and_gltf(self):
        measures = self.make("a.stl", DATA / "c60.xyzr")
        found = self.read_back("trimesh", TRIMESH.replace("process=False", "process=True"), "a.stl")
        self.check_shape(found, measures)
        # Corners of triangles at the same place are one vertex.
        self.assertEqual(len(found["points"]), len(self.crossings()))
        measures = self.make("a.glb", DATA / "c60.xyzr", "--color", "patch")
        found = self.read_back("trimesh", GLTF, "a.glb")
        self.check_shape(found, measures)
        self.check_points(found, 5)
        patches = {1: [86, 180, 233], 2: [240, 228, 66], 3: [213, 94, 0]}
        for (_, normal, atoms), mine, color in zip(self.crossings(), found["normals"],
                                                   found["colors"]):
            self.assertEqual(color[:3], [linear(part) for part in patches[len(atoms)]])
            for a, b in zip(normal, mine):
                self.assertAlmostEqual(a, b, 5)

    def test_trimesh_reads_colours_of_obj(self):
        self.make("a.obj", DATA / "c60.xyzr", "--color", "patch")
        found = self.read_back("trimesh", GLTF, "a.obj")
        patches = {1: [86, 180, 233], 2: [240, 228, 66], 3: [213, 94, 0]}
        self.check_points(found, 9)
        self.assertEqual([color[:3] for color in found["colors"]],
                         [patches[len(atoms)] for _, _, atoms in self.crossings()])

    def test_trimesh_reads_all_values(self):
        self.check_whole_mesh("trimesh", TRIMESH, 9)

    def test_open3d_reads_the_mesh(self):
        self.check_whole_mesh("open3d", OPEN3D, 6)  # it stores OFF and OBJ in single precision

    def test_vtk_reads_vtp_files(self):
        measures = self.make("a.vtp", DATA / "c60.xyzr")
        found = self.read_back("vtk", VTK, "a.vtp")
        self.check_points(found, 11)
        self.check_shape(found, measures)
        self.assertTrue(found["has_normals"])
        self.assertEqual(found["scalars"], "patch")
        self.assertEqual(found["names"], {})
        self.assertEqual(sorted(found["arrays"]), ["Normals", "atom", "patch"])
        crossings = self.crossings()
        self.assertEqual(found["arrays"]["patch"], [len(atoms) for _, _, atoms in crossings])
        self.assertEqual(found["arrays"]["atom"], [atoms[0] for _, _, atoms in crossings])
        for theirs, (_, mine, _) in zip(found["arrays"]["Normals"], crossings):
            for a, b in zip(theirs, mine):
                self.assertAlmostEqual(a, b, 6)

    def test_vtp_of_a_pqr_file_has_chains_and_residues(self):
        """Chains and residues are those of the file's records."""
        self.make("a.vtp", DATA / "fas2.pqr", "--color", "chain")
        found = self.read_back("vtk", VTK, "a.vtp")
        self.assertEqual(found["scalars"], "color")
        self.assertEqual(found["open"], 0)
        arrays, names = found["arrays"], found["names"]
        records = [line.split() for line in
                   (DATA / "fas2.pqr").read_text(encoding="ascii").splitlines()
                   if line.startswith(("ATOM", "HETATM"))]
        self.assertGreater(len(names["residue_name"]), 50)
        for atom, residue, chain, color in zip(arrays["atom"], arrays["residue"], arrays["chain"],
                                               arrays["color"]):
            label = names["residue_name"][residue].split()
            self.assertEqual(label[:2], [records[atom][3], records[atom][-6]])
            self.assertEqual(" ".join(label[2:]), names["chain_name"][chain])
            self.assertEqual(len(color), 3)

    def test_vtp_without_triangles_is_read(self):
        self.make("a.vtp", DATA / "c60.xyzr", "--margin", "3", "--region=-9,-9,-9,-8,-8,-8")
        done = self.read_back("vtk", """
import json, sys, vtk
reader = vtk.vtkXMLPolyDataReader()
reader.SetFileName(sys.argv[1])
reader.Update()
json.dump({"cells": reader.GetOutput().GetNumberOfCells(), "error": reader.GetErrorCode()},
          sys.stdout)
""", "a.vtp")
        self.assertEqual(done, {"cells": 0, "error": 0})

    def test_vtk_reads_ply_as_text(self):
        measures = self.make("a.ply", DATA / "c60.xyzr", "--ply-ascii")
        found = self.read_back("vtk", VTK, "a.ply")
        self.check_points(found, 4)  # in single precision
        self.check_shape(found, measures)

    def test_biopython_reads_the_vertices(self):
        self.make("a.vert", DATA / "c60.xyzr")
        found = self.read_back("Bio", BIOPYTHON, "a.vert")
        self.check_points(found, 11)
        nearest = min(sum(x * x for x in position) for position, _, _ in self.crossings())
        self.assertAlmostEqual(found["depth"], nearest ** 0.5, 9)

    def test_pymol_reads_both_formats(self):
        """PyMOL reads MSMS's files unchanged, and multiplies the coordinates of text PLY by a
        hundred."""
        for name, scale, *options in (("a.vert", 1), ("a.face", 1), ("a.ply", 100, "--ply-ascii")):
            with self.subTest(name=name):
                self.make(name, DATA / "c60.xyzr", *options)
                found = self.read_back("pymol", PYMOL, name)
                self.assertEqual(found["type"], "object:cgo")
                for end, theirs in zip((min, max), found["extent"]):
                    for axis in range(3):
                        mine = end(position[axis] for position, _, _ in self.crossings())
                        self.assertAlmostEqual(theirs[axis] / scale, mine, 4)

    def test_script_for_pymol_loads_colours_and_normals(self):
        """The corners of the triangles are those of the mesh as text, read here word by word."""
        begin, end, vertex, normal, color, triangles = 2, 3, 4, 5, 6, 4  # of PyMOL's cgo.py
        for options in (("--color", "patch"), ("--color", "atom"), ()):
            with self.subTest(options=options):
                self.make("text.ply", DATA / "c60.xyzr", "--ply-ascii", *options)
                self.make("a.ply", DATA / "c60.xyzr", *options)
                header, _, body = (self.folder / "text.ply").read_text().partition("end_header\n")
                count = int(header.partition("element vertex ")[2].split()[0])
                rows = [[float(word) for word in line.split()] for line in body.splitlines()]
                corners = [int(corner) for row in rows[count:] for corner in row[1:]]
                for name in ("a", "text"):
                    found = self.read_back("pymol", PYMOL_SCRIPT, f"{name}.ply")
                    self.assertEqual(list(found), [name])
                    numbers = found[name]
                    self.assertEqual(len(numbers), 2 + 12 * len(corners) + 1)
                    self.assertEqual((*numbers[:2], numbers[-1]), (begin, triangles, end))
                    colors = set()
                    for index, corner in enumerate(corners):
                        got = numbers[2 + 12 * index:14 + 12 * index]
                        self.assertEqual((got[0], got[4], got[8]), (color, normal, vertex))
                        colors.add(tuple(round(255 * value, 3) for value in got[1:4]))
                        if options:
                            self.assertEqual([round(255 * value, 3) for value in got[1:4]],
                                             rows[corner][6:9])
                        for mine, theirs in zip(rows[corner], got[9:] + got[5:8]):
                            self.assertAlmostEqual(mine, theirs, 5)
                    self.assertEqual(len(colors) > 1, bool(options))

    def test_script_for_pymol_refuses_other_files(self):
        self.make("a.ply", DATA / "c60.xyzr")
        mesh = (self.folder / "a.ply").read_bytes()
        python = python_with("pymol")
        if python is None:
            raise unittest.SkipTest("pymol is not installed")
        other = "not a mesh of eses-blocks"
        for name, content, message in (
                ("cut.ply", mesh[:-1], other), ("head.ply", mesh[:100], other), ("a.txt", b"x", other),
                ("none.ply", None, "no such file")):
            path = self.folder / name
            if content is not None:
                path.write_bytes(content)
            done = subprocess.run([python, "-c", PYMOL_SCRIPT, path], capture_output=True, text=True,
                                  check=False)
            self.assertIn(f"Error: {path}: ", done.stdout)
            self.assertIn(message, done.stdout)
            self.assertNotIn("Traceback", done.stdout + done.stderr)
            self.assertTrue(done.stdout.endswith("{}"))

    def test_triangles_of_msms_are_read_by_their_counts(self):
        """The counts in the third line are read, as MaSIF and Jmol do."""
        self.make("a.vert", DATA / "c60.xyzr")
        self.make("a.off", DATA / "c60.xyzr")
        off = (self.folder / "a.off").read_text(encoding="ascii").splitlines()
        vertices, triangles = map(int, off[1].split()[:2])
        for suffix, count, columns in ((".vert", vertices, 9), (".face", triangles, 5)):
            lines = (self.folder / f"a{suffix}").read_text(encoding="ascii").splitlines()
            self.assertEqual(int(lines[2].split()[0]), count)
            self.assertEqual(len(lines), 3 + count)
            self.assertEqual({len(line.split()) for line in lines[3:]}, {columns})
        for mine, theirs in zip(lines[3:], off[2 + vertices:]):
            self.assertEqual([int(x) - 1 for x in mine.split()[:3]],
                             [int(x) for x in theirs.split()[1:]])


if __name__ == "__main__":
    unittest.main()
