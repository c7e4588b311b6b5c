"""Tests of Ctrl-C while a script imports its modules, and while it ends."""

import os
import re
import signal
import subprocess
import sys

from support import SCRIPTS, TestCase, forget_signals, run

# Replaces a module of the standard library that common.py imports.
MODULE = "difflib.py"
INTERRUPTED = """import os, signal, time
os.kill(os.getpid(), signal.SIGINT)
time.sleep(0.1)
print("still here")
"""


class Interrupt(TestCase):
    def run_interrupted(self, script, prepare):
        (self.folder / MODULE).write_text(INTERRUPTED)
        return run(script, "--help", preexec_fn=prepare,
                   env={**os.environ, "PYTHONPATH": str(self.folder)})

    def test_ctrl_c_prints_no_traceback(self):
        scripts = [str(path.relative_to(SCRIPTS)) for path in SCRIPTS.rglob("*")
                   if path.suffix == "" and path.is_file() and re.search(rb"import start$", path.read_bytes(), re.M)]
        self.assertEqual(len(scripts), 7)
        for script in scripts:
            with self.subTest(script=script):
                done = self.run_interrupted(script, forget_signals)
                self.assertEqual((done.returncode, done.stdout, done.stderr),
                                 (-signal.SIGINT, "", ""))

    def test_ignored_ctrl_c_stays_ignored(self):
        """Ctrl-C is ignored in a background job of a shell."""
        def prepare():
            forget_signals()
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        done = self.run_interrupted("assemble", prepare)
        self.assertIn("still here", done.stdout)

    def test_second_signal_does_not_disturb_cleaning_up(self):
        script = """import os, signal, sys, time
from eses_tools import common
number = int(sys.argv[1])
def main():
    try:
        os.kill(os.getpid(), number)
        time.sleep(10)
    finally:
        os.kill(os.getpid(), number)
        time.sleep(0.1)
        print("cleaned")
common.end_with(main)
"""
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 128 + signal.SIGTERM)):
            with self.subTest(signal=number):
                done = subprocess.run([sys.executable, "-c", script, str(int(number))], capture_output=True, text=True,
                                      check=False, timeout=60, preexec_fn=forget_signals,
                                      env={**os.environ, "PYTHONPATH": str(SCRIPTS)})
                self.assertEqual((done.returncode, done.stdout, done.stderr), (code, "cleaned\n", ""))
