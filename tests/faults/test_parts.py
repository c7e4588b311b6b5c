"""Tests of runs whose parts are computed by independent processes, with --part and --join."""

import json
import os
import signal
import unittest
import unittest.mock

from faults import MMCIF, SMALL, FaultTest, needs_library
from support import DATA, needs_gemmi

CHECKPOINT = ".eses-blocks.resume"
RUN = (SMALL, "-q", "--spacing", "0.4", "-b", "9", "-t", "2")


class Parts(FaultTest):
    def chunks(self):
        return [name for name in self.all_files(self.output / CHECKPOINT) if name.endswith(".sums")]

    def clear(self):
        for name in self.all_files():
            (self.output / name).unlink()

    def reference_of(self, *arguments):
        """Returns the output of one process and its files, and removes these."""
        done = self.run_program(*arguments)
        self.assertDone(done)
        files = self.contents()
        self.clear()
        return done.stdout, files

    def assertOnlyParts(self):
        self.assertEqual(self.all_files(), [CHECKPOINT])

    def check_parts(self, count, *arguments):
        """Computes the parts one after the other, in a mixed order. The last one writes the files
        of one process."""
        stdout, reference = self.reference_of(*arguments)
        order = sorted(range(1, count + 1), key=lambda part: part * 7 % 5)
        for part in order:
            done = self.run_program(*arguments, "--part", f"{part}/{count}")
            self.assertDone(done)
            if part != order[-1]:
                self.assertEqual(done.stdout, "")
                self.assertOnlyParts()
        self.assertEqual(done.stdout, stdout)
        self.assertEqual(self.all_files(), sorted(reference))
        self.assertTrue(self.contents() == reference)
        self.clear()


class Identity(Parts):
    def test_files_do_not_depend_on_the_number_of_parts(self):
        for count in range(1, 6):
            with self.subTest(count=count):
                self.check_parts(count, *RUN)
                self.check_parts(count, DATA / "1ubq.xyzr", "-q", "--spacing", "0.7", "--gzip")

    def test_more_parts_than_planes(self):
        path = self.folder / "one.xyzr"
        path.write_text("0 0 0 1\n")
        arguments = (path, "-q", "--spacing", "2", "--margin", "1")
        self.check_parts(2, *arguments)
        self.output.rmdir()
        self.assertFailed(self.run_program(*arguments, "--part", "1/7"), "use fewer parts")
        self.assertFalse(self.output.exists())

    def test_meshes_maps_and_tables(self):
        for mesh, more in (("mesh.ply", ("--color", "chain", "--inside", "map.dx")),
                           ("mesh.vtp", ("--mesh-quality", "--inside", "map.vti")),
                           ("mesh.obj", ("--dielectric", "diel_", "--kappa", "kappa.dx.gz")),
                           ("mesh.stl", ("--fill-cavities",)), ("mesh.face", ())):
            for count in (2, 3):
                with self.subTest(mesh=mesh, count=count):
                    self.check_parts(count, DATA / "fas2.pqr", "-q", "--spacing", "0.8", "--write",
                                     "all,residues,atoms", "--mesh", self.output / mesh, *more)

    @needs_gemmi
    def test_structures(self):
        self.check_parts(3, MMCIF, "-q", "--spacing", "0.9", "--write", "residues,atoms")

    def test_parts_at_the_same_time(self):
        _, reference = self.reference_of(*RUN)
        for _ in range(5):
            programs = [self.start(*RUN, "--part", f"{part}/4") for part in (1, 2, 3, 4)]
            for done in map(self.finish, programs):
                self.assertDone(done)
            self.assertTrue(self.contents() == reference)
            self.clear()

    def test_verification_is_added_up(self):
        arguments = (DATA / "1ubq.xyzr", "--spacing", "0.8", "--json", "--verify=500")
        for part in (1, 2, 3):
            done = self.run_program(*arguments, "--part", f"{part}/3")
            self.assertDone(done)
        self.assertEqual(json.loads(done.stdout)["verification"],
                         {"points": 500, "edges": 500, "faults": []})


