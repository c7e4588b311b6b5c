"""Tests of the documentation: links and anchors exist, and examples agree with the program."""

import json
import re
import shutil
import subprocess
import unittest
import urllib.parse

from support import PROGRAM, PROJECT, TestCase, needs_gemmi

FENCE = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^()\s]+)\)")
CODE = re.compile(r"`[^`\n]*`")

MAX_README_LINES = 150

# Lines of the report that depend on the machine or on the time of a run.
VARIABLE_LINES = ("blocks: ", "needs: ", "time: ", "peak memory: ")


def pages():
    """Returns all Markdown files of the project."""
    if shutil.which("git"):
        done = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md"],
                              cwd=PROJECT, capture_output=True, text=True, check=False)
        if done.returncode == 0 and done.stdout:
            return [PROJECT / name for name in done.stdout.splitlines() if (PROJECT / name).is_file()]
    # A source archive has no git repository.
    folders = [PROJECT, *(PROJECT / name for name in ("doc", "data", "scripts", "src", ".github"))]
    return sorted({path for folder in folders
                   for path in folder.glob("*.md" if folder == PROJECT else "**/*.md")})


def read(path):
    return path.read_text(encoding="utf-8")


def without_code(text):
    return CODE.sub("", FENCE.sub("", text))


def links_of(text):
    """Returns the targets of the links and images of a page, without addresses of other sites."""
    return [target for target in LINK.findall(without_code(text))
            if not urllib.parse.urlsplit(target).scheme]


def anchors_of(text):
    """Returns the names of the headings of a page, as GitHub makes them."""
    anchors = set()
    for heading in re.findall(r"^#+ +(.*?)#*$", FENCE.sub("", text), re.MULTILINE):
        label = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
        label = re.sub(r"[^\w\- ]", "", label).replace(" ", "-")
        name, number = label, 0
        while name in anchors:
            number += 1
            name = f"{label}-{number}"
        anchors.add(name)
    return anchors


def broken_links(path):
    """Returns the links of a page whose file or heading is missing."""
    broken = []
    for link in links_of(read(path)):
        name, _, anchor = urllib.parse.unquote(link).partition("#")
        target = (path.parent / name).resolve() if name else path
        if not target.exists() or (anchor and anchor not in anchors_of(read(target))):
            broken.append(link)
    return broken


