"""Tests of messages that name the option, the file or the atom to change, and of results that wait for earlier ones."""

import os
import subprocess
import time

from support import DATA, PROGRAM, TestCase

UBQ = DATA / "1ubq.xyzr"
MAX_WAITING = 1000  # of src/cli/table_command.cpp


class Messages(TestCase):
    def call(self, *arguments, code=0):
        done = subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              check=False, timeout=300)
        self.assertDone(done, code)
        return done

    def test_limits_name_their_options(self):
        pockets = ("measure", UBQ, "--pockets")
        for arguments, code, options in (
                ((*pockets, "--spacing", "2"), 2, "(--spacing)"),
                ((*pockets, "--large-probe", "1"), 2, "(--large-probe)"),
                ((*pockets, "--probe-radius", "0"), 2, "(--probe-radius)"),
                ((UBQ, "--spacing", "3", "--margin", "0"), 1, "(--margin)"),
                ((UBQ, "--spacing", "1e-300"), 1, "(--spacing, --margin)"),
                ((UBQ, "--blocks", "0:99,0:1,0:1"), 1, "(--blocks)"),
                ((UBQ, "--region=500,500,500,600,600,600"), 1, "(--region)"),
                ((UBQ, "--component", "99", "--mesh", "m.ply"), 1, "(--component)"),
                ((UBQ, "--part", "1/9999"), 1, "(--part)"),
                ((UBQ, "--grid-origin", "1,1,1", "--grid-points", "2,2,9000000000000"), 1, "(--grid-points)"),
                ((UBQ, "--grid-origin", "1,1,1e12", "--grid-points", "2,2,9"), 1,
                 "(--grid-origin, --grid-center, --spacing)")):
            with self.subTest(arguments=arguments):
                self.assertEqual(self.call(*arguments, "--quiet", code=code).stderr.splitlines()[0].rpartition(" (")[2],
                                 options.removeprefix("("))
        self.assertEqual(os.listdir(self.folder), [])

    def test_limits_do_not_name_options_of_other_commands(self):
        spheres = self.folder / "spheres.xyzr"
        spheres.write_text("0 0 0 1.5\n1 0 0 1.5\n-9e5 -9e5 -9e5 1.5\n")
        for arguments, options in ((("measure", spheres, "--pockets", "--spacing", "0.05"), ""),
                                   (("msms", "-if", spheres, "-of", "m"), r" \(-density\)")):
            error = self.call(*arguments, "--allow-far-atoms", code=1).stderr.splitlines()[-1]
            self.assertRegex(error, rf"; use a spacing of at least [\d.]+( and a margin of at least [\d.]+)?{options}$")

    def test_atoms_far_from_all_others_are_named(self):
        line = "ATOM  {:5d}  {:3} ALA A   1    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00           {}\n"
        path = self.folder / "placeholder.pdb"
        path.write_text("".join((line.format(1, "N", 0, 0, 0, "N"), line.format(2, "CA", 1.5, 0, 0, "C"),
                                 line.format(3, "CB", 9999.999, 9999.999, 9999.999, "C"))))
        warning = f"eses-blocks: warning: {path}: 1 atom is far from all others: line 3, A/ALA 1/CB\n"
        for command in ("measure", "interface"):
            done = subprocess.run([PROGRAM, command, path], capture_output=True, text=True, check=False)
            if "this build reads xyzr and PQR" in done.stderr:
                self.skipTest("this build has no gemmi")
            self.assertEqual((done.returncode, done.stderr), (0, warning))
            self.assertEqual(self.call(command, path, "-q").stderr, "")
        spheres = self.folder / "spheres.xyzr"
        spheres.write_text("0 0 0 1.5\n1 0 0 1.5\n-999.999 -999.999 -999.999 1.5\n")
        self.assertIn("1 atom is far from all others: line 3\n", self.call("measure", spheres).stderr)
        self.assertIn("1 atom is far from all others: line 3\n", self.call("measure", spheres, "--strict", code=1).stderr)
        # Copies of a molecule may be far from each other.
        copies = self.folder / "copies.xyzr"
        copies.write_text("".join(f"{250 * copy + 1.4 * i} {250 * copy} {250 * copy} 1.7\n"
                                  for copy in range(2) for i in range(20)))
        self.assertEqual(self.call("measure", copies, "--strict").stderr, "")
        # The search for pockets says the same with the size of its grid.
        self.assertEqual(self.call("measure", spheres, "--pockets", "--spacing", "1.4").stderr.count("far from"), 1)

    def test_names_of_water_may_be_in_lower_case(self):
        path = self.folder / "water.pqr"
        path.write_text("ATOM 1 N ALA 1 0 0 0 0.1 1.5\nHETATM 2 O hoh 2 9 0 0 0.1 1.5\nHETATM 3 OW sol 3 18 0 0 0.1 1.5\n")
        self.assertIn("\nread: 3 atoms; 2 of water,", self.call("measure", path).stdout)

    def test_a_third_side_of_groups_is_no_file(self):
        path = self.folder / "ions.pqr"
        path.write_text("ATOM 1 C ION A 1 0 0 0 1.00 2.00\nATOM 2 C ION B 2 3 0 0 1.00 2.00\n")
        for arguments in ((path, "--groups", "A", "B", "C"), ("--groups", "A", "B", "C", path)):
            self.assertIn("--groups takes two sides, here A and B, and there is no file C; chains of a side are joined by "
                          "+, as in eses-blocks interface FILE --groups A+B C\n",
                          self.call("interface", *arguments, code=2).stderr)
        self.assertIn("cannot open no.pqr", self.call("interface", "no.pqr", "--groups", "A", "B", code=1).stderr)

    def test_missing_files_are_named_first(self):
        for arguments in (("measure", "nofile", "--parts", "chains"), ("measure", "nofile", "--table", "residues"),
                          ("measure", "nofile", "--waters"), ("measure", "nofile", "--model", "all"),
                          ("interface", "nofile"), ("nofile", "--write", "residues"), ("nofile", "--waters"),
                          ("nofile", "--color", "chain", "--mesh", "m.ply"), ("pdb_to_xyzrn", "--format", "xyzr", "nofile")):
            with self.subTest(arguments=arguments):
                self.assertIn("error: cannot open nofile: No such file", self.call(*arguments, code=1).stderr)

    def test_results_that_wait_for_an_earlier_one_are_bounded(self):
        first, count = self.folder / "first.xyzr", MAX_WAITING + 400
        os.mkfifo(first)
        files = [self.folder / f"{i}.xyzr" for i in range(count)]
        for path in files:
            path.write_text("0 0 0 1.5\n")
        tables = self.folder / "tables"
        with subprocess.Popen([PROGRAM, "measure", first, *files, "--surface", "sas", "--write", "atoms", "-o", tables, "-t",
                               "2"], stdout=subprocess.PIPE, text=True) as process:
            def written():
                return sum(1 for name in os.listdir(tables) if name.endswith(".atoms.csv")) if tables.is_dir() else 0
            known, since, end = 0, time.monotonic(), time.monotonic() + 240
            while (known < MAX_WAITING - 1 or time.monotonic() < since + 2) and time.monotonic() < end:
                if written() != known:
                    known, since = written(), time.monotonic()
                time.sleep(0.05)
            with open(first, "w", encoding="ascii") as target:
                target.write("0 0 0 1.5\n")
            lines = process.communicate(timeout=240)[0].splitlines()
        self.assertEqual(known, MAX_WAITING - 1)
        self.assertEqual(process.returncode, 0)
        self.assertEqual([line.split()[-1] for line in lines[1:]], [str(path) for path in (first, *files)])
