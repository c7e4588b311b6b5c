"""Tests of the installation: its files, a downstream project, and that it does not affect other
code."""

import os
import pathlib
import re
import shutil
import subprocess
import unittest

from support import PROJECT, TestCase

BUILD = pathlib.Path(os.environ["ESES_BUILD"])
COMPILER = os.environ["CXX"]

# The beginnings of mangled names outside our namespace that are permitted. Templates and inline
# functions of the standard library and of header-only libraries are compiled into the library, as
# in any C++ library. They are weak symbols, of which the linker keeps one each.
SPECIAL = r"(?:T[VTISC]|GV|GR)?Z*"             # vtable of, type of, guard of; local to
NESTED = r"(?:N[rVKRO]*)?"
STANDARD = r"S[tabsiod]|9__gnu_cxx|10__cxxabiv1"
OURS = re.compile(f"_Z{SPECIAL}{NESTED}4eses")
OTHERS = re.compile(
    f"_Z{SPECIAL}{NESTED}(?:{STANDARD}|3fmt|3hwy|9nanoflann|5gemmi|3tao|10fast_float)"
    r"|_ZT[IS]P?K?F"                           # the type of a function, as std::function asks for
    r"|_Zn[wa]mPv$|_Zd[la]PvS_$"               # placement new, an inline function
    r"|DW\.ref\.|__clang_call_terminate$")     # made by the compiler


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

    def static_library(self):
        libraries = list(self.prefix.rglob("libeses.a"))
        if not libraries:
            self.skipTest("the library is a shared one")
        return libraries[0]

    def test_downstream_project_builds_and_runs(self):
        build = self.folder / "build"
        # pkg-config, fmt and Highway are hidden, because only building the library itself needs
        # them.
        missing = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in ("PkgConfig", "fmt", "hwy")]
        self.assertDone(run("cmake", "-G", "Unix Makefiles", "-S", PROJECT / "tests/downstream", "-B", build,
                            f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DCMAKE_CXX_COMPILER={COMPILER}",
                            *missing))
        self.assertDone(run("cmake", "--build", build, "--verbose"))
        self.assertDone(run(build / "blocks"))
        commands = self.folder.joinpath("build/CMakeFiles/blocks.dir/flags.make").read_text()
        for flag in ("-W", "-ffp-contract", "-fno-math-errno", "-fopenmp", "HWY_", "FMT_", "ESES_"):
            self.assertNotIn(flag, commands)
        self.assertNeedsNo(("hwy", "fmt", "mpi"), build)

    def test_pkg_config_finds_the_library(self):
        """One command compiles a program, also where the installation was moved to."""
        moved = self.folder / "moved"
        self.prefix.rename(moved)
        [file] = moved.rglob("eses.pc")
        environment = {**os.environ, "PKG_CONFIG_PATH": str(file.parent)}
        done = run("pkg-config", "--cflags", "--libs", "--static", "eses", env=environment)
        self.assertDone(done)
        for flag in ("-leses", "-lz", "-fopenmp"):
            self.assertIn(flag, done.stdout)
        self.assertDone(run(COMPILER, "-std=c++20", PROJECT / "tests/downstream/blocks.cpp", "-o",
                            self.folder / "blocks", *done.stdout.split()))
        libraries = {**os.environ, "LD_LIBRARY_PATH": str(file.parents[1])}
        self.assertDone(run(self.folder / "blocks", env=libraries))
        version = run("pkg-config", "--modversion", "eses", env=environment).stdout.strip()
        program = run(moved / "bin/eses-blocks", "--version", env=libraries).stdout
        self.assertEqual(program.splitlines()[0], f"eses-blocks {version}")

    def test_headers_stand_alone_and_define_only_the_version(self):
        before = run(COMPILER, "-std=c++20", "-x", "c++", "-dM", "-E", os.devnull)
        self.assertDone(before)
        self.assertGreater(len(self.headers()), 8)
        for header in self.headers():
            source = self.folder / "one.cpp"
            source.write_text(f"#include <{header}>\n")
            flags = ("-std=c++20", f"-I{self.prefix}/include", "-Wall", "-Wextra", "-Werror")
            self.assertDone(run(COMPILER, *flags, "-fsyntax-only", source))
            macros = run(COMPILER, *flags, "-dM", "-E", source).stdout
            version = [f"ESES_VERSION_{part}" for part in ("MAJOR", "MINOR", "PATCH")]
            self.assertEqual(sorted(re.findall(r"#define ((?:ESES|HWY|FMT)\w*)", macros)),
                             version if header.name in ("eses.hpp", "version.hpp") else [])

    def test_symbols_are_in_our_namespace(self):
        done = run("nm", "--extern-only", "--defined-only", self.static_library())
        self.assertDone(done)
        symbols = re.findall(r"^[0-9a-f]+ (\w) (\S+)$", done.stdout, re.MULTILINE)
        # nm's letters for weak symbols, and for symbols that exist once in the process.
        weak = {name for kind, name in symbols if kind in "VWvwu"}
        strong = {name for kind, name in symbols} - weak
        self.assertGreater(len(strong), 50)
        self.assertGreater(len(weak), 50)
        self.assertEqual(sorted(name for name in strong if not OURS.match(name)), [])
        self.assertEqual(sorted(name for name in weak if not (OURS.match(name) or OTHERS.match(name))),
                         [])

    def test_only_public_symbols_are_visible(self):
        """A shared library that contains the static one exports what the headers declare."""
        done = run("readelf", "--symbols", "--wide", "--demangle", self.static_library())
        self.assertDone(done)
        symbols = re.findall(r" (?:GLOBAL|WEAK|UNIQUE) +(\w+) +(\w+) (.+)$", done.stdout, re.MULTILINE)
        visible = {name for visibility, section, name in symbols
                   if visibility == "DEFAULT" and section != "UND"}
        hidden = {name for visibility, _, name in symbols if visibility == "HIDDEN"}
        ours = sorted(name for name in visible if re.match(r"(?:\w+ for )?eses::", name))
        self.assertEqual([name for name in ours if "::detail::" in name.split("(")[0].split("<")[0]], [])
        self.assertTrue(any(name.startswith("eses::detail::") for name in hidden))
        names = {name.split("(")[0] for name in ours}
        for name in ("Surface::Surface", "Result::is_inside", "Block::seconds", "compute", "make_mesh",
                     "for_each_block", "write_files", "estimate", "make_grid", "read_grid",
                     "read_atoms", "parse_atoms", "measure", "compute_dielectric"):
            self.assertIn(f"eses::{name}", names)
        self.assertIn("typeinfo for eses::MemoryLimitError", names)
        self.assertNotIn("MPI_", done.stdout)

    def test_all_files_are_installed(self):
        doc = "share/doc/eses-blocks"
        for name in ("bin/eses-blocks", "share/bash-completion/completions/eses-blocks",
                     "share/bash-completion/completions/eses-view",
                     "share/zsh/vendor-completions/_eses-blocks", "share/zsh/vendor-completions/_eses-tools",
                     "share/fish/vendor_completions.d/eses-blocks.fish",
                     "share/fish/vendor_completions.d/eses-msms.fish",
                     "share/eses-blocks/eses_pymol.py", f"{doc}/README.md",
                     f"{doc}/LICENSE", f"{doc}/CHANGELOG.md", f"{doc}/CITATION.cff",
                     f"{doc}/CONTRIBUTING.md", f"{doc}/SECURITY.md"):
            self.assertTrue((self.prefix / name).is_file(), name)
        pages = {path.name for path in (PROJECT / "doc").iterdir()
                 if path.suffix in (".md", ".png", ".sbatch", ".svg")}
        self.assertGreater(len(pages), 10)
        self.assertEqual({path.name for path in (self.prefix / doc / "doc").iterdir()}, pages)

    def test_links_have_the_interface_of_msms(self):
        spheres = self.folder / "spheres"
        spheres.write_text("0\t0\t0\t3\n")
        done = run(self.prefix / "bin/eses-msms", "-if", spheres, "-of", self.folder / "m")
        self.assertDone(done)
        self.assertIn("MSMS terminated normally", done.stdout)
        self.assertTrue((self.folder / "m.vert").is_file())
        for name in ("pdb_to_xyzr", "pdb_to_xyzrn"):
            done = run(self.prefix / f"bin/eses-{name}", "--help")
            self.assertDone(done)
            self.assertIn(f"eses-blocks {name} ", done.stdout)

    def test_scripts_run_from_their_folder(self):
        """Each script finds its modules and the installed program, from any folder."""
        scripts = self.prefix / "share/eses-blocks"
        before = sorted(scripts.rglob("*"))
        folder = self.folder / "structures"
        folder.mkdir()
        moved = self.prefix.rename(self.folder / "moved")  # the installation may be moved
        env = {**os.environ, "PATH": os.defpath}
        self.assertDone(run(moved / "bin/eses-assemble", PROJECT / "data/c60.xyzr", "--copies", "2",
                            "--rings", "1", "-o", folder / "two.xyzr", env=env, cwd=self.folder))
        done = run(moved / "bin/eses-pdbbind", folder, "-o", "out", env=env, cwd=self.folder)
        self.assertDone(done)
        self.assertIn("1 structure: 1 done", done.stdout)
        ion = self.folder / "ion.pqr"
        ion.write_text("ATOM 1 I ION 1 0.000 0.000 0.000 1.0000 3.0000\n")
        programs = self.folder / "programs"
        programs.mkdir()
        (programs / "apbs").write_text("#!/bin/sh\necho 'Fatal error: a replacement'; exit 3\n")
        (programs / "apbs").chmod(0o755)
        # The maps are made by the installed program before APBS is called.
        done = run(moved / "bin/eses-apbs", ion, "--keep", self.folder / "kept",
                   env={**env, "PATH": f"{programs}:{os.defpath}"})
        self.assertDone(done, 1)
        self.assertIn("eses-apbs: APBS fails (exit code 3)", done.stderr)
        self.assertTrue((self.folder / "kept/molecule1-x.dx").is_file())
        done = run(moved / "bin/eses-render", "missing.ply", "-o", "a.png", "--help", env=env)
        self.assertDone(done)
        self.assertIn("usage: eses-render", done.stdout)
        moved.rename(self.prefix)
        self.assertEqual(sorted(scripts.rglob("*")), before)  # nothing compiled stays behind

    def test_uninstall_removes_all_files(self):
        (self.prefix / "bin/other").write_text("")
        self.assertDone(run("cmake", f"-DBUILD={BUILD}", "-P", PROJECT / "cmake/uninstall.cmake"))
        self.assertEqual([path for path in self.prefix.rglob("*") if not path.is_dir()], [self.prefix / "bin/other"])
        self.assertEqual([path for path in self.prefix.rglob("eses*")], [])
        done = run("cmake", f"-DBUILD={BUILD}", "-P", PROJECT / "cmake/uninstall.cmake")
        self.assertEqual(done.returncode, 1)
        self.assertIn("nothing was installed", done.stderr)

    def test_all_modules_of_the_scripts_are_installed(self):
        scripts = self.prefix / "share/eses-blocks"
        self.assertEqual(sorted(path.name for path in scripts.iterdir() if path.is_file()),
                         ["apbs", "assemble", "eses_pymol.py", "pdbbind", "render", "report", "traj", "view"])
        installed, expected = ({str(path.relative_to(folder)) for path in (folder / "eses_tools").rglob("*")
                                if path.is_file() and "__pycache__" not in path.parts}
                               for folder in (scripts, PROJECT / "scripts"))
        self.assertEqual(installed, expected - {"eses_tools/README.md"})

    def test_commands_have_manual_pages_that_agree_with_their_help(self):
        """Every word of --help-all is in the page, and every option of the page in --help-all."""
        commands = {path.name: [path] for path in (self.prefix / "bin").iterdir()}
        commands |= {f"eses-blocks-{name}": [*commands["eses-blocks"], name] for name in ("diff", "interface", "measure")}
        pages = {path.stem: path for path in (self.prefix / "share/man/man1").iterdir()}
        self.assertEqual(set(pages), set(commands))
        for name, page in pages.items():
            with self.subTest(page=name):
                text = page.read_text()
                self.assertIn(f"\n{name} \\- ", text)
                # Scripts do not break the lines of their help.
                done = run(*commands[name], "--help-all", env={**os.environ, "COLUMNS": "1000"})
                self.assertDone(done)
                plain = re.sub(r"\\f[BIR]|\\[,/&]|^\.\w+", " ", text, flags=re.MULTILINE)
                plain = plain.replace("\\-", "-").replace("\\(aq", "'").replace("\\e", "\\")
                # help2man changes headings into capitals, and the usage into a synopsis.
                words, known = (set(re.findall(r"-*\w(?:[\w./-]*\w)?", part.lower())) for part in (done.stdout, plain))
                self.assertEqual(words - known - {"usage"}, set(), "run scripts/dev/make-manual")
                options = [set(re.findall(r"(?<![\w-])-?-[a-z][\w-]*", part)) for part in (plain, done.stdout)]
                self.assertGreater(len(options[0]), 2)
                self.assertEqual(options[0] - options[1], set(), "run scripts/dev/make-manual")
                if shutil.which("man"):
                    done = run("man", "--warnings", "--local-file", page,
                               env={**os.environ, "LC_ALL": "C.UTF-8"})
                    self.assertDone(done)
                    self.assertEqual(done.stderr, "")


if __name__ == "__main__":
    unittest.main()
