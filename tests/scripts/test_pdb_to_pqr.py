"""Tests of scripts/lib/pdb_to_pqr.py: the input of PDB2PQR."""

import gzip
import pathlib
import tempfile
import unittest

from support import TestCase
from eses_tools import common
from eses_tools import mmcif
from eses_tools import pdb_to_pqr


def atom(name, residue="GLY", number=1, chain="A", element="", record="ATOM", place=(1, 2, 3)):
    """Returns a record in the columns of the format. Names are as in columns 13 to 16."""
    x, y, z = place
    return (f"{record:6}    1 {name:4} {residue:3} {chain}{number:4}    {x:8.3f}{y:8.3f}{z:8.3f}"
            f"  1.00  0.00          {element:>2}\n")


BACKBONE = (" N  ", " CA ", " C  ", " O  ")


def names(lines):
    return [line[12:16] if line.startswith("ATOM") else line.strip()
            for line in pdb_to_pqr.protein_lines(lines)]


class Cleaning(unittest.TestCase):
    def test_hetatm_and_other_records_are_removed(self):
        self.assertEqual(names(["HEADER\n", *map(atom, BACKBONE), "TER\n", "CONECT    1\n",
                                atom("ZN  ", "ZN ", 9, record="HETATM"), "END\n"]),
                         [*BACKBONE, "TER"])

    def test_records_in_small_letters_and_with_six_digits_are_kept(self):
        small = atom(" CA ", chain="a").lower()
        six = "ATOM 100000" + atom(" CA ")[11:]
        lines = list(pdb_to_pqr.protein_lines([small, six]))
        self.assertEqual([line[:6] + line[12:22] for line in lines], ["ATOM   CA  GLY a", "ATOM   CA  GLY A"])

    def test_water_in_atom_records_is_removed(self):
        self.assertEqual(names([atom(" CA "), atom(" O  ", "HOH", 2), atom(" OH2", "TIP", 3)]), [" CA "])

    def test_hydrogens_are_removed_by_element(self):
        lines = [atom(" CA ", element="C"), atom(" HA ", element="H"), atom(" DB ", element="D"),
                 atom("HG  ", element="HG"), atom(" H1 ", element="C")]
        self.assertEqual(names(lines), [" CA ", "HG  ", " H1 "])

    def test_hydrogens_without_element_are_removed_by_name(self):
        kept = [*BACKBONE, " NE ", " NH1", " OH ", " CH2", " CD1", " OD1", " SG "]
        gone = [" H  ", " HA ", "HG11", "1HG1", "2HB ", " D  ", "HH12", " H5'"]
        for element in ("", "12"):  # old files have the line number there
            lines = [atom(name, element=element) for name in (*kept, *gone)]
            self.assertEqual(names(lines), kept)

    def test_only_the_first_model_is_kept(self):
        model = [*map(atom, BACKBONE), "TER\n", "ENDMDL\n"]
        self.assertEqual(names(["MODEL        1\n", *model, "MODEL        2\n", *model]),
                         [*BACKBONE, "TER"])

    def test_lone_nitrogen_is_removed(self):
        full = [atom(name, number=1) for name in BACKBONE]
        lone = [atom(" N  ", number=2), atom(" H  ", number=2)]
        self.assertEqual(names([*full, *lone, "TER\n"]), [*BACKBONE, "TER"])

    def test_lone_nitrogen_is_removed_beside_a_residue_of_the_same_number(self):
        full = [atom(name, chain=" ") for name in BACKBONE]
        lone = [atom(" N  ", chain=" ")]
        self.assertEqual(names([*full, "TER\n", *lone]), [*BACKBONE, "TER"])
        insertion = atom(" N  ")[:26] + "B" + atom(" N  ")[27:]
        self.assertEqual(names([*map(atom, BACKBONE), insertion]), [*BACKBONE])

    def test_other_lone_atoms_stay(self):
        self.assertEqual(names([atom(" CA ")]), [" CA "])
        self.assertEqual(names([atom(" N  "), atom(" CA ")]), [" N  ", " CA "])


