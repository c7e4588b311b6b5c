"""Tests of scripts/benchmarks/energies: measuring with a replacement for APBS, and plotting.

Skipped without matplotlib.
"""

import json
import os
import subprocess
import unittest
import xml.etree.ElementTree

from support import PROGRAM, PROJECT, SCRIPTS, TestCase, has_matplotlib, interpreter_of
from test_apbs import APBS, ESES, write_program

SCRIPT = SCRIPTS / "benchmarks" / "energies"


@unittest.skipUnless(has_matplotlib(SCRIPT), "python3-matplotlib is not installed")
class Energies(TestCase):
    def energies(self, *arguments, code=0, **environment):
        done = subprocess.run([interpreter_of(SCRIPT), SCRIPT, "-o", self.folder,
                               *map(str, arguments)], stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, check=False,
                              env={**os.environ, **environment})
        self.assertDone(done, code)
        if code:
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        return done

    def check_figure(self, study="energies"):
        xml.etree.ElementTree.parse(self.folder / f"{study}.svg")

    def test_saved_energies_are_drawn_again(self):
        text = (PROJECT / "doc" / "poisson-boltzmann.md").read_text(encoding="utf-8")
        for study, options in (("energies", ()), ("charges", ("--charges",))):
            saved = PROJECT / "doc" / f"{study}.json"
            table = self.energies(*options, "--from", saved).stdout
            self.check_figure(study)
            self.assertGreater(len(table.splitlines()), 7)
            for row in table.splitlines():
                self.assertIn(row, text)

    def test_energies_are_measured_and_drawn(self):
        write_program(self.folder / "apbs", APBS)
        program = write_program(self.folder / "program", ESES)
        path = os.pathsep.join((str(self.folder), os.defpath))
        for surfaces, count in (("mol", 18), ("mol,smol", 36), ("mol,smol", 36)):
            done = self.energies("--cases", "born", "--surfaces", surfaces, "--program", program,
                                 *(["--continue"] if count > 18 else []), PATH=path)
            rows = json.loads((self.folder / "energies.json").read_text())["rows"]
            self.assertEqual(len(rows), count)
            # Each energy is the difference from its reference: 2 - 4 kJ/mol.
            self.assertEqual({row["energy"] for row in rows}, {-2})
            self.assertEqual(len({(row["spacing"], *row["offset"]) for row in rows}), 18)
        self.assertNotIn("smol -", done.stdout)  # nothing is measured twice
        self.check_figure()

    def test_errors_are_one_line(self):
        (self.folder / "energies.json").write_text("{}")
        self.assertIn("energies.json", self.energies("--continue", "--program", PROGRAM,
                                                     code=1).stderr)
        self.energies("--from", self.folder / "missing", code=1)
        self.energies("--cases", "unknown", code=2)
        self.energies("--surfaces", "ses", code=2)
        self.energies("--charges", "--cases", "born", code=2)
