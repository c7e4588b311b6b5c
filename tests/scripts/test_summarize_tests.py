"""Tests of scripts/dev/summarize-tests on reports that ctest writes, and of the list of continuous
integration."""

import pathlib
import subprocess
import sys
import unittest

from support import PROJECT, TestCase, run

# One test skips by its exit code, one by its output, one in part, one without a reason.
TESTS = r"""
cmake_minimum_required(VERSION 3.21)
project(skips NONE)
enable_testing()
function(add name command)
  add_test(NAME ${name} COMMAND sh -c ${command})
  set_tests_properties(${name} PROPERTIES ${ARGN})
endfunction()
add("files: a" "seq 9999 && echo 'test skipped: no a' && echo 'test skipped: no a' && exit 77" SKIP_RETURN_CODE 77)
add(b "echo '  test skipped: b1, b2 and b3 are not installed'" SKIP_REGULAR_EXPRESSION "test skipped: ")
add(c "seq 9999 && printf 'test skipped: could not import \\047c0\\047: no\n'" LABELS part)
add(d "exit 77" SKIP_RETURN_CODE 77)
add(catch3 "printf 'x.cpp:5: SKIPPED:\nexplicitly with message:\n  no e\n' && exit 4" SKIP_RETURN_CODE 4)
add(done "echo no test was skipped" LABELS done)
"""
SKIPPED = ["  files: a: no a (2 tests)", "  b: b1, b2 and b3 are not installed",
           "  c: could not import 'c0': no", "  d: SKIP_RETURN_CODE=77", "  catch3: no e"]


class SummarizeTests(TestCase):
    def make_report(self, *options, more="", code=0):
        (self.folder / "CMakeLists.txt").write_text(TESTS + more)
        report = self.folder / "report.xml"
        for command, expected in ((("cmake", "-S", ".", "-B", "build"), 0),
                                  (("ctest", "--test-dir", "build", "--output-junit", report,
                                    "--test-output-size-passed", "1000000", *options), code)):
            self.assertDone(subprocess.run(command, cwd=self.folder, capture_output=True, text=True,
                                           check=False), expected)
        return report

    def permit(self, *lines):
        path = self.folder / "permitted"
        path.write_text("# A comment.\n\n" + "".join(f"{line}\n" for line in lines))
        return path

    def test_skips_are_listed_with_their_reasons(self):
        done = run("dev/summarize-tests", self.make_report())
        self.assertDone(done)
        heading, *lines, summary = done.stdout.splitlines()
        self.assertEqual(heading, "Skipped tests:")
        self.assertEqual(sorted(lines), sorted(SKIPPED))
        self.assertEqual(summary, "tests: 6; passed: 2, 1 of them in part; failed: 0; skipped: 4; "
                         "not installed: b1, b2, b3, c0")

    def test_names_of_failed_tests_are_at_the_end(self):
        failing = 'add("files: f" false LABELS f)\nadd(g "echo test skipped: needs g1 or a g2 && false" LABELS g)\n'
        done = run("dev/summarize-tests", self.make_report("-R", "^(done|files: f|g)$", more=failing, code=8))
        self.assertDone(done)
        self.assertEqual(done.stdout.splitlines(), [
            "Skipped tests:", "  g: needs g1 or a g2",
            "tests: 3; passed: 1; failed: 2; skipped: 0; not installed: g1",
            "failed: files: f", "failed: g"])

    def test_only_numbers_are_printed_if_all_tests_ran(self):
        done = run("dev/summarize-tests", self.make_report("-R", "done"))
        self.assertDone(done)
        self.assertEqual(done.stdout + done.stderr, "tests: 1; passed: 1; failed: 0; skipped: 0\n")

    def test_a_skip_that_is_not_permitted_is_an_error(self):
        report = self.make_report()
        explained = ("files: *: no a | there is no a", "[bcd]: * | letters")
        done = run("dev/summarize-tests", report, "--permitted", self.permit(*explained))
        self.assertDone(done, 1)
        self.assertIn("  files: a: no a (2 tests); permitted: there is no a\n", done.stdout)
        self.assertIn("  catch3: no e\n", done.stdout)
        self.assertIn("summarize-tests: 1 of 5 kinds of skips are not permitted", done.stderr)
        done = run("dev/summarize-tests", report, "--permitted",
                   self.permit(*explained, "catch3: no e | it is so"))
        self.assertDone(done)

    def test_malformed_list_is_an_error(self):
        report = self.make_report("-R", "done")
        for line in ("no a", "no a |", "| why"):
            done = run("dev/summarize-tests", report, "--permitted", self.permit(line))
            self.assertDone(done, 1)
            self.assertIn(":3: expected `PATTERN | EXPLANATION`", done.stderr)

    def test_runners_print_the_reasons(self):
        """The two runners of Python tests print what summarize-tests looks for."""
        for runner, text in (
                ("tests/scripts/run.py", "import unittest\nclass A(unittest.TestCase):\n"
                 "  def test_a(self): self.skipTest('no a')\n"
                 "  @unittest.skip('no b')\n  def test_b(self): pass\n  def test_c(self): pass\n"),
                ("python/tests/run.py", "import pytest\ndef test_a(): pytest.skip('no a')\n"
                 "@pytest.mark.skip(reason='no b')\ndef test_b(): pass\ndef test_c(): pass\n")):
            with self.subTest(runner=runner):
                path = self.folder / f"test_{pathlib.Path(runner).parts[0]}.py"
                path.write_text(text)
                done = subprocess.run([sys.executable, PROJECT / runner, path], cwd=self.folder,
                                      capture_output=True, text=True, check=False)
                if done.returncode == 77:
                    self.skipTest(f"{runner}: {done.stdout}")
                self.assertDone(done)
                reasons = [line for line in done.stdout.splitlines()
                           if line.startswith("test skipped: ")]
                self.assertEqual(reasons, ["test skipped: no a", "test skipped: no b"])

    def test_continuous_integration_refuses_missing_packages(self):
        """Its list is well-formed, and no entry permits that a package is missing."""
        report = self.folder / "report.xml"
        names = ("scripts: mesh", "faults: output", "python: stubtest")
        report.write_text("<testsuite>" + "".join(
            f'<testcase name="{name}" status="notrun"><system-out>test skipped: x is not installed'
            '</system-out></testcase>' for name in names) + "</testsuite>")
        done = run("dev/summarize-tests", report, "--permitted", PROJECT / ".ci/permitted-skips")
        self.assertDone(done, 1)
        self.assertIn("3 of 3 kinds of skips are not permitted", done.stderr)
        commands = [line for line in (PROJECT / ".ci/run").read_text().splitlines()
                    if "step scripts/test" in line]
        self.assertGreater(len(commands), 3)
        for line in commands:
            self.assertIn("scripts/test --complete ", line)


if __name__ == "__main__":
    unittest.main()
