"""Tests of Ctrl-C while a script imports its modules."""

import os
import re
import signal

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
