"""Compares results in memory with closed forms and with the files of the program."""

import concurrent.futures
import subprocess
import sys
import threading

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA


def crossing_lines(crossings):
    """Formats crossings as the lines of intersection_info.txt."""
    lines = []
    for row in zip(crossings.inside_point.tolist(), crossings.outside_point.tolist(),
                   crossings.position.tolist(), crossings.normal.tolist(),
                   crossings.atoms.tolist()):
        inside, outside, position, normal, atoms = row
        lines.append(" ".join([*(str(index) for index in inside + outside),
                               *(f"{value:.12e}" for value in position + normal),
                               *(str(atom) for atom in atoms if atom >= 0)]) + " \n")
    return lines


def assert_equal_files(result, folder):
    nx, ny, nz = result.grid.shape
    signs = np.loadtxt(folder / "grid_info.txt", dtype=np.int64)
    k, j, i = (axis.ravel() for axis in np.meshgrid(*map(np.arange, (nz, ny, nx)), indexing="ij"))
    assert np.array_equal(signs[:, :3], np.stack([i, j, k], axis=1))
    assert np.array_equal(signs[:, 3] == 1, result.inside.ravel(order="F"))
    lines = (folder / "intersection_info.txt").read_text().splitlines(keepends=True)
    assert crossing_lines(result.crossings) == lines
    areas = [line.split() for line in (folder / "partition_area.txt").read_text().splitlines()]
    assert [[str(atom), f"{area:.12e}"] for atom, area in enumerate(result.atom_areas)] == areas
    box = (folder / "bounding_box.txt").read_text().split()
    assert [f"{value:.12e}" for value in result.grid.origin] == box[:3]
    assert [str(count) for count in result.grid.shape] == box[6:]


@pytest.mark.parametrize("name, spacing", [("1ubq.xyzr", 0.8), ("c60.xyzr", 0.3),
                                           ("boxb.pqr", 0.7)])
def test_results_are_those_of_the_files(name, spacing, tmp_path, run_program):
    run_program(DATA / name, "1.4", spacing, 2 * spacing, "-o", tmp_path)
    atoms = eses.read_atoms(DATA / name)
    surface = eses.Surface(atoms.centers, atoms.radii)
    assert_equal_files(surface.compute(surface.grid(spacing, 2 * spacing)), tmp_path)


def test_chosen_grid_is_that_of_the_files(tmp_path, run_program, ubiquitin_surface):
    run_program(DATA / "1ubq.xyzr", "1.4", "0.9", "--grid-origin", "20,15,0", "--grid-points",
                "33,17,25", "-o", tmp_path)
    grid = ubiquitin_surface.grid(0.9, origin=(20, 15, 0), shape=(33, 17, 25))
    assert_equal_files(ubiquitin_surface.compute(grid), tmp_path)


def test_sphere_agrees_with_its_closed_form():
    # The surface of a sphere of radius 2 in closed form.
    surface = eses.Surface([[0.1, 0.2, 0.3]], [2.0])
    result = surface.compute(surface.grid(0.1))
    assert result.area == pytest.approx(16 * np.pi, rel=5e-3)
    assert result.volume == pytest.approx(32 / 3 * np.pi, rel=1e-2)
    assert result.convex_area == pytest.approx(result.area, rel=1e-12)
    assert result.saddle_area == result.concave_area == 0
    assert result.atom_areas == pytest.approx([result.area])
    crossings = result.crossings
    away = crossings.position - [0.1, 0.2, 0.3]
    assert np.linalg.norm(away, axis=1) == pytest.approx(2, abs=1e-12)
    assert crossings.normal == pytest.approx(away / 2, abs=1e-12)
    # The divergence theorem for the field x, averaged over the axes.
    along = crossings.position[np.arange(len(crossings)), crossings.axis]
    flux = np.where(crossings.lower_is_inside, along, -along).sum() / 3
    assert result.divergence_volume == pytest.approx(0.1**2 * flux, rel=1e-12)
    assert result.divergence_volume == pytest.approx(32 / 3 * np.pi, rel=2e-3)
    assert (crossings.kind == 1).all()
    assert (crossings.atoms == [0, -1, -1]).all()
    x, y, z = np.meshgrid(*map(result.grid.coordinates, range(3)), indexing="ij")
    distance = np.sqrt((x - 0.1)**2 + (y - 0.2)**2 + (z - 0.3)**2)
    is_clear = abs(distance - 2) > 1e-9
    assert np.array_equal(result.inside[is_clear], (distance < 2)[is_clear])
    assert result.inside_points == result.inside.sum()


