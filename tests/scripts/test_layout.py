"""Tests of the folders of scripts/: calls from other directories, and descriptions in the
READMEs."""

import os
import re
import subprocess
import sys

from support import SCRIPTS, TestCase

FOLDERS = [SCRIPTS, SCRIPTS / "dev", SCRIPTS / "benchmarks", SCRIPTS / "eses_tools", SCRIPTS / "lib"]


def files_in(folder):
    return [path for path in sorted(folder.iterdir()) if path.is_file()]


def interpreter(script):
    is_python = "python" in script.read_text(encoding="utf-8").partition("\n")[0]
    return sys.executable if is_python else "bash"


class Layout(TestCase):
    def test_scripts_can_be_called_through_a_link(self):
        scripts = [path for folder in FOLDERS for path in files_in(folder)
                   if os.access(path, os.X_OK)]
        self.assertGreater(len(scripts), 15)
        for script in scripts:
            with self.subTest(script=script.relative_to(SCRIPTS)):
                link = self.folder / script.name
                link.symlink_to(script)
                done = subprocess.run([interpreter(script), link.name, "--help"], cwd=self.folder,
                                      stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                      check=False)
                # Scripts without options print their usage as an error.
                self.assertIn(done.returncode, (0, 2), done.stderr)
                self.assertIn("usage: ", (done.stdout + done.stderr).lower())
                self.assertNotIn("Traceback", done.stderr)

    def test_help_of_the_tools_is_short_and_begins_with_examples(self):
        for name in ("apbs", "assemble", "pdbbind", "render", "report", "traj", "view"):
            with self.subTest(script=name):
                brief, complete = (subprocess.run([interpreter(SCRIPTS / name), SCRIPTS / name, option],
                                                  capture_output=True, text=True, check=True,
                                                  env={**os.environ, "COLUMNS": "80"}).stdout
                                   for option in ("--help", "--help-all"))
                self.assertLess(brief.count("\n"), 60)
                examples, _, rest = brief.partition("\nexamples:\n")[2].partition("\n\n")
                self.assertEqual(examples.count(f"  {name} "), 3)
                self.assertIn("\noptions:\n", rest)
                options = [set(re.findall(r"^  (?:-\w[^,]*, )?(--[\w-]+)", text, re.MULTILINE))
                           for text in (brief, complete)]
                self.assertEqual(options[0] - options[1], set())
                known = sorted(options[1] - {"--help", "--help-all"})
                done = subprocess.run([interpreter(SCRIPTS / name), SCRIPTS / name, known[0] + "x"],
                                      capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 2)
                self.assertIn(f"unknown option {known[0]}x; did you mean {known[0]}?\n", done.stderr)

    def test_every_script_is_described(self):
        for folder in FOLDERS:
            text = (folder / "README.md").read_text(encoding="utf-8")
            described = {name for line in text.splitlines() if line.startswith("- `")
                         for name in line.partition(":")[0].split("`")[1::2]}
            names = {path.name for path in files_in(folder)} - {"README.md"}
            self.assertEqual(described, names)
