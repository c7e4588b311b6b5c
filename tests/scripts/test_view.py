"""Tests of scripts/view: the files that its pages are made of. test_view_page.py has the pages.

Expected areas and names come from the input and from geometry.
"""

import base64
import gzip
import itertools
import json
import math
import os
import re
import shutil
import subprocess
import unittest

from support import PROGRAM, SCRIPTS, TestCase, can_import, run, write_map

SCRIPT = SCRIPTS / "view"
RADIUS = 1.7
# Two residues of different chains, far apart along x, so that their surfaces are two spheres.
TWO_ATOMS = (f"ATOM 1 CA ALA A 7 -6 0 0 0.5 {RADIUS}\n"
             f"ATOM 2 OXT GLY B 9A 6 0 0 -0.5 {RADIUS}\n")
HAS_PDB2PQR = shutil.which("pdb2pqr") or shutil.which("pdb2pqr30")
# Name, residue, chain, number, coordinates and element of atoms in ATOM or HETATM records. PDB2PQR has
# no charges for the ligands; water has another energy.
PEPTIDE = [("ATOM", *one) for one in (
    ("N", "CYS", "A", 2, 2.908, -14.771, 24.711, "N"), ("CA", "CYS", "A", 2, 2.638, -13.825, 23.633, "C"),
    ("CB", "CYS", "A", 2, 1.198, -13.996, 23.132, "C"), ("SG", "CYS", "A", 2, 0.725, -15.681, 22.638, "S"),
    ("C", "CYS", "A", 2, 2.842, -12.366, 24.012, "C"), ("O", "CYS", "A", 2, 3.025, -12.039, 25.188, "O"),
    ("N", "ALA", "A", 3, 2.792, -11.504, 22.996, "N"), ("CA", "ALA", "A", 3, 2.923, -10.056, 23.151, "C"),
    ("CB", "ALA", "A", 3, 4.226, -9.566, 22.552, "C"), ("C", "ALA", "A", 3, 1.736, -9.418, 22.436, "C"),
    ("O", "ALA", "A", 3, 1.332, -9.867, 21.362, "O"), ("O", "HOH", "A", 301, -4.0, -9.0, 28.0, "O"))]
LIGANDS = [("ATOM", "C1", "LIG", "A", 201, 9.0, -10.0, 23.0, "C"), ("ATOM", "O1", "LIG", "A", 201, 10.2, -10.0, 23.0, "O"),
           ("HETATM", "ZN", "ZN", "A", 202, 9.0, -15.0, 23.0, "ZN"), ("HETATM", "N", "ALA", "B", 3, -4.0, -15.0, 23.0, "N")]


def pdb_text(atoms):
    """Returns a PDB file, the serial numbers of which have six digits."""
    return "".join(f"{record if record == 'HETATM' else 'ATOM '}{99999 if record == 'HETATM' else 100000 + i:5} "
                   f"{name if element == 'ZN' else ' ' + name:4} {residue:>3} {chain}{number:4}    {x:8.3f}{y:8.3f}{z:8.3f}"
                   f"  1.00  0.00          {element:>2}\n"
                   for i, (record, name, residue, chain, number, x, y, z, element) in enumerate(atoms))


def cif_text(atoms):
    names = "group_PDB label_atom_id label_comp_id auth_asym_id auth_seq_id Cartn_x Cartn_y Cartn_z type_symbol".split()
    return ("data_a\nloop_\n" + "".join(f"_atom_site.{name}\n" for name in names)
            + "".join(" ".join(map(str, one)) + "\n" for one in atoms))


def run_view(*arguments, **how):
    return subprocess.run([SCRIPT, "--program", PROGRAM, *map(str, arguments)],
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
                          timeout=300, **how)


def data_of(page):
    """Returns the description of the molecules in a page, and the bytes of their arrays."""
    text = page.read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="molecules">(.*?)</script>', text, re.DOTALL)[1])
    arrays = [gzip.decompress(base64.b64decode(one)) for one in
              re.findall(r'id="arrays-\d+">(.*?)</script>', text, re.DOTALL)]
    return data, arrays


