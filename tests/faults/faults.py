"""Shared by the tests of faults: runs of the program in which a call fails or a signal arrives."""

import atexit
import errno
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

from support import DATA, PROGRAM, PROJECT, TestCase, forget_signals

NAMES = ("bounding_box.txt", "grid_info.txt", "intersection_info.txt", "partition_area.txt")


def loadable(library):
    """Returns a path of the library for LD_PRELOAD, where blanks and colons separate paths."""
    if not library or not set(library) & set(" :"):
        return library
    folder = tempfile.mkdtemp(prefix="eses-fault-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return shutil.copy(library, folder)


LIBRARY = loadable(os.environ.get("ESES_FAULT_LIBRARY"))  # see fault.cpp
FAULTY_PROGRAM = os.environ.get("ESES_FAULTY_BINARY")  # faulty_solver.cpp, faulty_cutters.cpp
SMALL = DATA / "c60.xyzr"
MMCIF = PROJECT / "tests" / "data" / "1a8o.cif.gz"
# Seconds until a test gives up. Only a run that never ends takes so long, on any machine.
PATIENCE = 600
# Seconds of CPU time that a run may take to end after a signal. It takes far less. Unlike
# wall-clock time, CPU time does not depend on how busy the machine is.
PROMPT = 5
TICKS = os.sysconf("SC_CLK_TCK")

# This runtime ends the process itself if it gets no memory or no thread, needs more memory than the
# estimates allow for, and prints messages of its own.
needs_gnu_openmp = unittest.skipIf(b"libomp.so" in PROGRAM.read_bytes(),
                                   "the OpenMP of LLVM does not report failures")
needs_library = unittest.skipUnless(LIBRARY, "no calls can be made to fail in this build")


def write_pdb(path):
    """A PDB file with two chains of alanine and an ion, on a winding line."""
    lines, places = [], ((0, 0, 0), (1.5, 0, 0), (2, 1.4, 0), (1.3, 2.4, 0.3), (2, -0.8, 1.2))
    for residue in range(60):
        chain = "AB"[residue // 30]
        corner = (4 * (residue % 4), 4 * (residue // 4 % 4), 4 * (residue // 16))
        for name, place in zip(("N", "CA", "C", "O", "CB"), places):
            x, y, z = (a + b for a, b in zip(corner, place))
            lines.append(f"ATOM  {len(lines) + 1:5}  {name:<3} ALA {chain}{residue + 1:4}    "
                         f"{x:8.3f}{y:8.3f}{z:8.3f}  1.00  0.00          {name[0]:>2}")
    lines.append(f"HETATM{len(lines) + 1:5} ZN    ZN B  99    {-4:8.3f}{0:8.3f}{0:8.3f}  1.00  0.00"
                 "          ZN")
    path.write_text("\n".join([*lines, "END", ""]))
    return path


def wait_for(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError
        time.sleep(0.005)


def cpu_seconds(program):
    """Returns the CPU time of a program, also if it has ended but was not waited for."""
    with open(f"/proc/{program.pid}/stat", encoding="ascii", errors="replace") as stat:
        fields = stat.read().rpartition(")")[2].split()
    user, system = fields[11:13]
    return (int(user) + int(system)) / TICKS


def has_ended(program):
    """Whether the program has ended. It can still be waited for afterwards."""
    return os.waitid(os.P_PID, program.pid, os.WEXITED | os.WNOWAIT | os.WNOHANG) is not None


def let_work(program, seconds):
    """Returns when the program has used `seconds` more CPU time, or has ended."""
    end = cpu_seconds(program) + seconds
    wait_for(lambda: has_ended(program) or cpu_seconds(program) > end)


class FaultTest(TestCase):
    def setUp(self):
        super().setUp()
        self.output = self.folder / "out"
        self.mark = self.folder / "mark"

    def start(self, *arguments, fault=None, spoil=None, prepare=forget_signals, **how):
        """Starts the program, which writes into `self.output`.

        With `fault`, fault.cpp makes a call fail. With `spoil`, the program of faulty_solver.cpp
        and faulty_cutters.cpp is started, whose results are wrong.
        """
        environment = dict(os.environ)
        if spoil is not None:
            environment["ESES_SPOIL"] = spoil
        if fault:
            environment.update(LD_PRELOAD=LIBRARY, ESES_FAULT=fault, ESES_FAULT_MARK=str(self.mark))
            self.mark.unlink(missing_ok=True)
        streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE,
                   "stderr": subprocess.PIPE, **how}
        executable = PROGRAM if spoil is None else FAULTY_PROGRAM
        has_tables = arguments[0] not in ("interface", "measure") or "--write" in arguments
        writes = ["-o", self.output] if has_tables else []
        program = subprocess.Popen([executable, *map(str, arguments), *writes],
                                   env=environment, text=True, preexec_fn=prepare, **streams)
        self.addCleanup(self.end, program)
        return program

    @staticmethod
    def end(program):
        if program.poll() is None:
            program.kill()
        program.communicate()

    def finish(self, program):
        out, err = program.communicate(timeout=PATIENCE)
        return subprocess.CompletedProcess(program.args, program.returncode, out, err)

    def end_by(self, program, *signals):
        """Sends the signals and returns the ended program. It must end soon."""
        before = cpu_seconds(program)
        for number in signals:
            program.send_signal(number)
        wait_for(lambda: has_ended(program))
        self.assertLess(cpu_seconds(program) - before, PROMPT)
        return self.finish(program)

    def run_program(self, *arguments, **how):
        return self.finish(self.start(*arguments, **how))

    def is_faulty(self):
        """Whether the last run met its fault."""
        return self.mark.exists()

    def stop_at(self, fault, *arguments, **how):
        """Returns a run that has stopped itself at a call."""
        program = self.start(*arguments, fault=f"{fault} signal={signal.SIGSTOP.value}", **how)
        wait_for(lambda: os.waitpid(program.pid, os.WNOHANG | os.WUNTRACED)[0] == program.pid)
        self.assertTrue(self.is_faulty())
        return program

    def all_files(self, folder=None):
        """Returns the names of all files, hidden ones included."""
        folder = folder or self.output
        return sorted(os.listdir(folder)) if folder.is_dir() else []

    def contents(self, folder=None):
        folder = folder or self.output
        return {name: (folder / name).read_bytes() for name in self.all_files(folder)}

    def make_reference(self, *arguments):
        """Returns the files that a run without faults writes, and removes them again."""
        self.assertDone(self.run_program(*arguments))
        files = self.contents()
        self.assertEqual(sorted(files), sorted(NAMES))
        for name in files:
            (self.output / name).unlink()
        return files

    def put(self, files):
        for name in self.all_files():
            (self.output / name).unlink()
        for name, content in files.items():
            (self.output / name).write_bytes(content)

    def assertFailed(self, done, message):
        self.assertEqual(done.returncode, 1, done)
        self.assertTrue(done.stderr.startswith("eses-blocks: error: "), done)
        self.assertEqual(done.stderr.count("\n"), 1, done)
        self.assertIn(message, done.stderr)
        self.assertNotIn("area:", done.stdout)


def message_of(code):
    return os.strerror(code)


NO_SPACE = message_of(errno.ENOSPC)
TINY = (SMALL, "1.4", "0.8", "0.8", "-b", "8", "-t", "2", "-q")  # many blocks, little text
