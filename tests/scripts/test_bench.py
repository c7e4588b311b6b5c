"""Tests of scripts/benchmarks/bench: measuring, saving, comparing, and errors."""

import gzip
import json
import os
import shutil
import signal
import subprocess
import time
import unittest
import unittest.mock

from support import DATA, PROGRAM, TestCase, run, write_program

from eses_tools import common, measuring  # after support, which makes the modules of the scripts known

COLUMNS = ("structure", "atoms", "points", "CPU s", "wall s", "peak MB", "MB written", "x copy")


def run_program(*arguments):
    done = subprocess.run([PROGRAM, *arguments, "--json"], capture_output=True, check=True)
    return json.loads(done.stdout)


class Run(unittest.TestCase):
    def test_signal_during_the_start_ends_the_program(self):
        """The program ends, too, if its script is ended before Popen returns."""
        started = []

        class Interrupted(subprocess.Popen):
            def __init__(self, *arguments, **how):
                super().__init__(*arguments, **how)
                started.append(self)
                signal.raise_signal(signal.SIGTERM)

        self.addCleanup(signal.signal, signal.SIGTERM, signal.getsignal(signal.SIGTERM))
        common.end_on_signals()
        with unittest.mock.patch("subprocess.Popen", Interrupted), \
                self.assertRaises(SystemExit) as ended:
            measuring.run(["sleep", "3600"], subprocess.DEVNULL, subprocess.DEVNULL)
        self.assertEqual(ended.exception.code, 143)
        self.assertEqual(started[0].returncode, -signal.SIGTERM)
        end = time.monotonic() + 600
        with self.assertRaises(ProcessLookupError):  # until the session has no process
            while time.monotonic() < end:
                os.killpg(started[0].pid, 0)
                time.sleep(0.02)


class BenchTest(TestCase):
    def setUp(self):
        super().setUp()
        self.input, self.saved = self.folder / "in", self.folder / "saved.json"
        self.input.mkdir()
        self.scratch = self.folder / "scratch"

    def add(self, name, source="c60.xyzr"):
        return shutil.copy(DATA / source, self.input / name)

    def bench(self, *arguments, code=0, program=PROGRAM):
        done = run("benchmarks/bench", "--program", program, "--scratch", self.scratch,
                   "--runs", "1", *arguments)
        self.assertDone(done, code)
        if self.scratch.exists():
            self.assertEqual(list(self.scratch.iterdir()), [])
        return done

    def refused(self, *arguments, code=1, **how):
        """Checks that the script prints one line of error before it measures. Returns the line."""
        done = self.bench(*arguments, code=code, **how)
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertTrue(done.stderr.startswith("bench: "), done.stderr)
        return done.stderr

    def read(self):
        return json.loads(self.saved.read_text(encoding="utf-8"))


class Figures(BenchTest):
    def test_structures_of_a_folder_are_measured(self):
        self.add("c60.xyzr")
        self.add("boxb.pqr", "boxb.pqr")
        with gzip.open(self.input / "packed.pqr.gz", "wb") as packed:
            packed.write((DATA / "boxb.pqr").read_bytes())
        (self.input / "1abc.pdb").write_text("")  # would have to be prepared by PDB2PQR
        done = self.bench(self.input, "--json", self.saved, "--threads", "1", "--block-size", "16")
        lines = done.stdout.splitlines()
        for column in COLUMNS:
            self.assertIn(column, lines[0])
        self.assertEqual([line.split(" | ")[:2] for line in lines[2:]],
                         [["| boxb", "619"], ["| c60", "60"], ["| packed", "619"]])
        saved = self.read()
        self.assertEqual(saved["settings"], {
            "runs": 1, "threads": 1, "probe_radius": 1.4, "spacing": 0.4, "margin": 0.8,
            "write": None, "block_size": 16})
        self.assertEqual(saved["structures"]["packed"]["area"],
                         saved["structures"]["boxb"]["area"])
        for row in saved["structures"].values():
            for key in ("cpu", "wall", "copy_cpu"):
                self.assertGreater(row[key], 0)
            self.assertGreater(row["peak_bytes"], 1_000_000)

    def test_bytes_and_settings_are_those_of_the_program(self):
        arguments = self.folder / "arguments"
        program = write_program(self.folder / "program", f"""echo "$@" >> '{arguments}'
exec '{PROGRAM}' "$@"
""")
        path = self.add("c60.xyzr")
        self.bench(path, "--json", self.saved, "--spacing", "0.5", "--margin", "1",
                   "--probe-radius", "1.2", "--write", "edges", "--threads", "2",
                   "--block-size", "9", "--runs", "2", program=program)
        lines = [line for line in arguments.read_text().splitlines() if "c60" in line]
        self.assertEqual(len(lines), 2)
        for line in lines:
            self.assertIn("1.2 0.5 1.0 --threads 2 --write edges --block-size 9 ", line)
        out = self.folder / "out"
        done = run_program(path, "1.2", "0.5", "1", "--write", "edges", "--output-dir", out)
        row = self.read()["structures"]["c60"]
        self.assertEqual(row["area"], done["area"])
        self.assertEqual(row["bytes"], sum(path.stat().st_size for path in out.iterdir()))

    def test_files_of_one_name_are_shown_by_their_paths(self):
        first = self.add("c60.xyzr")
        done = self.bench(first, DATA / "c60.xyzr", "--write", "none")
        self.assertIn(str(first), done.stdout)
        self.assertIn(str(DATA / "c60.xyzr"), done.stdout)


