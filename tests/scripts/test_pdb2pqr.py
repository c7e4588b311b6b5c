"""Tests of PDB and mmCIF files through scripts/pdbbind and the real PDB2PQR; skipped without PDB2PQR."""

import csv
import unittest

from support import DATA, PROGRAM, TestCase, needs_gemmi, run
from eses_tools import pdb_to_pqr

# data/fas2.pqr has names of its own for the ends of the chain and some others.
RESIDUES = {"CYX": "CYS", "HSD": "HIS"}
ATOMS = {("ILE", "CD"): "CD1"}
ENDS = {"NTE", "CTE"}
OXYGENS = {"OT1": "O", "OT2": "OXT"}

# Half of Rmin in the CHARMM force field, angstrom: nitrogen, carbons and oxygen of the backbone,
# and its polar hydrogen. The alpha carbon of glycine is smaller.
BACKBONE_RADII = {"N": {1.85}, "CA": {2.275, 2.175}, "C": {2.0}, "O": {1.7}, "H": {0.2245}}


def fasciculin():
    """Returns the atoms of fasciculin with hydrogens: name, residue, number, position (as text)."""
    lines = [line.split() for line in (DATA / "fas2.pqr").read_text().splitlines()
             if line.startswith("ATOM")]
    residue_of = {fields[4]: fields[3] for fields in lines if fields[3] not in ENDS}
    for _, _, name, _, number, x, y, z, _, _ in lines:
        residue = residue_of[number]
        yield (OXYGENS.get(name) or ATOMS.get((residue, name), name),
               RESIDUES.get(residue, residue), int(number), (x, y, z))


def record(kind, name, residue, number, place):
    x, y, z = map(float, place)
    padded = name if len(name) == 4 else f" {name:3}"
    return (f"{kind:6}    1 {padded} {residue} A{number:4}    {x:8.3f}{y:8.3f}{z:8.3f}"
            f"  1.00  0.00          {name[0]:>2}\n")


def pqr_atoms(path):
    for line in path.read_text().splitlines():
        if line.startswith("ATOM"):
            _, _, name, _, _, x, y, z, _, radius = line.split()
            yield name, (float(x), float(y), float(z)), float(radius)


