"""Tests of the pages for notebooks and the conversions to types of other packages."""

import json
import re
import subprocess
import sys

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA, PROJECT


@pytest.fixture(scope="module")
def result(fasciculin_surface):
    grid = fasciculin_surface.grid(1.0, margin=2.0)  # does not cut the surface
    return fasciculin_surface.compute(grid)


def data_of(page):
    return json.loads(re.search(r'id="molecules">(.*?)</script>', str(page), re.DOTALL)[1])


def test_surface_shows_its_atoms(fasciculin, fasciculin_surface, tmp_path):
    page = fasciculin_surface.show(1.0, fasciculin, color="chain", style="sticks", title="fas2")
    data = data_of(page)
    molecule, = data["molecules"]
    assert data["settings"] == {"color": "chain", "style": "sticks", "opacity": 45, "opacity_is_chosen": False}
    assert molecule["name"] == "fas2"
    assert molecule["residues"][1] == ["THR", "544", ""]
    assert {array["rows"] for array in molecule["arrays"] if array["name"] == "center"} == {
        len(fasciculin)}
    page.save(tmp_path / "fas2.html")
    assert (tmp_path / "fas2.html").read_text(encoding="utf-8") == str(page)
    assert page._repr_html_().startswith("<iframe srcdoc=")
    assert '"' not in re.search('srcdoc="([^"]*)"', page._repr_html_())[1]


def test_mesh_shows_itself(result):
    mesh = result.mesh()
    molecule, = data_of(mesh.show("atom"))["molecules"]
    assert molecule["vertices"] == len(mesh.vertices)
    assert molecule["triangles"] == len(mesh.faces)


def test_unknown_arguments_are_refused(fasciculin_surface, result, monkeypatch):
    """Arguments are checked before optional packages are imported."""
    surface = fasciculin_surface
    for name in ("k3d", "pandas", "xarray"):
        monkeypatch.setitem(sys.modules, name, None)  # hides the package
    points_only = surface.compute(surface.grid(1.0), inside=False, crossings=False)
    for call in (lambda: result.mesh().show("blue"), lambda: surface.show(1.0, style="dots"),
                 lambda: surface.show(1.0, backend="paper"),
                 lambda: result.mesh().show("blue", backend="k3d"),
                 lambda: result.mesh().show("component", backend="k3d"), points_only.to_xarray,
                 lambda: result.atom_table(eses.read_atoms(DATA / "c60.xyzr")),
                 lambda: surface.show(1.0, eses.read_atoms(DATA / "c60.xyzr")),
                 lambda: result.residue_table(eses.read_atoms(DATA / "c60.xyzr"))):
        with pytest.raises(ValueError):
            call()


def test_residue_table_is_that_of_the_program(fasciculin, result, run_program, tmp_path):
    pandas = pytest.importorskip("pandas")
    run_program(DATA / "fas2.pqr", "--spacing", "1", "--margin", "2", "--write", "residues", "-o",
                tmp_path)
    file = pandas.read_csv(tmp_path / "residue_area.csv", keep_default_na=False,
                           dtype={"residue_number": str, "chain": str})
    table = result.residue_table(fasciculin)
    assert list(table.columns) == list(file.columns)
    for name in ("chain", "residue_number", "residue", "atoms"):
        assert table[name].tolist() == file[name].tolist()
    assert np.allclose(table["area"], file["area"], atol=1e-6)


def test_meshes_of_trimesh_are_closed(result):
    pytest.importorskip("trimesh")
    mesh = result.mesh().to_trimesh()
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(result.divergence_volume, rel=0.05)
    assert np.array_equal(mesh.vertex_attributes["patch"], result.mesh().kind)


def test_meshes_of_pyvista_have_the_area(result):
    pytest.importorskip("pyvista")
    mesh = result.mesh().to_pyvista()
    assert mesh.n_open_edges == 0
    assert mesh.area == pytest.approx(result.area, rel=0.05)
    assert np.array_equal(mesh.point_data["atom"], result.mesh().atoms)


def test_data_sets_of_xarray_have_the_region(fasciculin_surface):
    surface = fasciculin_surface
    pytest.importorskip("xarray")
    grid = surface.grid(1.0)
    part = surface.compute(grid, region=((5, 5, 5), (15, 20, 25))).to_xarray()
    whole = surface.compute(grid).to_xarray()
    assert dict(part.sizes) == {"x": 10, "y": 15, "z": 20}
    same = whole["inside"].sel(x=part["x"], y=part["y"], z=part["z"])
    assert bool((same == part["inside"]).all())
    assert float(whole["x"][0]) == grid.origin[0]


def test_plots_of_k3d_have_the_mesh(result):
    pytest.importorskip("k3d")
    plot = result.mesh().show(backend="k3d")
    assert plot.objects[0].vertices.shape == result.mesh().vertices.shape


def test_missing_packages_are_named(tmp_path):
    ion = tmp_path / "ion.pqr"
    ion.write_text("ATOM 1 C1 ION 1 0.000 0.000 0.000 0.0000 1.7000\n")
    program = (
        "import sys\n"
        "for name in ('trimesh', 'pyvista', 'xarray', 'k3d', 'pandas'): sys.modules[name] = None\n"
        "import eses_blocks as eses\n"
        "surface = eses.Surface([[0, 0, 0]], [1.7])\n"
        "result = surface.compute(surface.grid(0.8))\n"
        "mesh = result.mesh()\n"
        "atoms = eses.read_atoms(sys.argv[1])\n"
        "for call in (mesh.to_trimesh, mesh.to_pyvista, result.to_xarray,\n"
        "             lambda: mesh.show(backend='k3d'), lambda: result.residue_table(atoms)):\n"
        "    try: call()\n"
        "    except ImportError as error: print(error)\n")
    done = subprocess.run([sys.executable, "-c", program, ion], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, done.stderr
    assert [line.partition(";")[0] for line in done.stdout.splitlines()] == [
        "to_trimesh needs trimesh", "to_pyvista needs pyvista", "to_xarray needs xarray",
        "show(backend='k3d') needs k3d", "residue_table needs pandas"]


@pytest.mark.parametrize("viewer", ["trimesh", "pyvista", "py3Dmol", "nglview", "molviewspec"])
def test_other_viewers_take_the_mesh(viewer, result, tmp_path, monkeypatch):
    """Runs the lines of doc/python.md."""
    package = pytest.importorskip(viewer)
    text = (PROJECT / "doc/python.md").read_text(encoding="utf-8")
    code, = re.findall(rf"```python\n(import {viewer}\n.*?)```", text, re.DOTALL)
    (tmp_path / "fas2.pqr").write_bytes((DATA / "fas2.pqr").read_bytes())
    monkeypatch.chdir(tmp_path)
    if viewer == "pyvista":
        monkeypatch.setattr(package, "OFF_SCREEN", True)
    mesh = result.mesh()
    names = {"mesh": mesh}
    exec(code, names)
    if viewer == "trimesh":
        assert len(package.load(tmp_path / "fas2.glb").to_mesh().faces) == len(mesh.faces)
    elif viewer == "py3Dmol":
        page = names["view"].write_html()
        assert page.count('"x":') == 2 * len(mesh.vertices) and "addModel" in page
    elif viewer == "nglview":
        (name, position, color, index, normal), = names["view"]._ngl_msg_archive[-1]["args"][1]
        assert name == "mesh" and len(position) == len(color) == len(normal) == mesh.vertices.size
        assert index == mesh.faces.ravel().tolist()
    elif viewer == "molviewspec":
        assert str(mesh.faces[-1, -1]) in names["view"].get_state().dumps()