def column(page, name):
    """Returns the numbers of an array of bytes with one column in a page."""
    data, (arrays,) = data_of(page)
    at = 0
    for one in data["molecules"][0]["arrays"]:
        size = one["columns"] * one["rows"] * one["width"]
        if one["name"] == name:
            return list(itertools.accumulate(arrays[at:at + size]))
        at += size
    raise KeyError(name)


def first_row(page, name):
    """Returns the first row of an array in a page, the differences of which are from zero."""
    data, (arrays,) = data_of(page)
    at = 0
    for one in data["molecules"][0]["arrays"]:
        count = one["columns"] * one["rows"]
        if one["name"] == name:
            return [sum(arrays[at + plane * count + column] << 8 * plane
                        for plane in range(one["width"])) for column in range(one["columns"])]
        at += one["width"] * count
    raise KeyError(name)


class WithoutPackages(TestCase):
    def test_arguments_are_checked_before_packages_are_imported(self):
        for name in ("numpy", "vtk"):
            (self.folder / f"{name}.py").write_text("raise ImportError\n")
        environment = {**os.environ, "PYTHONPATH": str(self.folder)}
        mesh, other = self.folder / "a.ply", self.folder / "b.ply"
        for path in (mesh, other):
            path.touch()
        for script, arguments, code, message in (
                ("view", [__file__], 2, "neither a structure nor a mesh"),
                ("view", [mesh, "--color", "blue"], 2, "--color: invalid choice: 'blue'"),
                ("view", [mesh], 1, "install numpy"),
                ("render", [__file__], 1, "not a .ply"),
                ("render", ["nothing"], 1, "nothing: no such file"),
                *(("view", [name], 1, f"{name}: no such file") for name in ("nothing", "nothing.pdb", "nothing.ply")),
                *((script, [self.folder], 1, ": a directory, not a file") for script in ("render", "view")),
                ("render", [mesh, other, "--cavities"], 2, "--cavities needs a single mesh")):
            with self.subTest(script=script, arguments=arguments):
                done = run(script, *arguments, "-o", self.folder / "c", env=environment)
                self.assertDone(done, code)
                self.assertIn(message, done.stderr)


    def test_missing_files_are_named_before_missing_options(self):
        for script in ("apbs", "assemble", "render", "report", "traj", "view"):
            with self.subTest(script=script):
                done = run(script, self.folder / "nothing")
                self.assertDone(done, 1)
                self.assertIn(f"{self.folder / 'nothing'}: no such file", done.stderr)
                self.assertDone(run(script, self.folder / "nothing", "--help"))