def test_arrays_have_documented_shapes_and_types(ubiquitin_surface):
    grid = ubiquitin_surface.grid(1.0)
    result = ubiquitin_surface.compute(grid)
    inside, crossings = result.inside, result.crossings
    nx, ny, nz = grid.shape
    assert inside.shape == (nx, ny, nz) and inside.dtype == bool
    assert inside.strides == (1, nx, nx * ny) and inside.flags.f_contiguous
    assert result.grid == grid
    assert result.region == ((0, 0, 0), grid.shape)
    count = len(crossings)
    assert count > 5000
    for name, dtype, shape in (("lower", np.int64, (count, 3)), ("axis", np.uint8, (count,)),
                               ("position", np.float64, (count, 3)),
                               ("normal", np.float64, (count, 3)),
                               ("atoms", np.int64, (count, 3)), ("kind", np.uint8, (count,)),
                               ("lower_is_inside", np.bool_, (count,)),
                               ("inside_point", np.int64, (count, 3)),
                               ("outside_point", np.int64, (count, 3))):
        array = getattr(crossings, name)
        assert array.dtype == dtype and array.shape == shape, name
    rows = np.arange(count)
    lower, axis = crossings.lower, crossings.axis
    upper = lower.copy()
    upper[rows, axis] += 1
    assert np.array_equal(inside[tuple(lower.T)], crossings.lower_is_inside)
    assert inside[tuple(crossings.inside_point.T)].all()
    assert not inside[tuple(crossings.outside_point.T)].any()
    is_lower_inside = crossings.lower_is_inside[:, None]
    assert np.array_equal(crossings.inside_point, np.where(is_lower_inside, lower, upper))
    assert np.array_equal(crossings.outside_point, np.where(is_lower_inside, upper, lower))
    assert np.array_equal((crossings.atoms >= 0).sum(axis=1), crossings.kind)
    # Every edge whose ends differ has a crossing.
    assert count == sum(int((np.diff(inside, axis=a) != 0).sum()) for a in range(3))
    normal_along = abs(crossings.normal[rows, axis])
    assert result.area == pytest.approx(normal_along.sum(), rel=1e-12)
    assert result.atom_areas.sum() == pytest.approx(result.area, rel=1e-12)
    assert result.convex_area + result.saddle_area + result.concave_area == pytest.approx(
        result.area, rel=1e-12)
    assert "eses_blocks.Result" in repr(result) and str(count) in repr(crossings)


def test_arrays_are_read_only_views_that_live_on(ubiquitin_surface):
    result = ubiquitin_surface.compute(ubiquitin_surface.grid(1.5))
    arrays = [result.inside, result.atom_areas, result.crossings.lower, result.crossings.atoms,
              result.crossings.position, result.mesh().vertices, result.mesh().faces]
    assert result.inside.base is result
    assert np.shares_memory(result.inside, result.inside)
    assert np.shares_memory(result.crossings.normal, result.crossings.normal)
    copies = [array.copy() for array in arrays]
    del result
    np.full(10**6, 7)  # overwrites freed memory
    for array, copy in zip(arrays, copies):
        assert np.array_equal(array, copy)
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


