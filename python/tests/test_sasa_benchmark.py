"""Tests of scripts/benchmarks/sasa, with a program of known error."""

import json
import subprocess
import sys

import pytest

import eses_blocks as eses
from conftest import DATA

SCRIPT = DATA.parent / "scripts" / "benchmarks" / "sasa"
# Every area is 0.25 too large.
ZSASA = """
import types
import numpy as np
import eses_blocks as eses

def calculate_sasa(centers, radii, *, n_points, probe_radius, n_threads, use_bitmask=False):
    if use_bitmask:
        raise RuntimeError("no bit masks")
    areas = eses.Surface(centers, radii, probe_radius=probe_radius).measure(ses=False, by_atom=True).by_atom.sas
    return types.SimpleNamespace(atom_areas=areas + 0.25)
"""


def test_errors_are_differences_from_exact_areas_and_failures_are_counted(tmp_path):
    pytest.importorskip("numpy")
    (tmp_path / "zsasa.py").write_text(ZSASA)
    path, output = DATA / "boxb.pqr", tmp_path / "rows.json"
    starter = f"import runpy, sys; sys.path.insert(0, {str(tmp_path)!r}); sys.argv = ['sasa'] + sys.argv[1:]; " \
              f"runpy.run_path({str(SCRIPT)!r}, run_name='__main__')"
    done = subprocess.run([sys.executable, "-c", starter, "--runs", "2", "--more", "--json", str(output), str(path)],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    rows = {row["method"]: row for row in json.loads(output.read_text())["rows"]}
    atoms = len(eses.read_molecule(path).radii)
    sampled = rows["zsasa, 100 points"]
    assert sampled["atoms"] == atoms and sampled["sum"] == pytest.approx(0.25 * atoms)
    assert sampled["worst"] == pytest.approx(0.25)
    assert rows["eses, exact, also the SES"]["worst"] < 1e-9
    assert rows["eses, also derivatives"]["cpu"] > 0
    assert "zsasa, 64 points, bit masks" not in rows and "no bit masks" in done.stderr
    assert "| zsasa, 100 points |" in done.stdout and "| 0.25 | 0.25 |" in done.stdout