@unittest.skipUnless(can_import(SCRIPT, "numpy"), "needs python3-numpy")
class Files(TestCase):
    def setUp(self):
        super().setUp()
        self.page = self.folder / "page.html"
        self.atoms = self.folder / "two.pqr"
        self.atoms.write_text(TWO_ATOMS)

    def mesh(self, name, *options):
        self.assertDone(subprocess.run([PROGRAM, self.atoms, "-q", "--write", "none", "--mesh",
                                        self.folder / name, *options], capture_output=True,
                                       text=True, check=False))
        return self.folder / name

    def test_structures_bring_their_atoms(self):
        self.assertDone(run_view(self.atoms, "-o", self.page))
        data, (arrays,) = data_of(self.page)
        molecule, = data["molecules"]
        self.assertEqual(molecule["residues"], [["ALA", "7", "A"], ["GLY", "9A", "B"]])
        self.assertEqual(molecule["names"], ["CA", "OXT"])
        self.assertEqual(molecule["elements"], ["C", "O"])
        self.assertEqual(molecule["chains"], ["A", "B"])
        self.assertEqual(len(arrays), sum(one["width"] * one["columns"] * one["rows"]
                                          for one in molecule["arrays"]))

    def test_meshes_of_all_formats_are_read(self):
        counts = set()
        for name, options in (("m.ply", ()), ("t.ply", ("--ply-ascii",)), ("m.vtp", ()),
                              ("m.obj", ()), ("c.obj", ("--color", "patch")), ("m.off", ()),
                              ("m.stl", ()), ("m.glb", ()),
                              ("m.vert", ()), ("n.face", ())):
            with self.subTest(name=name):
                self.assertDone(run_view(self.mesh(name, *options), "-o", self.page))
                molecule, = data_of(self.page)[0]["molecules"]
                counts.add((molecule["vertices"], molecule["triangles"]))
                self.assertAlmostEqual(molecule["radius_of_all"], 6 + RADIUS, delta=0.05)
                if name in ("m.ply", "t.ply", "m.vtp"):
                    self.assertEqual(molecule["residues"], [["ALA", "7", "A"], ["GLY", "9A", "B"]])
        ((vertices, triangles),) = counts
        self.assertEqual(vertices - 3 * triangles // 2 + triangles, 4)  # Euler: two closed surfaces

    def test_areas_of_atoms_are_those_of_spheres(self):
        for name in (self.atoms, self.mesh("m.ply", "--spacing", "0.2")):
            self.assertDone(run_view(name, "-o", self.page))
            (area,) = first_row(self.page, "area")
            self.assertAlmostEqual(area / 100 / (4 * math.pi * RADIUS**2), 1, delta=0.01)

    def test_other_surfaces_than_the_ses(self):
        for surface, radius in (("sas", RADIUS + 1.4), ("vdw", RADIUS)):
            with self.subTest(surface=surface):
                self.assertDone(run_view(self.atoms, "--surface", surface, "-o", self.page))
                self.assertAlmostEqual(data_of(self.page)[0]["molecules"][0]["radius_of_all"], 6 + radius, delta=0.05)
                (area,) = first_row(self.page, "area")
                self.assertAlmostEqual(area / 100 / (4 * math.pi * radius**2), 1, delta=0.01)

    def test_colours_of_files_are_kept(self):
        """The first vertices are those of the first sphere, which is red in colours of chains."""
        red = first_row(self.colored_page("m.ply"), "color_of_file")
        self.assertEqual(red.index(max(red)), 0)
        for name in ("m.vtp", "m.obj", "m.glb"):
            for value, expected in zip(first_row(self.colored_page(name), "color_of_file"), red):
                self.assertAlmostEqual(value, expected, delta=3)  # glTF has 8 bits of intensity

    def test_meshes_are_shown_in_their_colours(self):
        for color, expected in (("patch", "patch"), ("chain", "file")):
            self.assertDone(run_view(self.mesh("m.ply", "--color", color), "-o", self.page))
            self.assertEqual(data_of(self.page)[0]["settings"]["color"], expected)

    def colored_page(self, name):
        self.assertDone(run_view(self.mesh(name, "--color", "chain"), "--color", "file", "-o",
                                 self.page))
        return self.page

    def test_the_page_is_small_and_needs_no_network(self):
        self.assertDone(run_view(self.atoms, "--spacing", "0.8", "-o", self.page))
        text = self.page.read_text(encoding="utf-8")
        self.assertLess(len(text), 150000)
        self.assertIn("default-src 'none'", text)
        self.assertEqual(re.findall(r"(?:https?:)?//[a-z]+\.", text), [])

    def test_titles_cannot_end_elements(self):
        atoms = self.folder / "a<script>.pqr"
        atoms.write_text(TWO_ATOMS.replace("ALA", "</script>"))
        self.assertDone(run_view(atoms, "--title", "</title><b>", "-o", self.page))
        text = self.page.read_text(encoding="utf-8")
        self.assertIn(["</script>", "7", "A"], data_of(self.page)[0]["molecules"][0]["residues"])
        self.assertNotIn("<b>", text)
        self.assertNotIn("a<script>", text)

    def test_names_may_begin_with_a_hyphen(self):
        for name in ("-a.xyzr", "-b.pqr"):
            record = "ATOM 1 C ALA 1 " if name.endswith("pqr") else ""
            (self.folder / name).write_text(f"{record}0 0 0 {'0 ' if record else ''}1.5\n")
            done = run_view(f"./{name}", "-o", "./-page.html", cwd=self.folder)
            self.assertDone(done)
            self.assertGreater((self.folder / "-page.html").stat().st_size, 1000)

    def test_without_protein_pdb2pqr_is_not_started(self):
        source = self.folder / "heme.pdb"
        source.write_text("HETATM    1 FE   HEM A 155       1.000   2.000   3.000  1.00  0.00          FE\n")
        done = run_view(source, "--electrostatics", "-o", self.page)
        self.assertDone(done, 1)
        self.assertIn("heme.pdb: no atoms of a protein or nucleic acid in ATOM records", done.stderr)

    @unittest.skipUnless(HAS_PDB2PQR and shutil.which("apbs"), "needs pdb2pqr and apbs")
    def test_residues_without_charges_are_named_and_drawn(self):
        for name, text in (("a.pdb", pdb_text(PEPTIDE + LIGANDS)), ("a.cif", cif_text(PEPTIDE + LIGANDS))):
            with self.subTest(name=name):
                (self.folder / name).write_text(text)
                done = run_view(self.folder / name, "--electrostatics", "--spacing", "1", "-o", self.page)
                self.assertDone(done)
                self.assertIn(f"{name}: LIG A 201, ZN A 202, ALA B 3 left out, because PDB2PQR has no charges",
                              done.stderr)
                self.assertIn("surface and potential are those of the others", done.stderr)
                self.assertEqual(sum(column(self.page, "ligand")), 4)

    @unittest.skipUnless(shutil.which("apbs"), "needs apbs")
    def test_charged_ligands_are_part_of_the_surface(self):
        source = self.folder / "a.pqr"
        source.write_text("ATOM 1 CA ALA A 1 0 0 0 0.5 2.0\nATOM 2 ZN ZN A 2 9 0 0 2.0 1.4\n")
        arguments = (source, "--electrostatics", "--spacing", "1", "-o", self.page)
        done = run_view(*arguments)
        self.assertDone(done)
        self.assertNotIn("warning", done.stderr)
        self.assertNotIn('"ligand"', self.page.read_text(encoding="utf-8"))
        done = run_view(*arguments, "--ligands", "sticks")
        self.assertDone(done)
        self.assertIn("the surface is without ZN A 2, whose charges the potential has", done.stderr)

    def test_wrong_requests_are_refused(self):
        mesh = self.mesh("m.ply")
        broken = self.folder / "broken.ply"
        broken.write_bytes(mesh.read_bytes()[:-5])
        text = self.folder / "a.txt"
        text.write_text("none")
        for arguments, code, message in (
                ([text], 2, "neither a structure nor a mesh"),
                ([self.folder / "no.pqr"], 1, "no such file"),
                ([broken], 1, "not a mesh of eses-blocks"),
                ([mesh, "--color", "blue"], 2, "--color: invalid choice: 'blue'"),
                ([self.atoms, "--color", "potential"], 2, "needs --potential"),
                ([mesh, "--color", "potential"], 1, "the meshes have no potential"),
                ([mesh, "--electrostatics"], 2, "needs structures"),
                ([mesh, "--potential", text], 1, "not an OpenDX map"),
                ([self.atoms, "--", "--radii", "bondi"], 2, "--radii"),
                ([self.atoms, "--", "--surface", "sas"], 2, "--surface must come before --"),
                ([self.atoms, "--", "--spacing", "1"], 2, "--spacing must come before --"),
                ([self.atoms, "--opacity", "120"], 2, "expected a whole number from 0 to 100")):
            with self.subTest(message=message):
                done = run_view("-o", self.page, *arguments)
                self.assertEqual(done.returncode, code, done.stderr)
                self.assertIn(message, done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                self.assertFalse(self.page.exists())

    def test_potentials_are_those_of_the_map(self):
        """A map that grows along x has the potential x at each vertex, and x + offset n outside."""
        field = write_map(self.folder / "x.dx", 12)
        for offset in (0, 2):
            self.assertDone(run_view(self.atoms, "--potential", field, "--potential-offset", offset,
                                     "-o", self.page))
            data, _ = data_of(self.page)
            self.assertEqual(data["settings"]["color"], "potential")
            self.assertEqual(data["limits"]["potential"], 10)
            self.assertAlmostEqual(data["molecules"][0]["potential_max"], 6 + RADIUS + offset,
                                   delta=0.05)
        done = run_view(self.atoms, "--potential", field, "--potential-offset", 5, "-o", self.page)
        self.assertEqual(done.returncode, 1)
        self.assertIn("outside the map", done.stderr)


    def test_ligands_are_no_part_of_the_surface(self):
        """An amino acid, a ligand with a bond inside, a metal, and a cap that is bonded to the acid."""
        far, lines = 20, [("N", "GLY", 1, 0, 0), ("CA", "GLY", 1, 1.5, 0), ("C", "GLY", 1, 3, 0),
                          ("C1", "LIG", 2, 20, 0), ("C2", "LIG", 2, 21.5, 0), ("ZN", "ZN", 3, 0, 20),
                          ("C", "ACE", 4, -1.4, 0), ("O", "ACE", 4, -2.6, 0)]
        self.atoms.write_text("".join(
            f"ATOM {serial} {name} {residue} A {number} {x} {y} 0 0 {RADIUS}\n"
            for serial, (name, residue, number, x, y) in enumerate(lines, 1)))
        self.assertDone(run_view(self.atoms, "-o", self.page))
        molecule, = data_of(self.page)[0]["molecules"]
        self.assertGreater(molecule["radius_of_all"], far - 3)
        self.assertLess(molecule["step"] * 65535, 5.6 + 2 * RADIUS + 0.1)  # GLY and ACE
        places = {one["name"]: one for one in molecule["arrays"]}
        self.assertEqual(places["ligand"]["rows"], len(lines))
        self.assertDone(run_view(self.atoms, "--ligands", "surface", "-o", self.page))
        molecule, = data_of(self.page)[0]["molecules"]
        self.assertNotIn("ligand", {one["name"] for one in molecule["arrays"]})
        self.assertGreater(molecule["step"] * 65535, far)

    def test_caps_of_one_atom_are_no_ligands(self):
        import numpy
        from eses_tools import page
        names = ["N", "CA", "C", "N", "ZN"]  # glycine, NH2, and a metal as near
        atoms = page.Atoms(serial=numpy.arange(5), names=names, elements=["N", "C", "C", "N", "Zn"],
                           residues=[("GLY", "1", "A")] * 3 + [("NH2", "2", "A"), ("ZN", "3", "A")],
                           centers=numpy.array([[0, 0, 0], [1.5, 0, 0], [3, 0, 0], [3, 1.3, 0], [-1.8, 0, 0]]))
        self.assertEqual(list(numpy.flatnonzero(atoms.ligands())), [4])

    def test_tables_are_kept_in_the_page(self):
        table = self.folder / "t.csv"
        table.write_text("serial,</script>\n1,2\n")
        self.assertDone(run_view(self.atoms, "--table", table, "-o", self.page))
        self.assertEqual(data_of(self.page)[0]["table"]["text"], table.read_text())
        for wrong, message in (("a,b\n1,2\n", "no column serial or residue_number"), ("", "no column"),
                               ("serial,b\n999,2\n", "names no atom or residue of ")):
            table.write_text(wrong)
            done = run_view(self.atoms, "--table", table, "-o", self.page)
            self.assertDone(done, code=1)
            self.assertIn(f"t.csv: {message}", done.stderr)
        done = run_view(self.atoms, "--table", self.folder / "none.csv", "-o", self.page)
        self.assertDone(done, 1)
        self.assertIn("none.csv: no such file", done.stderr)
