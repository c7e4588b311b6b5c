"""Tests that VTK reads meshes; skipped without Debian's python3-vtk9."""

import math
import subprocess
import unittest

from support import DATA, PROGRAM, TestCase

try:
    import vtk
except ImportError:
    vtk = None


def read(path):
    reader = vtk.vtkPLYReader() if path.suffix == ".ply" else vtk.vtkOBJReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def open_or_branched_edges(mesh):
    edges = vtk.vtkFeatureEdges()
    edges.SetInputData(mesh)
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.BoundaryEdgesOn()
    edges.NonManifoldEdgesOn()
    edges.Update()
    return edges.GetOutput().GetNumberOfCells()


def component_count(mesh):
    connectivity = vtk.vtkPolyDataConnectivityFilter()
    connectivity.SetInputData(mesh)
    connectivity.SetExtractionModeToAllRegions()
    connectivity.Update()
    return connectivity.GetNumberOfExtractedRegions()


def off_lines(path):
    """Returns positions and triangles."""
    lines = path.read_text().splitlines()
    vertices, faces, _ = map(int, lines[1].split())
    return lines[2:2 + vertices], lines[2 + vertices:2 + vertices + faces]


@unittest.skipUnless(vtk, "python3-vtk9 is not installed")
class ReadByVtk(TestCase):
    def run_program(self, *arguments):
        done = subprocess.run([PROGRAM, *map(str, arguments), "-q", "--write", "none"],
                              capture_output=True, text=True, check=False)
        self.assertDone(done)
        return {key: float(value) for key, value in
                (line.removeprefix("surface ").split(": ") for line in done.stdout.splitlines())}

    def make(self, name, *arguments):
        path = self.folder / name
        measures = self.run_program(*arguments, "--mesh", path)
        return read(path), measures

    def check_closed(self, mesh):
        self.assertGreater(mesh.GetNumberOfCells(), 0)
        self.assertEqual(open_or_branched_edges(mesh), 0)

    def test_mesh_of_a_protein_is_closed(self):
        for name in ("a.ply", "a.obj"):
            with self.subTest(name=name):
                mesh, measures = self.make(name, DATA / "1ubq.xyzr", "--spacing", "0.25")
                self.check_closed(mesh)
                mass = vtk.vtkMassProperties()
                mass.SetInputData(mesh)
                mass.Update()
                self.assertAlmostEqual(mass.GetSurfaceArea() / measures["area"], 1, delta=0.01)
                self.assertAlmostEqual(mass.GetVolume() / measures["volume"], 1, delta=0.01)

    def test_vertices_are_those_of_the_text_files(self):
        path = self.folder / "a.off"
        self.run_program(DATA / "c60.xyzr", "--mesh", path)
        positions, triangles = off_lines(path)
        mesh, _ = self.make("a.ply", DATA / "c60.xyzr")
        self.assertEqual(mesh.GetNumberOfPoints(), len(positions))
        self.assertEqual(mesh.GetNumberOfCells(), len(triangles))
        for i, line in enumerate(positions):
            for read_back, text in zip(mesh.GetPoint(i), line.split()):
                self.assertAlmostEqual(read_back, float(text), places=4)  # VTK reads floats
        for i, line in enumerate(triangles):
            ids = mesh.GetCell(i).GetPointIds()
            self.assertEqual([3] + [ids.GetId(k) for k in range(3)], list(map(int, line.split())))

    def test_normals_of_a_ball_point_outward(self):
        (self.folder / "ball.xyzr").write_text("0.1 0.2 0.3 2.03\n")
        mesh, _ = self.make("a.ply", self.folder / "ball.xyzr", "--spacing", "0.2")
        self.check_closed(mesh)
        self.assertEqual(mesh.GetNumberOfCells(), 2 * mesh.GetNumberOfPoints() - 4)
        self.assertEqual(component_count(mesh), 1)
        normals = mesh.GetPointData().GetNormals()
        for i in range(mesh.GetNumberOfPoints()):
            for axis, centre in enumerate((0.1, 0.2, 0.3)):
                self.assertAlmostEqual(2.03 * normals.GetComponent(i, axis),
                                       mesh.GetPoint(i)[axis] - centre, places=5)
        # VTK's outward normals follow from the order of the corners.
        for i in range(0, mesh.GetNumberOfCells(), 7):
            cell = mesh.GetCell(i)
            corners = [mesh.GetPoint(cell.GetPointId(k)) for k in range(3)]
            normal = [0, 0, 0]
            vtk.vtkTriangle.ComputeNormal(*corners, normal)
            self.assertGreater(sum(n * (c - o) for n, c, o in
                                   zip(normal, corners[0], (0.1, 0.2, 0.3))), 1.9)

    def test_colours_are_read(self):
        mesh, _ = self.make("a.ply", DATA / "fas2.pqr", "--color", "chain", "--spacing", "0.8")
        self.check_closed(mesh)
        colours = mesh.GetPointData().GetScalars()
        self.assertEqual(colours.GetNumberOfComponents(), 3)
        self.assertTrue(math.isclose(colours.GetRange(0)[0], colours.GetRange(0)[1]))


if __name__ == "__main__":
    unittest.main()
