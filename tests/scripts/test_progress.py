"""Tests of the progress bar on a simulated terminal."""

import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import sys
import termios
import unittest

from support import PROGRAM, PROJECT, TestCase, skip_without_terminal

WIDTH = 70


class Bar(TestCase):
    def setUp(self):
        super().setUp()
        skip_without_terminal(self)
        self.input = self.folder / "many.xyzr"
        self.input.write_text("".join(f"{x * 3} {y * 3} {z * 3} 1.7\n" for x in range(16)
                                      for y in range(16) for z in range(16)))

    def run_on_terminal(self, *options, term="xterm", command=None, code=0):
        """Returns standard output and the text sent to the terminal."""
        master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, WIDTH, 0, 0))
        program = subprocess.Popen(
            command or [PROGRAM, self.input, "--spacing", "0.1", "--write", "areas", "-b", "17",
                        "-t", "1", "-o", self.folder / "out", *options],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=slave,
            env={**os.environ, "TERM": term}, text=True)
        os.close(slave)
        sent = b""
        while select.select([master], [], [], 120)[0]:
            try:
                part = os.read(master, 1 << 16)
            except OSError:  # the program has closed its end
                break
            if not part:
                break
            sent += part
        os.close(master)
        printed = program.communicate()[0]
        self.assertEqual(program.returncode, code, sent)
        return printed, sent.decode()

    def test_files_of_measure_are_counted(self):
        command = [PROGRAM, "measure", "-t", "1", *[self.input] * 20]
        printed, sent = self.run_on_terminal(command=command)
        self.assertEqual(printed.count("many.xyzr"), 20)
        self.assertRegex(sent, r"\d+% \[#* *\] +\d+/20 files")
        self.assertTrue(sent.endswith("\r"))
        quiet, sent = self.run_on_terminal(command=[*command, "-q"])
        self.assertNotIn("files", sent)

    def test_messages_are_coloured_on_terminals_only(self):
        point = self.folder / "point.xyzr"
        point.write_text("0 0 0 0.1\n")  # warned about
        command = [PROGRAM, "measure", point]
        plain = subprocess.run(command, capture_output=True, text=True, check=True).stderr
        self.assertTrue(plain.startswith("eses-blocks: warning: "), plain)
        coloured = self.run_on_terminal(command=command)[1].replace("\r\n", "\n")
        self.assertEqual(coloured, plain.replace("warning:", "\033[1;33mwarning:\033[0m"))
        self.assertNotIn("\033", self.run_on_terminal(command=command, term="dumb")[1])
        self.assertNotIn("\033", self.run_on_terminal(command=["env", "NO_COLOR=1", *command])[1])

    def test_errors_of_tools_are_coloured_on_terminals_only(self):
        command = [sys.executable, PROJECT / "scripts/render", self.folder / "no.ply", "-o", self.folder / "a.png"]
        plain = subprocess.run(command, capture_output=True, text=True, check=False).stderr
        self.assertTrue(plain.startswith("render: "), plain)
        coloured = self.run_on_terminal(command=command, code=1)[1].replace("\r\n", "\n")
        self.assertEqual(coloured, plain.replace("render:", "\033[1;31mrender:\033[0m", 1))
        self.assertNotIn("\033", self.run_on_terminal(command=["env", "NO_COLOR=1", *command], code=1)[1])

    def test_bar_grows_and_disappears(self):
        printed, sent = self.run_on_terminal()
        self.assertIn("surface area: ", printed)
        self.assertNotIn("\r", printed)
        lines = sent.split("\r")
        shares = [int(found[1]) for found in (re.match(r" *(\d+)% \[#* *\] +\d+/\d+ blocks", line)
                                              for line in lines) if found]
        self.assertGreater(len(shares), 3)
        self.assertEqual(shares, sorted(shares))
        self.assertIn(" left", sent)
        self.assertLess(max(len(line) for line in lines), WIDTH)
        # In the end the line is blank, and the cursor is at its start.
        self.assertEqual(lines[-1], "")
        self.assertEqual(lines[-2].strip(), "")

    def test_checks_have_a_bar(self):
        sent = self.run_on_terminal("--verify=200000")[1]
        self.assertRegex(sent, r"\d+/\d+ checks")

    def test_runs_with_resume_have_a_bar(self):
        self.assertRegex(self.run_on_terminal("--resume")[1], r"\d+/\d+ blocks")

    def test_bar_is_absent_where_it_would_disturb(self):
        self.assertEqual(self.run_on_terminal("--quiet")[1], "")
        self.assertNotIn("%", self.run_on_terminal(term="dumb")[1])

    def test_plan_is_shown_beside_json(self):
        printed, sent = self.run_on_terminal("--json")
        self.assertTrue(printed.startswith("{"))
        self.assertIn("grid: ", sent)


if __name__ == "__main__":
    unittest.main()
