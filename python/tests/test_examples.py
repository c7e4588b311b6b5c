"""Runs the examples as programs."""

import csv
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA, PROJECT

EXAMPLES = PROJECT / "python/examples"


def run(name, *arguments):
    done = subprocess.run([sys.executable, EXAMPLES / name, *map(str, arguments)],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return list(csv.DictReader(done.stdout.splitlines()))


@pytest.mark.parametrize("notebook", ["surface", "interface", "trajectory", "potential"])
def test_notebook_runs(notebook, tmp_path, monkeypatch, fasciculin_surface):
    needs = {"surface": (), "interface": (), "trajectory": ("MDAnalysis", "matplotlib"), "potential": ("matplotlib",)}
    for name in ("nbclient", "nbformat", "ipykernel", "pandas", *needs[notebook]):
        pytest.importorskip(name)
    import notebook_page  # pylint: disable=import-outside-toplevel
    assert notebook in notebook_page.PAGES
    monkeypatch.setenv("PYTHONPATH", str(pathlib.Path(eses.__file__).parents[1]))
    monkeypatch.setenv("JUPYTER_PATH", "")  # notebook_page sets it
    done = notebook_page.run(notebook_page.source_of(notebook), tmp_path)
    pictures = notebook_page.pictures_in(done)
    assert len(pictures) == (0 if notebook == "interface" else 1)
    if notebook == "surface":
        assert (tmp_path / "fas2.html").stat().st_size > 100000
        surface = fasciculin_surface
        area = surface.compute(surface.grid(0.5, 1.0), inside=False).area
        assert done.cells[-1].outputs[-1].text.endswith(f"of {area:.0f} square angstrom\n")
    # scripts/dev/make-notebook has made the page from the present notebook, with its outputs.
    assert notebook_page.page_of(notebook).read_text(encoding="utf-8") == notebook_page.markdown(notebook, done)
    for number in range(1, len(pictures) + 1):
        assert notebook_page.picture_of(notebook, number).stat().st_size < 300000


def test_trajectory_prints_area_and_volume(tmp_path, ubiquitin):
    rng = np.random.default_rng(2)
    frames = ubiquitin.centers + rng.normal(0, 0.1, (3, 602, 3))
    frames[0] = ubiquitin.centers
    np.save(tmp_path / "frames.npy", frames.astype(np.float32))
    rows = run("trajectory.py", DATA / "1ubq.xyzr", tmp_path / "frames.npy", "--spacing", "0.8")
    assert [row["frame"] for row in rows] == ["0", "1", "2"]
    for row, frame in zip(rows, frames.astype(np.float32)):
        surface = eses.Surface(frame, ubiquitin.radii)
        result = surface.compute(surface.grid(0.8))
        assert float(row["area"]) == pytest.approx(result.area, rel=1e-5)
        assert float(row["volume"]) == pytest.approx(result.volume, rel=1e-5)


def test_trajectory_of_mdanalysis_is_read(tmp_path):
    pytest.importorskip("MDAnalysis")
    rows = run("trajectory.py", DATA / "fas2.pqr", DATA / "fas2.pqr", "--spacing", "0.8")
    atoms = eses.read_atoms(DATA / "fas2.pqr")
    surface = eses.Surface(atoms.centers, atoms.radii)
    assert len(rows) == 1
    assert float(rows[0]["area"]) == pytest.approx(surface.compute(surface.grid(0.8)).area, rel=1e-4)


# Areas and volumes of two spheres of radius 1.7 for a probe of 1.4, by distance.
SES_OF_TWO_SPHERES = {3: (66.0779806211, 42.3467039769), 6: (72.7000761036, 41.1849134259)}


def write_spheres(path, distances):
    """Writes a PDB file with a model for each distance of two atoms."""
    path.write_text("".join(
        f"MODEL     {model:4}\n" + "".join(
            f"ATOM  {serial:5}  C   GLY A{serial:4}       0.000   0.000{z:8.3f}  1.00  0.00           C\n"
            for serial, z in ((1, 0), (2, distance))) + "ENDMDL\n"
        for model, distance in enumerate(distances, 1)))


@pytest.mark.parametrize("count", [2, 64, 130])
def test_trajectory_areas_prints_areas_and_volumes(tmp_path, count):
    pytest.importorskip("MDAnalysis")
    distances = [3 + 3 * (frame % 2) for frame in range(count)]
    write_spheres(tmp_path / "pair.pdb", distances)
    (tmp_path / "pair.xyzr").write_text("0 0 0 1.7\n0 0 3 1.7\n")
    rows = run("trajectory_areas.py", tmp_path / "pair.pdb", "--radii", tmp_path / "pair.xyzr")
    assert [row["frame"] for row in rows] == [str(frame) for frame in range(count)]
    for row, distance in zip(rows, distances):
        area, volume = SES_OF_TWO_SPHERES[distance]
        assert float(row["ses_area"]) == pytest.approx(area, rel=1e-9)
        assert float(row["ses_volume"]) == pytest.approx(volume, rel=1e-9)
        assert float(row["sas_area"]) == pytest.approx(4 * np.pi * 3.1 * (3.1 + distance / 2), rel=1e-9)


def test_surface_areas_can_be_imported(monkeypatch):
    mdanalysis = pytest.importorskip("MDAnalysis")
    monkeypatch.syspath_prepend(str(EXAMPLES))
    from trajectory_areas import SurfaceAreas  # pylint: disable=import-outside-toplevel
    universe = mdanalysis.Universe(str(DATA / "fas2.pqr"))  # with radii
    atoms = universe.select_atoms("index 0:99")
    results = SurfaceAreas(atoms).run().results
    assert results.atom_sas_area.shape == (1, len(atoms))
    surface = eses.Surface(atoms.positions, atoms.radii)
    assert results.atom_sas_area[0] == pytest.approx(surface.measure(by_atom=True).by_atom.sas)
    assert results.ses_volume == pytest.approx(surface.measure().ses_volume)


def test_ligand_features_knows_elements_of_two_letters(tmp_path):
    ligand = tmp_path / "ligand.pqr"
    ligand.write_text("".join(
        f"HETATM {number} {name} LIG 1 {4 * number} 0 0 0 1.7\n"
        for number, name in enumerate(("CL1", "BR2", "C3", "CL"), 1)))
    rows = run("ligand_features.py", DATA / "fas2.pqr", ligand, "--spacing", "1")
    assert [row["element"] for row in rows if row["part"] == "ligand"] == ["Cl", "Br", "C"]


def test_ligand_features_prints_buried_areas(tmp_path):
    # The ligand has two atoms, in contact with the loops of fasciculin.
    protein = eses.read_atoms(DATA / "fas2.pqr")
    far = protein.centers[np.argmax(protein.centers[:, 2])]
    ligand = tmp_path / "ligand.pqr"
    ligand.write_text("".join(
        f"HETATM{number:5} {name:<4} LIG     1    {x:8.3f}{y:8.3f}{z:8.3f} 0.000 1.700\n"
        for number, name, (x, y, z) in ((1, "C1", far + [0, 0, 3.0]), (2, "O1", far + [0, 0, 4.2]))))
    rows = run("ligand_features.py", DATA / "fas2.pqr", ligand, "--spacing", "0.5")
    assert list(rows[0]) == ["part", "residue", "element", "area", "buried_area"]
    assert {row["part"] for row in rows} == {"protein", "ligand"}
    assert {row["element"] for row in rows if row["part"] == "ligand"} == {"C", "O"}
    protein_area = sum(float(row["area"]) for row in rows if row["part"] == "protein")
    surface = eses.Surface(protein.centers, protein.radii)
    grid = surface.grid(0.5)
    # Another grid gives the same area within the error of the sum.
    assert protein_area == pytest.approx(surface.compute(grid).area, rel=0.01)
    buried = {part: sum(float(row["buried_area"]) for row in rows if row["part"] == part)
              for part in ("protein", "ligand")}
    assert buried["protein"] > 1 and buried["ligand"] > 1
    # Residues far from the ligand lose nothing but the rounding of the file.
    assert sum(abs(float(row["buried_area"])) < 1e-3 for row in rows) > len(rows) / 2