class Failure(Parts):
    def kill_part(self, part, count, number):
        """Kills a part before its write `number`. Returns false if it has fewer writes."""
        done = self.run_program(*RUN, "--part", f"{part}/{count}",
                                fault=f"write {number} signal={signal.SIGKILL.value}")
        return done.returncode == -signal.SIGKILL

    @needs_library
    def test_killed_part_is_computed_again_alone(self):
        _, reference = self.reference_of(*RUN)
        self.assertDone(self.run_program(*RUN, "--part", "1/3"))
        before, number = self.chunks(), 1
        while self.kill_part(2, 3, number):
            done = self.run_program(*RUN, "--join")
            if done.returncode == 0:  # the part was complete, and was killed while it joined all
                break
            self.assertFailed(done, "cannot join: the planes ")
            self.assertLessEqual(set(before), set(self.chunks()))
            if number == 1:
                self.assertDone(self.run_program(*RUN, "--part", "3/3"))
            self.assertOnlyParts()
            before = self.chunks()
            number += 3
        self.assertGreater(number, 6)
        self.assertTrue(self.contents() == reference)

    @needs_library
    def test_killed_join_is_repeated(self):
        """The last part is killed at any of the writes of its join."""
        stdout, reference = self.reference_of(*RUN)
        number, kills = 1, 0
        while True:
            self.assertDone(self.run_program(*RUN, "--part", "1/2"))
            if not self.kill_part(2, 2, number):
                break
            self.assertEqual([n for n in self.all_files() if not n.startswith(".")], [])
            done = self.run_program(*RUN, "--join")
            if done.returncode == 0:
                kills += 1
                self.assertEqual(done.stdout, stdout)
            else:
                self.assertFailed(done, "cannot join")
                self.assertDone(self.run_program(*RUN, "--part", "2/2"))
            self.assertTrue(self.contents() == reference)
            self.clear()
            number += 2
        self.assertGreater(kills, 2)

    @needs_library
    def test_resume_computes_missing_parts(self):
        _, reference = self.reference_of(*RUN)
        self.assertDone(self.run_program(*RUN, "--part", "2/3"))
        self.assertTrue(self.kill_part(1, 3, 9))
        self.assertDone(self.run_program(*RUN, "--resume"))
        self.assertTrue(self.contents() == reference)

    @needs_library
    def test_parts_that_end_at_the_same_time_are_joined(self):
        """A part computes its planes and ends while another one stands still at one of its calls."""
        _, reference = self.reference_of(*RUN)
        for call in ("lock", "unlink"):
            number, is_stopped = 0, True
            while is_stopped:
                number += 1
                first = self.start(*RUN, "--part", "1/2",
                                   fault=f"{call} {number} signal={signal.SIGSTOP.value}")
                is_stopped = os.WIFSTOPPED(os.waitpid(first.pid, os.WUNTRACED)[1])
                self.assertDone(self.run_program(*RUN, "--part", "2/2"))
                if is_stopped:
                    first.send_signal(signal.SIGCONT)
                    self.assertDone(self.finish(first))
                self.assertTrue(self.contents() == reference, (call, number))
                self.clear()
            self.assertGreater(number, 1)

    def test_join_without_parts_is_an_error(self):
        self.assertFailed(self.run_program(*RUN, "--join"), "are missing in")
        self.assertEqual(self.all_files(), [])

    def test_other_input_or_options_are_refused(self):
        self.assertDone(self.run_program(*RUN, "--part", "1/2"))
        for other in ((DATA / "1ubq.xyzr", *RUN[1:]), (*RUN, "--probe-radius", "1.5"),
                      (*RUN, "--write", "edges")):
            for how in (("--part", "2/2"), ("--join",)):
                self.assertFailed(self.run_program(*other, *how), "cannot resume")
        self.assertOnlyParts()

    @needs_library
    def test_same_part_twice_at_once_is_refused(self):
        first = self.stop_at("write 9", *RUN, "--part", "1/2")
        self.assertFailed(self.run_program(*RUN, "--part", "1/2"), "another run is writing it")
        for how in ("--join", "--resume"):
            self.assertFailed(self.run_program(*RUN, how), "another run is writing there")
        self.assertDone(self.run_program(*RUN, "--part", "2/2"))
        first.kill()
        first.wait()
        self.assertDone(self.run_program(*RUN, "--part", "1/2"))
        self.assertNotIn(CHECKPOINT, self.all_files())

    def test_pipes_are_refused(self):
        pipe = self.folder / "pipe.xyzr"
        os.mkfifo(pipe)
        for path in ("-", pipe):
            self.assertFailed(self.run_program(path, "--part", "1/2", "-q"), "not a regular file")

    def test_usage(self):
        for value in ("0/2", "3/2", "1", "1/2/3", "a/2", "1/0"):
            self.assertEqual(self.run_program(SMALL, "--part", value).returncode, 2)
        for more in (("--join",), ("--exact",)):
            self.assertEqual(self.run_program(SMALL, "--part", "1/2", *more).returncode, 2)

    def test_dry_run_writes_nothing(self):
        done = self.run_program(SMALL, "--part", "1/2", "--dry-run")
        self.assertDone(done)
        self.assertIn("part: 1 of 2, ", done.stdout)
        self.assertEqual(self.all_files(), [])

    def test_report_of_a_part(self):
        done = self.run_program(SMALL, "--part", "1/2")
        self.assertDone(done)
        self.assertIn("part 1 of 2 is complete: ", done.stdout)
        self.assertNotIn("area:", done.stdout)
        report = json.loads(self.run_program(SMALL, "--part", "1/2", "--json").stdout)
        self.assertEqual(report["part"], {"index": 1, "count": 2})
        self.assertNotIn("area", report)

    def test_steps_of_a_launcher_may_compute_parts(self):
        """Tasks of one job step of Slurm do not write the same files."""
        with unittest.mock.patch.dict(os.environ, PMI_SIZE="2", SLURM_STEP_NUM_TASKS="2"):
            self.assertFailed(self.run_program(*RUN), "would all write the same files")
            for part in (1, 2):
                self.assertDone(self.run_program(*RUN, "--part", f"{part}/2"))
        self.assertNotIn(CHECKPOINT, self.all_files())


if __name__ == "__main__":
    unittest.main()
