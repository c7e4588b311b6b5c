"""Tests of scripts/benchmarks/plot-cost: measuring on small input, and plotting.

Skipped without matplotlib.
"""

import json
import subprocess
import unittest
import xml.etree.ElementTree

from support import (DATA, PROGRAM, PROJECT, SCRIPTS, TestCase, has_matplotlib, interpreter_of)

SCRIPT = SCRIPTS / "benchmarks" / "plot-cost"
FIGURES = ("cost-spacing.svg", "cost-atoms.svg")


@unittest.skipUnless(has_matplotlib(SCRIPT), "python3-matplotlib is not installed")
class PlotCost(TestCase):
    def plot_cost(self, *arguments, code=0):
        done = subprocess.run([interpreter_of(SCRIPT), SCRIPT, *map(str, arguments)],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              check=False)
        self.assertDone(done, code)
        if code:
            self.assertEqual(done.stdout, "")
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        return done

    def words(self, name):
        text = (self.folder / name).read_text(encoding="utf-8")
        xml.etree.ElementTree.fromstring(text)
        return text

    def test_saved_costs_are_drawn_again(self):
        saved = PROJECT / "doc" / "cost.json"
        figures = json.loads(saved.read_text(encoding="utf-8"))
        self.plot_cost("--from", saved, "-o", self.folder)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), sorted(FIGURES))
        for name in FIGURES:
            words = self.words(name)
            for word in ("CPU time (s)", "peak memory (MB)", figures["date"][:10]):
                self.assertIn(word, words)
        self.assertIn("8,279 atoms", self.words("cost-spacing.svg"))

    def test_costs_are_measured_and_drawn(self):
        self.plot_cost(DATA / "c60.xyzr", "--program", PROGRAM, "--runs", "1", "--spacings",
                       "1.0,0.8", "--copies", "2", "--scratch", self.folder / "scratch",
                       "-o", self.folder / "made")
        self.assertEqual(list((self.folder / "scratch").iterdir()), [])
        figures = json.loads((self.folder / "made" / "cost.json").read_text(encoding="utf-8"))
        self.assertEqual([(row["spacing"], row["write"]) for row in figures["against_spacing"]],
                         [(spacing, write) for spacing in (1.0, 0.8)
                          for write in ("edges,areas", "grid,edges,areas")])
        atoms = {(row["source"], row["structure"]): row["atoms"]
                 for row in figures["against_atoms"]}
        self.assertEqual(atoms["assembled", "achbp x 2"], 2 * atoms["data", "achbp"])
        self.assertEqual(atoms["given", "c60"], 60)
        for row in figures["against_spacing"] + figures["against_atoms"]:
            self.assertGreater(row["cpu"], 0)
            self.assertGreater(row["peak_bytes"], 1_000_000)
        for name in FIGURES:
            self.assertIn("CPU time (s)", self.words(f"made/{name}"))

    def test_errors_are_one_line(self):
        out = ("-o", self.folder)
        for text in ("{", "{}", "[]"):
            (self.folder / "cost.json").write_text(text)
            self.assertIn("cost.json",
                          self.plot_cost("--from", self.folder / "cost.json", *out, code=1).stderr)
        self.plot_cost("--from", self.folder / "missing", *out, code=1)
        self.plot_cost("--program", self.folder / "missing", *out, code=1)
        self.plot_cost("--program", PROGRAM, "-o", self.folder / "cost.json", code=1)
        self.plot_cost(self.folder / "missing.xyzr", *out, code=2)
        self.plot_cost("--spacings", "2", *out, code=2)
        self.plot_cost("--from", self.folder / "cost.json", DATA / "c60.xyzr", *out, code=2)
