"""Tests that other programs' libraries read maps of the inside. Needs Debian's packages
python3-vtk9 and python3-griddataformats; what is missing is skipped."""

import json
import subprocess
import unittest

from support import DATA, PROGRAM, TestCase, python_with

VTK = """
import json, sys, vtk
reader = vtk.vtkXMLImageDataReader()
reader.SetFileName(sys.argv[1])
reader.Update()
image = reader.GetOutput()
size = image.GetDimensions()
extent = image.GetExtent()
values = image.GetPointData().GetScalars()
h = image.GetSpacing()
json.dump({"size": size, "lower": image.GetPoint(0), "spacing": h,
           "first": extent[::2], "name": values.GetName(),
           "values": [int(values.GetValue(i)) for i in range(values.GetNumberOfTuples())]},
          sys.stdout)
"""
GRID_DATA = """
import json, sys, gridData
grid = gridData.Grid(sys.argv[1])
json.dump({"size": grid.grid.shape, "lower": list(grid.origin), "spacing": list(grid.delta),
           "values": [int(v) for v in grid.grid.flatten(order="F")]}, sys.stdout)
"""


class MapReaders(TestCase):
    def read_back(self, module, program, name, *options):
        python = python_with(module)
        if python is None:
            raise unittest.SkipTest(f"{module} is not installed")
        subprocess.run([PROGRAM, DATA / "c60.xyzr", "1.4", "0.9", "0.9", "-q", "--inside", name,
                        "-o", self.folder, *options], check=True, capture_output=True)
        done = subprocess.run([python, "-c", program, self.folder / name], check=True,
                              capture_output=True, text=True)
        found = json.loads(done.stdout)
        points = [tuple(map(int, line.split())) for line in
                  (self.folder / "grid_info.txt").read_text(encoding="ascii").splitlines()]
        low, high = (tuple(ends(p[axis] for p in points) for axis in range(3))
                     for ends in (min, max))
        box = (self.folder / "bounding_box.txt").read_text(encoding="ascii").split()
        self.assertEqual(tuple(found["size"]), tuple(b - a + 1 for a, b in zip(low, high)))
        for axis in range(3):
            self.assertAlmostEqual(found["spacing"][axis], 0.9)
            self.assertAlmostEqual(found["lower"][axis], float(box[axis]) + 0.9 * low[axis], 6)
        self.assertEqual(found["values"], [1 if p[3] > 0 else 0 for p in points])
        self.assertIn(1, found["values"])
        return found

    def test_vtk_reads_a_map(self):
        self.assertEqual(self.read_back("vtk", VTK, "map.vti")["name"], "inside")

    def test_vtk_reads_a_map_of_a_region(self):
        found = self.read_back("vtk", VTK, "map.vti", "--region=-3,-2,-1,4,5,3")
        self.assertTrue(all(first > 0 for first in found["first"]))

    def test_grid_data_formats_reads_a_map(self):
        self.read_back("gridData", GRID_DATA, "map.dx")

    def test_grid_data_formats_reads_a_map_of_a_region(self):
        self.read_back("gridData", GRID_DATA, "map.dx", "--region=-3,-2,-1,4,5,3")
