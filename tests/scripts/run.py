"""Runs the tests of one file. Exit code 77 means to ctest that all of them were skipped."""

import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
path = pathlib.Path(sys.argv[1]).resolve()
sys.path.insert(0, str(path.parent))
result = unittest.TextTestRunner(verbosity=2).run(
    unittest.defaultTestLoader.loadTestsFromName(path.stem))
if not result.wasSuccessful() or result.testsRun == 0:
    sys.exit(1)
for _, reason in result.skipped:
    print(f"test skipped: {reason}")  # for scripts/dev/summarize-tests
if len(result.skipped) == result.testsRun:
    sys.exit(77)
