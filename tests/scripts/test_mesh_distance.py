"""Tests of scripts/benchmarks/mesh-distance on an octahedron whose corners are on a sphere; skipped
without scipy."""

import math
import subprocess
import unittest

from support import PROGRAM, SCRIPTS, TestCase, can_import, interpreter_of, write_program

SCRIPT = SCRIPTS / "benchmarks" / "mesh-distance"
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


class MeshDistance(TestCase):
    def setUp(self):
        super().setUp()
        if not can_import(SCRIPT, "scipy"):
            raise unittest.SkipTest("scipy is not installed")
        self.atoms = self.folder / "ball.xyzr"
        self.atoms.write_text(f"0 0 0 {RADIUS}\n", encoding="ascii")

    def rows(self, *arguments):
        done = subprocess.run([interpreter_of(SCRIPT), SCRIPT, self.atoms, "--binary",
                               PROGRAM, "--spacings", "0.5", *map(str, arguments)],
                              capture_output=True, text=True, check=False)
        self.assertDone(done)
        return [[field.strip() for field in line.strip("|").split("|")]
                for line in done.stdout.splitlines()[2:]]

    def check_octahedron(self, row):
        distance = RADIUS - RADIUS / math.sqrt(3)  # of the middles from the sphere
        self.assertAlmostEqual(float(row[3]), 6 / (4 * math.pi * RADIUS ** 2), 2)
        for field in row[4:7]:
            self.assertAlmostEqual(float(field), distance, 2)
        self.assertLess(float(row[7]), 0.001)

    def test_meshes_of_files_are_measured(self):
        mesh = self.folder / "octahedron.off"
        mesh.write_text(OCTAHEDRON, encoding="ascii")
        own, other = self.rows("--other", mesh)
        self.assertEqual(own[:3], ["`ball.xyzr`", "plain", "0.50"])
        # The middle of an edge e is e^2 / (8 r) below the sphere; edges are below one diagonal.
        self.assertLess(float(own[6]), 0.5 ** 2 * 3 / (8 * RADIUS))
        self.assertLess(float(own[7]), 0.001)
        self.assertEqual(other[:3], ["`ball.xyzr`", "octahedron.off", ""])
        self.check_octahedron(other)

    def test_nanoshaper_is_run(self):
        program = write_program(self.folder / "NanoShaper",
                                "grep -qx 'Grid_scale = 2.0' $1 && grep -q ' 3$' atoms.xyzr &&\n"
                                f"cat > triangulatedSurf.off <<'END'\n{OCTAHEDRON}END\n")
        own, other = self.rows("--nanoshaper", program)
        self.assertEqual([own[1], other[1]], ["plain", "NanoShaper"])
        self.check_octahedron(other)


if __name__ == "__main__":
    unittest.main()