@unittest.skipUnless(pdb_to_pqr.find_program(), "pdb2pqr is not installed")
class Pdb2pqr(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.atoms = list(fasciculin())

    def run_on(self, text, code=0, *options, name="1fsc_protein.pdb"):
        source = self.folder / "in" / "1fsc" / name
        source.parent.mkdir(parents=True, exist_ok=True)
        source.write_text(text)
        self.output = self.folder / "out"
        done = run("pdbbind", self.folder / "in", "-o", self.output, "--program", PROGRAM, *options)
        self.assertDone(done, code)
        with open(self.output / "summary.csv", encoding="utf-8", newline="") as file:
            return next(csv.DictReader(file))

    def protein(self):
        return "".join(record("ATOM", *atom) for atom in self.atoms) + "TER\n"

    def test_hydrogens_are_rebuilt_and_radii_assigned(self):
        heavy = [atom for atom in self.atoms if not atom[0].startswith("H")]
        self.assertEqual(len(self.atoms), 906)
        first = self.run_on("".join(record("ATOM", *atom) for atom in heavy) + "TER\nEND\n")
        # The number of atoms is that of the file that others have prepared, hydrogens included.
        self.assertEqual(int(first["atoms"]), len(self.atoms))
        made = list(pqr_atoms(self.output / "1fsc" / "atoms.pqr"))
        for name, radii in BACKBONE_RADII.items():
            self.assertEqual({radius for other, _, radius in made if other == name}, radii, name)
        places = {place for name, place, _ in made}
        for name, _, _, place in heavy:
            if name in ("N", "CA", "C"):
                self.assertIn(tuple(map(float, place)), places)

        # Water, hydrogens and a lone nitrogen make no difference.
        water = record("HETATM", "O", "HOH", 900, ("50", "50", "50"))
        lone = record("ATOM", "N", "GLY", 605, ("-0.5", "8.0", "23.5"))
        second = self.run_on(self.protein().replace("TER\n", lone + "TER\n") + water)
        for key in ("atoms", "nx", "ny", "nz", "area", "volume"):
            self.assertEqual(first[key], second[key], key)

    def test_atoms_are_made_once(self):
        self.run_on(self.protein())
        atoms = self.output / "1fsc" / "atoms.pqr"
        before = atoms.stat()
        self.run_on(self.protein(), 0, "--spacing", "0.5")  # the file is written again
        self.assertNotEqual(atoms.stat().st_mtime_ns, before.st_mtime_ns)
        before = atoms.stat()
        done = run("pdbbind", self.folder / "in", "-o", self.output, "--program", PROGRAM)
        self.assertDone(done)
        self.assertEqual(atoms.stat().st_mtime_ns, before.st_mtime_ns)
        self.assertIn("INFO", (self.output / "1fsc" / "pdb2pqr.log").read_text())

    def test_failures_of_pdb2pqr_are_reported(self):
        """PDB2PQR 3.5 ends with a traceback that does not name the reason. The words of 3.6 differ."""
        row = self.run_on("".join(record("ATOM", *atom) for atom in self.atoms
                                  if atom[0] in ("N", "CA")), 1)
        self.assertEqual(row["status"], "failed")
        self.assertRegex(row["message"], "^PDB2PQR: .*(?:missing|incomplete).* [(]see .*pdb2pqr.log[)]$")
        self.assertIn("CRITICAL", (self.output / "1fsc" / "pdb2pqr.log").read_text())

    def test_file_of_alpha_carbons_is_refused_in_words(self):
        row = self.run_on("".join(record("ATOM", *atom) for atom in self.atoms if atom[0] == "CA"),
                          1)
        self.assertRegex(row["message"], "^61 of 61 residues have only their C-alpha atom")

    def test_pdb_and_mmcif_files_get_the_same_atoms_and_radii(self):
        first = self.run_on(self.protein())
        self.assertEqual((first["radii"], first["input"]), ("charmm", "1fsc/1fsc_protein.pdb"))
        (self.folder / "in" / "1fsc" / "1fsc_protein.pdb").unlink()
        items = ("group_PDB", "type_symbol", "auth_atom_id", "auth_comp_id", "auth_asym_id",
                 "auth_seq_id", "Cartn_x", "Cartn_y", "Cartn_z")
        rows = (f"ATOM {name[0]} {name} {residue} A {number} {' '.join(place)}\n"
                for name, residue, number, place in self.atoms)
        second = self.run_on("data_1FSC\nloop_\n" + "".join(f"_atom_site.{item}\n" for item in items)
                             + "".join(rows), name="1fsc_protein.cif")
        self.assertEqual(second["input"], "1fsc/1fsc_protein.cif")
        for key in ("status", "radii", "atoms", "nx", "ny", "nz", "area", "volume"):
            self.assertEqual(second[key], first[key], key)

    @needs_gemmi
    def test_prepared_atoms_are_not_used_with_other_radii(self):
        prepared = self.run_on(self.protein())
        direct = self.run_on(self.protein(), 0, "--radii", "protor")
        self.assertEqual((direct["status"], direct["radii"]), ("done", "protor"))
        # Hydrogens of the file are left out.
        self.assertLess(int(direct["atoms"]), int(prepared["atoms"]))
        self.assertFalse((self.output / "1fsc" / "atoms.pqr").exists())

    def test_residues_left_out_are_reported(self):
        leucines = [atom for atom in self.atoms if atom[1] == "LEU" and atom[0][0] != "H"]
        row = self.run_on(self.protein().replace(" LEU ", " XYZ "))
        self.assertEqual(row["status"], "done")
        self.assertIn(f"left out {len(leucines)} atoms", row["message"])