class Files(TestCase):
    def test_packed_and_plain_files_are_read(self):
        text = "REMARK \xe9\r\n" + "".join(map(atom, BACKBONE))
        plain, packed = self.folder / "a.pdb", self.folder / "b.pdb.gz"
        plain.write_text(text, encoding="latin-1")
        packed.write_bytes(gzip.compress(text.encode("latin-1")))
        for source in (plain, packed):
            pdb_to_pqr.write_protein(source, "pdb", self.folder / "out")
            lines = (self.folder / "out").read_text().splitlines()
            self.assertEqual([line[:6] for line in lines], ["ATOM  "] * 4 + ["END"])

    def test_assembly_of_several_models_is_refused(self):
        model = [*map(atom, BACKBONE), "ENDMDL\n"]
        text = "".join(["MODEL        1\n", *model, "MODEL        2\n", *model])
        for name in ("a.pdb1", "a.PDB12.gz"):
            source = self.folder / name
            source.write_bytes(gzip.compress(text.encode()) if name.endswith("gz") else
                               text.encode())
            with self.assertRaisesRegex(common.Failed, "2 models, which are the copies"):
                pdb_to_pqr.write_protein(source, "pdb", self.folder / "out")
        source = self.folder / "a.pdb"
        source.write_text(text)
        pdb_to_pqr.write_protein(source, "pdb", self.folder / "out")

    def test_file_without_atoms_is_refused(self):
        source = self.folder / "a.pdb"
        for text in ("", "END\n", atom(" H  "), atom(" N  ")):
            source.write_text(text)
            with self.assertRaises(common.Failed):
                pdb_to_pqr.write_protein(source, "pdb", self.folder / "out")


    def test_file_of_alpha_carbons_is_refused(self):
        source = self.folder / "a.pdb"
        source.write_text("".join(atom(" CA ", number=number) for number in range(1, 6)))
        with self.assertRaisesRegex(common.Failed, "^5 of 5 residues have only their C-alpha"):
            pdb_to_pqr.write_protein(source, "pdb", self.folder / "out")
        whole = "".join(atom(name, number=number) for number in range(6, 11) for name in BACKBONE)
        source.write_text(source.read_text() + whole)
        pdb_to_pqr.write_protein(source, "pdb", self.folder / "out")


ITEMS = ("group_PDB", "id", "type_symbol", "label_atom_id", "label_alt_id", "label_comp_id",
         "auth_asym_id", "auth_seq_id", "pdbx_PDB_ins_code", "Cartn_x", "Cartn_y", "Cartn_z",
         "occupancy", "B_iso_or_equiv", "pdbx_PDB_model_num")


def mmcif_text(*rows):
    """Returns a file with the atoms and with words of the format in its other values."""
    return ["data_1ABC\n", "_entry.id   1ABC\n", "_struct.title 'loop_ of a \"5' end'\n",
            "_struct.details\n", ";loop_\n", "_atom_site.id\n", ";\n",
            "loop_\n", "_chem_comp.id\n", "_chem_comp.name\n", "GLY GLYCINE\n", "#\n",
            "loop_\n", *(f"_atom_site.{item}\n" for item in ITEMS),
            *(row + "\n" for row in rows), "#\n", "loop_\n", "_atom_type.symbol\n", "C\n"]


