"""Tests of the completions of the shells."""

import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import tempfile
import unittest

from support import PROGRAM, PROJECT, SCRIPTS, TestCase, skip_without_terminal, write_map

COMPLETIONS = PROJECT / "packaging" / "completions"
TOOLS = ("apbs", "assemble", "pdbbind", "render", "report", "traj", "view")
BASH_COMPLETION = pathlib.Path("/usr/share/bash-completion/bash_completion")

# Runs the steps of bash when Tab is pressed after the last word.
COMPLETE = """
shopt -s progcomp extglob
source {library}
source '{file}'
COMP_WORDS=({words}) COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
COMP_LINE="${{COMP_WORDS[*]}}" COMP_POINT=${{#COMP_LINE}}
compopt() {{ :; }}
{function} "${{COMP_WORDS[0]}}" "${{COMP_WORDS[-1]}}" "${{COMP_WORDS[-2]}}"
printf '%s\\n' "${{COMPREPLY[@]}}"
"""


# An interactive zsh writes down the completions that it is offered, and then ends. Calls of compadd
# with -A, -D or -O only ask which words match.
ZSH_SETUP = """
unsetopt prompt_cr prompt_sp beep
fpath=('{completions}' $fpath)
autoload -U compinit && compinit -u -d {folder}/dump
compadd() {{
  local -a offered
  if [[ " ${{@[1,(i)(-|--)]}}" != *" -"[a-zA-Z0-9]#[ADO]* ]]; then
    builtin compadd -A offered "$@"
    if (( $#offered )); then print -rl -- $offered >>{offered}; fi
  fi
  builtin compadd "$@"
}}
note_end() {{ touch {offered}; exit }}
comppostfuncs=(note_end)
bindkey '^I' complete-word
PS1='READY''>'
"""


def options_of(*command):
    text = subprocess.run([PROGRAM, *command, "--help-all"], capture_output=True, text=True,
                          check=True).stdout
    return set(re.findall(r"^  (?:-\w, )?(--[\w-]+)", text, re.MULTILINE))


def options_of_tool(name):
    text = subprocess.run([SCRIPTS / name, "--help-all"], capture_output=True, text=True, check=True,
                          env={**os.environ, "COLUMNS": "1000"}).stdout
    return set(re.findall(r"^  (?:-\w [^,]*, |-\w, )?(--[\w-]+)", text, re.MULTILINE))


def link_tools(folder):
    """Makes links to the tools with their installed names."""
    for name in TOOLS:
        pathlib.Path(folder, f"eses-{name}").symlink_to(SCRIPTS / name)