def blocks_of(text, language):
    """Returns the fenced blocks of a page in this language; an empty name means blocks without
    one."""
    blocks = re.findall(r"^```(\w*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    return [code for name, code in blocks if name == language]


def report_of(*arguments):
    """Runs the program in the project's folder and returns its output."""
    return subprocess.run([PROGRAM, *arguments], cwd=PROJECT, capture_output=True, text=True,
                          check=False)


def lines_of(text):
    """Returns the lines of a program without their indentation and without empty lines."""
    return [line.strip() for line in text.splitlines() if line.strip()]


def contains(lines, part):
    return any(lines[first:first + len(part)] == part for first in range(len(lines)))


def keys_of(value):
    """Returns all keys of a JSON document."""
    if isinstance(value, dict):
        return set(value) | {key for item in value.values() for key in keys_of(item)}
    if isinstance(value, list):
        return {key for item in value for key in keys_of(item)}
    return set()


class Links(TestCase):
    def test_pages_are_found(self):
        names = {str(path.relative_to(PROJECT)) for path in pages()}
        self.assertLessEqual({"README.md", "CONTRIBUTING.md", "doc/README.md", "doc/output.md",
                              "data/README.md", "src/run/README.md"}, names)

    def test_links_exist(self):
        for path in pages():
            with self.subTest(page=str(path.relative_to(PROJECT))):
                self.assertEqual(broken_links(path), [])

    def test_index_names_every_page(self):
        linked = set(links_of(read(PROJECT / "doc/README.md")))
        for path in sorted((PROJECT / "doc").glob("*.md")):
            if path.name != "README.md":
                self.assertIn(path.name, linked)

    def test_broken_links_are_found(self):
        page = self.folder / "page.md"
        page.write_text("# One: `two`\n\n[a](page.md#one-two) [b](#one-two) [c](#three) "
                        "[d](gone.md) ![e](gone.png) [f](https://example.org/gone) `[g](gone.md)`\n"
                        "```\n[h](gone.md)\n# three\n```\n")
        self.assertEqual(broken_links(page), ["#three", "gone.md", "gone.png"])


class Examples(TestCase):
    def test_readme_is_short(self):
        self.assertLessEqual(len(read(PROJECT / "README.md").splitlines()), MAX_README_LINES)

    @needs_gemmi
    def test_measures_in_readme_are_those_of_the_program(self):
        shown, = blocks_of(read(PROJECT / "README.md"), "console")
        command, _, report = shown.partition("\n")
        done = report_of(*command.split()[2:])
        self.assertDone(done)
        self.assertEqual(report.strip(), done.stdout.strip())

    def test_report_in_output_is_that_of_the_program(self):
        shown, = (block for block in blocks_of(read(PROJECT / "doc/output.md"), "")
                  if block.startswith("input: "))
        done = report_of("data/1ubq.xyzr", "1.4", "0.4", "0.8", "-o", self.folder / "out")
        self.assertDone(done)
        printed = done.stdout.replace(str(self.folder / "out"), "out").splitlines()
        self.assertEqual([line.partition(": ")[0] for line in shown.splitlines()],
                         [line.partition(": ")[0] for line in printed])
        for line, expected in zip(printed, shown.splitlines()):
            if not line.startswith(VARIABLE_LINES):
                self.assertEqual(line, expected)

    def test_every_option_is_documented(self):
        options = set()
        for command in ([], ["measure"], ["interface"], ["diff"]):
            done = report_of(*command, "--help-all")
            self.assertDone(done)
            options.update(re.findall(r"^ +(?:-\w, )?(--[a-z][a-z-]*)", done.stdout, re.MULTILINE))
        self.assertGreater(len(options), 70)
        text = "\n".join(read(path) for path in pages() if path.parent in
                         (PROJECT, PROJECT / "doc") and path.name != "CHANGELOG.md")
        documented = set(re.findall(r"(?<![\w-])(--[a-z][a-z-]*)", text))
        self.assertEqual(sorted(options - documented), [])

    def test_json_keys_are_documented(self):
        text = read(PROJECT / "doc/output.md")
        done = report_of("data/boxb.pqr", "--json", "--quiet", "--verify=10", "--spacing", "1",
                         "--margin", "2", "--region=-100,-100,-100,100,100,100", "--resume",
                         "--mesh", self.folder / "mesh.ply", "-o", self.folder / "out")
        self.assertDone(done)
        keys = keys_of(json.loads(done.stdout))
        self.assertGreater(len(keys), 60)
        done = report_of("diff", "--json", self.folder / "out", self.folder / "out")
        self.assertDone(done)
        files = [entry for entry in json.loads(done.stdout).values() if isinstance(entry, dict)]
        self.assertEqual(len(files), 4)
        keys.update(key for entry in files for key in entry)
        self.assertEqual(sorted(key for key in keys if f"`{key}`" not in text), [])

    @needs_gemmi
    def test_json_keys_of_measure_and_interface_are_documented(self):
        text = "".join(read(PROJECT / "doc" / name) for name in ("measure.md", "cavities.md", "input.md", "output.md"))
        for arguments in (["interface", "tests/data/1a8o.cif.gz", "--assembly", "1"],
                          ["measure", "data/boxb.pqr", "--report", "10", "--write", "derivatives", "-o", self.folder],
                          ["measure", "data/fas2.pqr", "--cavities", "--pockets", "--at", "550"],
                          ["measure", "tests/data/1a8o.cif.gz", "--assembly", "1", "--parts", "chains"]):
            with self.subTest(arguments=arguments):
                done = report_of(*arguments, "--json")
                self.assertDone(done)
                keys = keys_of(json.loads(done.stdout))
                self.assertGreater(len(keys), 10)
                self.assertEqual(sorted(key for key in keys if f"`{key}`" not in text), [])

    def test_code_in_the_library_page_is_from_examples(self):
        sources = [lines_of(read(path)) for folder in ("examples", "tests/downstream")
                   for path in sorted((PROJECT / folder).rglob("*")) if path.is_file()]
        text = read(PROJECT / "doc/library.md")
        blocks = blocks_of(text, "cpp") + blocks_of(text, "cmake")
        self.assertGreater(len(blocks), 6)
        for block in blocks:
            with self.subTest(code=block):
                self.assertTrue(any(contains(source, lines_of(block)) for source in sources))

    def test_packages_to_build_are_listed(self):
        packages, = re.findall(r"^packages=\((.*?)\)", read(PROJECT / "scripts/lib/common.sh"),
                               re.MULTILINE | re.DOTALL)
        names = re.findall(r"[\w.+-]+", packages)
        self.assertGreater(len(names), 10)
        words = set(re.findall(r"[\w.+-]+", read(PROJECT / "doc/development.md")))
        self.assertEqual([name for name in names if name not in words], [])


if __name__ == "__main__":
    unittest.main()
