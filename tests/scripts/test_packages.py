"""Tests of scripts/lib/common.sh: which packages are installed on which release, and what is built.

Stand-ins for apt-get and its companions write down their calls. RELEASE lists the packages that the
release has, and BROKEN those that it cannot install.
"""

import os
import subprocess
import unittest

from support import PROJECT, TestCase, write_program

INSTALL = "-o DPkg::Lock::Timeout=300 -qq -y --no-install-recommends install "


class Packages(TestCase):
    def setUp(self):
        super().setUp()
        self.programs = self.folder / "programs"
        self.programs.mkdir()
        self.calls = self.folder / "calls"
        self.add("dpkg-query", "exit 1")  # nothing is installed
        self.add("apt-cache", 'case " $RELEASE " in *" $2 "*) echo "$2:"; echo "  Candidate: 1" ;; esac')
        self.add("apt-get", 'for name in $BROKEN; do case " $* " in *" $name "*) exit 100 ;; esac; done')
        self.add("cmake", "")
        self.add("sudo", 'while [ "$1" = -n ]; do shift; done; exec "$@"')

    def add(self, name, body):
        write_program(self.programs / name, f'echo "{name} $*" >>"{self.calls}"\n{body}\n')

    def source(self, commands, release="", broken=""):
        environment = {**os.environ, "PATH": f"{self.programs}:{os.environ['PATH']}", "RELEASE": release,
                       "BROKEN": broken}
        done = subprocess.run(["bash", "-c", f'source "$0"; {commands}', PROJECT / "scripts/lib/common.sh"],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
                              env=environment, timeout=60)
        calls = self.calls.read_text().splitlines() if self.calls.exists() else []
        return done, calls

    def installed(self, calls):
        return [line.partition(INSTALL)[2].split() for line in calls if INSTALL in line and "sudo" not in line]

    def test_first_package_of_the_release_is_chosen(self):
        for release, expected in (("a b c", ["a", "b"]), ("a c", ["a", "c"]), ("a b", ["a", "b"])):
            self.calls.unlink(missing_ok=True)
            done, calls = self.source("install_packages a 'b|c'", release)
            self.assertDone(done)
            self.assertEqual(self.installed(calls), [expected])

    def test_optional_packages_are_left_out_with_a_notice(self):
        done, calls = self.source("install_packages a 'b|c?' 'd?' 'e?'", "a d")
        self.assertDone(done)
        self.assertEqual(self.installed(calls), [["a", "d"]])
        self.assertEqual(done.stderr, "Going on without optional packages that cannot be installed here: b|c e\n")

    def test_optional_packages_that_cannot_be_installed_prevent_no_others(self):
        done, calls = self.source("install_packages a 'b?' 'c?'", "a b c", broken="b")
        self.assertDone(done)
        self.assertEqual(self.installed(calls), [["a", "b", "c"], ["a"], ["b"], ["c"]])
        self.assertIn("cannot be installed here: b\n", done.stderr)

    def test_missing_needed_packages_are_an_error(self):
        for release, broken in (("b", "a"), ("a b", "a")):
            done, _ = self.source("install_packages a 'b?'", release, broken)
            self.assertDone(done, 1)
            self.assertIn("could not install a", done.stderr)

    def test_nothing_is_called_if_all_packages_are_installed(self):
        self.add("dpkg-query", "echo installed | tr -d '\\n'")
        done, calls = self.source("install_packages a 'b|c' 'd?'")
        self.assertDone(done)
        self.assertEqual({line.split()[0] for line in calls}, {"dpkg-query"})
        self.assertEqual(done.stdout + done.stderr, "")

    def test_quickstart_installs_and_builds_only_the_program(self):
        """It also builds the library, which `cmake --install` installs."""
        done, calls = self.source("build_release", "")
        self.assertDone(done)
        packages, = self.installed(calls)
        self.assertIn("g++", packages)
        self.assertEqual([name for name in packages if name in ("catch2", "git", "help2man", "apbs")
                          or name.startswith(("python", "pybind"))], [])
        self.assertEqual([line for line in calls if line.startswith("cmake ")], [
            "cmake -S . -B build -DCMAKE_BUILD_TYPE=Release -DESES_BUILD_TESTS=OFF",
            "cmake --build build --target eses-blocks eses"])
        build = self.folder / "build"
        self.assertDone(subprocess.run(
            ["cmake", "-S", PROJECT, "-B", build, "-DESES_BUILD_TESTS=OFF", "-DESES_BUILD_PYTHON=OFF"],
            capture_output=True, text=True, check=False))
        rules = (build / "cmake_install.cmake").read_text()
        made = {line.split('"')[1] for line in rules.replace(" FILES ", "\n").splitlines()
                if line.startswith(f'"{build}/')}
        missing = {os.path.relpath(path, build) for path in made if not os.path.lexists(path)}
        self.assertEqual(missing, {"eses-blocks", "libeses.a"})
        self.assertEqual(os.readlink(build / "eses-msms"), "eses-blocks")


if __name__ == "__main__":
    unittest.main()
