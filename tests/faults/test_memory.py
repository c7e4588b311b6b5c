"""Tests of allocations that fail in every phase, and of the memory that reading takes."""

import errno
import gzip
import json
import os
import re
import resource
import signal
import subprocess
import sys
import unittest

from faults import (NAMES, PROGRAM, SMALL, TINY, FaultTest, forget_signals, needs_gnu_openmp,
                    needs_library)
from support import DATA

# The last two messages are from OpenMP's runtimes, which cannot start a thread.
OUT_OF_MEMORY = "[Oo]ut of memory|libgomp: |OMP: Error"
# The check needs a new process: the peak that a child reports is not below that of its parent.
PRINT_PEAK = """
import os, subprocess, sys
program = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(program.pid, 0)
print(usage.ru_maxrss)
sys.exit(os.waitstatus_to_exitcode(status))
"""
STRIDE = 7  # step between failing allocations; a prime, so that no pattern escapes


@needs_gnu_openmp
class Memory(FaultTest):
    has_begun = False

    def check(self, done, reference):
        # Code before main() aborts, or is that of OpenMP.
        is_early = done.returncode == -signal.SIGABRT or done.stderr.lstrip().startswith("libgomp: ")
        if is_early and not self.has_begun:
            self.assertEqual(self.all_files(), [])
            return
        self.has_begun = self.has_begun or done.returncode != 0
        if done.returncode == 0:  # the C library did not need the memory
            self.assertEqual(self.contents(), reference)
        else:
            self.assertEqual(done.returncode, 1, done)
            self.assertRegex(done.stderr, OUT_OF_MEMORY)
            # If only the report was left to print, the files exist and are complete.
            self.assertIn(self.contents(), ({}, reference))

    def for_allocations(self, action):
        reference = self.make_reference(*TINY)
        failures = 0
        for number in range(1, 1_000_000, STRIDE):
            done = self.run_program(*TINY, fault=f"alloc {number} {action}")
            if not self.is_faulty():
                self.assertDone(done)
                self.assertGreater(failures, 50)
                return
            failures += done.returncode == 1
            with self.subTest(allocation=number):
                self.check(done, reference)
            for name in self.all_files():
                (self.output / name).unlink()
        self.fail("there is no end of allocations")

    @needs_library
    def test_one_failing_allocation_ends_the_run_in_order(self):
        self.for_allocations(f"fail={errno.ENOMEM}")

    @needs_library
    def test_persistent_failure_ends_the_run_in_order(self):
        self.for_allocations(f"stay={errno.ENOMEM}")

    def test_address_space_limit_ends_the_run_in_order(self):
        """The limits range from too little to start to just not enough."""
        if not os.environ.get("ESES_FAULT_LIBRARY"):
            self.skipTest("sanitizers need the whole address space")
        path = self.folder / "gas.xyzr"  # 27,000 isolated atoms
        path.write_text("".join(f"{x * 9} {y * 9} {z * 9} 1.5\n"
                                for x in range(30) for y in range(30) for z in range(30)))
        codes = set()
        for megabytes in range(12, 80, 4):
            def limit(size=megabytes << 20):
                forget_signals()
                resource.setrlimit(resource.RLIMIT_AS, (size, size))
            done = self.run_program(path, "--spacing", "2", "--margin", "2", "-t", "1", "-q",
                                    prepare=limit)
            codes.add(done.returncode)
            if done.returncode == 0:
                self.assertEqual(self.all_files(), sorted(NAMES))
            elif done.returncode != 127:  # 127: the C library does not fit
                self.assertEqual(done.returncode, 1, done)
                self.assertRegex(done.stderr, OUT_OF_MEMORY)
                self.assertEqual(self.all_files(), [])
        self.assertLessEqual({0, 1}, codes)

    def test_threads_that_cannot_start_are_an_error(self):
        if not os.environ.get("ESES_FAULT_LIBRARY"):
            self.skipTest("sanitizers need the whole address space")

        def limit():
            forget_signals()
            resource.setrlimit(resource.RLIMIT_AS, (256 << 20, 256 << 20))
        done = self.run_program(SMALL, "-t", "500", "-b", "4", "-q", prepare=limit)
        self.assertEqual(done.returncode, 1, done)
        self.assertNotEqual(done.stderr, "")
        self.assertEqual(self.all_files(), [])


