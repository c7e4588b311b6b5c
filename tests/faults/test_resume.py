"""Tests of runs that are interrupted and continued with --resume."""

import os
import resource
import shutil
import signal
import unittest

from faults import (MMCIF, FaultTest, SMALL, forget_signals, needs_library, wait_for,
                    write_pdb)
from support import DATA, needs_gemmi, write_map

CHECKPOINT = ".eses-blocks.resume"
# Layers have 8 planes, so that there are several chunks.
RUN = (SMALL, "-q", "--spacing", "0.4", "-b", "9", "-t", "2")


class Resume(FaultTest):
    def setUp(self):
        super().setUp()
        self.reference = self.make_reference(*RUN)
        self.assertTrue(self.reference)

    def chunks(self):
        return [name for name in self.all_files(self.output / CHECKPOINT) if name.endswith(".sums")]

    def cut_off(self, number, *arguments):
        """Kills a run before its write `number`. Returns false if it has fewer writes."""
        done = self.run_program(*(arguments or RUN), "--resume",
                                fault=f"write {number} signal={signal.SIGKILL.value}")
        return done.returncode == -signal.SIGKILL

    def assertSame(self, *arguments):
        self.assertDone(self.run_program(*(arguments or RUN), "--resume"))
        self.assertEqual(self.contents(), self.reference)

    def test_resume_without_chunks_computes_everything(self):
        self.assertSame()
        self.assertSame()

    @needs_library
    def test_run_killed_at_any_write_is_continued(self):
        """No file has a final name, and the next run writes the same bytes."""
        number, kept = 1, set()
        while self.cut_off(number):
            self.assertEqual([name for name in self.all_files() if not name.startswith(".")], [])
            kept.add(len(self.chunks()))
            self.assertSame()
            self.put({})
            number += 1
        self.assertGreater(number, 20)
        self.assertGreater(len(kept), 3)

    @needs_library
    def test_run_killed_repeatedly_completes(self):
        """Each run continues where the previous one stopped, and finally completes."""
        runs, before = 0, 0
        while self.cut_off(6 + 3 * runs):
            runs += 1
            self.assertGreaterEqual(len(self.chunks()), before)
            before = len(self.chunks())
            self.assertLess(runs, 100)
        self.assertGreater(runs, 1)
        self.assertEqual(self.contents(), self.reference)

    @needs_library
    def test_other_blocks_and_threads_continue_a_run(self):
        self.assertTrue(self.cut_off(20))
        self.assertGreater(len(self.chunks()), 0)
        self.assertSame(SMALL, "-q", "--spacing", "0.4", "-b", "17", "-t", "1")

    def times(self):
        return {name: (self.output / CHECKPOINT / name).stat().st_mtime_ns for name in self.chunks()}

    @needs_library
    def test_complete_chunks_are_not_computed_again(self):
        self.assertTrue(self.cut_off(20))
        first = self.times()
        self.assertGreater(len(first), 0)
        self.assertTrue(self.cut_off(8))
        second = self.times()
        self.assertGreater(len(second), len(first))
        for name, time_ in first.items():
            self.assertEqual(second[name], time_)

    @needs_library
    def test_altered_pieces_are_found_and_computed_again(self):
        """An altered byte of any text, map or mesh is found, whose length is the same."""
        arguments = (*RUN, "--inside", "map.dx", "--mesh", self.output / "mesh.ply")
        self.assertDone(self.run_program(*arguments))
        reference = self.contents()
        for place in (0.01, 0.3, 0.6, 0.99):
            with self.subTest(place=place):
                self.put({})
                self.assertTrue(self.cut_off(70, *arguments))
                folder = self.output / CHECKPOINT
                path = max((folder / name.replace(".sums", ".pieces") for name in self.chunks()),
                           key=lambda pieces: pieces.stat().st_size)
                pieces = bytearray(path.read_bytes())
                pieces[int(place * len(pieces))] ^= 1
                path.write_bytes(pieces)
                self.assertFailed(self.run_program(*arguments, "--resume"), "damaged")
                self.assertEqual([n for n in self.all_files() if not n.startswith(".")], [])
                self.assertDone(self.run_program(*arguments, "--resume"))
                self.assertEqual(self.contents(), reference)

    @needs_library
    def test_run_killed_while_chunks_are_removed_is_continued(self):
        """A killed run leaves only files that the next run recognises and removes."""
        number = 1
        while True:
            shutil.rmtree(self.output)
            done = self.run_program(*RUN, "--resume",
                                    fault=f"unlink {number} signal={signal.SIGKILL.value}")
            if done.returncode == 0:
                break
            self.assertEqual(done.returncode, -signal.SIGKILL)
            self.assertSame()
            number += 1
        self.assertGreater(number, 10)

    @needs_library
    def test_incomplete_chunks_are_removed(self):
        """Incomplete chunks are removed. Otherwise those of other blocks would stay forever."""
        for block in ("9", "11", "13"):
            self.cut_off(14, SMALL, "-q", "--spacing", "0.4", "-b", block, "-t", "2")
        pieces = {name.removesuffix(".pieces") for name in self.all_files(self.output / CHECKPOINT)
                  if name.endswith(".pieces")}
        complete = {name.removesuffix(".sums") for name in self.chunks()}
        self.assertLessEqual(len(pieces - complete), 1)
        self.assertSame()

    @needs_library
    def test_resumed_run_verifies_only_the_rest(self):
        """Only the part that is still to be computed is verified."""
        self.assertTrue(self.cut_off(20, *RUN, "--verify=300"))
        kept = len(self.chunks())
        self.assertGreater(kept, 0)
        done = self.run_program(*[part for part in RUN if part != "-q"], "--resume",
                                "--verify=300")
        self.assertDone(done)
        self.assertIn("verified: 300 points, 300 edges; 0 faults", done.stdout)
        self.assertEqual(self.contents(), self.reference)

    @needs_library
    def test_compressed_files_are_continued(self):
        arguments = (*RUN, "--gzip")
        self.assertDone(self.run_program(*arguments))
        reference = self.contents()
        self.put({})
        self.assertTrue(self.cut_off(20, *arguments))
        self.assertDone(self.run_program(*arguments, "--resume"))
        self.assertEqual(self.contents(), reference)

    @needs_library
    def test_other_input_or_options_are_refused(self):
        self.assertTrue(self.cut_off(20))
        for arguments, names in (((SMALL, "-q", "--spacing", "0.5", "-b", "9"), "--spacing, the grid"),
                                 ((*RUN, "--probe-radius", "1.5"), "--probe-radius"),
                                 ((*RUN, "--write", "edges"), "--write"), ((*RUN, "--fill-cavities"), "--fill-cavities"),
                                 ((DATA / "1ubq.xyzr", *RUN[1:]), "the input, the grid")):
            with self.subTest(arguments=arguments):
                before = self.chunks()
                self.assertFailed(self.run_program(*arguments, "--resume"), f"that differs in {names}; remove it to start again")
                self.assertEqual(self.chunks(), before)
        self.assertSame()

    @needs_library
    def test_damaged_chunks_are_computed_again(self):
        for suffix, damage in ((".sums", lambda old: old[:-1]), (".sums", lambda old: old + b"x"),
                               (".sums", lambda old: old[:40] + bytes([old[40] ^ 1]) + old[41:]),
                               (".pieces", lambda old: old[:-5]),
                               (".pieces", lambda old: old + b"x"), (".pieces", lambda old: b"")):
            with self.subTest(suffix=suffix):
                self.assertTrue(self.cut_off(20))
                path = self.output / CHECKPOINT / (self.chunks()[-1].removesuffix(".sums") + suffix)
                path.write_bytes(damage(path.read_bytes()))
                self.assertSame()
                self.put({})

    @needs_library
    def test_second_run_at_once_is_refused(self):
        for chosen in ("edges", "none"):
            arguments = (*RUN, "--write", chosen, "--resume")
            first = self.stop_at("write 12", *arguments)
            self.assertFailed(self.run_program(*arguments), "another run is writing there")
            first.kill()
            first.wait()
            self.assertDone(self.run_program(*arguments))
            self.put({})

    def test_run_without_files_leaves_no_chunks(self):
        """The next run into the same directory writes files."""
        self.assertDone(self.run_program(*RUN, "--write", "none", "--resume"))
        self.assertEqual(self.all_files(), [])
        self.assertSame()

    def test_pipe_as_input_gives_the_same_files(self):
        pipe = self.folder / "pipe.xyzr"
        os.mkfifo(pipe)
        program = self.start(pipe, *RUN[1:], "--resume")
        pipe.write_bytes(SMALL.read_bytes())
        self.assertDone(self.finish(program))
        self.assertEqual(self.contents(), self.reference)

    def test_dry_run_writes_nothing(self):
        self.assertDone(self.run_program(*RUN, "--resume", "--dry-run"))
        self.assertEqual(self.all_files(), [])

    @needs_library
    def test_run_without_resume_removes_the_chunks(self):
        """A run without --resume starts again and removes the chunks."""
        self.assertTrue(self.cut_off(20))
        self.assertDone(self.run_program(*RUN))
        self.assertEqual(self.contents(), self.reference)

    @unittest.skipIf(os.environ.get("ESES_SANITIZE") == "thread", "takes too long there")
    def test_signals_keep_complete_chunks(self):
        path = self.folder / "big.xyzr"
        path.write_text("".join(f"{x * 3} {y * 3} {z * 3} 1.7\n"
                                for x in range(12) for y in range(12) for z in range(40)))
        arguments = (path, "-q", "--spacing", "0.35", "-b", "17", "-t", "1")
        for number in (signal.SIGINT, signal.SIGTERM):
            before = len(self.chunks())
            program = self.start(*arguments, "--resume")
            wait_for(lambda: len(self.chunks()) > before + 1)
            self.assertEqual(self.end_by(program, number).returncode, 128 + number.value)
            self.assertEqual(self.all_files(), [CHECKPOINT])
            self.assertGreater(len(self.chunks()), before)
        self.assertDone(self.run_program(*arguments, "--resume"))
        resumed = self.contents()
        self.put({})
        self.assertDone(self.run_program(*arguments))
        self.assertEqual(self.contents(), resumed)

    def check_resumed_runs(self, reference, arguments, step, *, killed=(),
                           resumed=lambda number: ()):
        """Checks the files of runs that are killed at every `step`-th write in turn, and then
        resumed. `killed` and `resumed(number of the write)` are further options of these runs."""
        number, kept = 3, set()
        self.put({})
        while self.cut_off(number, *arguments, *killed):
            self.assertEqual([n for n in self.all_files() if not n.startswith(".")], [])
            kept.add(len(self.chunks()))
            self.assertDone(self.run_program(*arguments, *resumed(number), "--resume"))
            self.assertEqual(self.contents(), reference)
            self.put({})
            number += step
        self.assertGreater(len(kept), 2)

    @needs_library
    def test_meshes_maps_and_residues_are_continued(self):
        for name, mesh, more in (("fas2.pqr", "mesh.ply", ("--inside", "map.dx", "--color", "chain",
                                                           "--write", "residues,atoms")),
                                 ("c60.xyzr", "mesh.obj", ("--inside", "map.vti", "--write",
                                                           "atoms")),
                                 ("c60.xyzr", "mesh.vert", ("--write", "edges")),
                                 ("c60.xyzr", "mesh.ply", ("--ply-ascii", "--write", "none")),
                                 ("fas2.pqr", "mesh.vtp", ("--color", "atom", "--write",
                                                           "none")),
                                 ("fas2.pqr", "mesh.glb", ("--color", "chain", "--write", "none")),
                                 ("fas2.pqr", "mesh.ply", (*self.potential(5), "--write", "none")),
                                 ("fas2.pqr", "mesh.stl", ("--write", "none")),
                                 ("fas2.pqr", "mesh.ply", ("--mesh-quality", "--write", "none")),
                                 ("c60.xyzr", "mesh.vtp", ("--mesh-quality",)),
                                 ("1ubq.xyzr", "mesh.vtp", ("--color", "component", "--write",
                                                            "none")),
                                 ("1ubq.xyzr", "mesh.ply", ("--component", "1"))):
            arguments = (DATA / name, "-q", "--spacing", "0.7", "-b", "9", "-t", "2", *more,
                         "--mesh", self.output / mesh)
            self.put({})
            self.assertDone(self.run_program(*arguments))
            reference = self.contents()
            self.assertIn(mesh, reference)
            self.check_resumed_runs(reference, arguments, 7)

    @needs_library
    def test_maps_for_solvers_are_the_same_after_resuming(self):
        """Runs are killed, then completed with other numbers of threads and other block sizes."""
        for more in (("--kappa", "kappa.dx", "--inside", "inside.dx"),
                     ("--kappa", "kappa.dx.gz", "--inside", "inside.dx.gz", "--gzip")):
            arguments = (SMALL, "-q", "--spacing", "0.4", "--write", "none", "--dielectric",
                         "diel_", *more)
            self.put({})
            self.assertDone(self.run_program(*arguments, "-b", "128", "-t", "1"))
            reference = self.contents()
            self.assertEqual(len(reference), 5)
            self.check_resumed_runs(
                reference, arguments, 11, killed=("-b", "9", "-t", "2"),
                resumed=lambda number: ("-b", 8 + number % 121, "-t", 1 + number % 4))

    @needs_library
    def test_filled_cavities_are_the_same_after_resuming(self):
        arguments = (DATA / "1ubq.xyzr", "-q", "--spacing", "0.6", "--fill-cavities", "-b", "9",
                     "-t", "2")
        self.put({})
        self.assertDone(self.run_program(*arguments))
        self.check_resumed_runs(self.contents(), arguments, 23)
        self.put({})
        self.assertTrue(self.cut_off(40, *arguments))
        for value in ("=13", "=20"):
            other = (*arguments, f"--fill-cavities{value}")
            other = tuple(one for one in other if one != "--fill-cavities")
            self.assertFailed(self.run_program(*other, "--resume"), "cannot resume")

    @needs_gemmi
    @needs_library
    def test_files_from_structures_are_the_same_after_resuming(self):
        """PDB and mmCIF files, whose labels are in files of areas and meshes."""
        for path in (MMCIF, write_pdb(self.folder / "chains.pdb")):
            arguments = (path, "-q", "--spacing", "0.9", "-b", "9", "-t", "2",
                         "--write", "all,residues,atoms", "--color", "chain", "--mesh",
                         self.output / "mesh.ply")
            self.put({})
            self.assertDone(self.run_program(*arguments))
            self.check_resumed_runs(self.contents(), arguments, 13)

    def potential(self, end):
        """Returns options for colours of a potential."""
        return ("--color", "potential", "--potential",
                write_map(self.folder / f"{end}.dx", end, 100))

    @needs_library
    def test_other_potential_is_refused(self):
        arguments = (*RUN, "--mesh", self.output / "mesh.ply")
        self.assertTrue(self.cut_off(30, *arguments, *self.potential(5)))
        self.assertGreater(len(self.chunks()), 0)
        for other, names in (((), "--color, --potential"), (self.potential(6), "--potential"),
                             ((*self.potential(5), "--potential-offset", "1"), "--potential-offset"),
                             ((*self.potential(5), "--potential-limit", "1"), "--potential-limit")):
            self.assertFailed(self.run_program(*arguments, *other, "--resume"), f"that differs in {names}; remove")

    @needs_library
    def test_other_mesh_is_refused(self):
        """The chunks of a mesh do not serve another mesh."""
        arguments = (*RUN, "--mesh", self.output / "mesh.ply")
        self.assertTrue(self.cut_off(30, *arguments))
        self.assertGreater(len(self.chunks()), 0)
        for other, names in ((RUN, "--mesh"), ((*RUN, "--mesh", self.output / "mesh.obj"), "--mesh"),
                             ((*RUN, "--mesh", self.output / "mesh.vtp"), "--mesh"), ((*arguments, "--ply-ascii"), "--ply-ascii"),
                             ((*arguments, "--color", "atom"), "--color"), ((*arguments, "--inside", "map.dx"), "--inside")):
            self.assertFailed(self.run_program(*other, "--resume"), f"that differs in {names}; remove")

    @unittest.skipIf(os.environ.get("ESES_SANITIZE") == "thread",
                     "the sanitizer itself maps files that are larger")
    def test_full_disk_keeps_complete_chunks(self):
        done = self.run_program(*RUN, "--resume", prepare=lambda: self.limit(20000))
        self.assertFailed(done, "cannot write")
        self.assertEqual([n for n in self.all_files() if not n.startswith(".")], [])
        self.assertSame()

    @staticmethod
    def limit(size):
        forget_signals()
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


if __name__ == "__main__":
    unittest.main()
