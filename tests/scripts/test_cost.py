"""Tests of scripts/benchmarks/cost: measuring and plotting on small input; skipped without
matplotlib."""

import csv
import gzip
import json
import shutil
import subprocess
import unittest
import xml.etree.ElementTree

from support import DATA, PROGRAM, SCRIPTS, TestCase, has_matplotlib, interpreter_of

SCRIPT = SCRIPTS / "benchmarks" / "cost"


@unittest.skipUnless(has_matplotlib(SCRIPT), "python3-matplotlib is not installed")
class Cost(TestCase):
    def cost(self, *arguments, code=0):
        command = [interpreter_of(SCRIPT), SCRIPT, *map(str, arguments), "-o", self.folder]
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              check=False)
        self.assertDone(done, code)
        return done

    def measure(self, name, *arguments, code=0):
        self.cost("measure", name, DATA, "--program", PROGRAM, "--scratch", self.folder,
                     "--runs", "1", *arguments, code=code)
        path = self.folder / f"{name}.json"
        return json.loads(path.read_text(encoding="utf-8")) if code == 0 else None

    def words(self, name):
        """Returns the text of a figure. SVG has it in comments beside the outlines of letters."""
        text = (self.folder / f"{name}.svg").read_text(encoding="utf-8")
        xml.etree.ElementTree.fromstring(text)
        return text

    def test_spacings_and_blocks_are_measured_and_drawn(self):
        saved = self.measure("paper-single", "--structure", "boxb", "--spacings", "0.8,0.4")
        self.assertEqual([(row["spacing"], row["series"]) for row in saved["rows"]],
                         [(spacing, blocks) for spacing in (0.8, 0.4)
                          for blocks in ("no blocks", "blocks of 128", "blocks of 64")])
        for row in saved["rows"]:
            self.assertEqual(row["atoms"], 619)
            self.assertGreater(row["wall"], 0)
            self.assertGreater(row["peak_bytes"], 1_000_000)
        self.assertEqual(len({row["area"] for row in saved["rows"]}), 2)  # the same area
        self.cost("plot")
        words = self.words("paper-single")
        for word in ("time (s)", "peak memory (MB)", "no blocks", "619 atoms",
                     saved["date"][:10], f"{saved['machine']['cores']} core"):
            self.assertIn(word, words)

    def test_copies_are_measured_and_drawn(self):
        saved = self.measure("paper-complex", "--structure", "c60", "--copies", "6",
                             "--spacings", "0.8,0.6")
        self.assertEqual({row["atoms"] for row in saved["rows"]}, {360})

    def test_core_set_is_measured_and_drawn(self):
        (self.folder / "in").mkdir()
        with open(DATA / "zhao2018.csv", encoding="utf-8", newline="") as table:
            first, second, third = sorted(row["id"] for row in csv.DictReader(table))[:3]
        for name in (f"a/{first}.xyzr", f"b/{first}.xyzr", f"{second}/{second}_protein.pqr",
                     "boxb.pqr", f"{first}2.xyzr"):
            path = self.folder / "in" / name
            path.parent.mkdir(exist_ok=True)
            shutil.copy(DATA / ("c60.xyzr" if path.suffix == ".xyzr" else "boxb.pqr"), path)
        # A truncated structure must not affect the others.
        (self.folder / "in" / f"{third}.xyzr.gz").write_bytes(
            gzip.compress(b"0 0 0 1\n" * 100)[:-12])
        done = self.cost("measure", "paper-core", self.folder / "in", "--program", PROGRAM,
                            "--scratch", self.folder, code=1)
        self.assertIn(f"{third}.xyzr.gz", done.stderr)
        saved = json.loads((self.folder / "paper-core.json").read_text(encoding="utf-8"))
        self.assertEqual([row["structure"] for row in saved["rows"]], [second, f"a/{first}"])
        self.cost("plot")
        for word in ("Zhao et al. (2018)", "2 structures"):
            self.assertIn(word, self.words("paper-core"))

    def test_captions_name_no_folders(self):
        (self.folder / "in" / "set").mkdir(parents=True)
        shutil.copy(DATA / "c60.xyzr", self.folder / "in" / "set" / "2ymd.xyzr")
        self.cost("measure", "paper-threads", self.folder / "in", "--program", PROGRAM, "--scratch",
                     self.folder, "--runs", "1", "--spacings", "0.8,0.4")
        self.cost("plot")
        self.assertIn("2ymd, 60 atoms", self.words("paper-threads"))
        self.assertNotIn("set/2ymd", self.words("paper-threads"))

    def test_structures_of_data_and_rings_are_measured(self):
        saved = self.measure("cost-atoms", "--structure", "c60", "--copies", "2")
        self.assertEqual([(row["structure"], row["atoms"]) for row in saved["rows"]], [("c60 × 2", 120)])
        self.cost("plot")
        self.assertIn("CPU time (s)", self.words("cost-atoms"))

    def test_saved_numbers_in_doc_are_drawn(self):
        names = {path.stem for path in SCRIPTS.parent.glob("doc/*.json")} & set(
            path.stem for pattern in ("cost-*", "paper-*") for path in SCRIPTS.parent.glob(f"doc/{pattern}.svg"))
        self.assertEqual(len(names), 6)
        for name in names:
            shutil.copy(SCRIPTS.parent / f"doc/{name}.json", self.folder)
        self.cost("plot")
        self.assertIn("8,279 atoms", self.words("cost-spacing"))
        for name in names:
            saved = json.loads((self.folder / f"{name}.json").read_text(encoding="utf-8"))
            self.assertIn(saved["date"][:10], self.words(name))

    def test_errors_are_one_line(self):
        self.assertIn("nothing measured", self.cost("plot", code=1).stderr)
        self.measure("paper-single", code=1)  # 5z10 is missing
        self.measure("paper-core", code=1)  # no structure of the paper's table
        (self.folder / "paper-single.json").mkdir()
        done = self.cost("measure", "paper-single", DATA, "--structure", "c60", "--program", PROGRAM,
                            "--scratch", self.folder, code=1)
        self.assertIn("paper-single.json", done.stderr)
        (self.folder / "paper-single.json").rmdir()
        (self.folder / "paper-core.json").write_text("[]")
        self.assertIn("paper-core.json", self.cost("plot", code=1).stderr)
