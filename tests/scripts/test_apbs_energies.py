"""Tests of scripts/apbs with the real APBS, against exact energies and those of other surfaces.

Skipped if APBS is not installed.
"""

import json
import math
import os
import pathlib
import shutil
import subprocess
import unittest

from support import DATA, PROGRAM, PROJECT, TestCase, run
from eses_tools import poisson_boltzmann as pb

EXAMPLES = pathlib.Path("/usr/share/apbs/examples")  # in Debian's package apbs-data

# CODATA 2018: charge (C), Avogadro constant (1/mol), electric constant (F/m), Boltzmann constant.
CHARGE, AVOGADRO, ELECTRIC, BOLTZMANN = 1.602176634e-19, 6.02214076e23, 8.8541878128e-12, 1.380649e-23
ANGSTROM = 1e-10
COULOMB = CHARGE**2 * AVOGADRO / (4 * math.pi * ELECTRIC * ANGSTROM) / 1000  # kJ/mol angstrom

WATER = 78.54
TEMPERATURE = 298.15


def born_energy(radius, solute_dielectric=1):
    """Returns the solvation energy of a unit charge at the centre of a sphere, kJ/mol (Born,
    1920)."""
    return -COULOMB / (2 * radius) * (1 / solute_dielectric - 1 / WATER)


def debye_energy(radius, molar):
    """Returns the contribution of ions that stay outside of `radius`, kJ/mol (Debye and Hueckel,
    1923)."""
    per_cubic_meter = 1000 * molar * AVOGADRO
    kappa = ANGSTROM * math.sqrt(2 * per_cubic_meter * CHARGE**2
                                 / (ELECTRIC * WATER * BOLTZMANN * TEMPERATURE))
    return -COULOMB / (2 * WATER) * kappa / (1 + kappa * radius)


def ion_energy(charge, radius, ions, far=60.0, steps=1200):
    """Returns the contribution of ions by the nonlinear equation, kJ/mol. `ions`: charges and mol/l.

    Each solution of the equation in r, phi'' + 2 phi' / r = -4 pi l_B sum_i z_i c_i exp(-z_i phi),
    starts far away, where it is that of Debye and Hueckel, and has some charge at the centre. The
    energy is the integral over the charge of the potential that the ions make at the centre.
    """
    bjerrum = 1000 * COULOMB / (WATER * BOLTZMANN * AVOGADRO * TEMPERATURE)  # angstrom
    weights = [(4 * math.pi * bjerrum * 1000 * molar * AVOGADRO * ANGSTROM**3 * z, z)
               for z, molar in ions]
    kappa = math.sqrt(sum(weight * z for weight, z in weights))
    h = (radius - far) / steps

    def slope(r, u, v):
        return v, -2 * v / r - sum(weight * math.exp(-z * u) for weight, z in weights)

    amplitude = charge * bjerrum * math.exp(kappa * radius) / (1 + kappa * radius) / 100
    energy, before, shift_before = 0.0, 0.0, 0.0
    while True:
        r, u = far, amplitude * math.exp(-kappa * far) / far
        v = -(kappa + 1 / far) * u
        for _ in range(steps):  # Runge and Kutta
            a = slope(r, u, v)
            b = slope(r + h / 2, u + h / 2 * a[0], v + h / 2 * a[1])
            c = slope(r + h / 2, u + h / 2 * b[0], v + h / 2 * b[1])
            d = slope(r + h, u + h * c[0], v + h * c[1])
            u += h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
            v += h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
            r += h
        reached = -v * radius**2 / bjerrum
        shift = u - reached * bjerrum / radius
        step = min(charge, reached) - before
        end = shift_before + step / (reached - before) * (shift - shift_before)
        energy += step * (shift_before + end) / 2
        if reached >= charge:
            return energy * BOLTZMANN * AVOGADRO * TEMPERATURE / 1000
        before, shift_before = reached, shift
        amplitude *= 1.1


def map_values(path):
    """Returns the lines of numbers in a .dx file, which follow the object of class array."""
    lines = iter(path.read_text().splitlines())
    for line in lines:
        if line.startswith("object") and "class array" in line:
            count = int(line.split()[line.split().index("items") + 1])
            break
    values = []
    while len(values) < count:
        values += map(float, next(lines).split())
    return values