@needs_gnu_openmp
@unittest.skipUnless(os.environ.get("ESES_FAULT_LIBRARY"), "sanitizers need memory themselves")
class Limits(FaultTest):
    """The limit that a message names suffices, and the bound of the memory is one."""

    def test_the_named_limit_suffices(self):
        cases = [(name, ["--spacing", spacing, *more]) for name, spacing, more in (
            ("c60", "1", []), ("c60", "0.25", []), ("1ubq", "1", ["--mesh", self.output / "m.ply"]),
            ("1ubq", "0.5", ["--dielectric", "d", "--kappa", "k.dx"]),
            ("1ubq", "0.5", ["--mesh", self.output / "m.vtp", "--mesh-quality"]),
            ("1a0q", "1", []), ("1a0q", "0.5", ["--fill-cavities"]), ("1a0q", "0.5", ["--exact"]))]
        for name, options in cases:
            with self.subTest(name=name, options=options):
                command = [DATA / f"{name}.xyzr", *options, "--json", "-q"]
                done = self.run_program(*command, "--max-memory", "1M")
                self.assertEqual(done.returncode, 1)
                limit = re.search(r"at least (\d+) MiB \(--max-memory \1M\)", done.stderr)
                self.assertIsNotNone(limit, done.stderr)
                for more, bound in (["--max-memory", f"{limit[1]}M"], int(limit[1]) << 20), ([], None):
                    done = self.run_program(*command, *more)
                    self.assertDone(done)
                    report = json.loads(done.stdout)
                    bound = bound or report["plan"]["memory_bytes"]
                    self.assertLessEqual(report["peak_memory_bytes"], bound)

    def test_the_printed_memory_is_at_most_twice_the_peak(self):
        """Small runs of several threads need less when the threads do not work at the same time."""
        for name, spacing, threads in (("c60", "0.5", 4), ("1ubq", "0.3", 1), ("1a0q", "0.8", 1), ("1a0q", "0.8", 8),
                                       ("achbp", "1", 1), ("achbp", "1", 8)):
            with self.subTest(name=name, threads=threads):
                done = self.run_program(DATA / f"{name}.xyzr", "--spacing", spacing, "-t", threads, "--write", "none")
                self.assertDone(done)
                used, = re.findall(r"; (\d+) threads?$", done.stdout, re.M)
                text, = re.findall(r"^needs: (.*) of memory, ", done.stdout, re.M)
                if used != "1":
                    self.assertEqual(text, "less than 128 MB")
                    continue
                peak, = re.findall(r"^peak memory: ([\d.]+) MB$", done.stdout, re.M)
                self.assertLessEqual(float(text.removeprefix("at most ").removesuffix(" MB")), 2 * float(peak))


@unittest.skipUnless(os.environ.get("ESES_FAULT_LIBRARY"), "sanitizers need memory themselves")
class Reading(FaultTest):
    """Input that is much larger than the limit is refused before it is in memory."""

    LIMIT = 64 << 20  # bytes

    def check(self, path, message):
        for more in ([], ["--resume"]):
            with self.subTest(path=path.name, more=more):
                done = subprocess.run(
                    [sys.executable, "-c", PRINT_PEAK, PROGRAM, path, "--max-memory",
                     str(self.LIMIT), "-o", self.output, "-q", *more],
                    capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 1)
                self.assertIn(message, done.stderr)
                self.assertLess(int(done.stdout) << 10, self.LIMIT)
                self.assertEqual(self.all_files(), [])

    def test_too_many_atoms_are_refused_while_reading(self):
        block = b"1 2 3 1.5\n" * 100_000  # 60 blocks are 240 MB of atoms
        plain, packed = self.folder / "a.xyzr", self.folder / "b.xyzr.gz"
        plain.write_bytes(60 * block)
        packed.write_bytes(60 * gzip.compress(block))
        for path in (plain, packed):
            self.check(path, "exceeds the memory limit of 64 MiB")

    def test_one_endless_line_is_refused_while_reading(self):
        block = b"1" * (1 << 20)
        plain, packed = self.folder / "a.xyzr", self.folder / "b.xyzr.gz"
        plain.write_bytes(128 * block)
        packed.write_bytes(1024 * gzip.compress(block))  # 1 GiB of text
        for path in (plain, packed):
            self.check(path, ":1: more than 4096 characters in the line")
