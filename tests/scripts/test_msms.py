"""Tests that callers of MSMS work with eses-msms: the calls and readers of MaSIF and PyVOL, which are
written anew here. Missing files are skipped. python/tests/test_drop_ins.py has those of Biopython."""

import gzip
import os
import pathlib
import subprocess
import unittest

from support import DATA, PROGRAM, TestCase, needs_gemmi

# PDB files of the Debian packages freesasa and python-biopython-doc.
UBIQUITIN = "/usr/share/freesasa/test-data/1ubq.pdb"
CAPSID = "/usr/share/doc/python-biopython-doc/Tests/PDB/1A8O.pdb.gz"


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

    def test_advice_names_options_of_msms(self):
        done = subprocess.run([self.msms, "-if", DATA / "1ubq.xyzr", "-density", "1000000", "-of", self.folder / "x"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "of memory, but .* are available; use a lower -density\n")
        done = subprocess.run([self.msms, "-foo"], capture_output=True, text=True, check=False)
        self.assertIn("unknown option '-foo'\n", done.stderr)

    @needs_gemmi
    def test_call_and_reader_of_masif(self):
        structure = self.pdb_file(UBIQUITIN)
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
        structure = self.pdb_file(CAPSID)
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
