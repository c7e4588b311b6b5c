"""Tests of signals in every phase: a prompt end, the exit code of the signal, and no file left."""

import array
import fcntl
import os
import resource
import signal
import termios
import unittest

from faults import (NAMES, SMALL, TINY, FaultTest, forget_signals, has_ended, let_work,
                    needs_library, wait_for)

STRIDE = 13  # step between the allocations at which a signal arrives
BALL = "0 0 0 200\n"  # at a spacing of 0.3 a grid of 2.4e9 points

needs_prompt_signals = unittest.skipIf(
    os.environ.get("ESES_SANITIZE") == "thread",
    "this sanitizer delays signals while a file is opened or read")


class Phase(FaultTest):
    """A run in one phase. `number` is the signal that a test sends."""

    def big_input(self, text=BALL):
        path = self.folder / "big.xyzr"
        path.write_text(text)
        return path

    def has_temporaries(self):
        return any(name.endswith(".part") for name in self.all_files())

    def has_text(self):
        try:
            return any(entry.stat().st_size > 100_000 for entry in os.scandir(self.output))
        except OSError:
            return False

    def check_end(self, program, number):
        """Sends the signal and checks that the run ends soon."""
        self.assertFalse(has_ended(program), "the run was over before the signal")
        done = self.end_by(program, number)
        self.assertEqual(done.returncode, 128 + number, done)
        self.assertEqual(self.all_files(), [])

    def for_signals(self, start, is_ready):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(signal=number):
                program = start()
                wait_for(is_ready)
                self.check_end(program, number.value)

    @needs_prompt_signals
    def test_signal_ends_waiting_for_input(self):
        fifo = self.folder / "fifo.xyzr"
        os.mkfifo(fifo)
        for number in (signal.SIGINT, signal.SIGTERM):
            program = self.start(fifo)
            with open(fifo, "w") as input_end:  # returns when the program has opened it
                input_end.write("0 0 0 1\n")
                input_end.flush()
                wait_for(lambda pipe=input_end: self.is_empty(pipe))  # then it waits for more
                self.check_end(program, number.value)

    @staticmethod
    def is_empty(pipe):
        waiting = array.array("i", [0])
        fcntl.ioctl(pipe, termios.FIONREAD, waiting)
        return waiting[0] == 0

    @needs_prompt_signals
    def test_signal_ends_waiting_for_a_writer(self):
        fifo = self.folder / "fifo.xyzr"
        os.mkfifo(fifo)
        program = self.start(fifo)
        # The program sleeps in open().
        wait_for(lambda: "S (sleeping)" in self.status(program) and self.catches_signals(program))
        self.check_end(program, signal.SIGINT.value)

    def test_signal_ends_a_verification(self):
        """There are far more points and edges than can be checked in this time."""
        for number in (signal.SIGINT, signal.SIGTERM):
            program = self.start(SMALL, "30", "--write", "none", "--verify=1000000")
            let_work(program, 1)  # the blocks take a few milliseconds
            self.check_end(program, number.value)

    @staticmethod
    def status(program):
        with open(f"/proc/{program.pid}/status", encoding="ascii", errors="replace") as status:
            return status.read()

    def catches_signals(self, program):
        caught = next(line for line in self.status(program).splitlines()
                      if line.startswith("SigCgt:"))
        return int(caught.split()[1], 16) >> (signal.SIGTERM.value - 1) & 1

    def test_signal_ends_the_building_of_patches(self):
        """There are a hundred thousand atoms with many neighbours each."""
        edge = 47
        path = self.big_input("".join(
            f"{x * 1.1:.1f} {y * 1.1:.1f} {z * 1.1:.1f} 3\n"
            for x in range(edge) for y in range(edge) for z in range(edge)))
        self.for_signals(lambda: self.start(path, "-q", "-t", "1", "--write", "areas"),
                         self.has_temporaries)

    def test_signal_ends_the_solving_of_blocks(self):
        path = self.big_input()
        self.for_signals(lambda: self.start(path, "-q", "--spacing", "0.3", "--write", "edges"),
                         self.has_text)

    def test_signal_ends_writing(self):
        """The blocks are empty, and there is much text."""
        path = self.big_input("0 0 0 1\n500 500 500 1\n")
        self.for_signals(lambda: self.start(path, "-q", "--spacing", "0.5", "--write", "grid"),
                         self.has_text)

    def test_signal_ends_a_long_block(self):
        path = self.big_input()
        program = self.start(path, "-q", "--spacing", "0.5", "-b", "900", "--write", "edges")
        wait_for(lambda: has_ended(program) or self.has_temporaries())
        let_work(program, 0.3)
        if has_ended(program) and "memory" in program.communicate()[1]:
            self.skipTest("not enough memory for a large block")
        self.check_end(program, signal.SIGTERM.value)

    def test_ignored_signals_stay_ignored(self):
        """Signals that nohup, `trap '' INT` or a background job had ignored stay ignored."""
        ignored = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1, signal.SIGALRM,
                   signal.SIGQUIT)

        def prepare():
            forget_signals()
            for number in ignored:
                signal.signal(number, signal.SIG_IGN)
        path = self.big_input()
        program = self.start(path, "-q", "--spacing", "0.3", "--write", "edges", prepare=prepare)
        wait_for(self.has_temporaries)
        for number in ignored:
            program.send_signal(number)
        let_work(program, 0.3)
        self.assertIsNone(program.poll())
        self.check_end(program, signal.SIGUSR2.value)

    def start_blocks(self, **how):
        return self.start(self.big_input(), "-q", "--spacing", "0.3", "--write", "edges", **how)

    def test_other_signals_leave_no_files(self):
        for number in (signal.SIGUSR1, signal.SIGUSR2, signal.SIGALRM, signal.SIGXCPU,
                       signal.SIGVTALRM, signal.SIGPROF, signal.SIGIO, signal.SIGPWR,
                       signal.SIGRTMIN, signal.SIGRTMAX):
            with self.subTest(signal=number):
                program = self.start_blocks()
                wait_for(self.has_temporaries)
                self.check_end(program, number.value)

    def test_inherited_timer_ends_the_run(self):
        """A timer survives exec(): `perl -e 'alarm 3; exec @ARGV' eses-blocks ...`."""
        def prepare():
            forget_signals()
            signal.alarm(3)
        done = self.run_program(self.big_input(), "-q", "--spacing", "0.2", "-t", "1", "--write",
                                "edges", prepare=prepare)
        self.assertEqual(done.returncode, 128 + signal.SIGALRM, done)
        self.assertEqual(self.all_files(), [])

    @unittest.skipIf(os.environ.get("ESES_SANITIZE"), "sanitizers handle these signals")
    def test_core_dumps_are_still_possible(self):
        """The process is ended by the signal itself, so that it can dump core."""
        def prepare():
            forget_signals()
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        for number in (signal.SIGQUIT, signal.SIGABRT, signal.SIGSEGV, signal.SIGBUS):
            with self.subTest(signal=number):
                program = self.start_blocks(prepare=prepare)
                wait_for(self.has_text)
                program.send_signal(number)
                self.assertEqual(self.finish(program).returncode, -number)
                self.assertEqual(self.all_files(), [])

    @unittest.skipIf(os.environ.get("ESES_SANITIZE"), "sanitizers handle these signals")
    def test_core_dumps_wait_for_the_files_of_other_threads(self):
        def prepare():
            forget_signals()
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        atoms = "".join(f"{3 * (k % 6)} {3 * (k // 6 % 6)} {3 * (k // 36)} 1.7\n" for k in range(216))
        files = [self.folder / f"{k}.xyzr" for k in range(40)]
        for file in files:
            file.write_text(atoms)
        ended = 0
        for turn in range(20):
            program = self.start("measure", *files, "-q", "--write", "atoms,derivatives", "-t", "4", prepare=prepare)
            # The lock is the first file.
            wait_for(lambda: len(self.all_files()) > turn + 1 or has_ended(program))
            program.send_signal(signal.SIGQUIT)
            ended += self.finish(program).returncode == -signal.SIGQUIT
            self.assertEqual([name for name in self.all_files() if name.startswith(".")], [])
            for name in self.all_files():
                (self.output / name).unlink()
        self.assertGreater(ended, 5)

    @needs_library
    def test_signal_ends_a_run_on_a_file_system_that_hangs(self):
        for call in ("open 2", "write 1", "close 1", "rename 2"):
            with self.subTest(call=call):
                program = self.start(*TINY, fault=f"{call} hang")
                wait_for(self.is_faulty)
                done = self.end_by(program, signal.SIGTERM)
                self.assertEqual(done.returncode, 128 + signal.SIGTERM.value)
                self.assertFalse(self.has_temporaries())
                self.assertNotIn("bounding_box.txt", self.all_files())
                self.assertDone(self.run_program(*TINY))
                self.assertEqual(self.all_files(), sorted(NAMES))
                self.put({})

    @needs_library
    def test_second_signal_ends_at_once(self):
        program = self.start(*TINY, fault="write 1 hang")
        wait_for(self.is_faulty)
        done = self.end_by(program, signal.SIGINT, signal.SIGTERM)
        self.assertIn(done.returncode, (128 + signal.SIGINT, 128 + signal.SIGTERM))
        self.assertFalse(self.has_temporaries())


@needs_library
class EveryMoment(FaultTest):
    """Signals that arrive at every call on a file, and at allocations during a run."""

    def for_every(self, call, stride, least):
        reference = self.make_reference(*TINY)
        interrupted = 0
        for turn in range(100_000):
            number = (signal.SIGINT, signal.SIGTERM)[turn % 2].value
            done = self.run_program(*TINY, fault=f"{call} {1 + turn * stride} signal={number}")
            if not self.is_faulty():
                self.assertDone(done)
                self.assertGreater(interrupted, least)
                return
            with self.subTest(call=1 + turn * stride):
                if done.returncode == -number:  # before main() has started
                    self.assertEqual((interrupted, self.all_files()), (0, []))
                else:
                    self.assertEqual(done.returncode, 128 + number, done)
                    interrupted += 1
                # After the last rename all files exist, and only then.
                self.assertIn(self.contents(), ({}, reference))
                self.put({})
        self.fail("there is no end of calls")

    def test_signal_at_every_call_leaves_no_file(self):
        self.for_every("file", 1, 20)

    def test_signal_at_allocations_leaves_no_file(self):
        self.for_every("alloc", STRIDE, 20)
