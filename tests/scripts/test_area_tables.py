"""Other programs read the tables of measured areas in their formats."""

import importlib.util
import subprocess
import unittest

from support import PROGRAM, PROJECT, TestCase, needs_gemmi

STRUCTURE = PROJECT / "tests/data/1a8o.cif.gz"


def measure(path, table):
    return subprocess.run([PROGRAM, "measure", path, "--table", table], capture_output=True, text=True,
                          check=False)


@needs_gemmi
class Tables(TestCase):
    def table(self, name):
        done = measure(STRUCTURE, name)
        self.assertDone(done)
        return done.stdout

    def residues(self):
        header, *rows = (line.split(",") for line in self.table("residues").splitlines())
        return [dict(zip(header, row)) for row in rows]

    @unittest.skipUnless(importlib.util.find_spec("Bio"), "Bio is not installed")
    def test_biopython_reads_rsa(self):
        from Bio.PDB import NACCESS
        read = NACCESS.process_rsa_data(self.table("rsa").splitlines())
        residues = self.residues()
        self.assertEqual(len(read), len(residues))
        for residue in residues:
            found = read[residue["chain"], (" ", int(residue["residue_number"]), " ")]
            self.assertEqual(found["res_name"], residue["residue"])
            area = float(residue["sas_area"])
            self.assertAlmostEqual(found["all_atoms_abs"], area, delta=0.0051)
            for one, other in (("side_chain", "main_chain"), ("non_polar", "all_polar")):
                self.assertAlmostEqual(found[f"{one}_abs"] + found[f"{other}_abs"], area, delta=0.0101)
            relative = residue["relative_sas_area"]
            self.assertAlmostEqual(found["all_atoms_rel"], 100 * float(relative) if relative else -99.9,
                                   delta=0.051)

    def test_the_program_reads_structures(self):
        whole = self.table("atoms").splitlines()
        for name in ("pdb", "cif"):
            path = self.folder / f"areas.{name}"
            path.write_text(self.table(name))
            again = measure(path, "atoms").stdout.splitlines()
            self.assertEqual(again, whole)


if __name__ == "__main__":
    unittest.main()