def test_arrays_stay_read_only(ubiquitin_surface):
    result = ubiquitin_surface.compute(ubiquitin_surface.grid(1.5))
    mesh = result.mesh()
    arrays = [ubiquitin_surface.centers, ubiquitin_surface.radii, result.inside, result.atom_areas]
    arrays += [getattr(result.crossings, name) for name in
               ("lower", "axis", "position", "normal", "atoms", "kind", "lower_is_inside")]
    arrays += [mesh.vertices, mesh.normals, mesh.faces, mesh.atoms, mesh.kind]
    for array in arrays:
        with pytest.raises(ValueError, match="WRITEABLE"):
            array.flags.writeable = True


def test_results_do_not_depend_on_threads_and_blocks(ubiquitin_surface):
    grid = ubiquitin_surface.grid(0.7)
    first = ubiquitin_surface.compute(grid, threads=1)
    for arguments in ({"threads": 2}, {"threads": 5, "block_size": 9}, {"block_size": 128}):
        other = ubiquitin_surface.compute(grid, **arguments)
        assert other.area == first.area and other.volume == first.volume
        assert np.array_equal(other.atom_areas, first.atom_areas)
        assert np.array_equal(other.inside, first.inside)
        for name in ("lower", "axis", "position", "normal", "atoms", "kind", "lower_is_inside"):
            assert np.array_equal(getattr(other.crossings, name), getattr(first.crossings, name))


def test_python_threads_share_a_surface(ubiquitin_surface):
    grid = ubiquitin_surface.grid(0.9)
    expected = ubiquitin_surface.compute(grid).atom_areas
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        areas = list(pool.map(
            lambda _: ubiquitin_surface.compute(grid, threads=1).atom_areas, range(8)))
    for each in areas:
        assert np.array_equal(each, expected)


def test_other_threads_run_during_a_computation(lattice):
    surface = eses.Surface(*lattice(12))
    grid = surface.grid(0.2)
    turns, ended = [0], threading.Event()

    def count():
        while not ended.wait(0.001):
            turns[0] += 1

    counter = threading.Thread(target=count)
    counter.start()
    before = turns[0]
    surface.compute(grid, threads=1, crossings=False)
    during = turns[0] - before
    ended.set()
    counter.join()
    assert during >= 5


