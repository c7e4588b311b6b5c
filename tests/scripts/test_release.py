"""Tests that the version is the same everywhere."""

import datetime
import re
import subprocess
import unittest

from support import PROGRAM, PROJECT, TestCase


def found(name, pattern):
    text = (PROJECT / name).read_text(encoding="utf-8")
    return re.search(pattern, text, re.MULTILINE).groups()


class Release(TestCase):
    def setUp(self):
        super().setUp()
        self.version, = found("CMakeLists.txt", r"^project\(eses-blocks VERSION (\S+)")
        self.release, self.date = found("CHANGELOG.md", r"^## \[(\d[^]]*)\] - (\d{4}-\d\d-\d\d)$")

    def test_program_has_the_version(self):
        done = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=False)
        self.assertDone(done)
        self.assertEqual(done.stdout.splitlines()[0], f"eses-blocks {self.version}")

    def test_changelog_has_the_version(self):
        self.assertEqual(self.release, self.version)
        headings = re.findall(r"^## (.*)", (PROJECT / "CHANGELOG.md").read_text(encoding="utf-8"),
                              re.MULTILINE)
        self.assertEqual(headings[:2], ["[Unreleased]", f"[{self.version}] - {self.date}"])

    def test_conda_recipe_has_the_version(self):
        self.assertEqual(found("packaging/conda/recipe.yaml", r'^  version: "(\S+)"$'), (self.version,))

    def test_python_package_has_the_version(self):
        pattern, = found("pyproject.toml", r"^regex = '(.*)'$")
        self.assertEqual(re.search(pattern, (PROJECT / "CMakeLists.txt").read_text())["value"], self.version)

    def test_manual_pages_have_the_version_and_the_date(self):
        month = datetime.date.fromisoformat(self.date).strftime("%B %Y")
        pages = sorted((PROJECT / "packaging/man").iterdir())
        self.assertGreater(len(pages), 10)
        for page in pages:
            self.assertEqual(found(page, r'^\.TH \S+ "1" "(.*?)" "eses-blocks (.*?)"'), (month, self.version),
                             "run scripts/dev/make-manual")

    def test_no_address_is_made_up(self):
        """Names of hosts that are reserved for examples appear in tests only."""
        reserved = re.compile(r"@[\w.-]*\bexample\.(?:org|com|net)\b|\bexample\.(?:org|com|net)/")
        for name in ("CITATION.cff", "README.md", "SECURITY.md", "pyproject.toml", *(
                path for folder in ("cmake", "packaging", ".github")
                for path in (PROJECT / folder).rglob("*") if path.is_file())):
            self.assertIsNone(reserved.search((PROJECT / name).read_text(encoding="utf-8")), name)

    def test_citation_has_the_version(self):
        self.assertEqual(found("CITATION.cff", r"^version: (\S+)$"), (self.version,))
        self.assertEqual(found("CITATION.cff", r"^date-released: (\S+)$"), (self.date,))


if __name__ == "__main__":
    unittest.main()
