"""Tests of scripts/benchmarks/boundary-elements: exact energies, the solver, messages and plotting."""

import importlib.machinery
import importlib.util
import subprocess
import sys
import unittest
import xml.etree.ElementTree

from support import PROGRAM, PROJECT, SCRIPTS, TestCase, can_import, has_matplotlib, interpreter_of

SCRIPT = SCRIPTS / "benchmarks" / "boundary-elements"


def load_script():
    loader = importlib.machinery.SourceFileLoader("boundary_elements", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    keeps_bytecode, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    loader.exec_module(module)
    sys.dont_write_bytecode = keeps_bytecode
    return module


class ExactEnergies(TestCase):
    def test_central_charge_has_the_energy_of_a_born_ion(self):
        script = load_script()
        energy = script.kirkwood(3.0, script.Charges([(0, 0, 0)], [2.0]))
        born = -script.COULOMB * 2.0**2 / (2 * 3.0) * (1 - 1 / script.SOLVENT_DIELECTRIC)
        self.assertAlmostEqual(energy, born, places=9)

    def test_charge_in_a_conductor_has_the_energy_of_its_image(self):
        script = load_script()
        script.SOLVENT_DIELECTRIC = 1e12
        energy = script.kirkwood(5.0, script.Charges([(0, 0, 3)], [1.5]))
        image = -script.COULOMB * 1.5**2 * 5 / (2 * (5**2 - 3**2))
        self.assertAlmostEqual(energy, image, places=6)

    def test_charges_in_a_conductor_have_the_energies_of_their_images(self):
        script = load_script()
        script.SOLVENT_DIELECTRIC = 1e12
        charges = script.Charges([(0, 0, 3), (0, 2, 0)], [1.5, -1.0])
        # The image of a charge q at distance s is -q R / s at distance R^2 / s.
        potential_at_second = -1.5 * 5 / 3 / (2**2 + (25 / 3)**2)**0.5
        selves = 1.5**2 * 5 / (2 * (25 - 9)) + 5 / (2 * (25 - 4))
        expected = script.COULOMB * (-selves - potential_at_second)
        self.assertAlmostEqual(script.kirkwood(5.0, charges), expected, places=6)


@unittest.skipUnless(all(map(importlib.util.find_spec, ("fmm3dpy", "numba", "scipy"))),
                     "fmm3dpy, numba or scipy is not installed")
class Energies(TestCase):
    def test_curved_triangles_give_the_energy_of_a_sphere(self):
        script = load_script()
        atoms, charges = script.read_case("sphere", PROGRAM, self.folder)
        exact = script.exact_energy("sphere")
        for name, max_error in (("curved", 1e-3), ("plain", 1e-3), ("flat", 0.04)):
            with self.subTest(series=name):
                is_quality = script.SERIES[name].is_quality
                mesh = script.make_mesh(PROGRAM, atoms, is_quality, 1.4, self.folder)
                energy, _ = script.solve(mesh, charges, name)
                self.assertLess(abs(energy / exact - 1), max_error)


@unittest.skipUnless(has_matplotlib(SCRIPT), "python3-matplotlib is not installed")
class Figures(TestCase):
    def run_script(self, *arguments, code=0):
        done = subprocess.run([interpreter_of(SCRIPT), SCRIPT, "-o", self.folder,
                               *map(str, arguments)], stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, check=False)
        self.assertDone(done, code)
        return done

    def test_saved_energies_are_drawn_again(self):
        text = (PROJECT / "doc" / "poisson-boltzmann.md").read_text(encoding="utf-8")
        table = self.run_script("--from", PROJECT / "doc" / "boundary-elements.json").stdout
        xml.etree.ElementTree.parse(self.folder / "boundary-elements.svg")
        self.assertGreater(len(table.splitlines()), 7)
        for row in table.splitlines():
            self.assertIn(row, text)

    def test_errors_are_one_line(self):
        self.run_script("--from", self.folder / "missing", code=1)
        self.run_script("--cases", "unknown", code=2)

    @unittest.skipIf(can_import(SCRIPT, "fmm3dpy"), "fmm3dpy is installed")
    def test_missing_package_is_named(self):
        self.assertIn("fmm3dpy is missing", self.run_script(code=1).stderr)
