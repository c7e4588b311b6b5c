"""Tests of projects that contain the sources of the library instead of an installed package."""

import os
import subprocess
import unittest

from support import PROJECT, TestCase

COMPILER = os.environ["CXX"]

# Only the program and the tests need these packages.
UNNEEDED = ("CLI11", "nlohmann_json", "MPI", "Catch2", "Python", "Python3", "pybind11", "Doxygen")


def run(*command):
    return subprocess.run([str(part) for part in command], capture_output=True, text=True,
                          check=False, timeout=1000)


class Subproject(TestCase):
    def configure(self, *arguments):
        self.build = self.folder / "build"
        self.assertDone(run("cmake", "-G", "Unix Makefiles", "-S", PROJECT / "tests/downstream/sources",
                            "-B", self.build, f"-DESES_SOURCE_DIR={PROJECT}",
                            f"-DCMAKE_CXX_COMPILER={COMPILER}", *arguments,
                            *(f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in UNNEEDED)))

    def build_and_run(self):
        self.assertDone(run("cmake", "--build", self.build))
        self.assertDone(run(self.build / "blocks"))
        self.assertNeedsNo(("mpi", "fmt", "hwy"), self.build)
        self.assertFalse(list(self.build.rglob("eses-blocks")))  # the program is not built
        self.assertIn("Total Tests: 0", run("ctest", "--test-dir", self.build, "-N").stdout)

    def test_sources_are_a_part_of_a_project(self):
        """Both ways have the same build directory, so that the library is compiled once."""
        self.configure("-DDOWNSTREAM_FETCHES=OFF")
        self.build_and_run()
        # The project chose no build type, and none was forced on it.
        self.assertIn("\nCMAKE_BUILD_TYPE:STRING=\n", (self.build / "CMakeCache.txt").read_text())
        flags = self.build / "_deps/eses-build/CMakeFiles/eses_objects.dir/flags.make"
        self.assertNotRegex(flags.read_text(), r" -O\d|NDEBUG")
        self.configure("-DDOWNSTREAM_FETCHES=ON")
        (self.build / "blocks").unlink()
        self.build_and_run()

    def test_chosen_build_type_holds(self):
        self.configure("-DCMAKE_BUILD_TYPE=RelWithDebInfo")
        flags = self.build / "_deps/eses-build/CMakeFiles/eses_objects.dir/flags.make"
        self.assertRegex(flags.read_text(), " -O2 -g -DNDEBUG ")


if __name__ == "__main__":
    unittest.main()
