"""Tests of scripts/pdbbind with the input, options and failures of its users."""

import contextlib
import csv
import fcntl
import gzip
import json
import os
import shutil
import signal
import subprocess
import time

from support import (DATA, PROGRAM, PROJECT, TestCase, command, forget_signals,
                     needs_gemmi, run, write_program)

PATIENCE = 600  # seconds until a test gives up; no normal run takes so long

# Replaces eses-blocks. A structure whose name begins with "slow" takes longer than any test waits.
SLOW = f"""case "$1" in */slow*) echo $$ >>"$0.pids"; exec sleep 3600;; esac
exec '{PROGRAM}' "$@"
"""


def report_of(path):
    """Returns the report of eses-blocks for a structure."""
    done = subprocess.run([PROGRAM, path, "--json", "--write", "none"], capture_output=True,
                          check=True)
    return json.loads(done.stdout)


def summary(folder, name="summary.csv"):
    with open(folder / name, encoding="utf-8", errors="surrogateescape", newline="") as file:
        return {row["id"]: row for row in csv.DictReader(file)}


def wait_for(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError
        time.sleep(0.02)


class PdbbindTest(TestCase):
    def setUp(self):
        super().setUp()
        self.input, self.output = self.folder / "in", self.folder / "results"
        self.input.mkdir()

    def add(self, name, source="c60.xyzr"):
        path = self.input / name
        path.parent.mkdir(parents=True, exist_ok=True)
        return shutil.copy(DATA / source, path)

    def arguments(self, *more):
        return (self.input, "-o", self.output, "--program", PROGRAM, *more)

    def run_pdbbind(self, *more, code=0, **how):
        done = run("pdbbind", *self.arguments(*more), **how)
        self.assertDone(done, code)
        return done

    def files(self, name):
        return sorted(path.name for path in (self.output / name).iterdir())

    def stamp(self, name):
        """Returns a value that changes when the structure is computed again."""
        return (self.output / name / "status.json").stat().st_mtime_ns

    def statuses(self):
        return {name: row["status"] for name, row in summary(self.output).items()}


class Results(PdbbindTest):
    def test_rows_are_those_of_the_program(self):
        self.add("c60.xyzr")
        self.add("below/boxb.pqr", "boxb.pqr")
        with gzip.open(self.input / "1ubq.xyzr.gz", "wb") as packed:
            packed.write((DATA / "1ubq.xyzr").read_bytes())
        self.run_pdbbind()
        rows = summary(self.output)
        self.assertEqual(list(rows), ["1ubq", "below/boxb", "c60"])
        for name, source in (("c60", "c60.xyzr"), ("1ubq", "1ubq.xyzr"), ("below/boxb", "boxb.pqr")):
            row, report = rows[name], report_of(DATA / source)
            self.assertEqual(int(row["atoms"]), report["atoms"])
            self.assertEqual([int(row[key]) for key in ("nx", "ny", "nz")], report["grid"]["size"])
            self.assertEqual([int(row[key]) for key in ("bx", "by", "bz")],
                             report["blocks"]["along_axes"])
            self.assertEqual(float(row["area"]), report["area"])
            for key in ("volume", "divergence_volume"):
                self.assertEqual(float(row[key]), report[key])
            for kind in ("convex", "saddle", "concave"):
                self.assertEqual(float(row[f"{kind}_area"]), report["area_by_kind"][kind])
            self.assertEqual(row["radii"], "file")
            self.assertGreater(float(row["seconds"]), 0)
            self.assertGreater(int(row["peak_bytes"]), 1_000_000)
            self.assertEqual(row["status"], "done")
        self.assertEqual([row["input"] for row in rows.values()],
                         ["1ubq.xyzr.gz", "below/boxb.pqr", "c60.xyzr"])

    def test_exact_values_are_in_the_table(self):
        (self.input / "two.xyzr").write_text("0 0 0 1.7\n0 0 3 1.7\n", encoding="ascii")
        self.run_pdbbind("--", "--exact")
        row = summary(self.output)["two"]  # values in closed form
        self.assertAlmostEqual(float(row["exact_area"]), 66.0779806211, delta=1e-9)
        self.assertAlmostEqual(float(row["exact_volume"]), 42.3467039769, delta=1e-9)
        self.run_pdbbind()
        row = summary(self.output)["two"]
        self.assertEqual((row["exact_area"], row["exact_volume"]), ("", ""))

    @needs_gemmi
    def test_structures_are_read_directly_with_radii(self):
        self.add("a.cif.gz", PROJECT / "tests/data/1a8o.cif.gz")
        record = "ATOM      1  CA  ALA A   1      {:6.3f}   0.000   0.000  1.00  0.00           C\n"
        (self.input / "b.pdb").write_text(record.format(0) + record.format(3))
        self.add("c.xyzr")
        self.run_pdbbind("--radii", "bondi")
        rows = summary(self.output)
        self.assertEqual([int(row["atoms"]) for row in rows.values()], [556, 2, 60])
        self.assertEqual([row["radii"] for row in rows.values()], ["bondi", "bondi", "file"])
        status = json.loads((self.output / "b/status.json").read_text())
        self.assertEqual(status["report"]["structure"]["radii"], "bondi")
        stamps = [self.stamp(name) for name in "abc"]
        self.run_pdbbind("--radii", "bondi")
        self.assertEqual([self.stamp(name) for name in "abc"], stamps)
        # Other radii give other results. xyzr files have their own radii.
        self.run_pdbbind("--radii", "msms")
        changed = [self.stamp(name) != stamp for name, stamp in zip("abc", stamps)]
        self.assertEqual(changed, [True, True, False])

    @needs_gemmi
    def test_assembly_files_have_ids_of_their_own(self):
        record = "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n"
        for name in ("a.pdb", "a.pdb1", "b.pdbx.pdb"):
            (self.input / name).write_text(record)
        (self.input / "a.pdb2").write_text(f"MODEL        1\n{record}ENDMDL\n"
                                           f"MODEL        2\n{record}ENDMDL\n")
        done = self.run_pdbbind("--radii", "bondi", code=1)
        status = {name: row["status"] for name, row in summary(self.output).items()}
        self.assertEqual(status, {"a": "done", "a.pdb1": "done", "a.pdb2": "failed",
                                  "b.pdbx": "done"})
        self.assertIn("2 models, which are the copies of an assembly", done.stderr)

    @needs_gemmi
    def test_options_of_structure_files_reach_the_program(self):
        self.add("a.cif.gz", PROJECT / "tests/data/1a8o.cif.gz")
        self.run_pdbbind("--radii", "protor", "--", "--waters")
        self.assertEqual(int(summary(self.output)["a"]["atoms"]), 644)
        # Radii that cannot be used are one error, not one for each structure.
        done = self.run_pdbbind("--radii", "unknown", code=2)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn("protor, bondi, msms, naccess, oons, one of them with +shannon, occupancy", done.stderr)
        done = self.run_pdbbind("--", "--radii", "msms", code=2)
        self.assertIn("--radii", done.stderr)

    def test_keep_chooses_the_files(self):
        self.add("c60.xyzr")
        kept = {"none": [], "edges": ["bounding_box.txt", "intersection_info.txt",
                                      "partition_area.txt"]}
        kept["all"] = sorted([*kept["edges"], "grid_info.txt"])
        for keep in ("all", "none", "edges"):  # each run removes the files of the previous one
            self.run_pdbbind("--keep", keep)
            self.assertEqual(self.files("c60"), sorted([*kept[keep], "status.json"]))

    def test_options_reach_the_program(self):
        self.add("c60.xyzr")
        self.run_pdbbind("--spacing", "0.5", "--block-size", "9", "--", "--probe-radius", "1.2")
        report = json.loads((self.output / "c60" / "status.json").read_text())["report"]
        self.assertEqual(report["parameters"],
                         {"surface": "ses", "probe_radius": 1.2, "spacing": 0.5, "margin": 0.8,
                          "fill_cavities": None})
        self.assertEqual(report["blocks"]["size"], [9, 9, 9])

    def test_compressed_files_are_read(self):
        self.add("c60.xyzr")
        self.run_pdbbind("--", "--gzip")
        names = ["bounding_box.txt", "intersection_info.txt", "partition_area.txt"]
        self.assertEqual(self.files("c60"), [*(name + ".gz" for name in names), "status.json"])
        self.run_pdbbind("--keep", "none")
        self.assertEqual(self.files("c60"), ["status.json"])

    def test_threads_are_divided_among_structures(self):
        self.add("a.xyzr", "1ubq.xyzr")
        self.add("b.xyzr", "1ubq.xyzr")
        # Each run waits for the other, so both must run at the same time.
        both = write_program(self.folder / "program", f"""case "$1" in *.xyzr)
  touch "$0.$$"
  until [ $(ls "$0".* | wc -l) -eq 2 ]; do sleep 0.02; done
esac
exec '{PROGRAM}' "$@"
""")
        self.run_pdbbind("--jobs", "2", "--threads", "5", "--program", both)
        self.assertEqual(sorted(row["threads"] for row in summary(self.output).values()),
                         ["2", "3"])


class Names(PdbbindTest):
    def test_ids_follow_the_layout_of_pdbbind(self):
        self.add("1abc/1abc_protein.xyzr")
        self.add("1abc/1abc_pocket.xyzr")
        self.add("2abc_protein.xyzr")
        self.add("set/3abc/3abc.xyzr")
        self.add("set/4abc_pocket.xyzr")  # without a protein beside it
        self.run_pdbbind()
        self.assertEqual(list(self.statuses()), ["1abc", "2abc", "set/3abc", "set/4abc_pocket"])

    def test_unusual_names_are_computed(self):
        names = ["a b", "-dash", "--", "größe", "'quoted\"", "two\nlines", os.fsdecode(b"\xff"), "*"]
        for name in names:
            self.add(name + ".xyzr")
        self.run_pdbbind()
        self.assertEqual(self.statuses(), {name: "done" for name in sorted(names)})
        for name in names:
            self.assertIn("intersection_info.txt", self.files(name))

    def test_unusual_folders_are_computed(self):
        self.input = self.input / "-o x"
        self.input.mkdir()
        self.add("c60.xyzr")
        done = run("pdbbind", "./-o x", "-o", "out put", "--program", PROGRAM,
                   cwd=self.input.parent)
        self.assertDone(done)
        self.assertIn("c60", summary(self.input.parent / "out put"))

    def test_two_files_of_one_id_are_refused(self):
        self.add("1abc.xyzr")
        self.add("1abc.pqr", "boxb.pqr")
        done = self.run_pdbbind(code=1)
        self.assertIn("1abc.xyzr", done.stderr)
        self.assertIn("1abc.pqr", done.stderr)
        self.assertFalse(self.output.exists())
        self.run_pdbbind("--only", "*.pqr")
        self.assertEqual(summary(self.output)["1abc"]["atoms"], "619")

    def test_ids_that_are_names_of_summaries_are_refused(self):
        """Refused before anything is computed."""
        self.add("a.xyzr")
        for name in ("summary.csv.xyzr", "summary.csv/b.xyzr", "summary-1-of-2.csv.pqr"):
            path = self.add(name)
            for options in ((), ("--task", "1/2"), ("--task", "2/2")):
                done = self.run_pdbbind(*options, code=1)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                self.assertIn(f"{path}: its results would go to {self.output}", done.stderr)
            self.assertFalse(self.output.exists())
            self.run_pdbbind("--only", "a.*")
            shutil.rmtree(self.output)
            path.unlink()
        self.add("b/summary.csv.xyzr")
        self.run_pdbbind()
        self.assertEqual(self.statuses(), {"a": "done", "b/summary.csv": "done"})

    def test_folder_in_the_place_of_the_summary_is_refused(self):
        self.add("a.xyzr")
        (self.output / "summary.csv").mkdir(parents=True)
        done = self.run_pdbbind(code=1)
        self.assertEqual(done.stderr, f"pdbbind: cannot write {self.output}/summary.csv: Is a directory\n")
        self.assertEqual(self.files("."), ["summary.csv"])

    def test_links_are_followed_once(self):
        self.add("a/c60.xyzr")
        (self.input / "a" / "loop").symlink_to(self.input)
        self.run_pdbbind()
        self.assertEqual(list(self.statuses()), ["a/c60"])

    def test_results_are_not_taken_for_structures(self):
        self.add("c60.xyzr")
        self.output = self.input / "results"
        self.run_pdbbind("--keep", "none")
        (self.output / "c60" / "atoms.pqr").write_bytes((DATA / "boxb.pqr").read_bytes())
        self.add("._c60.xyzr")  # macOS leaves it beside a file
        self.run_pdbbind("--keep", "none")
        self.assertEqual(list(self.statuses()), ["c60"])

    def test_areas_of_measure_are_not_taken_for_structures(self):
        self.add("a.pqr", "boxb.pqr")
        measured = subprocess.run([PROGRAM, "measure", "a.pqr", "--write", "cif"], cwd=self.input, check=False)
        self.assertEqual(measured.returncode, 0)
        done = self.run_pdbbind("--keep", "none")
        self.assertEqual(list(self.statuses()), ["a"])
        self.assertIn("a.areas.cif is left out", done.stderr)


class Failures(PdbbindTest):
    def test_one_bad_file_does_not_stop_the_others(self):
        self.add("good.xyzr")
        (self.input / "bad.xyzr").write_text("0 0 0 1\n1 2 x 1\n")
        (self.input / "cut.xyzr.gz").write_bytes(gzip.compress(b"0 0 0 1\n" * 100)[:-12])
        (self.input / "plain.xyzr.gz").write_bytes(b"0 0 0 1\n")
        done = self.run_pdbbind(code=1)
        self.assertEqual(self.statuses(), {"bad": "failed", "cut": "failed", "good": "done",
                                           "plain": "failed"})
        self.assertIn("bad.xyzr:2", summary(self.output)["bad"]["message"])
        for name in ("bad.xyzr:2", "cut.xyzr.gz", "plain.xyzr.gz"):
            self.assertIn(name, done.stderr)
        self.assertEqual(self.files("bad"), ["status.json"])

    def test_failed_structure_is_tried_again(self):
        (self.input / "c60.xyzr").write_text("nothing\n")
        self.run_pdbbind(code=1)
        self.add("c60.xyzr")
        self.run_pdbbind()
        self.assertEqual(self.statuses(), {"c60": "done"})

    def test_folder_without_structures_is_an_error(self):
        self.assertIn("no structures", self.run_pdbbind(code=1).stderr)
        (self.input / "notes.txt").write_text("0 0 0 1\n")
        self.assertIn("no structures", self.run_pdbbind(code=1).stderr)
        self.assertFalse(self.output.exists())

    def test_invalid_options_are_refused(self):
        self.add("c60.xyzr")
        (self.folder / "file").write_text("")
        for code, arguments in (
                (1, (self.folder / "missing",)),
                (1, (self.folder / "file",)),
                (1, (self.input, "-o", self.input)),
                (1, (self.input, "-o", self.folder / "file")),
                (1, (self.input, "-o", "/proc/results", "--program", PROGRAM)),
                (1, (self.input, "-o", self.output, "--program", self.folder / "missing")),
                (1, (self.input, "-o", self.output, "--program", "/bin/true")),
                (2, (self.input, "-o", self.output, "--program", PROGRAM, "--spacing", "x")),
                (2, (self.input, "-o", self.output, "--program", PROGRAM, "--", "--threads", "1")),
                (2, (self.input, "-o", self.output, "--task", "3/2")),
                *((2, (self.input, "-o", self.output, "--program", PROGRAM, "--", *words))
                  for words in (("--no-such-option",), ("--spacing", "0"), ("other.xyzr",))),
                (2, ())):
            done = run("pdbbind", *arguments)
            self.assertDone(done, code)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertFalse(self.output.exists())

    def test_arguments_that_the_script_sets_are_refused(self):
        self.add("c60.xyzr")
        for words in (("--dry-run",), ("--help",), ("--help-all",), ("-h",), ("-qh",), ("--version",), ("--json",),
                      ("-o", "x"), ("-ox",), ("--output-dir=x",), ("--format", "xyzr"),
                      ("--write", "grid"), ("--write=none",), ("--mesh", "x.ply"),
                      ("--color=atom",), ("--inside", "x.dx"), ("--threads", "1"), ("-t1",),
                      ("--spacing", "0.5", "--dry-run")):
            done = self.run_pdbbind("--", *words, code=2)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn("is refused after --", done.stderr)
            self.assertFalse(self.output.exists())
        self.run_pdbbind("--", "-qb32", "--verify=10", "--strict", "--max-memory", "1G",
                         "--region", "-5,-5,-5,5,5,5")
        self.assertEqual(self.statuses(), {"c60": "done"})

    def test_help_describes_every_option(self):
        output = run("pdbbind", "--help-all").stdout
        for option, word in (("--probe-radius", "solvent"), ("--spacing", "grid points"),
                             ("--margin", "grid boundary"), ("--block-size", "side of a block")):
            self.assertIn(word, " ".join(output.partition(option)[2].split())[:120])

    def test_unwritable_output_is_refused(self):
        if os.geteuid() == 0:
            self.skipTest("root may write everywhere")
        self.add("c60.xyzr")
        self.output.mkdir(mode=0o500)
        self.assertIn("Permission denied", self.run_pdbbind(code=1).stderr)


class Resuming(PdbbindTest):
    def setUp(self):
        super().setUp()
        for name in ("a", "b", "c"):
            self.add(name + ".xyzr")

    def redone(self, *arguments):
        """Calls the script again and returns the ids that it computes. All must be done at the
        end."""
        before = {name: self.stamp(name) for name in "abc"
                  if (self.output / name / "status.json").exists()}
        self.run_pdbbind(*arguments)
        self.assertEqual(set(self.statuses().values()), {"done"})
        return {name for name in "abc" if self.stamp(name) != before.get(name)}

    def test_complete_results_are_kept(self):
        self.assertEqual(self.redone(), {"a", "b", "c"})
        before = summary(self.output)
        self.assertEqual(self.redone(), set())
        self.assertEqual(summary(self.output), before)  # including the times
        self.assertEqual(self.redone("--threads", "1", "--jobs", "2"), set())

    def test_changed_structures_are_computed_again(self):
        self.run_pdbbind()
        (self.output / "a" / "intersection_info.txt").unlink()
        (self.output / "b" / "partition_area.txt").write_text("cut off")
        self.assertEqual(self.redone(), {"a", "b"})
        self.add("c.xyzr", "1ubq.xyzr")
        self.assertEqual(self.redone(), {"c"})
        self.assertEqual(summary(self.output)["c"]["atoms"], "602")
        a = self.input / "a.xyzr"
        a.write_text(a.read_text().replace("1.70\n", "1.80\n"))  # the same length
        self.assertEqual(self.redone(), {"a"})

    def test_other_options_are_computed_again(self):
        self.run_pdbbind()
        self.assertEqual(self.redone("--spacing", "0.5"), {"a", "b", "c"})
        self.assertEqual(self.redone("--spacing", "0.5", "--keep", "none"), {"a", "b", "c"})
        self.assertEqual(self.redone("--spacing", "0.5", "--keep", "none"), set())

    def test_incomplete_results_are_computed_again(self):
        self.run_pdbbind("--keep", "all")
        wrecked = self.output / "a"
        (wrecked / "status.json").unlink()
        (wrecked / "partition_area.txt").rename(wrecked / ".partition_area.txt.1.part")
        (wrecked / ".work-1").mkdir()
        (wrecked / ".work-1" / "report").write_text("{")
        (self.output / "b" / "status.json").write_text('{"status": "do')
        self.assertEqual(self.redone(), {"a", "b", "c"})  # c: --keep has changed
        for name in "abc":
            self.assertEqual(self.files(name), ["bounding_box.txt", "intersection_info.txt",
                                                "partition_area.txt", "status.json"])

    def test_edited_status_is_computed_again(self):
        self.run_pdbbind()
        path = self.output / "a" / "status.json"
        status = json.loads(path.read_text())
        names = list(status["files"])
        for changed in ({"files": None}, {"files": 1}, {"files": names}, {"files": {"\0": 1}},
                        {"files": "files"}, {"report": None}, {"report": {}}, {"seconds": None},
                        {"report": {**status["report"], "grid": None}}, {"prepared": None},
                        {"prepared": {"remark": 1}}, {"status": None}, {"request": []}):
            with self.subTest(changed=changed):
                path.write_text(json.dumps({**status, **changed}))
                self.assertEqual(self.redone(), {"a"})
        for text in ("null", "[]", "[" * 100_000, "{}"):
            path.write_text(text)
            self.assertEqual(self.redone(), {"a"})

    def test_files_of_a_running_program_are_left_alone(self):
        """Files that another process is still writing are left alone until it has ended."""
        folder = self.output / "a"
        folder.mkdir(parents=True)
        unfinished = folder / ".grid_info.txt.1.part"
        unfinished.write_text("0 0 0 -1\n")
        with open(folder / ".eses-blocks.lock", "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            done = self.run_pdbbind("--keep", "all", code=1)
            self.assertIn(f"another run is writing into {folder}", done.stderr + done.stdout)
            self.assertTrue(unfinished.exists())
        self.run_pdbbind("--keep", "all")
        self.assertFalse([name for name in self.files("a") if name.startswith(".")])


class Interruption(PdbbindTest):
    def setUp(self):
        super().setUp()
        self.add("a.xyzr")
        self.add("slow1.xyzr", "1ubq.xyzr")  # larger ones come first
        self.add("slow2.xyzr", "1ubq.xyzr")
        self.slow = write_program(self.folder / "slow", SLOW)
        self.addCleanup(self.end_slow_ones)

    def end_slow_ones(self):
        for number in self.slow_ones():
            with contextlib.suppress(ProcessLookupError):
                os.kill(int(number), signal.SIGKILL)

    def slow_ones(self):
        path = self.folder / "slow.pids"
        return path.read_text().split() if path.exists() else []

    def start(self):
        """Returns a run of which `a` is done and both others are running."""
        process = subprocess.Popen(
            command("pdbbind", *self.arguments("--jobs", "3", "--program", self.slow)),
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            preexec_fn=forget_signals)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        wait_for(lambda: (self.output / "a" / "status.json").exists()
                 and len(self.slow_ones()) == 2)
        return process

    def finish(self):
        """Checks that a second call computes the rest and keeps the finished structure."""
        before = self.stamp("a")
        self.run_pdbbind()
        self.assertEqual(self.stamp("a"), before)
        self.assertEqual(self.statuses(), {"a": "done", "slow1": "done", "slow2": "done"})

    def check_signal(self, number):
        process = self.start()
        process.send_signal(number)
        _, output = process.communicate(timeout=PATIENCE)  # does not wait for the slow structures
        self.assertEqual(process.returncode, 128 + number, output)
        self.assertEqual(self.statuses(), {"a": "done", "slow1": "pending", "slow2": "pending"})
        self.assertEqual(self.files("slow1"), [])
        self.finish()

    def test_ctrl_c_ends_the_run_in_order(self):
        self.check_signal(signal.SIGINT)

    def test_sigterm_ends_the_run_in_order(self):
        self.check_signal(signal.SIGTERM)

    def test_killed_run_is_continued(self):
        process = self.start()
        done = self.run_pdbbind(code=1)
        self.assertIn("another run", done.stderr)
        process.kill()
        process.wait()
        self.assertTrue(any(name.startswith(".work-") for name in self.files("slow1")))
        self.finish()
        self.assertFalse([name for name in self.files("slow1") if name.startswith(".")])


class WithoutPdb2pqr(PdbbindTest):
    """PDB2PQR is missing or fails. test_pdb2pqr.py runs the real one."""

    def setUp(self):
        super().setUp()
        self.programs = self.folder / "bin"
        self.programs.mkdir()
        self.add("c60.xyzr")
        (self.input / "1abc.pdb").write_text(
            "ATOM      1  N   GLY A   1      11.104   6.134  -6.504  1.00  0.00           N\n"
            "ATOM      2  CA  GLY A   1      12.560   6.134  -6.504  1.00  0.00           C\n")

    def run_with_path(self, path):
        return self.run_pdbbind(code=1, env={**os.environ, "PATH": str(path)})

    def test_missing_pdb2pqr_is_reported(self):
        done = self.run_with_path(self.programs)
        self.assertIn("apt-get install pdb2pqr", done.stderr)
        self.assertIn("1abc.pdb", done.stderr)
        # PDB and mmCIF files are prepared alike.
        (self.input / "1abc.pdb").unlink()
        self.add("1abc.cif.gz", PROJECT / "tests/data/1a8o.cif.gz")
        self.assertIn("1abc.cif.gz", self.run_with_path(self.programs).stderr)
        self.run_pdbbind("--only", "*.xyzr", env={**os.environ, "PATH": str(self.programs)})

    def test_failing_pdb2pqr_is_reported(self):
        write_program(self.programs / "pdb2pqr30", """echo "INFO:called with $*" >&2
echo "CRITICAL:Too few atoms" >&2
echo "CRITICAL:Giving up." >&2
exit 1
""")
        done = self.run_with_path(self.programs)
        self.assertEqual(self.statuses(), {"1abc": "failed", "c60": "done"})
        self.assertIn("Too few atoms", summary(self.output)["1abc"]["message"])
        self.assertIn("1abc", done.stderr)
        self.assertIn("--ff=CHARMM", (self.output / "1abc" / "pdb2pqr.log").read_text())