class Comparison(BenchTest):
    def setUp(self):
        super().setUp()
        self.add("c60.xyzr")
        self.add("boxb.pqr", "boxb.pqr")
        self.bench(self.input, "--json", self.saved)

    def change(self, change):
        figures = self.read()
        change(figures)
        self.saved.write_text(json.dumps(figures), encoding="utf-8")

    def lines(self):
        done = self.bench(self.input, "--against", self.saved)
        return {line.strip("|").split()[0]: line for line in done.stdout.partition("against")[2].splitlines() if line}

    def test_comparison_shows_times_and_different_results(self):
        def change(figures):
            figures["structures"]["c60"]["cpu"] = 1e3
            figures["structures"]["c60"]["area"] *= 1 + 1e-8
            figures["structures"]["boxb"]["volume"] *= 1 + 1e-10

        self.change(change)
        lines = self.lines()
        self.assertIn(" 1000.000 ", lines["c60"])
        self.assertIn(" -100.0 % ", lines["c60"])
        self.assertTrue(lines["c60"].endswith(" DIFFER |"), lines["c60"])
        self.assertTrue(lines["boxb"].endswith(" same |"), lines["boxb"])
        self.assertIn("CPU", lines)  # geometric mean

    def test_figures_without_block_size_are_compared(self):
        self.change(lambda figures: (figures["settings"].pop("block_size"),
                                     figures.pop("build")))
        self.assertIn("boxb", self.lines())

    def test_comparison_names_other_structures_and_machines(self):
        self.change(lambda figures: figures["structures"].pop("c60"))
        self.assertNotIn("c60", self.lines())
        self.change(lambda figures: figures.update(machine={"cpu": "abacus"}))
        self.assertIn("abacus", " ".join(self.lines().values()))
        self.change(lambda figures: figures["structures"].clear())
        self.assertNotIn("boxb", self.lines())

    def test_figures_with_other_settings_are_refused(self):
        for option, value in (("--spacing", "0.5"), ("--threads", "1"), ("--block-size", "32"),
                              ("--write", "edges")):
            line = self.refused(self.input, "--against", self.saved, option, value)
            self.assertIn(option[2:].replace("-", "_"), line)

    def test_files_without_figures_are_refused(self):
        self.assertIn("No such file",
                      self.refused(self.input, "--against", self.folder / "missing"))
        for text in ("{", "{}", "[]", "3", "\0", self.saved.read_text().replace('"cpu"', '"c"'),
                     json.dumps({**self.read(), "structures": {"c60": {}}}),
                     json.dumps({**self.read(), "structures": []}),
                     json.dumps({**self.read(), "settings": 1})):
            self.saved.write_text(text, encoding="utf-8")
            self.assertIn("saved.json", self.refused(self.input, "--against", self.saved))


class Failures(BenchTest):
    def test_one_bad_structure_does_not_stop_the_others(self):
        self.add("c60.xyzr")
        (self.input / "bad.xyzr").write_text("0 0 0 1\n1 2 x 1\n")
        (self.input / "cut.xyzr.gz").write_bytes(gzip.compress(b"0 0 0 1\n" * 100)[:-12])
        (self.input / "plain.xyzr.gz").write_bytes(b"0 0 0 1\n")
        (self.input / "broken.xyzr.gz").write_bytes(gzip.compress(b"")[:10] + b"\xff" * 20)
        done = self.bench(self.input, "--json", self.saved, code=1)
        self.assertEqual(list(self.read()["structures"]), ["c60"])
        self.assertIn("c60", done.stdout)
        for name in ("bad.xyzr", "cut.xyzr.gz", "plain.xyzr.gz", "broken.xyzr.gz"):
            self.assertIn(name, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 4, done.stderr)

    def test_no_result_is_an_error(self):
        (self.input / "bad.xyzr").write_text("x\n")
        self.saved.write_text("kept")
        done = self.bench(self.input, "--json", self.saved, code=1)
        self.assertIn("no run has succeeded", done.stderr)
        self.assertEqual(self.saved.read_text(), "kept")

    def test_unusable_paths_are_refused(self):
        self.assertIn("no structures", self.refused(self.input))
        path = self.add("c60.xyzr")
        self.assertIn("missing", self.refused(self.folder / "missing"))
        for place in (self.folder / "missing" / "b.json", self.folder, path / "b.json"):
            self.assertIn(str(place), self.refused(path, "--json", place))
        self.assertIn("missing", self.refused(path, program=self.folder / "missing"))
        self.assertIn("is not eses-blocks", self.refused(path, program="/bin/true"))
        self.add("c60.pqr")  # two files with the same id
        self.assertIn("c60.pqr", self.refused(self.input))
        done = run("benchmarks/bench", path, "--program", PROGRAM, "--scratch", path)
        self.assertDone(done, 1)
        self.assertIn("File exists", done.stderr)

    def test_invalid_options_are_refused(self):
        for arguments in (("--runs", "0"), ("--spacing", "x"), ("--block-size", "x"), ("--what",)):
            self.refused(*arguments, code=2)
