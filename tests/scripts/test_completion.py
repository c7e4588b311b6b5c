"""The completions of the shells."""

import pathlib
import re
import shutil
import subprocess
import unittest

from support import PROGRAM, PROJECT, TestCase

COMPLETIONS = PROJECT / "packaging" / "completions"
BASH_COMPLETION = pathlib.Path("/usr/share/bash-completion/bash_completion")

# What bash does when Tab is pressed behind the last word.
COMPLETE = """
shopt -s progcomp extglob
source {library}
source {file}
COMP_WORDS=({words}) COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
COMP_LINE="${{COMP_WORDS[*]}}" COMP_POINT=${{#COMP_LINE}}
compopt() {{ :; }}
_eses_blocks "${{COMP_WORDS[0]}}" "${{COMP_WORDS[-1]}}" "${{COMP_WORDS[-2]}}"
printf '%s\\n' "${{COMPREPLY[@]}}"
"""


def options_of(*command):
    text = subprocess.run([PROGRAM, *command, "--help"], capture_output=True, text=True,
                          check=True).stdout
    return set(re.findall(r"^  (?:-\w, )?(--[\w-]+)", text, re.MULTILINE))


class Bash(TestCase):
    def complete(self, *words):
        if not BASH_COMPLETION.is_file():
            self.skipTest("bash-completion is not installed")
        script = COMPLETE.format(library=BASH_COMPLETION, file=COMPLETIONS / "eses-blocks.bash",
                                 words=" ".join(f"'{word}'" for word in (PROGRAM, *words)))
        done = subprocess.run(["bash", "--norc", "-c", script], capture_output=True, text=True,
                              cwd=self.folder, check=False)
        self.assertEqual(done.stderr, "")
        return set(done.stdout.split())

    def test_options(self):
        found = {name.rstrip("=") for name in self.complete("--")}
        self.assertEqual(found, options_of())
        self.assertEqual(self.complete("diff", "--"), options_of("diff"))

    def test_values_are_accepted(self):
        for option, others in (("--format", ()), ("--write", ()), ("--color", ("--mesh", "a.ply"))):
            values = self.complete(option, "")
            self.assertTrue(values)
            for value in values:
                done = subprocess.run([PROGRAM, "missing.pqr", option, value, *others],
                                      cwd=self.folder, capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn("cannot open missing.pqr", done.stderr)

    def test_values(self):
        (self.folder / "a.xyzr").touch()
        (self.folder / "a.txt").touch()
        (self.folder / "sub").mkdir()
        self.assertEqual(self.complete("--format", ""), {"auto", "xyzr", "pqr"})
        self.assertEqual(self.complete("a"), {"a.xyzr"})
        self.assertEqual(self.complete("a.xyzr", "-o", ""), {"sub"})
        self.assertEqual(self.complete("diff", ""), {"sub"})
        self.assertEqual(self.complete("--spacing", ""), set())


class Zsh(TestCase):
    def test_syntax(self):
        if not shutil.which("zsh"):
            self.skipTest("zsh is not installed")
        done = subprocess.run(["zsh", "-n", COMPLETIONS / "_eses-blocks"], capture_output=True,
                              text=True, check=False)
        self.assertDone(done)
        self.assertEqual(done.stderr, "")


if __name__ == "__main__":
    unittest.main()
