"""Tests of scripts/apbs with replacements for APBS and eses-blocks: grids, input files, results and
errors.

test_apbs_energies.py runs the real programs.
"""

import csv
import gzip
import io
import json
import os
import signal
import subprocess
import time
import unittest

from support import DATA, PROGRAM, SCRIPTS, TestCase, command, forget_signals, run, write_program
from eses_tools import poisson_boltzmann as pb

PATIENCE = 600  # seconds until a test gives up; no normal run takes so long

ION = "ATOM 1 I ION 1 0.000 0.000 0.000 1.0000 3.0000\n"
OTHER = "ATOM 1 J ION 2 8.000 1.000 2.000 -1.0000 2.0000\n"

# Replaces APBS. The energies are 2, 4, 8 ... kJ/mol, in the order of the input file.
APBS = """for argument; do
  case $argument in --output-file=*) energies=${argument#*=} ;; esac
done
for name in $(awk '$1 == "write" { print $4 }' "$argument"); do echo "potential" >"$name-PE0.dx"; done
awk '/^elec name/ { value = value ? 2 * value : 2; print; printf "    calc\\n"
  printf "        totEnergy %.12E kJ/mol\\n", value; print "    end\\nend" }' "$argument" >"$energies"
"""

# Replaces eses-blocks, except that it reads atoms. It writes its arguments to a file, one call per
# line.
ESES = f"""case $1 in --version|pdb_to_xyzr) exec '{PROGRAM}' "$@" ;; esac
echo "$*" >>"$0.calls"
echo {{}}
"""


def atom(x, y, z, radius, charge=0.0):
    return pb.Atom(x, y, z, charge, radius)


def molecule(*atoms):
    return pb.Molecule("m.pqr", atoms)


class Grids(unittest.TestCase):
    def check(self, grid, molecules, padding):
        """Checks that the grid encloses all spheres and the padding, and that a smaller one
        would not."""
        for axis in range(3):
            self.assertEqual(grid.points[axis] % 32, 1)
            half = (grid.points[axis] - 1) / 2 * grid.spacing
            needed = max(abs(one[axis] - grid.center[axis]) + one.radius
                         for m in molecules for one in m.atoms) + padding
            self.assertGreaterEqual(half, needed - 1e-6)
            self.assertLess(half - 16 * grid.spacing, needed)

    def test_grid_encloses_molecule_and_padding(self):
        molecules = [molecule(atom(0, 0, 0, 3), atom(-7, 20, 1, 1.5)), molecule(atom(0, -9, 30, 0))]
        for spacing in (0.1, 0.25, 0.3, 0.5, 1.0, 3.0):
            for padding in (0, 1.7, 10):
                grid = pb.choose_grid(molecules, spacing, padding)
                self.check(grid, molecules, padding)
                self.assertEqual(grid.center, (-2.75, 6.25, 13.5))

    def test_grid_has_the_given_center(self):
        molecules = [molecule(atom(1, 2, 3, 3))]
        grid = pb.choose_grid(molecules, 0.5, 4, (1.2, 1.9, 8.0))
        self.assertEqual(grid.center, (1.2, 1.9, 8.0))
        self.check(grid, molecules, 4)

    def test_exact_length_needs_no_further_points(self):
        """A length of 32 edges gives exactly 33 points, although 16 is not a multiple of 0.1 in
        binary."""
        for spacing in (0.1, 0.25, 0.3, 0.5, 0.7):
            grid = pb.choose_grid([molecule(atom(0, 0, 0, 16 * spacing - 1))], spacing, 1)
            self.assertEqual(grid.points, (33, 33, 33))


