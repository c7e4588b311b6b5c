"""Tests of scripts/pdbbind whose structures are shared by the tasks of an array."""

import os
import re
import shutil
import subprocess

from support import PROGRAM, PROJECT, SCRIPTS, run
from test_pdbbind import PdbbindTest, summary

RUN_DEPENDENT = ("seconds", "peak_bytes", "threads")


def without_run(rows):
    return {name: {key: value for key, value in row.items() if key not in RUN_DEPENDENT}
            for name, row in rows.items()}


class Tasks(PdbbindTest):
    def setUp(self):
        super().setUp()
        for name in ("a", "b", "c", "d", "e"):
            self.add(name + ".xyzr")
        self.add("f.xyzr", "1ubq.xyzr")
        (self.input / "bad.xyzr").write_text("0 0 0 1\nx\n")

    def merge(self):
        return run("pdbbind", "merge", self.output)

    def test_all_tasks_together_give_the_results_of_one_run(self):
        self.run_pdbbind(code=1)
        at_once, self.output = summary(self.output), self.folder / "shares"
        for task in (3, 1):
            run("pdbbind", *self.arguments("--task", f"{task}/3"))
        missing = self.merge()
        self.assertDone(missing, 1)
        self.assertIn("task 2 of 3", missing.stderr)
        run("pdbbind", *self.arguments("--task", "2/3"))
        self.assertDone(self.merge(), 1)  # a structure has failed
        self.assertEqual(without_run(summary(self.output)), without_run(at_once))
        sizes = [len(summary(self.output, f"summary-{task}-of-3.csv")) for task in (1, 2, 3)]
        self.assertEqual(sorted(sizes), [2, 2, 3])

    def test_more_tasks_than_structures_are_allowed(self):
        for task in range(1, 10):
            run("pdbbind", *self.arguments("--task", f"{task}/9", "--keep", "none"))
        self.merge()
        self.assertEqual(len(summary(self.output)), 7)

    def test_shares_of_different_arrays_are_refused(self):
        run("pdbbind", *self.arguments("--task", "1/1", "--keep", "none"))
        shutil.copy(self.output / "summary-1-of-1.csv", self.output / "summary-2-of-2.csv")
        self.assertIn("1 and 2 tasks", self.merge().stderr)
        (self.output / "summary-1-of-1.csv").rename(self.output / "summary-1-of-2.csv")
        self.assertIn("two tasks", self.merge().stderr)
        self.assertDone(self.merge(), 1)

    def test_several_tasks_of_one_step_are_independent(self):
        """`srun -n 2` starts two tasks. Each has a share, so the program must not refuse."""
        (self.input / "bad.xyzr").unlink()
        self.run_pdbbind("--task", "1/2", env={**os.environ, "SLURM_STEP_NUM_TASKS": "2"})
        rows = summary(self.output, "summary-1-of-2.csv")
        self.assertEqual([row["status"] for row in rows.values()], ["done"] * 3)

    def test_slurm_file_of_the_documentation_runs_a_task(self):
        text = (PROJECT / "doc/pdbbind.md").read_text(encoding="utf-8")
        (self.folder / "eses-pdbbind").symlink_to(SCRIPTS / "pdbbind")
        for task in (1, 2):
            environment = {**os.environ, "PATH": f"{self.folder}:{os.environ['PATH']}",
                           "SLURM_ARRAY_TASK_ID": str(task), "SLURM_ARRAY_TASK_COUNT": "2", "SLURM_CPUS_PER_TASK": "1"}
            subprocess.run(["bash", "-c", re.search("```bash\n(.*?)```", text, re.DOTALL)[1], "pdbbind.sbatch",
                            self.input, self.output, "--keep", "none", "--program", PROGRAM],
                           env=environment, capture_output=True, check=False)
        self.merge()
        self.assertEqual(sum(row["status"] == "done" for row in summary(self.output).values()), 6)