class Mmcif(unittest.TestCase):
    def test_records_are_those_of_the_pdb_format(self):
        rows = ("ATOM 1 C CA . GLY A 12 ? 1.0 2 -3.25 1.00 4.5 1",
                "ATOM 2 ZN ZN B 'ZN' A -3 C 100 200.1234 3 0.5 ? 1",
                "HETATM 3 O O . HOH A 13 ? 1 2 3 1 1 1",
                "ATOM 4 H HG11 . VAL B 1 ?", "1 2 3 1 1 1",  # a row on two lines
                "ATOM 5 O \"O5'\" . A B 2 ? 1 2 3 1 1 1",
                "ATOM 6 C CA . GLY A 12 ? 1.0 2 -3.25 1.00 4.5 2")
        self.assertEqual(list(mmcif.to_pdb(mmcif_text(*rows))), [
            "ATOM      0  CA  GLY A  12       1.000   2.000  -3.250  1.00  4.50           C\n",
            "ATOM      0 ZN  B ZN A  -3C    100.000 200.123   3.000  0.50  0.00          ZN\n",
            "TER\n",
            "ATOM      0 HG11 VAL B   1       1.000   2.000   3.000  1.00  1.00           H\n",
            "ATOM      0  O5'   A B   2       1.000   2.000   3.000  1.00  1.00           O\n",
            "TER\n"])

    def test_long_names_of_chains_get_free_letters(self):
        rows = [f"ATOM 1 C CA . GLY {chain} 1 ? 1 2 3 1 1 1" for chain in ("AA", "A", "B-2", "AA")]
        lines = [line for line in mmcif.to_pdb(mmcif_text(*rows)) if line != "TER\n"]
        self.assertEqual([line[21] for line in lines], ["B", "A", "C", "B"])

    def test_atoms_that_do_not_fit_are_refused(self):
        for row, words in (("ATOM 1 C CA . GLY A 10000 ? 1 2 3 1 1 1", "residue number 10000"),
                           ("ATOM 1 C CA . GLY A 1 ? 1 2 12345.6 1 1 1", "cartn_z 12345.6"),
                           ("ATOM 1 C CA . ABCDE A 1 ? 1 2 3 1 1 1", "residue ABCDE"),
                           ("ATOM 1 C CA . GLY A 1 ? x 2 3 1 1 1", "cartn_x, found 'x'"),
                           ("ATOM 1 C CA . GLY A 1 ? . 2 3 1 1 1", "no _atom_site.cartn_x")):
            with self.subTest(row=row), self.assertRaisesRegex(common.Failed, words):
                list(mmcif.to_pdb(mmcif_text(row)))
        rows = [f"ATOM 1 C CA . GLY chain{number} 1 ? 1 2 3 1 1 1" for number in range(63)]
        self.assertEqual(len(list(mmcif.to_pdb(mmcif_text(*rows[:62])))), 2 * 62)
        with self.assertRaisesRegex(common.Failed, "63 chains .* --radii protor"):
            list(mmcif.to_pdb(mmcif_text(*rows)))

    def test_file_without_atoms_has_no_records(self):
        for text in ([], ["data_x\n"], ["loop_\n"], mmcif_text()):
            self.assertEqual(list(mmcif.to_pdb(text)), [])


class Answers(unittest.TestCase):
    def test_reason_of_a_failure_is_one_line(self):
        self.assertEqual(pdb_to_pqr.failure("INFO:x\nCRITICAL:No heavy atoms\nCRITICAL:Giving up.\n"
                                            "Traceback\nRuntimeError\n"), "No heavy atoms")
        self.assertEqual(pdb_to_pqr.failure("Traceback\nValueError: bad\n"), "ValueError: bad")
        self.assertEqual(pdb_to_pqr.failure(""), "no message")
        self.assertEqual(pdb_to_pqr.failure(
            "CRITICAL:Unknown format code 'i' for object of type 'int'\nCRITICAL:Giving up.\n"),
            "too many heavy atoms are missing to rebuild them")

    def test_remark_names_residues_left_out(self):
        self.assertIn("72 atoms", pdb_to_pqr.remark("WARNING:Ignoring 72 missing lines in output."))
        self.assertEqual(pdb_to_pqr.remark("WARNING:Ignoring 392 header lines in output."), "")
