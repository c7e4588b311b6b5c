"""Tests scripts/benchmarks/cavity-volumes; skipped without scipy."""

import importlib.util
import unittest

from support import PROGRAM, TestCase, run


@unittest.skipUnless(importlib.util.find_spec("scipy"), "needs scipy")
class CavityVolumes(TestCase):
    def test_volumes_of_flood_fills_approach_the_exact_ones(self):
        """A hollow cube of atoms has one cavity. The grids know nothing of its faces and arcs."""
        atoms = self.folder / "a.xyzr"
        atoms.write_text("".join(f"{2.5 * x} {2.5 * y} {2.5 * z} 1.8\n"
                                 for x in range(5) for y in range(5) for z in range(5)
                                 if {0, 4} & {x, y, z}))
        done = run("benchmarks/cavity-volumes", atoms, "--program", PROGRAM, "--spacings", 0.4, 0.2, 0.1)
        self.assertDone(done)
        rows = [line.strip("| ").split(" | ") for line in done.stdout.splitlines()[2:]]
        self.assertEqual([row[:2] for row in rows], [["1", "centers"], ["1", "void"]])
        for _, name, *volumes in rows:
            *grids, exact = map(float, volumes)
            errors = [abs(volume / exact - 1) for volume in grids]
            with self.subTest(name=name, errors=errors):
                self.assertLess(errors[2], min(errors[0] / 2, 0.04))

    def test_failures_of_the_program_are_reported(self):
        atoms = self.folder / "a.xyzr"
        atoms.write_text("0 0 0 1\n")
        done = run("benchmarks/cavity-volumes", atoms, "--program", PROGRAM, "--probe-radius", 1e6)
        self.assertEqual(done.returncode, 1)
        self.assertIn("--probe-radius is '1000000.0'", done.stderr)
