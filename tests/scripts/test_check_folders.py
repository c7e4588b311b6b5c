"""Tests of scripts/dev/check-folders on a small tree with one fault at a time."""

from support import TestCase, run

LIST = """# Comment.
low: Arithmetic.
middle: Files. | low
high: The program. | low middle
main.cpp: The entry point. | high

<tree.hpp> only in middle/find.cpp
<LIB/*> only in high/
#pragma omp only in low/
"""

SOURCES = {
    "include/eses/number.hpp": "#include <vector>\n",
    "include/eses/made.hpp.in": '#include "eses/number.hpp"\n',
    "src/low/add.hpp": '#include "eses/number.hpp"\n',
    "src/low/add.cpp": '#include "low/add.hpp"\n#pragma omp parallel for\n',
    "src/middle/find.cpp": '#include <tree.hpp>\n\n#include "low/add.hpp"\n',
    "src/middle/find.hpp": '#include "eses/made.hpp"\n',
    "src/high/run.cpp": '#include <LIB/LIB.hpp>\n#include "low/add.hpp"\n'
                        '#include "middle/find.hpp"\n',
    "src/high/run.hpp": "#pragma once\n",
    "src/main.cpp": '#include "high/run.hpp"\n',
    "src/high/README.md": "# high\n\nMay use: `low`, `middle`.\n",
}


class CheckFolders(TestCase):
    def setUp(self):
        super().setUp()
        self.write("src/folders.txt", LIST)
        for name, text in SOURCES.items():
            self.write(name, text)

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def change_list(self, old, new):
        self.assertIn(old, LIST)
        self.write("src/folders.txt", LIST.replace(old, new))

    def check(self, *problems):
        """Runs the script, which must report exactly these problems."""
        done = run("dev/check-folders", "--root", self.folder)
        self.assertEqual(done.stderr.splitlines(), list(problems))
        self.assertDone(done, 1 if problems else 0)

    def test_tree_as_listed_has_no_problems(self):
        self.check()

    def test_forbidden_include_is_reported(self):
        self.write("src/low/sub.cpp", '\n# include "middle/find.hpp"\n')
        self.check('src/low/sub.cpp:2: folder low must not use middle: "middle/find.hpp"')

    def test_forbidden_include_by_another_spelling_is_reported(self):
        self.write("src/low/sub.cpp", '#include "../middle/find.hpp"\n#include <high/run.hpp>\n')
        self.check('src/low/sub.cpp:1: folder low must not use middle: "../middle/find.hpp"',
                   "src/low/sub.cpp:2: folder low must not use high: <high/run.hpp>")

    def test_public_header_that_uses_a_room_is_reported(self):
        self.write("include/eses/number.hpp", '#include "low/add.hpp"\n')
        self.check('include/eses/number.hpp:1: include must not use src: "low/add.hpp"')

    def test_unknown_include_is_reported(self):
        self.write("src/low/sub.cpp", '#include "low/missing.hpp"\n')
        self.check('src/low/sub.cpp:1: "low/missing.hpp" is neither in src nor in include')

    def test_room_that_is_not_listed_is_reported(self):
        self.write("src/attic/old.cpp", '#include "low/add.hpp"\n')
        self.check("src/attic: this folder is not listed in src/folders.txt")

    def test_listed_room_that_does_not_exist_is_reported(self):
        self.change_list("high: ", "attic: Old things.\nhigh: ")
        self.check("src/folders.txt:4: folder attic is not there")

    def test_unused_permission_is_reported(self):
        self.change_list("entry point. | high", "entry point. | high low")
        self.check("src/folders.txt:5: folder main.cpp does not use low")

    def test_use_of_a_room_that_is_not_listed_is_reported(self):
        self.change_list("Files. | low", "Files. | low attic")
        self.check("src/folders.txt:3: folder middle may use attic, which is not listed")

    def test_cycle_is_reported(self):
        self.change_list("Arithmetic.", "Arithmetic. | high")
        self.write("src/low/sub.cpp", '#include "high/run.hpp"\n')
        self.check("src/folders.txt:2: cycle of folders: low -> high -> middle -> low")

    def test_room_that_uses_itself_is_reported(self):
        self.change_list("Files. | low", "Files. | low middle")
        self.check("src/folders.txt:3: cycle of folders: middle -> middle",
                   "src/folders.txt:3: folder middle does not use middle")

    def test_malformed_and_repeated_lines_are_reported(self):
        self.write("src/folders.txt", LIST + "attic | low\nlow: Again.\n")
        self.check("src/folders.txt:10: expected `FOLDER: SENTENCE. | FOLDER...` or "
                   "`<HEADER> only in PATH`",
                   "src/folders.txt:11: folder low is listed twice")

    def test_library_in_another_place_is_reported(self):
        self.write("src/middle/other.cpp",
                   "#include <tree.hpp>\n#include <LIB/more.hpp>\n#pragma omp critical\n")
        self.check("src/middle/other.cpp:1: <tree.hpp> is only allowed in src/middle/find.cpp",
                   "src/middle/other.cpp:2: <LIB/more.hpp> is only allowed in src/high/",
                   "src/middle/other.cpp:3: #pragma omp is only allowed in src/low/")

    def test_library_in_public_header_is_reported(self):
        self.write("include/eses/number.hpp", "#include <tree.hpp>\n")
        self.check("include/eses/number.hpp:1: <tree.hpp> is only allowed in src/middle/find.cpp")

    def test_two_places_may_use_a_library(self):
        self.write("src/folders.txt", LIST + "#pragma omp only in middle/\n")
        self.check("src/folders.txt:10: middle/ does not use #pragma omp")
        self.write("src/middle/other.cpp", "#pragma omp parallel\n")
        self.check()

    def test_readme_must_agree_with_the_list(self):
        self.write("src/middle/README.md", "# middle\n\nMay use: `low`, `high`.\n")
        self.check("src/middle/README.md:3: lists other folders than src/folders.txt:3")

    def test_missing_list_is_an_error(self):
        (self.folder / "src/folders.txt").unlink()
        done = run("dev/check-folders", "--root", self.folder)
        self.assertDone(done, 1)
        self.assertIn("folders.txt: No such file or directory", done.stderr)
