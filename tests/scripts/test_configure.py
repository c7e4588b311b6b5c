"""Tests of the configuration with CMake where required packages are missing."""

import re
import subprocess
import sysconfig

from support import PROJECT, TestCase


class Configure(TestCase):
    def missing_packages(self, *arguments):
        """Returns the packages that CMake's message names."""
        done = subprocess.run(["cmake", "-S", PROJECT, "-B", self.folder / "build", *arguments],
                              capture_output=True, text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        found = re.search(r"Required packages are missing\..*?\n\n +apt-get install ([^\n]*)\n",
                          done.stderr, re.DOTALL)
        self.assertTrue(found, done.stderr)
        return set(found[1].split())

    def test_packages_of_missing_headers_are_named(self):
        # The headers of gemmi and PEGTL are only in a directory that CMake does not search.
        self.assertLessEqual({"gemmi-dev", "tao-pegtl-dev"},
                             self.missing_packages("-DCMAKE_IGNORE_PATH=/usr/include", "-DESES_WITH_GEMMI=ON"))

    def test_gemmi_is_optional(self):
        for option in ("AUTO", "OFF"):
            self.assertNotIn("gemmi-dev", self.missing_packages(
                "-DCMAKE_IGNORE_PATH=/usr/include", f"-DESES_WITH_GEMMI={option}",
                "-DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON"))

    def test_headers_of_gemmi_without_its_library_are_not_used(self):
        for name, text in (("gemmi/version.hpp", '#define GEMMI_VERSION "0.7.5"\n'),
                           ("gemmi/mmcif.hpp", ""), ("tao/pegtl.hpp", "")):
            path = self.folder / "include" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        include, triplet = self.folder / "include", sysconfig.get_config_var("MULTIARCH")
        options = (f"-DGEMMI_INCLUDE_DIR={include}", f"-DPEGTL_INCLUDE_DIR={include}",
                   "-DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON",
                   f"-DCMAKE_IGNORE_PATH=/lib/{triplet};/usr/lib/{triplet}")
        self.assertNotIn("gemmi-dev", self.missing_packages(*options))
        self.assertIn("gemmi-dev", self.missing_packages(*options, "-DESES_WITH_GEMMI=ON"))

    def test_all_missing_packages_are_named(self):
        names = {"nlohmann_json": "nlohmann-json3-dev", "CLI11": "libcli11-dev", "fmt": "libfmt-dev",
                 "nanoflann": "libnanoflann-dev", "ZLIB": "zlib1g-dev", "PkgConfig": "pkg-config"}
        found = self.missing_packages(
            *(f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in names))
        self.assertEqual(found, {*names.values(), "libhwy-dev"})

    def test_packages_for_python_are_named(self):
        self.assertEqual(self.missing_packages("-DESES_BUILD_PYTHON=ON",
                                               "-DCMAKE_DISABLE_FIND_PACKAGE_pybind11=ON"),
                         {"pybind11-dev"})