class Bash(TestCase):
    def complete(self, *words, tool=None):
        if not BASH_COMPLETION.is_file():
            self.skipTest("bash-completion is not installed")
        with tempfile.TemporaryDirectory() as folder:
            # Bash has the words as they are typed, where a blank in the path is escaped.
            program = pathlib.Path(folder, f"eses-{tool}" if tool else PROGRAM.name)
            program.symlink_to(SCRIPTS / tool if tool else PROGRAM)
            script = COMPLETE.format(library=BASH_COMPLETION, file=COMPLETIONS / "eses-blocks.bash",
                                     function="_eses_tool" if tool else "_eses_blocks",
                                     words=" ".join(f"'{word}'" for word in (program, *words)))
            done = subprocess.run(["bash", "--norc", "-c", script], capture_output=True, text=True,
                                  cwd=self.folder, check=False)
        self.assertEqual(done.stderr, "")
        return set(done.stdout.split())

    def test_options_are_those_of_help(self):
        found = {name.rstrip("=") for name in self.complete("--")}
        self.assertEqual(found, options_of())
        self.assertEqual(self.complete("diff", "--"), options_of("diff"))

    def test_options_of_tools_are_those_of_their_help(self):
        for name in ("view", "traj"):
            found = {option.rstrip("=") for option in self.complete("--", tool=name)}
            self.assertEqual(found, options_of_tool(name))
        self.assertEqual(self.complete("a.ply", "--atoms", "", tool="view"), {"none", "sticks", "balls", "spheres"})
        self.assertEqual(self.complete("a.ply", "--surface", "s", tool="view"), {"ses", "sas"})

    def test_options_of_msms_are_those_of_its_help(self):
        text = subprocess.run([PROGRAM, "msms", "--help"], capture_output=True, text=True,
                              check=True).stdout
        known = set(re.findall(r"^  (-\w\w+)", text, re.MULTILINE)) - {"-no_rest_on_pbr"}
        self.assertEqual(self.complete("msms", "-") - {"--help", "--version", "--allow-far-atoms"}, known)
        self.assertEqual(self.complete("msms", "-surface", ""), {"tses", "ases"})

    def test_completed_values_are_accepted_by_the_program(self):
        for option, others in (("--format", ()), ("--write", ()), ("--color", ("--mesh", "a.ply"))):
            values = self.complete(option, "")
            self.assertTrue(values)
            for value in values:
                more = (("--potential", write_map(self.folder / "x.dx", 1))
                        if value == "potential" else ())
                done = subprocess.run([PROGRAM, "missing.pqr", option, value, *others, *more],
                                      cwd=self.folder, capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn("cannot open missing.pqr", done.stderr)

    def test_values_and_files_are_completed(self):
        (self.folder / "a.xyzr").touch()
        (self.folder / "a.txt").touch()
        for name in ("m.ply", "m.obj", "m.off", "m.vtp", "m.stl", "m.glb", "m.face", "i.dx", "i.vti",
                     "z.dx.gz", "z.gz"):
            (self.folder / name).touch()
        (self.folder / "sub").mkdir()
        self.assertEqual(self.complete("--mesh", ""),
                         {"m.ply", "m.obj", "m.off", "m.vtp", "m.stl", "m.glb", "m.face", "sub"})
        self.assertEqual(self.complete("--inside", ""), {"i.dx", "i.vti", "z.dx.gz", "sub"})
        self.assertEqual(self.complete("--kappa", ""), {"i.dx", "z.dx.gz", "sub"})
        self.assertEqual(self.complete("--format", ""), {"auto", "xyzr", "pqr", "pdb", "mmcif"})
        self.assertEqual(self.complete("a"), {"a.xyzr"})
        self.assertEqual(self.complete("a.xyzr", "-o", ""), {"sub"})
        self.assertEqual(self.complete("diff", ""), {"sub"})
        self.assertEqual(self.complete("--spacing", ""), set())

    def test_later_names_of_a_list_are_completed(self):
        self.assertEqual(self.complete("--write", "grid,"),
                         {f"grid,{name}" for name in ("all", "none", "edges", "areas", "residues", "atoms")})
        self.assertEqual(self.complete("measure", "--write", "res,atoms,r"), {"res,atoms,residues", "res,atoms,rsa"})
        self.assertEqual(self.complete("interface", "--write", "pdb,c"), {"pdb,cif"})
        self.assertEqual(self.complete("measure", "--surface", "sas,v"), {"sas,vdw"})
        self.assertEqual(self.complete("--surface", ""), {"ses", "sas", "vdw"})


class Zsh(TestCase):
    def setUp(self):
        super().setUp()
        if not shutil.which("zsh"):
            self.skipTest("zsh is not installed")
        skip_without_terminal(self)

    def complete(self, line):
        """Returns the completions of an interactive zsh when Tab is pressed at the end of the
        line."""
        with tempfile.TemporaryDirectory() as folder:
            offered = pathlib.Path(folder, "offered")
            setup = pathlib.Path(folder, "setup")
            link_tools(folder)
            setup.write_text(ZSH_SETUP.format(folder=folder, completions=COMPLETIONS, offered=offered))
            child, terminal = pty.fork()
            if child == 0:
                os.chdir(self.folder)
                os.environ["PATH"] = f"{folder}:{PROGRAM.parent}:{os.environ['PATH']}"
                os.environ["TERM"] = "xterm"
                os.execlp("zsh", "zsh", "-f", "-i")
            try:
                os.write(terminal, f"source {setup}\n".encode())
                shown = self.read_until(terminal, b"READY>")
                os.write(terminal, f"{line}\t".encode())
                # zsh ends itself after the completion, and with it the terminal.
                shown += self.read_until(terminal, None)
            finally:
                os.close(terminal)
                os.waitpid(child, 0)
            self.assertTrue(offered.exists(), shown)
            return offered.read_text().splitlines()

    @staticmethod
    def read_until(terminal, mark):
        shown = b""
        while mark is None or mark not in shown:
            ready, _, _ = select.select([terminal], [], [], 60)
            if not ready:
                raise TimeoutError(shown)
            try:
                read = os.read(terminal, 4096)
            except OSError:  # Linux reports that the other end is closed
                read = b""
            if not read:
                break
            shown += read
        return shown

    def test_script_has_no_syntax_error(self):
        done = subprocess.run(["zsh", "-n", COMPLETIONS / "_eses-blocks"], capture_output=True,
                              text=True, check=False)
        self.assertDone(done)
        self.assertEqual(done.stderr, "")

    def test_options_are_those_of_help(self):
        for command in ((), ("diff",)):
            words = " ".join((PROGRAM.name, *command))
            found = {name.rstrip("=") for name in self.complete(f"{words} --")}
            self.assertEqual(found, options_of(*command))
        self.assertEqual(self.complete(f"{PROGRAM.name} --js"), ["--json"])
        for name in ("view", "traj"):
            found = {option.rstrip("=") for option in self.complete(f"eses-{name} --")}
            self.assertEqual(found, options_of_tool(name))
        self.assertEqual(set(self.complete("eses-traj --surface=")), {"all", "ses", "sas"})

    def test_files_commands_and_values_are_completed(self):
        for name in ("a.xyzr", "b.pqr.gz", "c.ply", "d.obj", "e.off", "f.dx", "g.vti", "h.txt", "i.cif.gz",
                     "j.vtp", "k.dx.gz", "l.gz", "m.pdb12.gz", "n.pdbx", "o.mcif", "p.pdbq"):
            (self.folder / name).touch()
        (self.folder / "sub").mkdir()
        meshes, maps = {"c.ply", "d.obj", "e.off", "j.vtp"}, {"f.dx", "g.vti", "k.dx.gz"}
        atoms = {"a.xyzr", "b.pqr.gz", "i.cif.gz", "m.pdb12.gz", "n.pdbx", "o.mcif"}
        for line, expected in (
                ("", atoms | {"sub", "diff", "interface", "measure", "msms", "pdb_to_xyzr", "pdb_to_xyzrn"}),
                ("di", {"diff"}),
                ("--json ", atoms | {"sub"}),
                ("a.xyzr -o ", {"sub"}),
                ("a.xyzr --output-dir=", {"sub"}),
                ("a.xyzr --mesh ", meshes | {"sub"}),
                ("a.xyzr --mesh=", meshes | {"sub"}),
                ("a.xyzr --inside ", maps | {"sub"}),
                ("a.xyzr --kappa ", {"f.dx", "k.dx.gz", "sub"}),
                ("a.xyzr --color ", {"patch", "atom", "chain", "potential", "component"}),
                ("a.xyzr --potential ", {"f.dx", "k.dx.gz", "sub"}),
                ("a.xyzr --format ", {"auto", "xyzr", "pqr", "pdb", "mmcif"}),
                ("a.xyzr --write ", {"all", "none", "grid", "edges", "areas", "residues", "atoms"}),
                ("a.xyzr --write grid,", {"all", "none", "edges", "areas", "residues", "atoms"}),
                ("measure --write res,atoms,rs", {"rsa"}),
                ("interface a.pdb --write pdb,c", {"cif"}),
                ("measure --surface sas,v", {"vdw"}),
                ("a.xyzr --threads ", set()),
                ("a.xyzr ", set()),
                *((f"measure {option} ", {"atoms", "residues", "chains", "derivatives", "cavities",
                   "pieces", "pockets", "rsa", "seq", "res", "pdb", "cif"})
                  for option in ("--write", "--table")),
                ("measure a.xyzr --parts ", {"chains"}),
                *((f"interface a.pdb {option} ", {"interfaces", "residues", "atoms", "pdb", "cif"}) for option in ("--write", "--table")),
                ("measure a.pdb --radii ", {"protor", "bondi", "msms", "naccess", "oons", "protor+shannon", "bondi+shannon", "occupancy", "sub", "a.xyzr", "b.pqr.gz", "i.cif.gz",
                                            "m.pdb12.gz", "o.mcif", "l.gz", "p.pdbq", "n.pdbx"} | meshes | maps | {"h.txt"}),
                ("measure a.pdb --surface ", {"ses", "sas", "vdw", "all"}),
                ("measure a.pdb --hydrogens ", {"keep", "drop"}),
                ("msms -surface ", {"tses", "ases"}),
                ("pdb_to_xyzr --form", {"--format"}),
                ("diff ", {"sub"}),
                ("diff sub ", {"sub"}),
                ("diff --tolerance ", set())):
            with self.subTest(line=line):
                found = {name.rstrip("/") for name in self.complete(f"{PROGRAM.name} {line}")}
                self.assertEqual(found, expected)


class Fish(TestCase):
    def complete(self, line):
        """Returns the completions, without their descriptions."""
        if not shutil.which("fish"):
            self.skipTest("fish is not installed")
        with tempfile.TemporaryDirectory() as folder:
            link_tools(folder)
            script = f"source '{COMPLETIONS / 'eses-blocks.fish'}'; complete -C '{line}'"
            done = subprocess.run(["fish", "--no-config", "-c", script], capture_output=True, text=True, check=False,
                                  cwd=self.folder, env={**os.environ, "HOME": folder,
                                                        "PATH": f"{folder}:{PROGRAM.parent}:{os.environ['PATH']}"})
        self.assertEqual(done.stderr, "")
        return {line.partition("\t")[0] for line in done.stdout.splitlines()}

    def test_options_are_those_of_help(self):
        for command in ((), ("diff",), ("measure",)):
            found = self.complete(" ".join((PROGRAM.name, *command, "--")))
            self.assertEqual(found - {"--probe-in", "--probe-out"}, options_of(*command))  # second names
        for name in ("view", "traj"):
            self.assertEqual(self.complete(f"eses-{name} --"), options_of_tool(name))
        self.assertIn("-probe_radius", self.complete(f"{PROGRAM.name} msms -"))

    def test_commands_files_and_values_are_completed(self):
        (self.folder / "a.xyzr").touch()
        commands = {"diff", "interface", "measure", "msms", "pdb_to_xyzr", "pdb_to_xyzrn"}
        self.assertEqual(self.complete(f"{PROGRAM.name} "), commands | {"a.xyzr"})
        self.assertEqual(self.complete(f"{PROGRAM.name} measure "), {"a.xyzr"})
        self.assertEqual(self.complete(f"{PROGRAM.name} --color "), {"patch", "atom", "chain", "potential", "component"})
        self.assertEqual(self.complete(f"{PROGRAM.name} interface --table "), {"interfaces", "residues", "atoms", "pdb", "cif"})
        self.assertEqual(self.complete(f"{PROGRAM.name} measure --table r"), {"residues", "rsa", "res"})
        self.assertEqual(self.complete(f"{PROGRAM.name} measure --write res,atoms,r"), {"res,atoms,residues", "res,atoms,rsa"})
        self.assertEqual(self.complete(f"{PROGRAM.name} --write grid,a"), {"grid,all", "grid,areas", "grid,atoms"})
        self.assertEqual(self.complete(f"{PROGRAM.name} measure --surface sas,v"), {"sas,vdw"})
        self.assertEqual(self.complete(f"{PROGRAM.name} msms -surface "), {"tses", "ases"})
        self.assertEqual(self.complete(f"{PROGRAM.name} measure --write=res,atoms,r"),
                         {"--write=res,atoms,residues", "--write=res,atoms,rsa"})
        self.assertEqual(self.complete(f"{PROGRAM.name} measure --table=r"),
                         {"--table=residues", "--table=rsa", "--table=res"})
        self.assertEqual(self.complete("eses-view a.ply --atoms=st"), {"--atoms=sticks"})
        self.assertEqual(self.complete("eses-view a.ply --atoms "), {"none", "sticks", "balls", "spheres"})


if __name__ == "__main__":
    unittest.main()
