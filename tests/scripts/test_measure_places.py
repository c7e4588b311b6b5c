"""Tests of `measure` with models, reported atoms and places, and of `interface` with several files. The molecules are
small and made here."""

import csv
import io
import json
import math
import subprocess
import unittest

from support import DATA, PROGRAM, TestCase

ALANINE = (("N", 0, 0, 0), ("CA", 1.5, 0, 0), ("C", 2, 1.4, 0), ("O", 1.3, 2.4, 0.3), ("CB", 2, -0.8, 1.2))


def atom_line(number, name, residue, chain, residue_number, place, record="ATOM"):
    x, y, z = place
    return (f"{record:<6}{number:5}  {name:<3} {residue} {chain}{residue_number:4}    {x:8.3f}{y:8.3f}{z:8.3f}"
            f"  1.00  0.00          {name[0]:>2}\n")


def peptide(shift=0.0):
    """Six alanines of two chains along a line."""
    lines = []
    for residue in range(6):
        for name, x, y, z in ALANINE:
            place = (x + 3.8 * residue + shift * (residue % 2), y, z)
            lines.append(atom_line(len(lines) + 1, name, "ALA", "AB"[residue // 3], residue + 1, place))
    return "".join(lines)


def cup(depth):
    """A pit in a block of atoms, with a ligand at its bottom."""
    lines, count = [], 0
    for x in range(-4, 5):
        for y in range(-4, 5):
            for z in range(5):
                if abs(x) <= 1 and abs(y) <= 1 and z >= 5 - depth:
                    continue
                count += 1
                lines.append(atom_line(count, "CA", "GLY", "A", count, (2.5 * x, 2.5 * y, 2.5 * z)))
    lines.append(atom_line(count + 1, "C1", "LIG", "A", 999, (0, 0, 2.5 * (5 - depth) + 1), "HETATM"))
    return "".join(lines)


class Case(TestCase):
    def file(self, name, text):
        path = self.folder / name
        path.write_text(text, encoding="ascii")
        return str(path)

    def call(self, *arguments, code=0):
        done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
        if code == 0 and "this build reads xyzr and PQR" in done.stderr:
            raise unittest.SkipTest("this build has no gemmi")
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def json(self, *arguments):
        return [json.loads(line) for line in self.call(*arguments, "--json", "-q").stdout.splitlines()]

    def rows(self, path):
        with open(path, encoding="utf-8", newline="") as table:
            return list(csv.DictReader(table))


class Models(Case):
    def setUp(self):
        super().setUp()
        self.path = self.file("nmr.pdb", "".join(f"MODEL     {number:4}\n{peptide(0.1 * number)}ENDMDL\n"
                                                 for number in (1, 2, 7)))

    def test_each_model_has_a_result(self):
        found = self.json("measure", self.path, "--model", "all")
        self.assertEqual([each["model"] for each in found], [1, 2, 7])
        for each in found:
            one, = self.json("measure", self.path, "--model", each["model"])
            self.assertEqual(one["ses_area"], each["ses_area"])
        self.assertEqual(len({each["ses_area"] for each in found}), 3)
        lines = self.call("measure", self.path, "--model", "all").stdout.splitlines()
        self.assertTrue(lines[0].endswith(" file, model"))
        self.assertTrue(lines[3].endswith("nmr.pdb, 7"))

    def test_tables_have_models(self):
        table = self.folder / "all.csv"
        missing = str(self.folder / "missing.pdb")
        done = self.call("measure", self.path, missing, "--model", "all", "--csv", table, "--write", "residues",
                         "-o", self.folder / "out", code=1)
        self.assertNotIn("(model 0)", done.stderr)
        rows = self.rows(table)
        self.assertEqual([row["model"] for row in rows], ["1", "2", "7", ""])
        self.assertEqual([row["radii"] for row in rows], ["protor"] * 3 + [""])
        self.assertIn("missing.pdb", rows[3]["error"])
        self.assertEqual(sorted(path.name for path in (self.folder / "out").iterdir()),
                         [f"nmr.model{number}.residues.csv" for number in (1, 2, 7)])

    def test_interfaces_of_each_model(self):
        """Results of a model are those of --model N, in all outputs."""
        table, out = self.folder / "all.csv", self.folder / "out"
        missing = str(self.folder / "missing.pdb")
        written = ("--csv", table, "--write", "interfaces,pdb", "-o", out)
        done = self.call("interface", self.path, missing, "--model", "all", *written, code=1)
        self.assertEqual(done.stdout.count(" (3 models)"), 3)
        self.assertNotIn("(model 0)", done.stderr)
        rows = self.rows(table)
        self.assertEqual([row["model"] for row in rows], ["1", "2", "7", ""])
        self.assertIn("missing.pdb", rows[3]["error"])
        names = [f"nmr.model{number}.interface{ending}" for number in (1, 2, 7) for ending in ("s.csv", ".areas.pdb")]
        self.assertEqual(sorted(path.name for path in out.iterdir()), sorted(names))
        printed = self.call("interface", self.path, "--model", "all", "--table", "residues").stdout
        residues = list(csv.DictReader(io.StringIO(printed)))
        found = self.json("interface", self.path, "--model", "all")
        self.assertEqual([each["model"] for each in found], [1, 2, 7])
        for number, row, each in zip((1, 2, 7), rows, found):
            one, = self.json("interface", self.path, "--model", number)
            self.assertEqual(one["interfaces"], each["interfaces"])
            self.assertAlmostEqual(float(row["sas_interface_area"]), one["interfaces"][0]["sas"]["interface_area"], 5)
            text = self.call("interface", self.path, "--model", number, "--table", "residues").stdout
            self.assertEqual([{**each, "file": self.path, "model": str(number)} for each in csv.DictReader(io.StringIO(text))],
                             [each for each in residues if each["model"] == str(number)])
            for ending, name in (("s.csv", "interfaces"), (".areas.pdb", "pdb")):
                self.assertEqual(self.call("interface", self.path, "--model", number, "--table", name).stdout,
                                 (out / f"nmr.model{number}.interface{ending}").read_text())
        self.assertEqual(len({row["sas_interface_area"] for row in rows}), 4)
        done = self.call("interface", self.path, "--model", "all", "--area-cutoff", "1e6", "--csv", "-")
        self.assertEqual(done.stdout.count("\n"), 1)

    def test_errors(self):
        for command in ("measure", "interface"):
            done = self.call(command, "-", "--format", "pdb", "--model", "all", code=2)
            self.assertIn("give its name", done.stderr)
            done = self.call(command, self.path, "--model", "x", code=2)
            self.assertIn("expected all, or a whole number", done.stderr)
            self.assertIn("is read as PQR", self.call(command, DATA / "fas2.pqr", "--model", "all", code=2).stderr)
        self.assertIn("a single file or model; use --write",
                      self.call("interface", self.path, "--model", "all", "--table", "pdb", code=2).stderr)
        self.assertIn("prints the table of a single file or model; use --write atoms",
                      self.call("measure", self.path, "--model", "all", "--table", "atoms", code=2).stderr)

    def test_left_out_atoms_are_counted(self):
        path = self.file("b.pdb", peptide() + atom_line(31, "O", "HOH", "A", 99, (40, 0, 0), "HETATM"))
        table = self.folder / "one.csv"
        self.call("measure", path, DATA / "c60.xyzr", "--csv", table)
        self.assertEqual([(row["left_out"], row["radii"]) for row in self.rows(table)], [("1", "protor"), ("", "")])


class Reports(Case):
    def test_areas_are_those_of_the_atoms_in_the_molecule(self):
        path = self.file("a.pdb", peptide())
        atoms = list(csv.DictReader(io.StringIO(self.call("measure", path, "--table", "atoms").stdout)))
        found, = self.json("measure", path, "--report", "//A/2", "--report", "B")
        for report, chosen in zip(found["reports"], ([a for a in atoms if a["residue_number"] == "2"],
                                                     [a for a in atoms if a["chain"] == "B"])):
            self.assertEqual(report["atoms"], len(chosen))
            for area in ("ses_area", "sas_area"):
                self.assertAlmostEqual(report[area], sum(float(a[area]) for a in chosen), 4)
            self.assertAlmostEqual(report["polar_sas_area"] + report["apolar_sas_area"], report["sas_area"], 9)
        self.assertAlmostEqual(found["reports"][0]["relative_sas_area"], found["reports"][0]["sas_area"] / 129, 9)
        self.assertIsNone(found["reports"][1]["relative_sas_area"])
        self.assertEqual(found["reports"][0]["residues"], ["A:ALA 2"])
        whole, = self.json("measure", path)
        self.assertEqual(found["ses_area"], whole["ses_area"])

    def test_tables_have_the_reported_atoms(self):
        path = self.file("a.pdb", peptide())
        rows = list(csv.DictReader(io.StringIO(
            self.call("measure", path, "--report", "//A/2", "--report", "//A/1-2", "--table", "atoms").stdout)))
        self.assertEqual([row["serial"] for row in rows], [str(number) for number in range(1, 11)])
        table = self.folder / "r.csv"
        self.call("measure", path, path, "--report", "B", "--csv", table)
        self.assertGreater(float(self.rows(table)[1]["sas_area of B"]), 0)

    def test_names_are_those_of_the_option(self):
        path = self.file("a.pdb", peptide())
        texts = ["ligand:ALA", "ligand:B/5", "A+B", "//A/2"]
        reports = [argument for text in texts for argument in ("--report", text)]
        found, = self.json("measure", path, *reports)
        self.assertEqual([each["name"] for each in found["reports"]], texts)
        lines = self.call("measure", path, *reports).stdout
        for text in texts:
            self.assertIn(f"report {text}: ", lines)
        heading = self.call("measure", path, path, *reports, "--csv", "-").stdout.splitlines()[0]
        for text in texts:
            self.assertIn(f",sas_area of {text},", heading)

    def test_errors(self):
        path = self.file("a.pdb", peptide())
        self.assertIn("C", self.call("measure", path, "--report", "C", code=1).stderr)
        number, name = self.json("measure", path, "--report", "5", "--report", "//B/5")[0]["reports"]
        self.assertEqual([number["atoms"], number["sas_area"]], [name["atoms"], name["sas_area"]])
        for text in ("B:5", "resid 5", "ALA 5", "ALA5", "B:ALA 5", ":5"):
            done = self.call("measure", path, "--report", text, code=1)
            self.assertTrue(done.stderr.endswith("; residue 5 is //B/5\n"), done.stderr)
        for text in ("ALA", "ala"):
            done = self.call("measure", path, "--report", text, code=1)
            self.assertTrue(done.stderr.endswith("; residue ALA is ligand:ALA\n"), done.stderr)
        done = self.call("measure", path, "--report", "ligand", code=1)
        self.assertIn("there are no ligands, which --report names; they are residues of several atoms", done.stderr)
        self.call("measure", path, "--report", "A", "--parts", "chains", code=2)
        self.call("measure", DATA / "c60.xyzr", "--report", "A", code=2)


    def test_few_residues_have_areas_of_their_own(self):
        path = self.file("two.pdb", peptide())
        table = list(csv.DictReader(io.StringIO(self.call("measure", path, "--table", "residues").stdout)))
        lines = self.call("measure", path, "--report", "2-4").stdout.splitlines()
        at = next(i for i, line in enumerate(lines) if line.startswith("report 2-4: "))
        self.assertEqual(lines[at + 1:], [
            f"  {row['chain']}:ALA {row['residue_number']}: SAS area {float(row['sas_area']):.4f}, "
            f"relative SAS area {float(row['relative_sas_area']):.4f}" for row in table[1:4]])
        long = self.file("long.pdb", "".join(atom_line(i, "CA", "ALA", "A", i, (3.8 * i, 0, 0)) for i in range(1, 13)))
        for report, count in (("1-10", 10), ("1-11", 0), ("7", 0)):
            lines = self.call("measure", long, "--report", report).stdout.splitlines()
            self.assertEqual(sum(line.startswith("  A:ALA ") for line in lines), count)
        self.assertNotIn("  A:ALA", self.call("measure", long, "--report", "1-3", "--surface", "ses").stdout)

    def test_rows_in_the_same_line_are_atoms_of_their_own(self):
        columns = ("group_PDB id type_symbol label_atom_id label_alt_id label_comp_id label_asym_id label_entity_id label_seq_id "
                   "Cartn_x Cartn_y Cartn_z auth_seq_id auth_asym_id").split()
        path = self.file("rows.cif", "data_x\nloop_\n" + "".join(f"_atom_site.{name}\n" for name in columns) +
                         "ATOM 1 N N . ALA A 1 1 0 0 0 1 A ATOM 2 N N . GLY A 1 2 9 0 0 2 A\n"
                         "ATOM 3 C CA . ALA A 1 1 1.5 0 0 1 A\nATOM 4 C CA . GLY A 1 2 10.5 0 0 2 A\n")
        found, = self.json("measure", path, "--report", "//A/1")
        report, = found["reports"]
        self.assertEqual(report["atoms"], 2)
        alone, = self.json("measure", path, "--select", "//A/1")
        self.assertAlmostEqual(report["sas_area"], alone["sas_area"])

    def test_errors_name_the_option(self):
        path = self.file("a.pdb", peptide())
        self.call("measure", path)
        done = self.call("measure", path, "--report", "/2/A", code=1)
        self.assertIn("the selection names model 2, but model 1 is read; use --model 2 (--report /2/A)", done.stderr)
        self.assertNotIn("--select", done.stderr)
        done = self.call("interface", path, "--ligand", "//A[", code=1)
        self.assertTrue(done.stderr.endswith(" (--ligand //A[)\n"), done.stderr)
        self.assertNotIn("--select", done.stderr)
        pqr = self.file("a.pqr", "ATOM 1 N ALA 1 5 0 0 0.4 1.5\n")
        done = self.call("measure", pqr, "--report", "//A[", code=1)
        self.assertTrue(done.stderr.endswith(" (--report //A[)\n"), done.stderr)
        done = self.call("measure", pqr, "--select", "A", code=2)
        self.assertIn("; --report takes atoms of PQR files", done.stderr)
        done = self.call("interface", self.file("odd.txt", "hello"), code=2)
        self.assertIn("(use --format pqr, pdb or mmcif if it is such a file)", done.stderr)

    def test_csv_may_be_the_null_device_or_in_a_new_directory(self):
        for command, path in (("measure", DATA / "c60.xyzr"), ("interface", self.file("a.pqr", "ATOM 1 N ALA 1 5 0 0 0.4 1.5\n"))):
            with self.subTest(command=command):
                self.assertEqual(self.call(command, path, "--csv", "/dev/null").stdout, self.call(command, path).stdout)
                table = self.folder / command / "new" / "x.csv"
                done = self.call(command, path, "--csv", table)
                self.assertIn(f"note: created the directory {table.parent} of --csv\n", done.stderr)
                self.assertEqual(self.call(command, path, "--csv", table).stderr, "")
                self.assertTrue(table.is_file())

    def test_waters_of_pqr_files_are_counted(self):
        path = self.file("w.pqr", "ATOM 1 N ALA 1 5 0 0 0.4 1.5\nATOM 2 O WAT 2 0 0 0 -0.8 1.6\n")
        for command in ("measure", "interface"):
            self.assertIn("\nread: 2 atoms; 1 of water, which pdb2pqr leaves out", self.call(command, path).stdout)
        self.assertNotIn("water", self.call("measure", DATA / "fas2.pqr").stdout)


class Places(Case):
    def test_pocket_of_a_ligand(self):
        path = self.file("cup.pdb", cup(3))
        found, = self.json("measure", path, "--pockets", "--at", "ligand:LIG", "--large-probe", "6")
        self.assertEqual(found["at"]["left_out_atoms"], 1)
        self.assertEqual(found["atoms"], cup(3).count("ATOM  "))
        pocket, = found["pockets"]
        self.assertGreater(pocket["volume"], 50)
        self.assertGreater(pocket["volume_at_place"], 5)
        self.assertEqual(pocket["mouths"], 1)
        row, = csv.DictReader(io.StringIO(self.call("measure", path, "--pockets", "--at", "ligand:LIG", "--large-probe", "6",
                                                    "--csv", "-").stdout))
        self.assertAlmostEqual(float(row["pocket_volume"]), pocket["volume"], delta=1e-3)
        self.assertAlmostEqual(float(row["volume_at_place"]), pocket["volume_at_place"], delta=1e-3)
        for axis in range(2):  # the pit is symmetric, the grid is not
            self.assertAlmostEqual(pocket["centroid"][axis], 0, delta=0.3)
        for low, middle, high in zip(pocket["low"], pocket["centroid"], pocket["high"]):
            self.assertLess(low, middle)
            self.assertLess(middle, high)
        self.assertGreater(pocket["depth"], 1)
        deeper, = self.json("measure", self.file("deep.pdb", cup(4)), "--pockets", "--at", "ligand:LIG", "--probe-out", "6")
        self.assertAlmostEqual(deeper["pockets"][0]["depth"] - pocket["depth"], 2.5, delta=0.5)
        alone, = self.json("measure", path, "--pockets", "--select", "(!LIG)", "--large-probe", "6")
        self.assertIn(pocket["volume"], [each["volume"] for each in alone["pockets"]])
        for text in ("ligand:A/999", "ligand:A/LIG", "ligand://A/999", "ligand:(LIG)"):
            other, = self.json("measure", path, "--pockets", "--at", text, "--large-probe", "6")
            self.assertEqual(other["pockets"], found["pockets"])
        text = self.call("measure", path, "--pockets", "--at", "ligand:LIG", "--large-probe", "6").stdout
        self.assertIn("left out: 1 atom of ligand:LIG\n", text)
        self.assertIn("pocket 1: centre ", text)

    def test_tables_have_the_values_of_json(self):
        path = self.file("cup.pdb", cup(3))
        arguments = ("measure", path, "--at", "ligand:LIG", "--large-probe", "6")
        found, = self.json(*arguments, "--pockets")
        row, = csv.DictReader(io.StringIO(self.call(*arguments, "--table", "pockets").stdout))
        pocket, = found["pockets"]
        for name in ("depth", "volume_at_place", "volume"):
            self.assertEqual(row[name], f"{pocket[name]:.6f}")
        for name in ("low", "high", "centroid"):
            self.assertEqual([row[f"{name}_{axis}"] for axis in "xyz"], [f"{value:.6f}" for value in pocket[name]])

    def test_empty_tables_have_a_reason(self):
        path = self.file("cup.pdb", cup(3))
        nothing = ("--min-pocket-volume", 1e6, "--large-probe", "6")
        for arguments, reason in ((("--table", "pockets", *nothing), "no pocket has the volume of --min-pocket-volume: "),
                                  (("--table", "pockets", "--at", "0,0,30", *nothing),
                                   "no pocket at the place: it is far from all atoms\n"),
                                  (("--table", "cavities", "--probe-radius", "5"),
                                   "no cavity holds a probe of 5 angstrom\n")):
            done = self.call("measure", path, *arguments)
            self.assertEqual(done.stdout.count("\n"), 1)
            self.assertIn(f"note: {path}: {reason}", done.stderr)
            self.assertEqual(self.call("measure", path, *arguments, "-q").stderr, "")
        done = self.call("measure", path, "--write", "pockets", "-o", self.folder, *nothing)
        self.assertIn("no pocket has the volume of --min-pocket-volume", done.stderr)
        self.assertNotIn("no pocket", self.call("measure", path, "--table", "pockets", "--large-probe", "6").stderr)

    def test_the_same_pocket_at_a_point_a_box_and_atoms(self):
        path = self.file("cup.pdb", cup(3))
        at = [self.json("measure", path, "--select", "(!LIG)", "--pockets", "--large-probe", "6", "--at", place)[0]
              for place in ("0,0,6.5", "-1,-1,5,1,1,8")]
        volumes = {each["pockets"][0]["volume"] for each in at}
        self.assertEqual(len(volumes), 1)
        self.assertEqual([len(each["pockets"]) for each in at], [1, 1])
        by_atoms = self.json("measure", path, "--pockets", "--large-probe", "6", "--at", "ligand:GLY")
        self.assertEqual(by_atoms[0]["at"]["left_out_atoms"], cup(3).count("GLY"))

    def test_reasons(self):
        path = self.file("cup.pdb", cup(3))
        for place, reason in (("0,0,30", "far from all atoms"), ("7.5,7.5,5", "are in atoms, or in cavities"),
                              ("0,0,6.5", "are below --min-pocket-volume")):
            text = self.call("measure", path, "--select", "(!LIG)", "--pockets", "--large-probe", "6",
                             "--min-pocket-volume", 1e6, "--at", place).stdout
            self.assertIn("0 pockets at ", text)
            self.assertIn(reason, text)

    def test_cavities(self):
        every, = self.json("measure", DATA / "1ubq.xyzr", "--cavities")
        for number, cavity in enumerate(every["cavities"], 1):
            place = ",".join(str(value) for value in cavity["largest_probe_center"])
            found, = self.json("measure", DATA / "1ubq.xyzr", "--cavities", "--at", place)
            self.assertIn(number, found["at"]["cavities"])
            self.assertEqual(found["cavities"], [every["cavities"][one - 1] for one in found["at"]["cavities"]])
            table = self.call("measure", DATA / "1ubq.xyzr", "--table", "cavities", "--at", place).stdout
            self.assertEqual([int(row["cavity"]) for row in csv.DictReader(io.StringIO(table))], found["at"]["cavities"])
        text = self.call("measure", DATA / "1ubq.xyzr", "--cavities", "--at", "0,0,0").stdout
        self.assertIn("no cavity has a probe centre at the place; all 3 are elsewhere", text)
        text = self.call("measure", DATA / "1ubq.xyzr", "--cavities").stdout
        self.assertIn("  {:.3f},{:.3f},{:.3f} ".format(*every["cavities"][0]["centroid"]), text)

    def test_errors(self):
        for arguments in (["--at", "1,2,3"], ["--pockets", "--at", "1,2,3,0,0,0"], ["--pockets", "--at", "A"]):
            self.call("measure", DATA / "c60.xyzr", *arguments, code=2)
        path = self.file("a.pdb", peptide())
        for text in ("10,20", "10 20 30", "nan,0,0", "1,2,inf", "1,2,3,4", "1,2,3,0,0,0", "1,2,3,4,5,nan"):
            done = self.call("measure", path, "--pockets", "--at", text, code=2)
            self.assertIn(f"--at is '{text}', expected three numbers X,Y,Z, six X0,Y0,Z0,X1,Y1,Z1", done.stderr)


class Ligands(Case):
    """The same texts for each option that takes parts."""

    def options(self, text):
        return (("measure", "--select", text), ("measure", "--report", text), ("measure", "--pockets", "--at", text),
                ("measure", "--parts", f"A|{text}"), ("interface", "--groups", "A", text), ("interface", "--ligand", text))

    def test_ligands_of_a_blank_chain(self):
        path = self.file("blank.pdb", peptide() + atom_line(31, "C1", "LIG", " ", 401, (2, 3.5, 2), "HETATM"))
        for command, *arguments in self.options("ligand:/401"):
            named, = self.json(command, path, *arguments[:-1], arguments[-1].replace("/401", "LIG"))
            found, = self.json(command, path, *arguments)
            for each in (named, found):  # the text itself
                for key in ("reports", "at", "parts"):
                    each.pop(key, None)
                for interface in each.get("interfaces", []):
                    for side in ("first", "second"):
                        interface[side].pop("name")
            self.assertEqual(found, named)
        done = self.call("interface", path, "--ligand", "401", code=1)
        self.assertTrue(done.stderr.endswith("; residue 401 is ligand:/401\n"), done.stderr)
        done = self.call("measure", path, "--report", "A:401", code=1)
        self.assertTrue(done.stderr.endswith("; residue 401 is ligand:/401\n"), done.stderr)
        self.call("interface", path, "--ligand", "/401")

    def test_waters_that_are_left_out(self):
        path = self.file("w.pdb", peptide() + atom_line(31, "O", "HOH", "A", 401, (2, 3.5, 2), "HETATM"))
        for text in ("ligand:HOH", "ligand:A/HOH"):
            for command, *arguments in self.options(text):
                self.assertIn("(--waters keeps them)", self.call(command, path, *arguments, code=1).stderr)
                self.call(command, path, *arguments, "--waters")

    def test_a_ligand_without_a_name(self):
        path = self.file("a.pdb", peptide())
        for command, *arguments in self.options("ligand:"):
            self.assertIn("ligand:', expected ", self.call(command, path, *arguments, code=2).stderr)

    def test_a_chain_that_is_a_ligand(self):
        path = self.file("only.pdb", peptide().replace(" A ", " P ") +
                         atom_line(31, "C1", "LIG", "A", 401, (2, 3.5, 2), "HETATM"))
        for command, option, *parts in (("measure", "--parts", "A|ligand:LIG"), ("measure", "--parts", "ligand:LIG|P|A"),
                                        ("interface", "--groups", "A", "ligand:LIG")):
            done = self.call(command, path, option, *parts, code=1)
            self.assertIn(f"{path}: part A of {option} is empty: all its atoms belong to ligand:LIG\n", done.stderr)

    def test_numbers_that_name_nothing(self):
        path = self.file("a.pdb", peptide())
        for text in ("57", "57-60"):
            done = self.call("measure", path, "--report", text, code=1)
            self.assertIn(f"no atoms of chain or residue {text}, which --report names; the chains are A (residues 1 to 3), "
                          "B (residues 4 to 6)\n", done.stderr)

    def test_chains_with_numbers_are_places(self):
        path = self.file("numbers.pdb", cup(3).replace("GLY A", "GLY 1").replace("LIG A", "LIG 2"))
        found, = self.json("measure", path, "--cavities", "--at", "1+2")
        self.assertEqual(found["at"]["place"], "1+2")
        self.call("measure", path, "--cavities", "--at", "1,2", code=2)


class Interfaces(Case):
    def test_written_tables(self):
        path, out = self.file("a.pdb", peptide()), self.folder / "out"
        names = ["interfaces.csv", "interface.residues.csv", "interface.atoms.csv", "interface.areas.pdb", "interface.areas.cif"]
        text = self.call("interface", path, "--write", "cif,pdb,atoms,residues,interfaces", "-o", out).stdout
        self.assertEqual(text.splitlines()[-1], "written: " + ", ".join(f"{out}/a.{name}" for name in names))
        for name, table in zip(names, ("interfaces", "residues", "atoms", "pdb", "cif")):
            self.assertEqual((out / f"a.{name}").read_text(), self.call("interface", path, "--table", table).stdout)
        interface = next(csv.DictReader(io.StringIO((out / "a.interfaces.csv").read_text())))
        lost = float(interface["sas_lost_by_first"]) + float(interface["sas_lost_by_second"])
        self.assertGreater(lost, 1)
        lines = (out / "a.interface.areas.pdb").read_text().splitlines()
        atoms = [line for line in lines if line.startswith(("ATOM", "HETATM"))]
        self.assertAlmostEqual(sum(float(line[60:66]) for line in atoms), lost, delta=0.006 * len(atoms))
        done = self.call("measure", out, code=1)  # has only files of areas
        self.assertIn("besides 2 files of areas that --write has written", done.stderr)

    def test_ligands(self):
        path = self.file("a.pdb", peptide() + atom_line(31, "C1", "LIG", "B", 401, (2, 3.5, 2), "HETATM"))
        found, = self.json("interface", path, "--ligand", "LIG")
        self.assertEqual(len(found["interfaces"]), 1)
        two = self.file("two.pdb", peptide() + "".join(
            atom_line(31 + i, f"C{i}", "LIG", "B", 401, (2 + 1.4 * i, 3.5, 2), "HETATM") for i in range(2)))
        self.assertEqual(self.json("interface", two, "--ligand", "ligand"), self.json("interface", two, "--ligand", "LIG"))
        for text in ("B/401", "B/LIG", "//B/401", "(LIG)", "ligand:LIG", "ligand:B/401", "ligand:(LIG)"):
            self.assertEqual(self.json("interface", path, "--ligand", text), [found])
        each, = self.json("interface", path, "--ligand", "//A")
        self.assertEqual({interface["first"]["name"] for interface in each["interfaces"]},
                         {f"A:ALA {i}" for i in (1, 2, 3)})
        for text, advice in (("lig", "no atoms of residue lig, which --ligand names; the residues are LIG, ALA; did you "
                              "mean LIG?"), ("401", "; residue 401 is ligand:B/401"),
                             ("A/401", "no atoms of ligand A/401, which --ligand names; the ligands are B/401 (LIG); did you mean "
                              "B/401?"),
                             ("A/lig", "the ligands are B/401 (LIG); did you mean B/LIG?"),
                             ("ligand:lig", "; did you mean LIG?"), ("(EDO)", "no atoms of (EDO), which --ligand names; the chains are A (residues 1 to 3), B (residues 4 to "
                              "401)")):
            done = self.call("interface", path, "--ligand", text, code=1)
            self.assertTrue(done.stderr.endswith(f"{advice}\n"), done.stderr)

    def test_files_of_folders_that_an_option_does_not_apply_to(self):
        folder, table = self.folder / "mixed", self.folder / "all.csv"
        folder.mkdir()
        (folder / "a.pdb").write_text(peptide(), encoding="ascii")
        (folder / "a.xyzr").write_text("0 0 0 1.5\n", encoding="ascii")
        names = self.file("names.txt", f"{folder}/a.pdb\n{folder}/a.xyzr\n")
        for command, *options in (("interface",), ("measure", "--radii", "bondi"), ("measure", "--report", "A"),
                                  ("measure", "--model", "all"), ("measure", "--write", "residues", "-o", self.folder / "out")):
            for files in ([folder], ["--files-from", names]):
                done = self.call(command, *files, *options, "--csv", table, code=1)
                good, bad = self.rows(table)
                self.assertEqual(good["error"], "")
                self.assertIn("a.xyzr is read as xyzr", bad["error"])
                self.assertEqual(done.stderr.count(f"error: {bad['error']}\n"), 1)
            table.unlink()
            self.call(command, folder, folder / "a.xyzr", *options, "--csv", table, code=2)
            self.assertFalse(table.exists())

    def test_empty_tables_have_a_reason(self):
        path = self.file("far.pdb", peptide() + atom_line(31, "C1", "LIG", "C", 401, (90, 0, 0), "HETATM"))
        for arguments, reason in ((["--groups", "A", "C"], "the two sides do not touch each other"),
                                  (["--ligand", "LIG"], "the ligand touches no other atoms"),
                                  (["--area-cutoff", "999"], "no interface has 999 A^2, the area of --area-cutoff"),
                                  (["--chains", "A"], "the file has a single chain; --ligand NAME, --groups and "
                                   "--assembly ID choose other sides"),
                                  (["--chains", "A,C"], "no chains touch each other")):
            self.assertIn(f"\n{reason}\n", self.call("interface", path, *arguments).stdout)
            for table in (["--table", "residues"], ["--csv", "-"]):
                done = self.call("interface", path, *arguments, *table)
                self.assertEqual(done.stdout.count("\n"), 1)
                self.assertIn(f"note: {path}: {reason}\n", done.stderr)
                self.assertEqual(self.call("interface", path, *arguments, *table, "-q").stderr, "")
        path = self.file("a.pdb", peptide())
        note = f"eses-blocks: note: {path}: no residue loses 500 A^2, the area of --residue-cutoff\n"
        for arguments, has_note in ((["--table", "residues"], True), (["--table", "atoms"], False),
                                    (["--write", "residues", "--csv", "-", "-o", self.folder], True)):
            done = self.call("interface", path, "--residue-cutoff", "500", *arguments)
            self.assertEqual(done.stderr, note if has_note else "")
            self.assertEqual(self.call("interface", path, "--residue-cutoff", "500", *arguments, "-q").stderr, "")

    def test_csv(self):
        path, missing, table = self.file("a.pdb", peptide()), str(self.folder / "no.pdb"), self.folder / "all.csv"
        self.call("interface", path, missing, "--csv", table, code=1)
        self.assertEqual(table.read_text(), self.call("interface", path, missing, "--csv", "-", code=1).stdout)
        first, failed = csv.DictReader(io.StringIO(table.read_text()))
        self.assertEqual((first["file"], first["error"], failed["file"]), (path, "", missing))
        self.assertIn("No such file", failed["error"])
        self.assertGreater(float(first["sas_interface_area"]), 0)
        for arguments in (["--csv", "-", "--json"], ["--csv", "-", "--table", "atoms"], [path, "--table", "pdb"], ["-o", "x"],
                          ["--write", "residue"]):
            self.call("interface", path, *arguments, code=2)
        self.call("interface", path, "--csv", path, code=1)  # would replace its input

    def test_a_missing_file_of_radii_is_reported_once(self):
        paths = [self.file("a.pdb", peptide()), self.file("b.pdb", peptide(0.2))]
        for command in ("interface", "measure"):
            error, = self.call(command, *paths, "--radii", self.folder / "no.radii", code=1).stderr.splitlines()
            self.assertIn("no.radii: No such file", error)

    def test_several_files(self):
        paths = [self.file("a.pdb", peptide()), self.file("b.pdb", peptide(0.2))]
        table = self.call("interface", *paths, "--table", "interfaces").stdout
        rows = list(csv.DictReader(io.StringIO(table)))
        self.assertEqual([row["file"] for row in rows], paths)
        for row, path in zip(rows, paths):
            one, = csv.DictReader(io.StringIO(self.call("interface", path, "--table", "interfaces").stdout))
            self.assertEqual(one, {key: value for key, value in row.items() if key != "file"})
        missing = str(self.folder / "missing.pdb")
        done = self.call("interface", missing, paths[0], "--json", code=1)
        failed, found = map(json.loads, done.stdout.splitlines())
        self.assertEqual(failed["file"], missing)
        self.assertTrue(math.isfinite(found["interfaces"][0]["sas"]["interface_area"]))
        folder = self.call("interface", self.folder, "--table", "residues").stdout
        self.assertTrue(folder.startswith("file,side,"))

    def test_files_with_errors_have_their_warnings(self):
        path = self.file("ca.pdb", "".join(atom_line(i, "CA", "ALA", "A", i, (3.8 * i, 0, 0)) for i in range(1, 6)))
        warning, error = self.call("interface", path, "--groups", "A", "Z", code=1).stderr.splitlines()
        self.assertIn(f"warning: {path}: 5 residues have a single atom", warning)
        self.assertIn(f"error: {path}: no atoms of chain Z", error)
        strict, = self.call("interface", path, "--groups", "A", "Z", "--strict", code=1).stderr.splitlines()
        self.assertEqual(strict, warning.replace("warning", "error"))

    def test_files_in_parallel_have_the_results_of_one_thread(self):
        paths = [self.file(f"{i}.pdb", peptide(0.05 * i)) for i in range(8)]
        paths.insert(3, str(self.folder / "missing.pdb"))
        one, many = (self.call("interface", *paths, "--threads", threads, "--csv", self.folder / f"{threads}.csv", code=1)
                     for threads in (1, 4))
        self.assertEqual((many.stdout, many.stderr), (one.stdout, one.stderr))
        self.assertEqual((self.folder / "4.csv").read_text(), (self.folder / "1.csv").read_text())
        self.assertEqual([row["file"] for row in self.rows(self.folder / "4.csv")], paths)


if __name__ == "__main__":
    unittest.main()