def test_forked_processes_compute():
    # The test runs in a process of its own, because the threads of this one must not take part.
    code = """
import multiprocessing
import eses_blocks as eses
surface = eses.Surface([[0, 0, 0], [2, 0, 0]], [1.5, 1.7])
grid = surface.grid(0.2)
expected = surface.compute(grid, threads=2).area

def area_of(threads):
    return surface.compute(grid, threads=threads).area

with multiprocessing.get_context("fork").Pool(2) as pool:
    print(pool.map(area_of, [0, 1, 2, 5]) == 4 * [expected])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                          check=False, timeout=300)
    assert (done.stdout, done.stderr) == ("True\n", "")


def test_region_is_a_part_of_the_whole(ubiquitin_surface):
    grid = ubiquitin_surface.grid(0.9)
    whole = ubiquitin_surface.compute(grid)
    begin, end = (5, 10, 3), (25, 24, 31)
    part = ubiquitin_surface.compute(grid, region=(begin, end))
    slices = tuple(map(slice, begin, end))
    assert part.region == (begin, end)
    assert np.array_equal(part.inside, whole.inside[slices])
    lower = whole.crossings.lower
    is_in_region = ((lower >= begin) & (lower < end)).all(axis=1)
    assert 0 < is_in_region.sum() < len(lower)
    assert np.array_equal(part.crossings.lower, lower[is_in_region])
    assert np.array_equal(part.crossings.position, whole.crossings.position[is_in_region])


def test_range_of_blocks_is_a_part_of_the_whole(ubiquitin_surface):
    grid = ubiquitin_surface.grid(0.9)
    nx, ny, nz = grid.shape
    # A block of 17 points has 16 cells; the last one along an axis owns the rest.
    part = ubiquitin_surface.compute(grid, block_size=17, blocks=((1, 0, 0), (2, 1, 2)))
    assert part.region == ((16, 0, 0), (32, 16, 32))
    last = (nx - 2) // 16
    rest = ubiquitin_surface.compute(grid, block_size=17, blocks=((last, 0, 0), (last + 1, 1, 1)))
    assert rest.region == ((16 * last, 0, 0), (nx, 16, 16))
    assert ubiquitin_surface.compute(grid, blocks=((0, 0, 0), (1, 1, 1))).region == (
        (0, 0, 0), (min(nx, 64) if nx <= 64 else 63, min(ny, 64), min(nz, 64)))


def test_mesh_is_closed_and_oriented(ubiquitin_surface):
    result = ubiquitin_surface.compute(ubiquitin_surface.grid(0.8))
    mesh, crossings = result.mesh(), result.crossings
    assert mesh.vertices.shape == mesh.normals.shape == (len(crossings), 3)
    assert abs(mesh.vertices - crossings.position).max() <= 1.001e-4 * 0.8
    assert np.array_equal(mesh.normals, crossings.normal)
    assert np.array_equal(mesh.atoms, crossings.atoms[:, 0])
    assert np.array_equal(mesh.kind, crossings.kind)
    faces = mesh.faces
    assert faces.dtype == np.int64 and faces.shape[1] == 3
    # The mesh is closed and oriented: each edge of a triangle belongs to one other triangle, in the
    # opposite direction.
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    forth = np.sort(edges[:, 0] * len(crossings) + edges[:, 1])
    back = np.sort(edges[:, 1] * len(crossings) + edges[:, 0])
    assert np.array_equal(forth, back) and (np.diff(forth) > 0).all()
    # The volume of the polyhedron by the divergence theorem is positive if normals point outward.
    a, b, c = (mesh.vertices[faces[:, q]] for q in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    assert volume == pytest.approx(result.volume, rel=0.02)
    assert "vertices" in repr(mesh)


def test_mesh_of_the_program_has_one_more_layer_of_points(tmp_path, run_program, ubiquitin_surface):
    # The difference is documented in doc/python.md.
    grid = ubiquitin_surface.grid(0.8, 1.6)
    begin, end = np.array((10, 12, 11)), np.array((30, 35, 26))
    low, high = (np.array(grid.origin) + 0.8 * (point - 0.5) for point in (begin, end))
    run_program(DATA / "1ubq.xyzr", "1.4", "0.8", "1.6", "-o", tmp_path, "--write", "none", "--mesh",
                tmp_path / "part.ply", "--ply-ascii",
                "--region=" + ",".join(map(str, (*low, *high))))
    header, body = (tmp_path / "part.ply").read_text().split("end_header\n")
    count = int(header.split("element vertex ")[1].split()[0])
    lines = [line.split() for line in body.splitlines()]
    vertices = np.array([line[:3] for line in lines[:count]], float)
    faces = np.array([line[1:] for line in lines[count:]], int)
    mesh = ubiquitin_surface.compute(grid, region=(begin, end + 1)).mesh()
    assert np.allclose(mesh.vertices, vertices, rtol=0, atol=1e-9)
    assert np.array_equal(mesh.faces, faces)
    own = ubiquitin_surface.compute(grid, region=(begin, end)).mesh()
    assert 0 < len(own.vertices) < count


def test_grid_without_inside_points_has_empty_results(chain):
    surface = eses.Surface(*chain)
    result = surface.compute(surface.grid(0.5, origin=(100, 0, 0), shape=(4, 5, 6)))
    assert result.area == result.volume == result.inside_points == 0
    assert not result.inside.any() and len(result.crossings) == 0
    assert result.crossings.position.shape == (0, 3)
    assert result.crossings.atoms.shape == result.crossings.inside_point.shape == (0, 3)
    assert result.crossings.kind.shape == (0,)
    assert result.mesh().vertices.shape == result.mesh().faces.shape == (0, 3)


def test_only_chosen_parts_are_computed(chain):
    surface = eses.Surface(*chain)
    grid = surface.grid(0.5)
    whole = surface.compute(grid)
    totals = surface.compute(grid, inside=False, crossings=False)
    assert totals.area == whole.area and totals.volume == whole.volume
    for part in (lambda: totals.inside, totals.mesh, lambda: totals.crossings,
                 surface.compute(grid, inside=False).mesh):
        with pytest.raises(ValueError, match="not .*chosen; compute with (inside|crossings)=True"):
            part()


def test_progress_is_reported(ubiquitin_surface):
    calls = []
    ubiquitin_surface.compute(ubiquitin_surface.grid(0.8), block_size=20,
                              progress=lambda done, total: calls.append((done, total)))
    done, totals = zip(*calls)
    assert list(done) == sorted(done)
    assert done[-1] == totals[0] > 10 and set(totals) == {totals[0]}

    def fail(done, total):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        ubiquitin_surface.compute(ubiquitin_surface.grid(0.8), threads=2, progress=fail)
    with pytest.raises(TypeError, match="callable"):
        ubiquitin_surface.compute(ubiquitin_surface.grid(0.8), progress=3)


def test_wrong_arguments_are_refused(chain):
    surface = eses.Surface(*chain)
    grid = surface.grid(0.5)
    for arguments, message in (({"threads": -1}, "threads"), ({"block_size": 1}, "block_size"),
                               ({"block_size": 129}, "block_size"),
                               ({"region": ((0, 0, 0), (1, 1, 1)),
                                 "blocks": ((0, 0, 0), (1, 1, 1))}, "both"),
                               ({"region": ((3, 0, 0), (3, 1, 1))}, "region"),
                               ({"region": ((0, 0, 0), (1, 1, 999))}, "region"),
                               ({"blocks": ((0, 0, 0), (1, 1, 9))}, "blocks")):
        for method in (surface.compute, surface.blocks):
            with pytest.raises(ValueError, match=message):
                method(grid, **arguments)
    for limit in ("2G", -1, 1.5, None, 2**64):
        for method in (surface.compute, surface.blocks):
            with pytest.raises(TypeError, match="max_memory must be a whole number of bytes"):
                method(grid, max_memory=limit)
    for size in (1, 129, 2**70, -2**70):
        for method in (surface.compute, surface.blocks):
            with pytest.raises(ValueError, match=f"block_size must be 2 to 128, .* not {size}$"):
                method(grid, block_size=size)
    for arguments in ({"threads": 1.5}, {"block_size": 9.0}, {"block_size": None}, {"region": ((0, 0), (1, 1))},
                      {"region": 3}, {"inside": "yes"}, {"unknown": 1}):
        with pytest.raises(TypeError):
            surface.compute(grid, **arguments)
    for method in (surface.compute, surface.blocks):
        with pytest.raises(TypeError):
            method(grid, 1)
        with pytest.raises(TypeError):
            method("grid")


def test_memory_limits_are_kept(chain):
    surface = eses.Surface(*chain)
    with pytest.raises(MemoryError, match="needs"):
        surface.compute(surface.grid(0.05), max_memory=1 << 20)
    with pytest.raises(MemoryError, match="memory"):
        surface.compute(surface.grid(0.001, origin=(0, 0, 0), shape=(10**5, 10**5, 10**5)))
    with pytest.raises(MemoryError):
        surface.blocks(surface.grid(0.05), max_memory=1 << 20)
    with pytest.raises(MemoryError) as error:
        surface.compute(surface.grid(0.05), max_memory=1 << 20)
    assert "--" not in str(error.value)  # the options of the program


def test_memory_of_the_caller_does_not_count():
    held = np.ones(40 << 20)  # 320 MiB
    surface = eses.Surface([[0, 0, 0]], [1.5])
    assert surface.compute(surface.grid(0.2), max_memory=250 << 20).inside.any()
    assert held[-1] == 1


def test_small_grid_in_a_large_molecule_needs_little_memory():
    index = np.indices((40, 40, 40)).reshape(3, -1).T
    surface = eses.Surface(3.0 * index, np.full(len(index), 1.7))
    grid = eses.Grid((60, 60, 60), 0.05, (20, 20, 20))
    result = surface.compute(grid, max_memory=1 << 30)
    assert result.inside.shape == (20, 20, 20)


def test_table_of_atoms_has_the_rows_of_the_file(tmp_path, run_program):
    pandas = pytest.importorskip("pandas")
    atoms = eses.read_atoms(DATA / "fas2.pqr")
    surface = eses.Surface(atoms.centers, atoms.radii)
    result = surface.compute(surface.grid(0.8), inside=False, crossings=False)
    table = result.atom_table(atoms)
    assert np.array_equal(table.area, result.atom_areas)
    run_program(DATA / "fas2.pqr", "--spacing", "0.8", "--write", "atoms", "-o", tmp_path)
    file = pandas.read_csv(tmp_path / "atoms.csv", keep_default_na=False, dtype={"residue_number": str})
    assert list(table.columns) == list(file.columns)
    assert len(table) == len(file) == len(atoms)
    for column in set(file.columns) - {"area"}:
        assert table[column].tolist() == file[column].tolist(), column
    assert np.allclose(table.area, file.area, rtol=0, atol=1e-6)
    # Without the atoms the names are empty.
    plain = result.atom_table()
    assert set(plain.name) == {""} and np.array_equal(plain.radius, atoms.radii)
    with pytest.raises(ValueError, match="906 atoms, but 60"):
        result.atom_table(eses.read_atoms(DATA / "c60.xyzr"))


def test_missing_pandas_is_an_import_error(monkeypatch, ubiquitin, ubiquitin_surface):
    monkeypatch.setitem(sys.modules, "pandas", None)
    result = ubiquitin_surface.compute(ubiquitin_surface.grid(2.0, 2.0))
    with pytest.raises(ImportError, match="atom_table needs pandas; install it"):
        result.atom_table()
    with pytest.raises(ImportError, match="to_dataframe needs pandas; install it"):
        ubiquitin.to_dataframe()


def test_tables_notice_another_order_of_the_atoms(tmp_path):
    pytest.importorskip("pandas")
    lines = [f"ATOM {i} CA ALA A {i} {4 * i} 0 0 0 1.5\n" for i in range(1, 4)]
    forward, backward, moved = (tmp_path / name for name in ("a.pqr", "b.pqr", "c.pqr"))
    forward.write_text("".join(lines))
    backward.write_text("".join(reversed(lines)))
    moved.write_text("".join(lines).replace(" 0 0 0 ", " 1 0 0 "))
    atoms = eses.read_atoms(forward)
    surface = eses.Surface(atoms.centers, atoms.radii)
    result = surface.compute(surface.grid(0.5))
    assert len(result.atom_table(eses.read_atoms(moved))) == 3  # of another frame
    with pytest.raises(ValueError, match="in another order"):
        result.atom_table(eses.read_atoms(backward))
    with pytest.raises(TypeError, match="atoms must be Atoms, not array"):
        result.residue_table(np.zeros(3))


def test_arrays_that_are_called_read_only_are(tmp_path):
    path = tmp_path / "a.pqr"
    path.write_text("ATOM 1 CA ALA A 1 0 0 0 0 1.5\n")
    atoms = eses.read_atoms(path)
    surface = eses.Surface(atoms.centers, atoms.radii)
    crossings = surface.compute(surface.grid(0.5)).crossings
    for array in (atoms.element, atoms.labels.chain, atoms.labels.atom_name, crossings.inside_point,
                  crossings.outside_point):
        assert not array.flags.writeable
