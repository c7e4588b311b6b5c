"""Tests of measurements of many files that are interrupted and continued with --resume."""

import re
import signal

from faults import NO_SPACE, FaultTest, has_ended, needs_library, wait_for, write_pdb
from support import needs_gemmi

LOG = ".all.csv.eses-blocks.results"
COUNT = 5


@needs_gemmi
class Results(FaultTest):
    def setUp(self):
        super().setUp()
        self.inputs = self.folder / "inputs"
        self.inputs.mkdir()
        lines = write_pdb(self.folder / "whole.pdb").read_text().splitlines(keepends=True)
        for i in range(COUNT):
            (self.inputs / f"{i}.pdb").write_text("".join(lines[:200 + 20 * i]) + "END\n")
        self.table = self.output / "all.csv"
        self.output.mkdir()

    def arguments(self, *more, command="measure"):
        return (command, self.inputs, "--csv", self.table, "--write", "residues", *more)

    def resumed(self, *more, **how):
        return self.run_program(*self.arguments("--resume", *more), **how)

    def fail_once(self, *more):
        """A run in which one more file fails, so that the results of all others are kept."""
        bad = self.inputs / "5.pdb"
        bad.write_text("no atoms\n")
        done = self.resumed(*more)
        self.assertDone(done, 1)
        self.assertIn(LOG, self.all_files())
        self.assertIn("run the same command again to measure only the files that failed", done.stderr)
        bad.unlink()

    def assertKept(self, done, count):
        found = re.search(r"note: (\d+) results? of an earlier run kept", done.stderr)
        self.assertEqual(int(found[1]) if found else 0, count, done.stderr)

    def check_killed_runs(self, arguments, count):
        """Kills a run at each of its writes, and again at the next one, and continues it."""
        self.put({})
        done = self.run_program(*arguments)
        self.assertDone(done)
        reference, printed = self.contents(), done.stdout
        kept, number = set(), 1
        while True:
            self.put({})
            done = self.run_program(*arguments, "--resume", fault=f"write {number} signal={signal.SIGKILL.value}")
            if done.returncode != -signal.SIGKILL:
                break
            self.assertNotIn("all.csv", self.all_files())
            self.run_program(*arguments, "--resume", fault=f"write 1 signal={signal.SIGKILL.value}")
            done = self.run_program(*arguments, "--resume")
            self.assertDone(done)
            self.assertEqual(done.stdout, printed)
            self.assertEqual(self.contents(), reference)
            found = re.search(r"note: (\d+) result", done.stderr)
            kept.add(int(found[1]) if found else 0)
            number += 1
        self.assertLessEqual(kept, set(range(count + 1)))
        if arguments[-2:] == ("-t", "1"):  # otherwise the order of writes differs between runs
            self.assertEqual(len(kept), count + 1)
        else:
            self.assertGreater(max(kept), 0)

    @needs_library
    def test_runs_that_are_killed_at_any_write_go_on(self):
        for command, more in (("measure", ("-t", "2")), ("measure", ("--json",)), ("measure", ("-t", "1")),
                              ("interface", ("-t", "1")), ("interface", ("--json",))):
            self.check_killed_runs(self.arguments(*more, command=command), COUNT)

    @needs_library
    def test_models_of_killed_runs_are_kept(self):
        text = "".join(f"MODEL     {i + 1:4}\n{(self.inputs / f'{i}.pdb').read_text()[:-4]}ENDMDL\n" for i in range(3))
        for path in self.inputs.iterdir():
            path.unlink()
        (self.inputs / "models.pdb").write_text(text)
        for command in ("measure", "interface"):
            self.check_killed_runs(self.arguments("--model", "all", "-t", "1", command=command), 3)

    @needs_library
    def test_full_disks_keep_complete_results(self):
        self.assertDone(self.run_program(*self.arguments()))
        reference = self.contents()
        self.put({})
        self.fail_once()
        bytes_of_log = (self.output / LOG).stat().st_size
        kept = set()
        for byte in range(1, bytes_of_log, bytes_of_log // 17):
            self.put({})
            self.assertFailed(self.resumed("-q", fault=f"space {byte} {LOG}"), NO_SPACE)
            done = self.resumed()
            self.assertDone(done)
            found = re.search(r"note: (\d+) result", done.stderr)
            kept.add(int(found[1]) if found else 0)
            self.assertEqual(self.contents(), reference)
        self.assertGreater(len(kept), 2)

    def test_damaged_results_are_measured_again(self):
        self.assertDone(self.run_program(*self.arguments()))
        reference = self.contents()
        self.fail_once()
        log = (self.output / LOG).read_bytes()
        mark = 8  # A file without it is none of results.
        for i in range(mark, len(log), len(log) // 29):
            self.put({**reference, LOG: log[:i] + bytes([log[i] ^ 1]) + log[i + 1:]})
            done = self.resumed()
            self.assertDone(done, 0)
            self.assertEqual(self.contents(), reference)
            self.put({**reference, LOG: log[:i]})
            self.assertDone(self.resumed())
            self.assertEqual(self.contents(), reference)

    def test_files_and_tables_that_have_changed_are_measured_again(self):
        self.fail_once()
        changed = self.inputs / "1.pdb"
        changed.write_text(changed.read_text().replace("1.500", "1.600"))
        (self.output / "3.residues.csv").unlink()
        (self.inputs / "4.pdb").unlink()
        done = self.resumed()
        self.assertDone(done)
        self.assertKept(done, 2)
        self.assertNotIn(LOG, self.all_files())
        (self.output / "4.residues.csv").unlink()
        resumed = self.contents()
        self.put({})
        self.assertDone(self.run_program(*self.arguments()))
        self.assertEqual(self.contents(), resumed)

    def test_failed_files_are_tried_again(self):
        bad = self.inputs / "5.pdb"
        bad.write_text("no atoms\n")
        for kept in (0, COUNT):
            done = self.resumed()
            self.assertDone(done, 1)
            self.assertKept(done, kept)
            self.assertIn("no ATOM or HETATM records found", self.table.read_text())
        bad.write_text((self.inputs / "0.pdb").read_text())
        done = self.resumed()
        self.assertDone(done)
        self.assertKept(done, COUNT)
        self.assertEqual(self.table.read_text().count(",protor,0,\n"), COUNT + 1)

    def test_other_options_are_refused(self):
        radii = self.folder / "radii"
        radii.write_text("name: mine\ntypes:\nC_ALI 2.00 apolar\natoms:\nANY CA C_ALI\n")
        chosen = ("--radii", radii, "--unknown-radius", "1.5")
        self.fail_once(*chosen)
        before = self.contents()
        for more, names in ((("--probe-radius", "1.5", *chosen), "--probe-radius"),
                            ((), "--radii, --unknown-radius, the file of --radii"),
                            (("--surface", "sas", "--json", *chosen), "--surface, --json"),
                            (("--strict", "--radii", radii, "--unknown-radius", "1.6"), "--unknown-radius, --strict")):
            self.assertFailed(self.resumed(*more), f"cannot resume: {self.output / LOG} has results of a run that differs in "
                              f"{names}; remove it to start again")
            self.assertEqual(self.contents(), before)
        self.assertKept(self.resumed(*chosen, "-t", "1"), COUNT)  # does not affect results
        self.fail_once(*chosen)
        radii.write_text(radii.read_text().replace("2.00", "2.01"))
        self.assertFailed(self.resumed(*chosen), "differs in the file of --radii; remove")

    def test_runs_without_resume_start_again(self):
        self.fail_once()
        done = self.run_program(*self.arguments())
        self.assertDone(done)
        self.assertKept(done, 0)
        self.assertNotIn(LOG, self.all_files())

    def test_results_are_kept_beside_tables(self):
        arguments = ("measure", self.inputs, "--write", "atoms", "--model", "all", "--resume")
        bad = self.inputs / "5.pdb"
        bad.write_text("no atoms\n")
        self.assertDone(self.run_program(*arguments), 1)
        self.assertIn(".eses-blocks.results", self.all_files())
        bad.unlink()
        done = self.run_program(*arguments)
        self.assertDone(done)
        self.assertKept(done, COUNT)
        self.assertNotIn(".eses-blocks.results", self.all_files())

    def test_tables_of_another_run_are_measured_again(self):
        """Tables with other areas may have the same size."""
        done = self.run_program(*self.arguments())
        self.assertDone(done)
        reference = self.contents()
        self.put({})
        self.fail_once()
        self.assertDone(self.run_program("measure", self.inputs, "--csv", self.output / "other.csv", "--write", "residues",
                                         "--probe-radius", "1.41"))
        (self.output / "other.csv").unlink()
        done = self.resumed()
        self.assertDone(done)
        self.assertKept(done, 0)
        self.assertEqual(self.contents(), reference)

    def test_single_inputs_leave_results_of_many(self):
        self.fail_once()
        self.assertDone(self.run_program("measure", self.inputs / "1.pdb", "--csv", self.table, "--resume"))
        self.assertIn(LOG, self.all_files())
        done = self.resumed()
        self.assertDone(done)
        self.assertKept(done, COUNT)

    def test_other_files_with_the_name_of_results_stay(self):
        (self.output / LOG).write_text("important\n")
        self.assertFailed(self.resumed(), "is no file of kept results")
        self.assertDone(self.run_program(*self.arguments()))
        self.assertEqual((self.output / LOG).read_text(), "important\n")

    def test_signals_keep_results(self):
        atoms = "".join(f"{x * 3} {y * 3} {z * 3} 1.7\n" for x in range(12) for y in range(12) for z in range(12))
        for i in range(400):
            (self.inputs / f"a{i:02}.xyzr").write_text(atoms)
        arguments = ("measure", self.inputs, "--csv", self.table, "-t", "1", "--resume")
        program = self.start(*arguments)
        wait_for(lambda: has_ended(program) or (self.output / LOG).exists() and
                 (self.output / LOG).stat().st_size > 2000)
        self.assertEqual(self.end_by(program, signal.SIGTERM).returncode, 128 + signal.SIGTERM.value)
        self.assertEqual(self.all_files(), [LOG])
        done = self.run_program(*arguments)
        self.assertDone(done)
        self.assertIn(" of an earlier run kept", done.stderr)

    def test_nothing_else_is_replaced_by_results(self):
        (self.output / LOG).mkdir()
        self.assertFailed(self.resumed(), "it is a directory")
        (self.output / LOG).rmdir()
        (self.output / LOG).write_text("1 2 3 1.5\n")
        for command in (("--resume",), ()):
            done = self.run_program("measure", self.output / LOG, "--csv", self.table, *command)
            self.assertFailed(done, "is an input file")
            self.assertEqual(self.contents(), {LOG: b"1 2 3 1.5\n"})
        done = self.run_program("measure", self.inputs, "--csv", "-", "--resume")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--resume needs --csv FILE or --write", done.stderr)
