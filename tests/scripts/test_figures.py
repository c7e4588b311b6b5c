"""Tests of scripts/benchmarks/figures: measuring and plotting on small input; skipped without
matplotlib."""

import csv
import gzip
import json
import shutil
import subprocess
import unittest
import xml.etree.ElementTree

from support import DATA, PROGRAM, SCRIPTS, TestCase, has_matplotlib, interpreter_of

SCRIPT = SCRIPTS / "benchmarks" / "figures"


@unittest.skipUnless(has_matplotlib(SCRIPT), "python3-matplotlib is not installed")
class Figures(TestCase):
    def figures(self, *arguments, code=0):
        command = [interpreter_of(SCRIPT), SCRIPT, *map(str, arguments), "-o", self.folder]
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              check=False)
        self.assertDone(done, code)
        return done

    def measure(self, name, *arguments, code=0):
        self.figures("measure", name, DATA, "--program", PROGRAM, "--scratch", self.folder,
                     "--runs", "1", *arguments, code=code)
        path = self.folder / f"paper-{name}.json"
        return json.loads(path.read_text(encoding="utf-8")) if code == 0 else None

    def words(self, name):
        """Returns the text of a figure. SVG has it in comments beside the outlines of letters."""
        text = (self.folder / f"paper-{name}.svg").read_text(encoding="utf-8")
        xml.etree.ElementTree.fromstring(text)
        return text

    def test_spacings_and_blocks_are_measured_and_drawn(self):
        saved = self.measure("single", "--structure", "boxb", "--spacings", "0.8,0.4",
                             "--blocks", "none,16")
        self.assertEqual([(row["spacing"], row["block"]) for row in saved["rows"]],
                         [(0.8, "none"), (0.8, 16), (0.4, "none"), (0.4, 16)])
        for row in saved["rows"]:
            self.assertEqual(row["atoms"], 619)
            self.assertGreater(row["wall"], 0)
            self.assertGreater(row["peak_bytes"], 1_000_000)
        self.assertEqual(len({row["area"] for row in saved["rows"]}), 2)  # the same area
        self.figures("plot")
        words = self.words("single")
        for word in ("time (s)", "peak memory (MB)", "no blocks", "619 atoms",
                     saved["date"][:10], f"{saved['machine']['cores']} core"):
            self.assertIn(word, words)

    def test_copies_are_measured_and_drawn(self):
        saved = self.measure("complex", "--structure", "c60", "--copies", "6",
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
        done = self.figures("measure", "core", self.folder / "in", "--program", PROGRAM,
                            "--scratch", self.folder, code=1)
        self.assertIn(f"{third}.xyzr.gz", done.stderr)
        saved = json.loads((self.folder / "paper-core.json").read_text(encoding="utf-8"))
        self.assertEqual([row["structure"] for row in saved["rows"]], [second, f"a/{first}"])
        self.figures("plot")
        for word in ("Zhao et al. (2018)", "2 structures"):
            self.assertIn(word, self.words("core"))

    def test_captions_name_no_folders(self):
        (self.folder / "in" / "set").mkdir(parents=True)
        shutil.copy(DATA / "c60.xyzr", self.folder / "in" / "set" / "2ymd.xyzr")
        self.figures("measure", "threads", self.folder / "in", "--program", PROGRAM, "--scratch",
                     self.folder, "--runs", "1", "--spacings", "0.8,0.4", "--blocks", "16")
        self.figures("plot")
        self.assertIn("2ymd, 60 atoms", self.words("threads"))
        self.assertNotIn("set/2ymd", self.words("threads"))

    def test_errors_are_one_line(self):
        self.assertIn("nothing measured", self.figures("plot", code=1).stderr)
        self.measure("single", code=1)  # 5z10 is missing
        self.measure("core", code=1)  # no structure of the paper's table
        (self.folder / "paper-single.json").mkdir()
        done = self.figures("measure", "single", DATA, "--structure", "c60", "--program", PROGRAM,
                            "--scratch", self.folder, code=1)
        self.assertIn("paper-single.json", done.stderr)
        (self.folder / "paper-single.json").rmdir()
        (self.folder / "paper-core.json").write_text("[]")
        self.assertIn("paper-core.json", self.figures("plot", code=1).stderr)
