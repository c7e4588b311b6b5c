"""Tests of eses-traj: tables of trajectories."""

import csv
import gzip
import re
import signal
import subprocess
import sys
import time
import warnings

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA

try:
    import MDAnalysis as mda
except ImportError:
    mda = None

COMMAND = (sys.executable, "-m", "eses_tools", "traj")
COUNT = 12


@pytest.fixture(autouse=True, scope="module")
def fixture_library():
    pytest.importorskip("MDAnalysis")


def run(folder, *arguments, code=0):
    done = subprocess.run([*COMMAND, *map(str, arguments)], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stderr
    if code:
        assert done.stderr.count("\n") == 1, done.stderr
    return done


def rows_of(path):
    with open(path, encoding="utf-8") as source:
        return list(csv.DictReader(source))


def write_trajectory(folder, count):
    """Writes top.pdb and run.xtc: fasciculin as chain A, and a chain B of waters that do not move with it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        protein = mda.Universe(DATA / "fas2.pqr")
        water = mda.Universe.empty(4, n_residues=4, atom_resindex=range(4), trajectory=True)
        for name, values in (("names", ["OW"] * 4), ("resnames", ["SOL"] * 4), ("resids", range(1, 5)),
                             ("elements", ["O"] * 4), ("chainIDs", ["B"] * 4), ("record_types", ["ATOM"] * 4)):
            water.add_TopologyAttr(name, values)
        protein.add_TopologyAttr("chainIDs", ["A"] * len(protein.atoms))
        heavy = protein.select_atoms("not name H*")
        heavy.atoms.residues.resnames = [name if name != "NTE" else "GLY" for name in heavy.residues.resnames]
        water.atoms.positions = heavy.positions[:4] + (0.0, 0.0, 3.0)
        universe = mda.Merge(heavy, water.atoms)
        universe.atoms.write(folder / "top.pdb")
        centers = universe.atoms.positions.copy()
        rng = np.random.default_rng(1)
        with mda.Writer(str(folder / "run.xtc"), len(centers)) as target:
            for frame in range(count):
                universe.atoms.positions = centers + rng.normal(0, 0.1, centers.shape)
                universe.trajectory.ts.time = 2.0 * frame
                target.write(universe.atoms)


@pytest.fixture(scope="module", name="folder")
def fixture_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("trajectory")
    write_trajectory(folder, COUNT)
    return folder


@pytest.fixture(name="universe")
def fixture_universe(folder):
    return mda.Universe(folder / "top.pdb", folder / "run.xtc")


def near(text, value):
    return float(text) == pytest.approx(value, abs=2e-3)


def test_rows_of_frames_are_those_of_measure(folder, universe, tmp_path):
    run(folder, "run.xtc", "top.pdb", "--stride", 5, "-o", tmp_path / "areas.csv")
    rows = rows_of(tmp_path / "areas.csv")
    assert [(row["frame"], row["time"]) for row in rows] == [("0", "0"), ("5", "10"), ("10", "20")]
    for row in rows:
        universe.trajectory[int(row["frame"])]  # pylint: disable=expression-not-assigned
        result = eses.measure(universe)
        assert near(row["ses"], result.ses_area) and near(row["sas"], result.sas_area)
        assert near(row["sas_polar"], result.polar) and near(row["sas_apolar"], result.apolar)
        assert near(row["ses_volume"], result.ses_volume) and near(row["sas_volume"], result.sas_volume)
    assert not list(tmp_path.glob(".areas*"))


def test_rows_of_residues_have_names_and_relative_areas(folder, universe, tmp_path):
    run(folder, "top.pdb", "run.xtc", "--start", -1, "--level", "residue", "--waters", "--report", "protein", "-o",
        tmp_path / "areas.csv.gz")
    with gzip.open(tmp_path / "areas.csv.gz", "rt") as source:
        rows = list(csv.DictReader(source))
    universe.trajectory[-1]  # pylint: disable=expression-not-assigned
    table = eses.measure(universe, report="protein", waters=True).residues
    assert len(rows) == len(table) > 60
    for i, row in enumerate(rows):
        for name in ("chain", "icode", "residue"):
            assert row[name] == table[name][i]
        assert int(row["residue_number"]) == table["residue_number"][i] and row["frame"] == str(COUNT - 1)
        assert near(row["ses"], table["ses"][i]) and near(row["sas_polar"], table["sas_polar"][i])
        assert near(row["relative_sas"], table["relative_sas"][i])


def test_surfaces_chains_and_selections(folder, universe, tmp_path):
    common = ("run.xtc", "top.pdb", "--stop", 1, "--level", "chain", "--waters")
    run(folder, *common, "--surface", "sas", "-o", tmp_path / "all.csv")
    run(folder, *common, "--surface", "ses", "--report", "protein", "-o", tmp_path / "part.csv")
    run(folder, *common, "--select", "protein", "-o", tmp_path / "alone.csv")
    table = eses.measure(universe, waters=True).chains
    rows = rows_of(tmp_path / "all.csv")
    assert list(rows[0]) == ["frame", "time", "chain", "sas", "sas_polar", "sas_apolar"]
    assert [row["chain"] for row in rows] == ["A", "B"]
    assert all(near(row["sas"], area) for row, area in zip(rows, table["sas"]))
    [part], [alone] = rows_of(tmp_path / "part.csv"), rows_of(tmp_path / "alone.csv")
    assert list(part) == ["frame", "time", "chain", "ses"]
    assert near(part["ses"], eses.measure(universe, report="protein", waters=True).ses_area)
    assert near(alone["ses"], eses.measure(universe.select_atoms("protein")).ses_area)
    assert float(alone["sas"]) > float(rows[0]["sas"])


@pytest.fixture(scope="module", name="with_ligand")
def fixture_with_ligand(tmp_path_factory):
    """A trajectory of fasciculin with a ligand in its largest pocket, which moves with it."""
    folder = tmp_path_factory.mktemp("pockets")
    source = tmp_path_factory.mktemp("without")
    write_trajectory(source, 3)
    universe = mda.Universe(source / "top.pdb", source / "run.xtc")
    protein = universe.select_atoms("protein")
    center = eses.Surface(protein).pockets(6)[0]["centroid"]
    ligand = universe.select_atoms("resname SOL")[:2]
    ligand.residues.resnames, ligand.names = ["LIG", "LIG"], ["C1", "C2"]
    ligand.residues.resids = [9, 9]
    (protein + ligand).write(folder / "top.pdb")
    shifts = [frame.positions[0] for frame in universe.trajectory] - universe.trajectory[0].positions[0]
    with mda.Writer(str(folder / "run.xtc"), len(protein) + 2) as target:
        for frame, shift in zip(universe.trajectory, shifts):
            ligand.positions = center + shift + [[0, 0, 0], [1.5, 0, 0]]
            frame.time = 2.0 * frame.frame
            target.write(protein + ligand)
    return folder, center


@pytest.mark.parametrize("place", ["ligand:LIG", "protein and resid 550:570", "point", "box", None])
def test_pockets_of_frames_are_those_of_pockets(with_ligand, tmp_path, place):
    folder, center = with_ligand
    universe = mda.Universe(folder / "top.pdb", folder / "run.xtc")
    where = {"point": center, "box": [center - 4, center + 4]}.get(place, place)
    text = ",".join(f"{each:.6f}" for each in np.ravel(where)) if place in ("point", "box") else place
    options = ("--large-probe", 6, "--spacing", 0.5, "--min-pocket-volume", 5, "--threads", 2)
    at = [f"--at={text}"] if place else []
    selection = "protein" if place in ("point", "box") else "all"  # the ligand would fill the place
    run(folder, "run.xtc", "top.pdb", "--pockets", *at, *options, "--select", selection, "-o", tmp_path / "pockets.csv")
    rows = rows_of(tmp_path / "pockets.csv")
    assert len(rows) == 3 and ("volume_at_place" in rows[0]) == (place is not None)
    for row in rows:
        universe.trajectory[int(row["frame"])]  # pylint: disable=expression-not-assigned
        atoms = universe.select_atoms(selection)
        found = eses.Surface(atoms).pockets(6, spacing=0.5, min_volume=5, at=where)
        assert int(row["pockets"]) == len(found) > 0
        assert near(row["pocket_volume"], sum(each["volume"] for each in found))
        if place:
            assert near(row["volume_at_place"], sum(each["volume_at_place"] for each in found))
        assert near(row["sas"], eses.measure(atoms).sas_area)
    assert len({row["pocket_volume"] for row in rows}) == 3


def test_threads_and_standard_output_change_nothing(folder, tmp_path):
    run(folder, "run.xtc", "top.pdb", "--threads", 1, "-o", tmp_path / "one.csv")
    for threads in (2, 3):
        done = run(folder, "run.xtc", "top.pdb", "--threads", threads, "-o", "-")
        assert done.stdout == (tmp_path / "one.csv").read_text()


def test_a_killed_run_goes_on(tmp_path):
    write_trajectory(tmp_path, 200)
    arguments = [*COMMAND, "run.xtc", "top.pdb", "--threads", "1", "-o", "areas.csv"]
    kept = tmp_path / ".areas.csv.frames"
    with subprocess.Popen(arguments, cwd=tmp_path, stderr=subprocess.PIPE) as process:
        end = time.monotonic() + 60
        while not (kept.exists() and kept.read_bytes().count(b"\n") > 9) and time.monotonic() < end:
            time.sleep(0.01)
        process.send_signal(signal.SIGSTOP)  # so that it does not end meanwhile
        # Another run of the same table ends at once.
        assert "another" in run(tmp_path, *arguments[len(COMMAND):], code=1).stderr
        process.send_signal(signal.SIGKILL)
    assert not (tmp_path / "areas.csv").exists()
    with open(kept, "ab") as target:
        target.write(b"7,14,half a l")  # what a full disk or a power failure may leave
    done = run(tmp_path, *arguments[len(COMMAND):])
    assert re.search(r"\d frames? finished before", done.stderr)
    run(tmp_path, *arguments[len(COMMAND):-1], "whole.csv")
    assert (tmp_path / "areas.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()
    assert not kept.exists()


def test_frames_of_other_options_are_not_used(folder, tmp_path):
    run(folder, "run.xtc", "top.pdb", "-o", tmp_path / "areas.csv")
    (tmp_path / ".other.csv.frames").write_text('{"version": "0"}\n0,0,1,1,1,1,1,1\n')
    done = run(folder, "run.xtc", "top.pdb", "-o", tmp_path / "other.csv")
    assert "before" not in done.stderr
    assert (tmp_path / "other.csv").read_bytes() == (tmp_path / "areas.csv").read_bytes()


def test_molecules_that_the_box_divides_are_reported(tmp_path):
    write_trajectory(tmp_path, 1)
    universe = mda.Universe(tmp_path / "top.pdb")
    universe.dimensions = (60, 60, 60, 90, 90, 90)
    universe.atoms[100:].positions += (60, 0, 0)
    universe.atoms.write(tmp_path / "cut.pdb")
    done = run(tmp_path, "cut.pdb", "-o", "areas.csv")
    assert "warning: the periodic box divides a molecule at" in done.stderr


def test_a_report_of_all_that_blocks_is_a_warning(folder, tmp_path):
    warning = "warning: --report index 0:99 has all atoms of --select index 0:99, so that nothing else blocks; the residues of other atoms are "
    for options, warns in ((("--select", "index 0:99", "--report", "index 0:99"), True), (("--select", "index 0:99"), False),
                           (("--report", "all", "--waters"), False), (("--report", "index 0:99"), False)):
        done = run(folder, "run.xtc", "top.pdb", "--stop", 1, *options, "-o", tmp_path / "areas.csv")
        assert (warning in done.stderr) == warns, done.stderr


@pytest.mark.parametrize("arguments, message", [
    (("run.xtc", "top.pdb", "--select", "resname NONE", "-o", "x.csv"), "--select resname NONE: no atoms"),
    (("run.xtc", "top.pdb", "--select", "what is this", "-o", "x.csv"), "--select what is this: "),
    (("run.xtc", "top.pdb", "--pockets", "--at", "ligand:LIG", "-o", "x.csv"), "--at: no atoms of residue LIG"),
    (("run.xtc", "top.pdb", "--start", "99", "-o", "x.csv"), "no frames are chosen; there are 12"),
    (("gone.xtc", "top.pdb", "-o", "x.csv"), "gone.xtc: no such file"),
    (("run.xtc", "run.xtc", "-o", "x.csv"), "its suffix is that of no topology"),
    (("run.xtc", "-o", "x.csv"), "run.xtc: its suffix is that of no topology; give trajectories and then a topology"),
    (("run.xtc", "top.pdb", "-o", "top.pdb"), "top.pdb is an input file, and would be overwritten"),
    (("run.xtc", "top.pdb", "-o", "no/x.csv"), "no/x.csv: No such file or directory"),
])
def test_errors_are_one_line(folder, arguments, message):
    done = run(folder, *arguments, code=1)
    assert done.stderr.startswith("eses-traj: ") and message in done.stderr, done.stderr
    assert not (folder / "x.csv").exists()


def test_atoms_without_a_radius_are_an_error_with_options(tmp_path):
    (tmp_path / "x.pdb").write_text("HETATM    1  UNK UNX A   1       0.000   0.000   0.000  1.00  0.00           X\n")
    done = run(tmp_path, "x.pdb", "-o", "x.csv", code=1)
    assert done.stderr.endswith("in the set protor: UNX UNK (element unknown); use --unknown-radius or another set (--radii)\n")
    run(tmp_path, "x.pdb", "-o", "x.csv", "--unknown-radius", 1.7)
    assert near(rows_of(tmp_path / "x.csv")[0]["sas"], 4 * np.pi * 3.1**2)


def test_wrong_options_of_pockets_leave_no_files(folder, tmp_path):
    done = subprocess.run([*COMMAND, "run.xtc", "top.pdb", "--pockets", "--spacing", "9", "-o", tmp_path / "x.csv"], cwd=folder,
                          capture_output=True, text=True, check=False)
    assert done.returncode == 1 and "eses-traj: the spacing must be between" in done.stderr
    assert not list(tmp_path.iterdir())


def test_wrong_options_end_with_2(folder):
    run(folder, "run.xtc", "top.pdb", "-o", "x.csv", "--level", "atom", code=2)
    run(folder, "run.xtc", "top.pdb", "-o", "x.csv", "--stride", "0", code=2)
    for options, message in ((["--at", "ligand"], "--at needs --pockets"),
                             (["--pockets", "--level", "residue"], "--pockets needs --level frame"),
                             (["--pockets", "--at=1,2"], "three numbers X,Y,Z"),
                             (["--pockets", "--at=1,2,3,1,5,6"], "three numbers X,Y,Z"),
                             (["--pockets", "--at="], "expected a selection")):
        done = subprocess.run([*COMMAND, "run.xtc", "top.pdb", "-o", "x.csv", *options], cwd=folder, capture_output=True,
                              text=True, check=False)
        assert done.returncode == 2 and message in done.stderr, done.stderr
