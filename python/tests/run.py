"""Runs one test file with pytest. Exit code 77 means to ctest that the file was skipped."""

import importlib.util
import os
import sys

sys.dont_write_bytecode = True
for name in ("numpy", "pytest"):
    if importlib.util.find_spec(name) is None:
        print(f"test skipped: {sys.executable} has no {name}")
        sys.exit(77)

import pytest  # noqa: E402  # pylint: disable=wrong-import-position


class Outcomes:
    """Counts the tests that did not skip, and prints the reasons of the others."""

    def __init__(self):
        self.done = 0

    def pytest_runtest_logreport(self, report):
        if report.skipped:
            reason = report.longrepr[2].removeprefix("Skipped: ")
            print(f"\ntest skipped: {reason}")  # for scripts/dev/summarize-tests
        elif report.when == "call":
            self.done += 1


outcomes = Outcomes()
os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
code = pytest.main(["-p", "no:cacheprovider", "-q", "-rs", *sys.argv[1:]], plugins=[outcomes])
sys.exit(77 if code == 0 and outcomes.done == 0 else code)
