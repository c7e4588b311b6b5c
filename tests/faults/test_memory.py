"""Allocations that fail, in every phase."""

import errno
import os
import resource
import signal

from faults import NAMES, SMALL, TINY, FaultTest, forget_signals, needs_library

# The last two are what OpenMP's runtimes say where they cannot start a thread.
OUT_OF_MEMORY = "[Oo]ut of memory|libgomp: |OMP: Error"
STRIDE = 7  # of the allocations that are made to fail; a prime, so that no pattern hides from it


class Memory(FaultTest):
    has_begun = False

    def check(self, done, reference):
        if done.returncode == -signal.SIGABRT and not self.has_begun:  # what comes before main()
            self.assertEqual(self.all_files(), [])
            return
        self.has_begun = True
        if done.returncode == 0:  # the C library has done without
            self.assertEqual(self.contents(), reference)
        else:
            self.assertEqual(done.returncode, 1, done)
            self.assertRegex(done.stderr, OUT_OF_MEMORY)
            # Where only the report is left to print, the files are there, and whole.
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
    def test_one_fails(self):
        self.for_allocations(f"fail={errno.ENOMEM}")

    @needs_library
    def test_all_fail_from_some_moment_on(self):
        self.for_allocations(f"stay={errno.ENOMEM}")

    def test_limit(self):
        """From too little to begin with to just not enough."""
        if not os.environ.get("ESES_FAULT_LIBRARY"):
            self.skipTest("sanitizers need all addresses there are")
        path = self.folder / "gas.xyzr"  # 27,000 atoms, far from each other
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
            elif done.returncode != 127:  # 127: not even the C library fits in
                self.assertEqual(done.returncode, 1, done)
                self.assertRegex(done.stderr, OUT_OF_MEMORY)
                self.assertEqual(self.all_files(), [])
        self.assertLessEqual({0, 1}, codes)

    def test_threads_that_cannot_start(self):
        if not os.environ.get("ESES_FAULT_LIBRARY"):
            self.skipTest("sanitizers need all addresses there are")

        def limit():
            forget_signals()
            resource.setrlimit(resource.RLIMIT_AS, (256 << 20, 256 << 20))
        done = self.run_program(SMALL, "-t", "500", "-b", "4", "-q", prepare=limit)
        self.assertEqual(done.returncode, 1, done)
        self.assertNotEqual(done.stderr, "")
        self.assertEqual(self.all_files(), [])
