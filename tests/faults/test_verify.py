"""Tests of a program whose results are wrong: --verify finds the faults, and no file is left."""

from faults import NAMES, SMALL, FaultTest

# Two pairs of atoms 1e-4 angstrom apart, whose SAS spheres meet in an ill-conditioned circle.
ALMOST_COINCIDENT = "0 0 0 1.6999\n0 .0001 -.0001 1.6999\n3 .2 .1 1.5\n3.0001 .2 .1 1.5\n"
# The SAS spheres of opposite atoms touch: a probe exactly fits between six atoms.
OCTAHEDRON = "".join(f"{x} {y} {z} 1.6\n" for x, y, z in (
    (3, 0, 0), (-3, 0, 0), (0, 3, 0), (0, -3, 0), (0, 0, 3), (0, 0, -3)))
# 300 atoms within 1e-9 angstrom, spread by multiples of irrational numbers.
CROWD = "".join(f"{i * 2 ** .5 % 1 * 1e-9} {i * 3 ** .5 % 1 * 1e-9} {i * 5 ** .5 % 1 * 1e-9} 1.7\n"
                for i in range(300))
MESSAGES = {
    "point": "point .*called (inside, but a probe covers it|outside, but no probe covers it)",
    "crossing": "edge .*(a probe covers the crossing|no probe touches the crossing"
                "|does not lead to an accessible probe)",
    "normal": "edge .*the normal",
    "atoms": "edge .*atom",
}


class Verify(FaultTest):
    def sets(self):
        yield SMALL
        for name, text in (("coincident.xyzr", ALMOST_COINCIDENT), ("octahedron.xyzr", OCTAHEDRON),
                           ("crowd.xyzr", CROWD)):
            (self.folder / name).write_text(text)
            yield self.folder / name

    def test_right_results_have_no_faults(self):
        for path in self.sets():
            with self.subTest(path=path.name):
                done = self.run_program(path, "1.4", "0.4", "0.8", "--verify", spoil="")
                self.assertDone(done)
                self.assertRegex(done.stdout, "verified: .* 0 faults")
                self.assertEqual(self.all_files(), sorted(NAMES))

    def test_wrong_results_leave_no_file(self):
        for path in self.sets():
            for spoil, message in MESSAGES.items():
                if (path.name, spoil) == ("crowd.xyzr", "atoms"):
                    continue  # the probe touches all atoms
                with self.subTest(path=path.name, spoil=spoil):
                    done = self.run_program(path, "1.4", "0.4", "0.8", "--verify", "-q",
                                            spoil=spoil)
                    self.assertDone(done, 1)
                    self.assertRegex(done.stderr, f"error: {message}")
                    self.assertIn("no files were written", done.stderr)
                    self.assertNotIn("area:", done.stdout)
                    self.assertEqual(self.all_files(), [])
