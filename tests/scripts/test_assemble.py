"""Tests of scripts/assemble: copies, the gap between them, and invalid input."""

import gzip
import itertools
import math
import os
import random
import subprocess

from support import DATA, PROGRAM, TestCase, run

WRITTEN = 0.0005  # rounding error: coordinates have three decimals

# Columns 1 to 54 of the first atoms of 1UBQ.
RECORDS = ("ATOM      1  N   MET A   1      27.340  24.430   2.614",
           "ATOM      2  CA  MET A   1      26.266  25.413   2.842",
           "HETATM    3  C   MET A   1      26.913  26.639   3.531")


def random_atoms(count):
    """Returns atoms with many digits, away from the origin. A radius may be 0."""
    chance = random.Random(7)
    return [(chance.gauss(30, 3), chance.gauss(-12, 5), chance.gauss(4, 2),
             chance.choice((0.0, 1.1, 1.7))) for _ in range(count)]


def write_xyzr(path, atoms):
    path.write_text("".join(f"{x:.4f} {y:.4f} {z:.4f} {r}\n" for x, y, z, r in atoms))
    return path


def parse(text):
    return [tuple(map(float, line.split())) for line in text.splitlines()]


def min_gap(one, other):
    return min(math.dist(a[:3], b[:3]) - a[3] - b[3] for a, b in itertools.product(one, other))


