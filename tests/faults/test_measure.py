"""Tests of a measurement that misses placements which cut a patch: it fails, and names atoms."""

import re

from faults import NO_SPACE, FaultTest, needs_library
from support import DATA

PROTEIN = DATA / "1ubq.xyzr"


class Measure(FaultTest):
    def test_right_cutters_fit(self):
        done = self.run_program("measure", PROTEIN, "--write", "atoms", spoil="")
        self.assertDone(done)
        self.assertRegex(done.stdout, "SES patches: ")

    def test_missed_cutters_are_found(self):
        for more in (["atoms"], ["cavities"], ["derivatives"], ["atoms", "-t", "3"]):
            with self.subTest(more=more):
                done = self.run_program("measure", PROTEIN, "--write", *more, spoil="cutter")
                self.assertDone(done, 1)
                self.assertNotIn("SES patches: ", done.stdout)
                found = re.search(r"the patches of the surface do not fit together: sum of the "
                                  r"forces \S+ square angstrom.*; at atoms ([0-9, ]+)", done.stderr)
                self.assertTrue(found, done.stderr)
                self.assertEqual(self.all_files(), [])

    def write_parts(self):
        """Returns a file of two chains."""
        lines = (DATA / "fas2.pqr").read_text().splitlines()
        atoms = [line.split() for line in lines if line.startswith("ATOM")]
        parts = self.folder / "parts.pqr"
        parts.write_text("".join(f"{' '.join(fields[:4])} {'AB'[int(fields[4]) > 575]} {' '.join(fields[4:])}\n"
                                 for fields in atoms))
        return parts

    def test_interfaces_fail_as_well(self):
        parts = self.write_parts()
        self.assertDone(self.run_program("interface", parts, spoil=""))
        done = self.run_program("interface", parts, spoil="cutter")
        self.assertDone(done, 1)
        self.assertEqual(done.stdout, "")
        self.assertIn("the patches of the surface do not fit together", done.stderr)

    @needs_library
    def test_full_disk_leaves_no_table_of_interfaces(self):
        parts = self.write_parts()
        for name in ("parts.interfaces.csv", "parts.interface.areas.pdb"):
            done = self.run_program("interface", parts, "--write", "interfaces,pdb", fault=f"space 1 .{name}.")
            self.assertTrue(self.is_faulty())
            self.assertFailed(done, f"cannot write {self.output / name}: {NO_SPACE}")
            self.assertEqual(done.stdout, "")
            self.assertEqual(self.all_files(), [])

    def test_grids_with_exact_values_fail_as_well(self):
        done = self.run_program(PROTEIN, "1.4", "0.8", "1.6", "--exact", spoil="cutter")
        self.assertDone(done, 1)
        self.assertIn("the patches of the surface do not fit together", done.stderr)
        self.assertEqual(self.all_files(), [])