class ApbsTest(TestCase):
    def setUp(self):
        super().setUp()
        self.programs, self.temporary = self.folder / "bin", self.folder / "tmp"
        for folder in (self.programs, self.temporary):
            folder.mkdir()
        self.set_apbs(APBS)
        self.program = write_program(self.folder / "program", ESES)
        self.ion = self.add("ion.pqr", ION)

    def set_apbs(self, body):
        write_program(self.programs / "apbs", body)

    def add(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def environment(self, *folders):
        return {**os.environ, "TMPDIR": str(self.temporary),
                "PATH": os.pathsep.join(map(str, folders or (self.programs, os.defpath)))}

    def apbs(self, *arguments, code=0, path=(), **how):
        done = run("apbs", "--program", self.program, *arguments, env=self.environment(*path), **how)
        self.assertDone(done, code)
        self.assertEqual(list(self.temporary.iterdir()), [])
        if code:
            self.assertEqual(done.stdout, "")
            self.assertNotIn("Traceback", done.stderr)
        return done

    def report(self, *arguments):
        return json.loads(self.apbs(*arguments, "--json").stdout)

    def calls(self):
        return self.program.with_name("program.calls").read_text().splitlines()

    def add_complex(self):
        return self.add("complex.pqr", ION + OTHER), self.ion, self.add("other.pqr", OTHER)


class Results(ApbsTest):
    def test_solvation_energy_of_one_file(self):
        done = self.report(self.ion)
        self.assertEqual(done["solvation_energy"], {"eses-blocks": 2 - 4})
        self.assertEqual([(row["surface"], row["energy"]) for row in done["energies"]],
                         [("eses-blocks", 2), ("reference", 4)])
        self.assertEqual(done["molecules"], [{"file": str(self.ion), "atoms": 1, "charge": 1}])

    def test_binding_energy_of_several_files(self):
        files = self.add_complex()
        done = self.report(*files)
        self.assertEqual(done["binding_energy"], {"eses-blocks": 2 - 4 - 8})
        self.assertEqual([row["file"] for row in done["energies"]], list(map(str, files)))
        self.assertEqual([row["charge"] for row in done["molecules"]], [0, 1, -1])

    def test_compare_adds_the_surfaces_of_apbs(self):
        self.assertEqual(self.report(*self.add_complex(), "--compare")["binding_energy"],
                         {"eses-blocks": 2 - 4 - 8, "mol": 16 - 32 - 64, "smol": 128 - 256 - 512})
        self.assertEqual(self.report(self.ion, "--compare")["solvation_energy"],
                         {"eses-blocks": 2 - 16, "mol": 4 - 16, "smol": 8 - 16})

    def test_table_lists_all_energies(self):
        rows = self.apbs(self.ion, "--compare").stdout.splitlines()
        self.assertEqual([len(row) for row in rows], [len(rows[0])] * 4)
        self.assertEqual(rows[-1].split(),
                         ["solvation", "energy", "-14.00", "-12.00", "-8.00"])

    def test_csv_has_the_values_of_the_json_report(self):
        for files, kind in (((self.ion,), "solvation_energy"), (self.add_complex(), "binding_energy")):
            rows = list(csv.DictReader(io.StringIO(self.apbs(*files, "--compare", "--csv").stdout)))
            done = self.report(*files, "--compare")
            expected = [("total_energy", row["file"], row["surface"], row["energy"])
                        for row in done["energies"]]
            expected += [(kind, str(files[0]), surface, energy)
                         for surface, energy in done[kind].items()]
            self.assertEqual([(*list(row.values())[:3], float(row["energy_kj_mol"])) for row in rows],
                             expected)

    def test_potential_is_written_once_it_is_complete(self):
        path, packed = self.folder / "new.dx", self.folder / "new.dx.gz"
        kept = self.folder / "kept"
        self.apbs(*self.add_complex(), "--write-potential", path, "--keep", kept)
        self.assertEqual(path.read_text(), "potential\n")
        self.assertEqual((kept / "apbs.in").read_text().count("write pot dx potential"), 1)
        self.apbs(self.ion, "--write-potential", packed)
        with gzip.open(packed, "rt") as source:
            self.assertEqual(source.read(), "potential\n")
        self.set_apbs(APBS.replace("$name-PE0", "other"))
        path.write_text("before")
        self.assertIn("no potential", self.apbs(self.ion, "--write-potential", path, code=1).stderr)
        self.assertEqual(path.read_text(), "before")
        self.apbs(self.ion, "--write-potential", self.folder / "missing" / "a.dx", code=1)

    def test_resources_are_announced_before_apbs_starts(self):
        said = self.apbs(self.ion, "--padding", "5", "--spacing", "0.5").stderr
        self.assertIn("33 x 33 x 33 grid points, 2 calculations", said)
        self.assertNotIn("memory are available", said)

    def test_too_little_memory_is_an_error_unless_it_is_ignored(self):
        done = self.apbs(self.ion, "--spacing", "0.002", code=1)
        self.assertRegex(done.stderr, r"apbs: only .* of .* of memory are available; use a larger "
                                      "--spacing .* --ignore-memory\n$")
        self.assertFalse(self.program.with_name("program.calls").exists())
        done = self.apbs(self.ion, "--spacing", "0.002", "--ignore-memory")
        self.assertIn("apbs: warning: only", done.stderr)
        self.assertIn("solvation energy", done.stdout)

    def test_compressed_input_is_read(self):
        packed = self.folder / "packed.pqr.gz"
        with gzip.open(packed, "wt") as target:
            target.write(ION)
        self.assertEqual(self.report(packed)["grid"], self.report(self.ion)["grid"])


class InputFile(ApbsTest):
    """The input of APBS and eses-blocks."""

    def input_text(self, *arguments):
        kept = self.folder / "kept"
        self.apbs(*arguments, "--keep", kept)
        return (kept / "apbs.in").read_text()

    def sections(self, text):
        """Returns a dictionary from keyword to the rest of the line, for each `elec` section."""
        return [dict(line.strip().split(" ", 1) for line in section.split("\nend")[0].splitlines()
                     if " " in line.strip())
                for section in text.split("elec ")[1:]]

    def test_all_calculations_use_one_grid(self):
        text = self.input_text(*self.add_complex(), "--compare", "--grid-center=-1.5,0.25,2")
        sections = self.sections(text)
        self.assertEqual(len(sections), 9)
        grids = {(s["dime"], s["grid"], s["gcent"]) for s in sections}
        self.assertEqual(grids, {("97 65 65", "0.5 0.5 0.5", "-1.5 0.25 2.0")})
        for call in self.calls():
            self.assertIn("--grid-center=-1.5,0.25,2.0 --grid-points 97,65,65 ", call)
            self.assertIn("--spacing 0.5 ", call)
        self.assertEqual(len(self.calls()), 3)

    def test_only_the_surface_of_eses_blocks_uses_maps(self):
        sections = self.sections(self.input_text(self.ion, "--compare"))
        self.assertEqual([section.get("usemap") for section in sections],
                         ["diel 1", None, None, None])
        self.assertEqual([(section["srfm"], section["srad"]) for section in sections[1:3]],
                         [("mol", "1.4"), ("smol", "1.4")])

    def test_reference_has_the_solute_dielectric_everywhere(self):
        sections = self.sections(self.input_text(self.ion, "--solute-dielectric", "4",
                                                 "--solvent-dielectric", "80"))
        self.assertEqual([(section["pdie"], section["sdie"]) for section in sections],
                         [("4.0", "80.0"), ("4.0", "4.0")])
        self.assertIn("--solute-dielectric 4.0 --solvent-dielectric 80.0", self.calls()[0])

    def test_ionic_strength_adds_ions_and_kappa_maps(self):
        text = self.input_text(self.ion, "--ionic-strength", "0.15", "--ion-radius", "1.8")
        solvated, reference = text.split("elec ")[1:]
        for charge in ("1", "-1"):
            self.assertIn(f"ion charge {charge} conc 0.15 radius 1.8\n", solvated)
        self.assertIn("usemap kappa 1\n", solvated)
        self.assertIn("kappa dx molecule1-kappa.dx\n", text)
        self.assertIn("--kappa molecule1-kappa.dx --ion-radius 1.8", self.calls()[0])
        self.assertNotIn("ion charge", reference)
        self.assertNotIn("usemap", reference)
        self.assertNotIn("kappa", self.input_text(self.ion))

    def test_ions_may_have_any_charge(self):
        text = self.input_text(self.ion, "--ion=2,0.05", "--ion=-1,0.1", "--equation", "npbe")
        solvated, reference = text.split("elec ")[1:]
        for ions in ("ion charge 2 conc 0.05 radius 2.0\n", "ion charge -1 conc 0.1 radius 2.0\n"):
            self.assertIn(ions, solvated)
        self.assertIn("    npbe\n", solvated)
        self.assertIn("    lpbe\n", reference)
        self.assertNotIn("ion charge", reference)
        settings = self.report(self.ion, "--ion=2,0.05", "--ion=-1,0.1")["settings"]
        self.assertEqual(settings["ions"], [{"charge": 2, "molar": 0.05},
                                            {"charge": -1, "molar": 0.1}])
        self.assertAlmostEqual(settings["ionic_strength"], 0.15)

    def test_coarse_grid_gives_the_boundary_of_the_fine_one(self):
        text = self.input_text(self.ion, "--padding", "4", "--coarse-padding", "20", "--ionic-strength",
                               "0.1", "--bcfl", "sdh")
        names = [section.split("\n")[0] for section in text.split("elec name ")[1:]]
        self.assertEqual(names, ["molecule1-eses-blocks-coarse", "molecule1-eses-blocks",
                                 "molecule1-reference-coarse", "molecule1-reference"])
        coarse, fine, *_ = sections = self.sections(text)
        self.assertEqual([section["bcfl"] for section in sections], ["sdh", "focus"] * 2)
        self.assertEqual([(section["dime"], section["grid"]) for section in (coarse, fine)],
                         [("65 65 65", "1.0 1.0 1.0"), ("33 33 33", "0.5 0.5 0.5")])
        # Both grids have maps of their own.
        self.assertEqual([section.get("usemap") for section in (coarse, fine)], ["kappa 2", "kappa 1"])
        self.assertIn("diel dx molecule1-coarse-x.dx molecule1-coarse-y.dx molecule1-coarse-z.dx", text)
        fine_call, coarse_call = self.calls()
        self.assertIn("--spacing 0.5 --grid-center=0.0,0.0,0.0 --grid-points 33,33,33 ", fine_call)
        self.assertIn("--spacing 1.0 --grid-center=0.0,0.0,0.0 --grid-points 65,65,65 ", coarse_call)

    def test_coarse_grid_encloses_the_fine_one(self):
        molecules = [molecule(atom(0, 0, 0, 1))]
        for spacing, coarse_spacing, coarse_padding in ((0.5, 0.51, 2.1), (0.5, 1, 8), (2, 3, 40)):
            fine = pb.choose_grid(molecules, spacing, 2, (3, 0, 0))
            coarse = pb.choose_coarse_grid(molecules, fine, coarse_spacing, coarse_padding)
            self.assertEqual((coarse.center, coarse.spacing), (fine.center, coarse_spacing))
            for axis in range(3):
                self.assertGreaterEqual(pb.half_length(coarse, axis), pb.half_length(fine, axis))
                self.assertGreaterEqual(pb.half_length(coarse, axis), 1 + coarse_padding)

    def test_atoms_keep_all_digits(self):
        """APBS gets the atoms with all digits, whatever the columns of the file."""
        path = self.add("odd.pqr", "REMARK\nHETATM12345 C1  XYZ A   1      -1.5D+00 0.123456789 "
                                   "2 -.25 1.7 C\n")
        self.input_text(path)
        self.assertEqual((self.folder / "kept" / "molecule1.pqr").read_text(),
                         "ATOM 1 X MOL 1 -1.5 0.123456789 2.0 -0.25 1.7\n")


    def test_charged_files_are_read_as_the_program_reads_them(self):
        """They are files of several programs, and a name that begins with a hyphen."""
        remarks = ("REMARK    The B-factors in this file hold atomic radii\n"
                   "REMARK    The occupancy in this file hold atomic charges\n")
        for name, text, charge, radius in (
                ("born", "ATOM      1  I   ION     1       0.000   0.000   0.000  1.00  3.00\n", 1, 3),
                ("joined", "ATOM      1  N    NALA   192     -51.730-160.850  81.990   0.141   1.550\n", 0.141, 1.55),
                ("gromacs", remarks + "ATOM      1  NA  NA      1       0.000   0.000   0.000  1.00  1.36           NA\n",
                 1, 1.36),
                ("channel", "".join(f"ATOM      1  H   FIL T   1       1.{i}47   3.772   1.026  1.00  1.15\n"
                                    for i in range(6)), 1, 1.15),
                ("-crlf", "ATOM 1 N ALA 1 0 0 0 -0.25 1.5 N\r\nTER\r\n", -0.25, 1.5)):
            with self.subTest(name=name):
                atoms = pb.read_molecule(self.add(f"{name}.pqr", text), PROGRAM).atoms
                self.assertEqual((atoms[0].charge, atoms[0].radius), (charge, radius))
        self.apbs("--", "-crlf.pqr", cwd=self.folder)

    def test_swapped_columns_and_further_text_are_refused(self):
        record = "ATOM      1  N   ALA     1       1.000   2.000   3.000"
        for name, text, message in (
                ("swapped", "REMARK  atom radii in columns 55-62\nREMARK  atom charges in columns 63-70\n"
                 f"{record}  1.5500  0.1410\n", "swapped.pqr:2: the remarks name the column of the radius before"),
                ("segment", f"{record} -0.3000 1.8500      PROA\n", 'segment.pqr:1: text "PROA" after the radius')):
            with self.subTest(name=name):
                self.assertIn(message, self.apbs(self.add(f"{name}.pqr", text), code=1).stderr)


class Errors(ApbsTest):
    def test_missing_apbs_is_an_error(self):
        (self.programs / "apbs").unlink()
        # A script of the same name in PATH is not APBS.
        for path in ((self.programs,), (SCRIPTS, self.programs)):
            done = self.apbs(self.ion, code=1, path=path)
            self.assertIn("apt-get install apbs", done.stderr)
        self.set_apbs(APBS)
        self.apbs(self.ion, path=(SCRIPTS, self.programs, os.defpath))

    def test_failure_of_apbs_is_an_error(self):
        self.set_apbs("echo 'Fatal error while reading from x.dx'; exit 13\n")
        done = self.apbs(self.ion, code=1)
        self.assertIn("exit code 13", done.stderr)
        self.assertIn("Fatal error while reading from x.dx", done.stderr)

    def test_crash_of_apbs_is_an_error(self):
        self.set_apbs("kill -SEGV $$\n")
        self.assertIn("APBS fails", self.apbs(self.ion, code=1).stderr)

    def test_energies_that_are_not_numbers_are_an_error(self):
        for value in ("nan", "-nan", "inf", "-INF"):
            self.set_apbs(APBS.replace("%.12E", value))
            self.assertIn("molecule1-eses-blocks", self.apbs(self.ion, code=1).stderr)

    def test_missing_energies_are_an_error(self):
        self.set_apbs(APBS.replace("elec name/", "elec name molecule1-e/"))
        self.assertIn("molecule1-reference", self.apbs(self.ion, code=1).stderr)
        self.set_apbs("exit 0\n")
        self.assertIn("APBS fails", self.apbs(self.ion, code=1).stderr)

    def test_failure_of_the_program_is_an_error(self):
        self.program = write_program(self.folder / "failing", f"""case $1 in
  --version|pdb_to_xyzr) exec '{PROGRAM}' "$@" ;;
esac
echo "eses-blocks: error: $1:7: no good" >&2
exit 1
""")
        done = self.apbs(self.ion, code=1)
        self.assertEqual(done.stderr.splitlines()[-1], f"apbs: {self.ion}:7: no good")
        self.program = self.folder / "missing"
        self.assertIn("scripts/quickstart", self.apbs(self.ion, code=1).stderr)

    def test_warnings_of_the_program_are_shown(self):
        body = ESES + 'echo "eses-blocks: warning: $1: doubtful" >&2\n'
        self.program = write_program(self.folder / "warning", body)
        self.assertIn(f"apbs: warning: {self.ion}: doubtful\n", self.apbs(self.ion).stderr)

    def test_files_that_are_not_a_complex_are_refused(self):
        """Complex and parts differ in the number, position, charge or radius of an atom."""
        _, ion, other = self.add_complex()
        for text, words in ((ION, "1 atom is not in"), (ION + OTHER + OTHER, "1 atom is in none"),
                            (ION + OTHER.replace("8.000", "8.002"), "the first at 8.002 1 2"),
                            (ION + OTHER.replace("-1.0000", "-0.9000"), "charge -0.9"),
                            (ION + OTHER.replace("2.0000", "2.1000"), "radius 2.1")):
            with self.subTest(text=text):
                whole = self.add("whole.pqr", text)
                self.assertIn(words, self.apbs(whole, ion, other, code=1).stderr)
        # Atoms with different numbers of decimals are equal.
        self.apbs(self.add("whole.pqr", ION + OTHER.replace("8.000", "8.00000")), ion, other)

    def test_a_complex_is_not_its_own_part(self):
        link = self.folder / "link.pqr"
        link.symlink_to(self.ion)
        hard = self.folder / "hard.pqr"
        os.link(self.ion, hard)
        for part in (self.ion, link, hard, self.temporary / ".." / self.ion.name):
            said = self.apbs(self.ion, part, code=1).stderr
            self.assertIn(f"{part} is the same file as the complex, {self.ion}", said)
        # A copy is another file.
        self.apbs(self.ion, self.add("copy.pqr", ION))

    def test_pdb_files_are_refused_by_name(self):
        """The columns of a PDB file may run together, be blank or hold names, such as those of
        elements and segments."""
        start = "ATOM      1  N   ALA A   1       1.000   2.000   3.000"
        for name, rest in (("joined", "  1.00100.00           N"), ("short", ""),
                           ("usual", "  1.00 20.00           N  "), ("blank", " " * 20 + "  N "),
                           ("segment", "  1.00 20.00      PROA"), ("zero", "  0.00  0.00"),
                           ("charge", "  0.50 20.00           N1+")):
            with self.subTest(name=name):
                path = self.add(f"{name}.pdb", "HEADER    PROTEIN\n" + f"{start}{rest}\n" * 3)
                said = self.apbs(path, code=1).stderr
                self.assertIn(f"{path}: this is a PDB file", said)
                self.assertIn("make a PQR file of it with pdb2pqr", said)
        # A damaged PQR file is no PDB file.
        damaged = self.add("damaged.pqr", f"{start}  0.1000 1.5000\n" * 3 + f"{start}  0.1O00 1.5\n")
        self.assertIn("damaged.pqr:4: field 10 (charge): expected a number", self.apbs(damaged, code=1).stderr)

    def test_unusable_files_and_folders_are_refused(self):
        self.assertIn("missing.pqr", self.apbs(self.folder / "missing.pqr", code=1).stderr)
        self.assertIn("no ATOM or HETATM records", self.apbs(DATA / "c60.xyzr", code=1).stderr)
        broken = self.add("broken.pqr", ION.replace("1.0000", "x"))
        self.assertIn("broken.pqr:1: field 9 (charge): expected a number", self.apbs(broken, code=1).stderr)
        taken = self.add("taken", "")
        self.assertIn("taken", self.apbs(self.ion, "--keep", taken, code=1).stderr)

    def test_invalid_options_are_refused(self):
        for arguments in (("--spacing", "0"), ("--spacing", "nan"), ("--padding", "-1"),
                          ("--grid-center", "1,2"), ("--grid-center", "1,2,x"),
                          ("--solute-dielectric", "0"), ("--solvent-dielectric", "-1"),
                          ("--ionic-strength", "-0.1"), ("--probe-radius", "0"),
                          ("--ion-radius", "inf"), ("--bcfl", "map"), ("--chgm", "spl1"),
                          ("--equation", "npbe"), ("--ion=1,0.1",), ("--ion=0,1", "--ion=1,0"),
                          ("--ion=1,0.1", "--ion=-1,0.1", "--ionic-strength", "1"), ("--ion", "1"),
                          ("--coarse-spacing", "1"), ("--coarse-padding", "6"),
                          ("--coarse-padding", "9", "--coarse-spacing", "0.5"),
                          ("--coarse-padding", "9", "--ionic-strength", "1", "--equation", "npbe"),
                          ("--write-potential", "a.txt"), ("--json", "--csv"), ("--unknown",)):
            with self.subTest(arguments=arguments):
                done = self.apbs(self.ion, *arguments, code=2)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.apbs(code=2)


class Interrupted(ApbsTest):
    def check_signal(self, number, code):
        started = self.folder / "started"
        self.set_apbs(f"echo $$ >'{started}.part'; mv '{started}.part' '{started}'\n"
                      "exec sleep 3600\n")
        with subprocess.Popen(command("apbs", self.ion, "--program", self.program),
                              env=self.environment(), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True,
                              preexec_fn=forget_signals) as process:
            end = time.monotonic() + PATIENCE
            while not started.exists():
                self.assertIsNone(process.poll(), "ended before APBS started")
                self.assertLess(time.monotonic(), end)
                time.sleep(0.02)
            process.send_signal(number)
            output, errors = process.communicate(timeout=PATIENCE)
        self.assertEqual((process.returncode, output), (code, ""))
        self.assertNotIn("Traceback", errors)
        self.assertEqual(list(self.temporary.iterdir()), [])
        end = time.monotonic() + PATIENCE
        with self.assertRaises(ProcessLookupError):
            while time.monotonic() < end:
                os.kill(int(started.read_text()), 0)
                time.sleep(0.02)

    def test_ctrl_c_ends_apbs_and_removes_files(self):
        self.check_signal(signal.SIGINT, 130)

    def test_sigterm_ends_apbs_and_removes_files(self):
        self.check_signal(signal.SIGTERM, 143)