class Assemble(TestCase):
    def assemble(self, *arguments, code=0):
        done = run("assemble", *arguments, "--program", PROGRAM)
        self.assertDone(done, code)
        return done

    def refused(self, *arguments, code=1):
        done = self.assemble(*arguments, code=code)
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertTrue(done.stderr.startswith("assemble: "), done.stderr)
        return done.stderr

    def test_complex_has_all_atoms_of_all_copies(self):
        for source, atoms in (("c60.xyzr", 60), ("boxb.pqr", 619)):
            target = self.folder / "complex.xyzr"
            done = self.assemble(DATA / source, "-o", target)
            self.assertEqual(len(parse(target.read_text())), 42 * atoms)
            self.assertIn(f"{42 * atoms:,} in all; rings: 6 of 7", done.stderr)

    def test_copies_keep_the_gap(self):
        """No two atoms of different copies are nearer than the gap, and the copies are close
        together."""
        count = 24
        path = write_xyzr(self.folder / "some.xyzr", random_atoms(count))
        for copies, rings, gap in ((1, 1, 1), (2, 1, 1), (3, 1, 0), (7, 1, 2.5), (4, 4, 1),
                                   (6, 3, 0.5), (12, 3, 1)):
            with self.subTest(copies=copies, rings=rings, gap=gap):
                done = self.assemble(path, "--copies", copies, "--rings", rings, "--gap", gap)
                atoms = parse(done.stdout)
                self.assertEqual(len(atoms), copies * count)
                parts = [atoms[i:i + count] for i in range(0, len(atoms), count)]
                gaps = [min_gap(*pair) for pair in itertools.combinations(parts, 2)]
                self.assertGreaterEqual(min(gaps, default=gap), gap)
                # Copies keep the gap from planes between them, so their distance may be slightly
                # larger.
                self.assertLess(min(gaps, default=gap), gap + 10)

    def test_distance_of_single_spheres_is_the_gap(self):
        """Each copy is one sphere, so its neighbours are known. Their distance is exactly the
        gap."""
        path = write_xyzr(self.folder / "one.xyzr", [(3.0, 4.0, 5.0, 1.5)])
        for copies, rings in ((2, 1), (3, 1), (8, 1), (5, 5)):
            atoms = parse(self.assemble(path, "--copies", copies, "--rings", rings).stdout)
            gaps = [min_gap([a], [b]) for a, b in itertools.combinations(atoms, 2)]
            self.assertGreaterEqual(min(gaps), 1)
            self.assertLess(min(gaps), 1.01)

    def test_copies_are_rigid(self):
        atoms = random_atoms(12)
        path = write_xyzr(self.folder / "some.xyzr", atoms)
        placed = parse(self.assemble(path, "--copies", "6", "--rings", "2").stdout)
        for start in range(0, len(placed), len(atoms)):
            copy = placed[start:start + len(atoms)]
            self.assertEqual([atom[3] for atom in copy], [atom[3] for atom in atoms])
            for i, j in itertools.combinations(range(len(atoms)), 2):
                self.assertAlmostEqual(math.dist(copy[i][:3], copy[j][:3]),
                                       math.dist(atoms[i][:3], atoms[j][:3]), delta=5 * WRITTEN)

    def program_accepts(self, path):
        done = subprocess.run([PROGRAM, path, "--dry-run"], stdin=subprocess.DEVNULL,
                              capture_output=True, check=False)
        return done.returncode == 0

    def one_copy(self, path):
        """Returns the atoms of a file that the program also reads."""
        self.assertTrue(self.program_accepts(path))
        return self.assemble(path, "--copies", 1, "--rings", 1).stdout

    def refused_like_the_program(self, path):
        self.assertFalse(self.program_accepts(path))
        return self.refused(path)

    def write_records(self, name, ends):
        path = self.folder / name
        path.write_text("".join(record + end + "\n" for record, end in zip(RECORDS, ends)))
        return path

    def test_elements_after_the_radius_are_accepted(self):
        numbers = (" -0.3000 1.8500", "  0.2100 2.2750", "  0.5100 2.0000")
        plain = self.one_copy(self.write_records("plain.pqr", numbers))
        self.assertEqual([atom[3] for atom in parse(plain)], [1.85, 2.275, 2.0])
        for element in ("N", "ZN", "Zn", "N1+", "ZN2+", "O1-"):
            path = self.write_records("element.pqr",
                                      [f"{end}  {element}" for end in numbers])
            self.assertEqual(self.one_copy(path), plain)
        for word in ("NAG", "N1", "N+", "N12", "N1+-"):
            path = self.write_records("word.pqr", [f"{end}  {word}" for end in numbers])
            self.assertIn(f'word.pqr:1: text "{word}" after the radius',
                          self.refused_like_the_program(path))
        short = self.folder / "short.pqr"
        short.write_text("ATOM 1 N MET 1 27.340 24.430 2.614 1.8500 N\n")
        self.assertIn("short.pqr:1: expected at least 10 fields",
                      self.refused_like_the_program(short))

    def test_pdb_files_named_pqr_are_refused(self):
        numbers = ("  1.00  9.67", "  1.00 10.38", "  0.50  9.62")
        for end in ("", "           N", "          ZN", "           N1+"):
            path = self.write_records("1ubq.pqr", [number + end for number in numbers])
            self.assertIn("1ubq.pqr: this is a PDB file", self.refused_like_the_program(path))
        # The records have a segment, which is not a number, and occupancies of 0.
        path = self.write_records("1ubq.pqr", [number + "      1UBQ N" for number in numbers])
        self.assertIn("1ubq.pqr", self.refused_like_the_program(path))
        path = self.write_records("1ubq.pqr", ("  0.00  9.67", "  0.00 10.38", "  0.00  3.62"))
        self.assertIn("1ubq.pqr: this is a PDB file", self.refused_like_the_program(path))
        # The charges have two decimals, and some are negative.
        path = self.write_records("charges.pqr", (" -0.30  1.85", "  0.21  2.27", " -0.51  2.00"))
        self.assertEqual([atom[3] for atom in parse(self.one_copy(path))], [1.85, 2.27, 2.0])

    def test_compressed_input_is_read(self):
        for name in ("boxb.pqr", "c60.xyzr"):
            packed = self.folder / (name + ".gz")
            packed.write_bytes(gzip.compress((DATA / name).read_bytes()))
            self.assertEqual(self.assemble(packed).stdout, self.assemble(DATA / name).stdout)

    def test_compressed_output_is_written(self):
        plain = self.assemble(DATA / "c60.xyzr").stdout
        for name in ("big.xyzr.gz", "big.GZ"):
            target = self.folder / name
            self.assemble(DATA / "c60.xyzr", "-o", target)
            packed = target.read_bytes()
            self.assertEqual(gzip.decompress(packed).decode(), plain)
            self.assertEqual(self.assemble(target, "--copies", 1, "--rings", 1).returncode, 0)
            self.assemble(DATA / "c60.xyzr", "-o", target)
            self.assertEqual(target.read_bytes(), packed)
        self.assertEqual(sorted(os.listdir(self.folder)), ["big.GZ", "big.xyzr.gz"])
        full = self.folder / "full.gz"
        full.symlink_to("/dev/full")
        self.assertIn("No space left", self.refused(DATA / "c60.xyzr", "-o", full))
        self.assertIn("nodir", self.refused(DATA / "c60.xyzr", "-o", self.folder / "nodir/x.gz"))

    def test_copies_must_be_a_multiple_of_rings(self):
        self.assertIn("10 copies", self.refused(DATA / "c60.xyzr", "--copies", "10", code=2))
        self.refused(DATA / "c60.xyzr", "--copies", "4", "--rings", "6", code=2)

    def test_invalid_options_are_refused(self):
        for arguments in ((), (DATA / "c60.xyzr", "--copies", "0"),
                          (DATA / "c60.xyzr", "--gap", "-1"), (DATA / "c60.xyzr", "--gap", "nan")):
            self.refused(*arguments, code=2)

    def test_wrong_input_is_refused(self):
        target = self.folder / "out.xyzr"
        for name, content, message in (
                ("short.xyzr", b"0 0 0 1\n1 2 3\n", "short.xyzr:2: field 4 (radius): missing"),
                ("word.xyzr", b"0 0 0 1\n\n1 2 x 1\n", 'word.xyzr:3: field 3 (z): expected a number, found "x"'),
                ("negative.xyzr", b"0 0 0 -1\n", "negative.xyzr:1: field 4 (radius): must not be negative"),
                ("nan.xyzr", b"0 nan 0 1\n", "nan.xyzr:1"),
                ("empty.xyzr", b"# nothing\n", "empty.xyzr: no atoms found"),
                ("short.pqr", b"REMARK\nATOM 1 N MET 1 2 3\n", "short.pqr:2"),
                ("word.xyzr.gz", gzip.compress(b"1 2 x 1\n"), "word.xyzr.gz:1"),
                ("cut.xyzr.gz", gzip.compress(b"0 0 0 1\n" * 99)[:-12], "cut.xyzr.gz: ")):
            path = self.folder / name
            path.write_bytes(content)
            self.assertIn(message, self.refused(path, "-o", target))
        self.assertIn("missing.xyzr", self.refused(self.folder / "missing.xyzr"))
        self.assertIn("missing.xyzr.gz", self.refused(self.folder / "missing.xyzr.gz"))
        self.assertIn("nodir", self.refused(DATA / "c60.xyzr", "-o", self.folder / "nodir" / "x"))
        self.assertFalse(target.exists())
