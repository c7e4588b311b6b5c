"""scripts/figures: measuring and plotting on small input; skipped without matplotlib."""

import json
import pathlib
import subprocess
import unittest
import xml.etree.ElementTree

from support import DATA, PROGRAM, PROJECT, TestCase

# The script's own interpreter, to which Debian's matplotlib belongs.
SCRIPT = PROJECT / "scripts" / "figures"
PYTHON = SCRIPT.read_text(encoding="utf-8").partition("\n")[0].removeprefix("#!")


def has_matplotlib():
    return pathlib.Path(PYTHON).exists() and subprocess.run(
        [PYTHON, "-c", "import matplotlib"], stderr=subprocess.DEVNULL, check=False).returncode == 0


@unittest.skipUnless(has_matplotlib(), "python3-matplotlib is not installed")
class Figures(TestCase):
    def figures(self, *arguments, code=0):
        done = subprocess.run([PYTHON, SCRIPT, *map(str, arguments), "-o", self.folder],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              check=False)
        self.assertDone(done, code)
        return done

    def measure(self, name, *arguments, code=0):
        self.figures("measure", name, DATA, "--program", PROGRAM, "--scratch", self.folder,
                     "--runs", "1", *arguments, code=code)
        path = self.folder / f"paper-{name}.json"
        return json.loads(path.read_text(encoding="utf-8")) if code == 0 else None

    def words(self, name):
        """Of a figure: it is XML, and its text stands in comments beside the outlines."""
        text = (self.folder / f"paper-{name}.svg").read_text(encoding="utf-8")
        xml.etree.ElementTree.fromstring(text)
        return text

    def test_spacings_and_blocks(self):
        saved = self.measure("single", "--structure", "boxb", "--spacings", "0.8,0.4",
                             "--blocks", "none,16")
        self.assertEqual([(row["spacing"], row["block"]) for row in saved["rows"]],
                         [(0.8, "none"), (0.8, 16), (0.4, "none"), (0.4, 16)])
        for row in saved["rows"]:
            self.assertEqual(row["atoms"], 619)
            self.assertGreater(row["wall"], 0)
            self.assertGreater(row["peak_bytes"], 1_000_000)
        self.assertEqual(len({row["area"] for row in saved["rows"]}), 2)  # blocks change nothing
        self.figures("plot")
        words = self.words("single")
        for word in ("time (s)", "peak memory (MB)", "no blocks", "619 atoms",
                     saved["date"][:10], f"{saved['machine']['cores']} core"):
            self.assertIn(word, words)

    def test_copies(self):
        saved = self.measure("complex", "--structure", "c60", "--copies", "6",
                             "--spacings", "0.8,0.6")
        self.assertEqual({row["atoms"] for row in saved["rows"]}, {360})

    def test_core_set(self):
        (self.folder / "in").mkdir()
        for name in ("c60.xyzr", "boxb.pqr"):
            (self.folder / "in" / name).symlink_to(DATA / name)
        self.figures("measure", "core", self.folder / "in", "--program", PROGRAM, "--scratch",
                     self.folder)
        self.figures("plot")
        self.assertIn("Zhao et al. (2018)", self.words("core"))

    def test_errors(self):
        self.assertIn("nothing measured", self.figures("plot", code=1).stderr)
        self.measure("single", code=1)  # no 5z10 there
        (self.folder / "paper-core.json").write_text("[]")
        self.assertIn("paper-core.json", self.figures("plot", code=1).stderr)
