"""Tests that callers of MSMS work with eses-msms: Biopython, and the calls and readers of MaSIF and
PyVOL, which are written anew here. Missing packages and files are skipped."""

import gzip
import json
import os
import pathlib
import subprocess
import unittest

from support import DATA, PROGRAM, TestCase, needs_gemmi, python_with

# PDB files of the Debian packages freesasa, pymol-data and python-biopython-doc.
STRUCTURES = ("/usr/share/freesasa/test-data/1ubq.pdb", "/usr/share/pymol/data/demo/pept.pdb",
              "/usr/share/doc/python-biopython-doc/Tests/PDB/1A8O.pdb.gz")

# Residue depths of a model, and the mean distances of the same atoms from the vertices of the files
# in the second argument.
BIOPYTHON = """
import json, sys, warnings
import numpy
from Bio.PDB import PDBParser, is_aa
from Bio.PDB.ResidueDepth import ResidueDepth, _read_vertex_array, get_surface
warnings.simplefilter("ignore")
model = next(iter(PDBParser(QUIET=True).get_structure("x", sys.argv[1])))
depths = ResidueDepth(model, msms_exec=sys.argv[2])
surface = get_surface(model, MSMS=sys.argv[2])
dense = _read_vertex_array(sys.argv[3])
def distance(atom):
    return numpy.sqrt(((dense - atom.coord) ** 2).sum(1).min())
expected = [float(numpy.mean([distance(atom) for atom in residue.get_unpacked_list()]))
            for residue, _ in depths]
json.dump({"depths": [float(depth) for _, (depth, _) in depths], "expected": expected,
           "vertices": len(surface)}, sys.stdout)
"""
# The spheres that Biopython passes to MSMS.
SPHERES = """
import sys
from Bio.PDB import PDBParser, Selection
from Bio.PDB.ResidueDepth import _get_atom_radius
model = next(iter(PDBParser(QUIET=True).get_structure("x", sys.argv[1])))
for atom in Selection.unfold_entities(model, "A"):
    print(*atom.coord, _get_atom_radius(atom, rtype="united"))
"""


def read_pair(name):
    """Reads NAME.vert and NAME.face as MaSIF does: counts in the third line, names in column 10."""
    lists = []
    for suffix in (".vert", ".face"):
        lines = pathlib.Path(f"{name}{suffix}").read_text(encoding="ascii").rstrip().split("\n")
        rows = [line.split() for line in lines[3:]]
        assert int(lines[2].split()[0]) == len(rows)
        lists.append(rows)
    vertices = [[float(field) for field in row[:6]] for row in lists[0]]
    faces = [[int(field) - 1 for field in row[:3]] for row in lists[1]]
    return vertices, faces, lists[0]


class Callers(TestCase):
    def setUp(self):
        super().setUp()
        self.msms = self.folder / "eses-msms"
        self.msms.symlink_to(PROGRAM)

    def call(self, *arguments, **how):
        done = subprocess.run([self.msms, *map(str, arguments)], capture_output=True, text=True,
                              check=False, **how)
        self.assertDone(done)
        return done

    def pdb_file(self, path):
        if not os.path.exists(path):
            raise unittest.SkipTest(f"{path} is not installed")
        plain = self.folder / "structure.pdb"
        data = pathlib.Path(path).read_bytes()
        plain.write_bytes(gzip.decompress(data) if path.endswith(".gz") else data)
        return plain

    def test_biopython_finds_residue_depths(self):
        python = python_with("Bio")
        if python is None:
            raise unittest.SkipTest("Bio is not installed")

        def run(program, *arguments):
            done = subprocess.run([python, "-c", program, *map(str, arguments)],
                                  capture_output=True, text=True, check=False)
            self.assertDone(done)
            return done.stdout
        for path in STRUCTURES:
            with self.subTest(path=path):
                structure = self.pdb_file(path)
                spheres = self.folder / "spheres"
                spheres.write_text(run(SPHERES, structure), encoding="ascii")
                self.call("-if", spheres, "-of", self.folder / "dense", "-density", "20")
                found = json.loads(run(BIOPYTHON, structure, self.msms, self.folder / "dense.vert"))
                self.assertGreater(found["vertices"], 100)
                self.assertGreater(len(found["depths"]), 5)
                for depth, expected in zip(found["depths"], found["expected"]):
                    # Vertices are on the surface, at most about 0.6 angstrom from its nearest point.
                    self.assertGreater(depth, expected - 0.05)
                    self.assertLess(depth, expected + 0.3)

    def test_advice_names_options_of_msms(self):
        done = subprocess.run([self.msms, "-if", DATA / "1ubq.xyzr", "-density", "1000000", "-of", self.folder / "x"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "of memory, but .* are available; use a lower -density\n")
        done = subprocess.run([self.msms, "-foo"], capture_output=True, text=True, check=False)
        self.assertIn("unknown option '-foo'\n", done.stderr)

    @needs_gemmi
    def test_call_and_reader_of_masif(self):
        structure = self.pdb_file(STRUCTURES[0])
        spheres = subprocess.run([PROGRAM, "pdb_to_xyzrn", structure], capture_output=True,
                                 text=True, check=True).stdout
        base = self.folder / "msms_1"
        pathlib.Path(f"{base}.xyzrn").write_text(spheres, encoding="ascii")
        done = self.call("-density", "3.0", "-hdensity", "3.0", "-probe", "1.5", "-if",
                         f"{base}.xyzrn", "-of", base, "-af", base)
        self.assertIn("MSMS terminated normally", done.stdout)
        vertices, faces, rows = read_pair(base)
        names = [line.split()[5] for line in spheres.splitlines()]
        for row in rows:
            self.assertEqual(row[9], names[int(row[7]) - 1])
        self.assertEqual({corner for face in faces for corner in face}, set(range(len(vertices))))
        areas = {}
        with open(f"{base}.area", encoding="ascii") as lines:
            next(lines)
            for line in lines:
                fields = line.split()
                areas[fields[3]] = float(fields[1])
        self.assertEqual(list(areas), list(dict.fromkeys(names)))
        row = done.stdout.split("SAS\n")[1].split("\n")[0].split()
        self.assertAlmostEqual(sum(areas.values()), float(row[5]), 1)
        self.assertAlmostEqual(len(vertices) / float(row[5]), 3, delta=0.1)

    @needs_gemmi
    def test_call_and_reader_of_pyvol(self):
        """PyVOL reads all components but the first one from NAME_1.face and so on."""
        structure = self.pdb_file(STRUCTURES[2])
        spheres = subprocess.run([PROGRAM, "pdb_to_xyzr", structure], capture_output=True,
                                 text=True, check=True).stdout
        (self.folder / "pyvol.xyzr").write_text(spheres, encoding="ascii")
        done = self.call("-if", self.folder / "pyvol.xyzr", "-of", self.folder / "pyvol_msms",
                         "-probe_radius", "1.4", "-no_area", "-noh", "-all_components")
        components = done.stdout.count("RS component")
        found = sorted(path.stem for path in self.folder.glob("pyvol_msms_*.face"))
        self.assertEqual(found, sorted(f"pyvol_msms_{i}" for i in range(1, components)))
        for name in ["pyvol_msms", *found]:
            vertices, faces, _ = read_pair(self.folder / name)
            self.assertEqual(2 * len({frozenset(pair) for a, b, c in faces
                                      for pair in ((a, b), (b, c), (c, a))}), 3 * len(faces))
            self.assertGreater(len(vertices), 3)


if __name__ == "__main__":
    unittest.main()
