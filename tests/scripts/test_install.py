"""What is installed: files, a downstream project, and that nothing of ours leaks into it."""

import os
import pathlib
import re
import subprocess
import unittest

from support import PROJECT, TestCase

BUILD = pathlib.Path(os.environ["ESES_BUILD"])
COMPILER = os.environ["CXX"]


def run(*command, **how):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True,
                          check=False, timeout=600, **how)


class Install(TestCase):
    def setUp(self):
        super().setUp()
        self.prefix = self.folder / "prefix"
        self.assertDone(run("cmake", "--install", BUILD, "--prefix", self.prefix))

    def headers(self):
        return sorted(path.relative_to(self.prefix / "include")
                      for path in (self.prefix / "include").rglob("*.hpp"))

    def test_downstream_project(self):
        build = self.folder / "build"
        self.assertDone(run("cmake", "-G", "Unix Makefiles", "-S", PROJECT / "tests/downstream", "-B", build,
                            f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DCMAKE_CXX_COMPILER={COMPILER}"))
        self.assertDone(run("cmake", "--build", build, "--verbose"))
        self.assertDone(run(build / "blocks"))
        commands = self.folder.joinpath("build/CMakeFiles/blocks.dir/flags.make").read_text()
        for flag in ("-W", "-ffp-contract", "-fno-math-errno", "HWY_", "ESES_"):
            self.assertNotIn(flag, commands)

    def test_headers_stand_alone_and_define_no_macro(self):
        before = run(COMPILER, "-std=c++20", "-x", "c++", "-dM", "-E", os.devnull)
        self.assertDone(before)
        self.assertGreater(len(self.headers()), 8)
        for header in self.headers():
            source = self.folder / "one.cpp"
            source.write_text(f"#include <{header}>\n")
            flags = ("-std=c++20", f"-I{self.prefix}/include", "-Wall", "-Wextra", "-Werror")
            self.assertDone(run(COMPILER, *flags, "-fsyntax-only", source))
            macros = run(COMPILER, *flags, "-dM", "-E", source).stdout
            self.assertEqual(re.findall(r"#define (?:ESES|HWY|FMT)\w*", macros), [])

    def test_symbols_are_in_our_namespace(self):
        libraries = list(self.prefix.rglob("libeses.a"))
        if not libraries:
            self.skipTest("the library is a shared one")
        done = run("nm", "--demangle", "--extern-only", "--defined-only", libraries[0])
        self.assertDone(done)
        # Strong symbols; weak ones are templates and inline functions of others, which any program
        # may have.
        strong = re.findall(r"^[0-9a-f]+ [TDBR] (.+)$", done.stdout, re.MULTILINE)
        self.assertGreater(len(strong), 50)
        ours = re.compile(r"(?:vtable for |typeinfo for |typeinfo name for )?eses::|.*\[clone ")
        self.assertEqual([name for name in strong if not ours.match(name)], [])

    def test_library_holds_no_bytecode_of_the_compiler(self):
        libraries = list(self.prefix.rglob("libeses.a"))
        if not libraries:
            self.skipTest("the library is a shared one")
        done = run("objdump", "--section-headers", libraries[0])
        self.assertDone(done)
        self.assertIn(".text", done.stdout)
        self.assertNotIn(".gnu.lto_", done.stdout)

    def test_files(self):
        for name in ("bin/eses-blocks", "share/bash-completion/completions/eses-blocks"):
            self.assertTrue((self.prefix / name).is_file(), name)


if __name__ == "__main__":
    unittest.main()