@unittest.skipUnless(shutil.which("apbs"), "apbs is not installed")
class Energies(TestCase):
    def apbs(self, *arguments):
        done = run("apbs", *arguments, "--program", PROGRAM, "--json",
                   env={**os.environ, "TMPDIR": str(self.folder)})
        self.assertDone(done)
        return json.loads(done.stdout)

    def solvation(self, *arguments):
        return self.apbs(*arguments)["solvation_energy"]

    def ion(self, radius=3.0, charge=1.0):
        path = self.folder / "ion.pqr"
        path.write_text(f"ATOM 1 I ION 1 0.000 0.000 0.000 {charge} {radius}\n")
        return path

    def check_born(self, spacing, limit, padding):
        """Checks several grids: the centre of the ion is at a grid point, between points and
        elsewhere."""
        exact = born_energy(3)
        for place in ((0, 0, 0), (0.5, 0.5, 0.5), (0.26, -0.42, 0.14), (0.1, 0.33, -0.48)):
            center = ",".join(str(spacing * value) for value in place)
            with self.subTest(spacing=spacing, place=place):
                energy = self.solvation(
                    self.ion(), "--solute-dielectric", "1", "--spacing", spacing, "--padding",
                    padding, f"--grid-center={center}")["eses-blocks"]
                self.assertLess(abs(energy / exact - 1), limit)

    def test_born_ion_is_within_its_limit(self):
        self.check_born(0.5, 0.003, 4.7)

    def test_born_ion_on_a_fine_grid_is_within_its_limit(self):
        self.check_born(0.25, 0.0007, 4.8)

    def test_energy_follows_dielectrics_and_charge(self):
        """The reference has the dielectric of the solute everywhere. The energy is proportional
        to q^2."""
        energy = self.solvation(self.ion(2.0, -2.0), "--solute-dielectric", "4", "--spacing", "0.25",
                                "--padding", "1.9")["eses-blocks"]
        self.assertLess(abs(energy / (4 * born_energy(2, 4)) - 1), 0.002)

    def test_born_ion_in_salt_has_the_debye_energy(self):
        """The ions add the energy of Debye and Hueckel. They stay 2 angstrom from the sphere.

        APBS's boundary condition lets them come closer, so the boundary must be far away.
        """
        arguments = (self.ion(), "--solute-dielectric", "1", "--spacing", "0.5", "--padding", "13")
        without = self.solvation(*arguments)["eses-blocks"]
        ions = self.solvation(*arguments, "--ionic-strength", "0.15")["eses-blocks"] - without
        self.assertLess(abs(ions / debye_energy(5, 0.15) - 1), 0.01)

    def test_focusing_gives_the_debye_energy_on_a_small_grid(self):
        """The ions are outside the fine grid."""
        arguments = (self.ion(), "--solute-dielectric", "1", "--spacing", "0.5", "--padding", "2",
                     "--coarse-padding", "20")
        without = self.solvation(*arguments)["eses-blocks"]
        done = self.apbs(*arguments, "--ionic-strength", "0.15")
        self.assertEqual((done["grid"]["points"], done["coarse_grid"]["points"]),
                         ([33] * 3, [65] * 3))
        ions = done["solvation_energy"]["eses-blocks"] - without
        self.assertLess(abs(ions / debye_energy(5, 0.15) - 1), 0.015)
        self.assertLess(abs(without / born_energy(3) - 1), 0.003)

    def test_nonlinear_equation_is_that_of_a_sphere(self):
        """Ions of two charges around a highly charged sphere, where both equations differ by 23 %."""
        ions = ((1, 0.1), (-2, 0.05))
        self.assertLess(abs(ion_energy(0.01, 5, ions) / (0.01**2 * debye_energy(5, 0.15)) - 1), 0.01)
        arguments = (self.ion(charge=3.0), "--solute-dielectric", "1", "--spacing", "0.8",
                     "--padding", "20")
        salt = [f"--ion={charge},{molar}" for charge, molar in ions]
        without, linear, nonlinear = (self.solvation(*arguments, *more)["eses-blocks"] for more in
                                      ((), salt, (*salt, "--equation", "npbe")))
        self.assertLess(abs((linear - without) / (9 * debye_energy(5, 0.15)) - 1), 0.01)
        self.assertLess(abs((nonlinear - without) / ion_energy(3, 5, ions) - 1), 0.01)

    def test_written_potential_is_that_of_the_ion(self):
        """In the solvent the potential is that of the charge, in units of kT/e."""
        path = self.folder / "potential.dx"
        done = self.apbs(self.ion(), "--solute-dielectric", "1", "--spacing", "0.5", "--padding", "5",
                         "--write-potential", path)
        points = done["grid"]["points"]
        values = map_values(path)
        self.assertEqual(len(values), math.prod(points))
        middle = [count // 2 for count in points]
        thermal = BOLTZMANN * AVOGADRO * TEMPERATURE / 1000
        for steps in (10, 12, 14):  # half angstroms from the centre along x
            value = values[((middle[0] + steps) * points[1] + middle[1]) * points[2] + middle[2]]
            self.assertLess(abs(value / (COULOMB / (WATER * steps / 2 * thermal)) - 1), 0.01)

    def test_kappa_map_is_that_of_apbs(self):
        """The ion accessibility that APBS writes itself gives the same map and energy."""
        kept = self.folder / "kept"
        result = self.apbs(DATA / "fas2.pqr", "--spacing", "0.8", "--padding", "3",
                           "--ionic-strength", "0.15", "--keep", kept)
        energy = result["energies"][0]["energy"]
        # The grid and ions are the same, the surface is that of APBS. Its maps replace ours.
        text = (kept / "apbs.in").read_text()
        section = text.split("\n\n")[1]
        own = section.replace("usemap diel 1", "write kappa dx own").replace("usemap kappa 1", "")
        (kept / "apbs.in").write_text("read\n    mol pqr molecule1.pqr\nend\n" + own + "\nquit\n")
        calculation = pb.Calculation("molecule1-eses-blocks", 0, pb.ESES)
        apbs = shutil.which("apbs")
        pb.run_apbs(apbs, [calculation], kept)
        written, = kept.glob("own*.dx")
        ours, theirs = map_values(kept / "molecule1-kappa.dx"), map_values(written)
        self.assertEqual(set(ours), {0, 1})
        self.assertEqual(set(theirs), {0, 1})
        self.assertEqual(len(ours), math.prod(result["grid"]["points"]))
        different = sum(one != other for one, other in zip(ours, theirs, strict=True))
        self.assertLess(different, 1e-5 * len(ours))  # rounding of points on a sphere
        shutil.copy(written, kept / "molecule1-kappa.dx")
        (kept / "apbs.in").write_text(text)
        again = pb.run_apbs(apbs, [calculation], kept).energies[calculation.name]
        self.assertLess(abs(again - energy), 1e-3)

    def test_ions_around_a_protein_contribute_as_with_apbs(self):
        """The contribution of ions hardly depends on the surface: APBS's own surface gives the same.

        With ions APBS samples its surface with other points, which changes the energy by more than
        the ions do. The calculation without ions therefore has a very small concentration of them.
        """
        arguments = (DATA / "fas2.pqr", "--spacing", "0.6", "--padding", "3", "--compare")
        without, ions = (self.solvation(*arguments, "--ionic-strength", molar)
                         for molar in ("1e-9", "0.15"))
        ions = {surface: energy - without[surface] for surface, energy in ions.items()}
        self.assertLess(ions["eses-blocks"], -5)
        for surface in ("mol", "smol"):
            self.assertLess(abs(ions["eses-blocks"] / ions[surface] - 1), 0.02)

    def test_example_of_the_documentation_runs(self):
        """Runs the commands and the input file of the page unchanged."""
        blocks = (PROJECT / "doc" / "poisson-boltzmann.md").read_text(encoding="utf-8").split("```")
        call, = (block for block in blocks if block.startswith("\neses-blocks data/fas2.pqr"))
        text, = (block for block in blocks if block.startswith("\nread\n"))
        (self.folder / "data").symlink_to(DATA)
        (self.folder / "apbs.in").write_text(text)
        arguments = call.replace("\\\n", " ").split()[1:]
        subprocess.run([PROGRAM, *arguments], cwd=self.folder, stdout=subprocess.DEVNULL, check=True)
        done = subprocess.run(["apbs", "apbs.in"], cwd=self.folder, capture_output=True, text=True,
                              check=True)
        printed, = (line.strip() for line in done.stdout.splitlines() if "Global net" in line)
        # Only the first digits are the same with other compilers.
        shown, = (block for block in "".join(blocks).split("`") if block.startswith("Global net"))
        self.assertAlmostEqual(float(printed.split()[-2]), float(shown.split()[-2]), delta=0.1)

    @unittest.skipUnless(EXAMPLES.is_dir(), "apbs-data is not installed")
    def test_binding_energy_of_hca_bind_is_in_range(self):
        """Acetazolamide and carbonic anhydrase at 0.5 angstrom, where placements differ by 1
        kJ/mol."""
        folder = EXAMPLES / "hca-bind"
        energy = self.apbs(*(folder / f"{name}.pqr" for name in ("complex", "acet", "hca")),
                           "--solute-dielectric", "1")["binding_energy"]["eses-blocks"]
        self.assertGreater(energy, -104)
        self.assertLess(energy, -98)
