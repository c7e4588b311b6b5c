"""Tests of scripts/benchmarks/meshes on an octahedron whose corners are on a sphere."""

import math
import subprocess
import unittest

from support import PROGRAM, SCRIPTS, TestCase, can_import, interpreter_of, write_program

SCRIPT = SCRIPTS / "benchmarks" / "meshes"
RADIUS = 3
OCTAHEDRON = """OFF
# a comment, as NanoShaper writes it

6 8 0  # counts
3 0 0
-3 0 0
0 3 0
0 -3 0
0 0 3
0 0 -3
3 0 2 4
3 2 1 4
3 1 3 4
3 3 0 4
3 2 0 5
3 1 2 5
3 3 1 5
3 0 3 5
"""


class Meshes(TestCase):
    def setUp(self):
        super().setUp()
        self.atoms = self.folder / "ball.xyzr"
        self.atoms.write_text(f"0 0 0 {RADIUS}\n", encoding="ascii")

    def rows(self, *arguments, code=0):
        done = subprocess.run([interpreter_of(SCRIPT), SCRIPT, self.atoms, *map(str, arguments),
                               "--program", PROGRAM, "--spacings", "0.5"],
                              capture_output=True, text=True, check=False)
        self.assertDone(done, code)
        self.messages = done.stderr
        return [[field.strip() for field in line.strip("|").split("|")]
                for line in done.stdout.splitlines()[2:]]

    def check_octahedron(self, row):
        distance = RADIUS - RADIUS / math.sqrt(3)  # of the middles from the sphere
        self.assertAlmostEqual(float(row[5]), 6 / (4 * math.pi * RADIUS ** 2), 2)
        for field in row[6:9]:
            self.assertAlmostEqual(float(field), distance, 2)
        self.assertLess(float(row[9]), 0.001)

    @unittest.skipUnless(can_import(SCRIPT, "scipy"), "scipy is not installed")
    def test_meshes_of_files_are_measured(self):
        mesh = self.folder / "octahedron.off"
        mesh.write_text(OCTAHEDRON, encoding="ascii")
        own, other = self.rows("--other", mesh)
        self.assertEqual(own[:3], ["`ball.xyzr`", "plain", "0.50"])
        # The middle of an edge e is e^2 / (8 r) below the sphere; edges are below one diagonal.
        self.assertLess(float(own[8]), 0.5 ** 2 * 3 / (8 * RADIUS))
        self.assertLess(float(own[9]), 0.001)
        self.assertEqual(other[:3], ["`ball.xyzr`", "octahedron.off", ""])
        self.check_octahedron(other)

    @unittest.skipUnless(can_import(SCRIPT, "scipy"), "scipy is not installed")
    def test_nanoshaper_is_run(self):
        program = write_program(self.folder / "NanoShaper",
                                "grep -qx 'Grid_scale = 2.0' $1 && grep -q ' 3$' atoms.xyzr &&\n"
                                f"cat > triangulatedSurf.off <<'END'\n{OCTAHEDRON}END\n")
        own, other = self.rows("--nanoshaper", program)
        self.assertEqual([own[1], other[1]], ["plain", "NanoShaper"])
        self.check_octahedron(other)

    def test_times_are_measured_without_distances(self):
        program = write_program(self.folder / "NanoShaper", "echo OFF > triangulatedSurf.off\n")
        rows = self.rows("--nanoshaper", program, "--fine", 0, "--runs", 2)
        self.assertEqual([row[:3] for row in rows], [["`ball.xyzr`", name, "0.50"] for name in ("plain", "NanoShaper")])
        for row in rows:
            self.assertEqual(len(row), 5)
            self.assertGreater(float(row[4]), 1)

    def test_failures_are_named(self):
        for script in ("echo no atoms; exit 1", "echo no atoms"):
            self.rows("--nanoshaper", write_program(self.folder / "NanoShaper", script), "--fine", 0, code=1)
            self.assertIn("no atoms", self.messages)
        self.rows(self.folder / "none.xyzr", code=1)
        self.assertIn("none.xyzr does not exist", self.messages)


if __name__ == "__main__":
    unittest.main()
