"""Tests of pickle and copy, and of objects that were made without their constructor."""

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA, PDB

REBUILDS = {f"pickle {protocol}": lambda value, protocol=protocol: pickle.loads(
    pickle.dumps(value, protocol)) for protocol in range(6)}
REBUILDS.update({"copy": copy.copy, "deepcopy": copy.deepcopy})
CROSSINGS = ("lower", "axis", "position", "normal", "atoms", "kind", "lower_is_inside",
             "inside_point", "outside_point")
MESH = ("vertices", "normals", "faces", "atoms", "kind")
TOTALS = ("area", "volume", "divergence_volume", "convex_area", "saddle_area", "concave_area",
          "inside_points", "grid", "region")
LABELS = ("chain", "residue", "residue_number", "atom_name")
CLASSES = [value for value in vars(eses._core).values() if isinstance(value, type)]


@pytest.fixture(name="rebuild", params=list(REBUILDS))
def fixture_rebuild(request):
    return REBUILDS[request.param]


@pytest.fixture(name="surface", scope="module")
def fixture_surface(chain):
    return eses.Surface(*chain, 1.1)


@pytest.fixture(name="result", scope="module")
def fixture_result(surface):
    return surface.compute(surface.grid(0.5))


def assert_equal_arrays(first, second, names):
    assert type(first) is type(second)
    for name in names:
        expected, array = getattr(first, name), getattr(second, name)
        assert array.dtype == expected.dtype and array.shape == expected.shape, name
        assert np.array_equal(array, expected), name
        assert array.flags.writeable == expected.flags.writeable, name


def test_surface(surface, rebuild):
    again = rebuild(surface)
    assert_equal_arrays(surface, again, ("centers", "radii"))
    assert again.probe_radius == 1.1
    grid = surface.grid(0.5)
    assert again.compute(grid).area == surface.compute(grid).area


@pytest.mark.usefixtures("needs_gemmi")
def test_atoms_keep_their_set_of_radii(rebuild, tmp_path):
    path = tmp_path / "two.pdb"
    path.write_text(PDB)
    for radii, waters in (("bondi", True), ("protor+shannon", False)):
        atoms = eses.read_atoms(path, radii=radii, waters=waters)
        before, after = eses.measure(atoms), eses.measure(rebuild(atoms))
        assert after.radii.name == before.radii.name == radii and after.radii.source == before.radii.source
        assert after.radii.guessed.tolist() == before.radii.guessed.tolist()
        assert after.left_out == before.left_out and rebuild(before).left_out == before.left_out
        assert rebuild(before).radii.name == radii


def test_diagnostics(rebuild, tmp_path):
    path = tmp_path / "ca.pdb"
    path.write_text("".join(f"ATOM  {i:5}  CA  ALA A{i:4}    {4 * i:8.3f}   0.000   0.000  1.00  0.00           C\n"
                            for i in range(1, 9)))
    atoms = eses.read_atoms(path)
    assert atoms.diagnostics
    surface = eses.Surface([[0, 0, 0], [0, 0, 0]], [1.5, 1.5])
    for before, after in ((atoms.diagnostics, rebuild(atoms).diagnostics),
                          (surface.diagnostics, [rebuild(one) for one in surface.diagnostics])):
        assert [(one.kind, one.count, one.examples, one.is_usual) for one in before] == [
            (one.kind, one.count, one.examples, one.is_usual) for one in after]


def test_grid(rebuild):
    grid = eses.Grid((1, 2, 3), 0.1, (3, 4, 5))
    assert rebuild(grid) == grid


@pytest.mark.parametrize("name", ["1ubq.xyzr", "fas2.pqr"])
def test_atoms(name, rebuild):
    atoms = eses.read_atoms(DATA / name)
    again = rebuild(atoms)
    assert_equal_arrays(atoms, again, ("centers", "radii", "lines", "element"))
    if name == "1ubq.xyzr":
        assert again.labels is None and again.charge is None
    else:
        assert np.array_equal(atoms.charge, again.charge)
        assert_equal_arrays(atoms.labels, again.labels, LABELS)
        assert_equal_arrays(atoms.labels, rebuild(atoms.labels), LABELS)


def test_crossings_and_mesh(result, rebuild):
    assert_equal_arrays(result.crossings, rebuild(result.crossings), CROSSINGS)
    assert_equal_arrays(result.mesh(), rebuild(result.mesh()), MESH)


@pytest.mark.parametrize("region", [None, ((3, 4, 2), (11, 15, 14))])
def test_result(surface, rebuild, region):
    result = surface.compute(surface.grid(0.5), region=region)
    again = rebuild(result)
    for name in TOTALS:
        assert getattr(again, name) == getattr(result, name), name
    assert_equal_arrays(result, again, ("inside", "atom_areas"))
    assert again.inside.flags.f_contiguous
    assert_equal_arrays(result.crossings, again.crossings, CROSSINGS)
    assert_equal_arrays(result.mesh(), again.mesh(), MESH)
    for mine, other in zip(result.dielectric(), again.dielectric()):
        assert np.array_equal(mine, other)
    assert np.array_equal(result.kappa(), again.kappa())


def test_result_without_parts(surface, rebuild):
    grid = surface.grid(0.5)
    again = rebuild(surface.compute(grid, inside=False, crossings=False))
    assert again.area == surface.compute(grid).area
    for part in (lambda: again.inside, lambda: again.crossings, again.mesh):
        with pytest.raises(ValueError, match="not .*chosen"):
            part()
    only = rebuild(surface.compute(grid, inside=False))
    assert len(only.crossings) == len(surface.compute(grid).crossings)


def test_empty_result(surface, rebuild):
    result = surface.compute(surface.grid(0.5, origin=(100, 0, 0), shape=(4, 5, 6)))
    again = rebuild(result)
    assert_equal_arrays(result.crossings, again.crossings, CROSSINGS)
    assert_equal_arrays(result.mesh(), again.mesh(), MESH)


def attributes_of(value):
    return {name: getattr(value, name) for name, member in vars(type(value)).items()
            if isinstance(member, property)}


def assert_equal_measures(first, second):
    assert type(first) is type(second)
    for name, expected in attributes_of(first).items():
        value = getattr(second, name)
        assert type(value) is type(expected), name
        if isinstance(expected, np.ndarray):
            assert_equal_arrays(first, second, (name,))
        elif type(expected) in CLASSES:
            assert_equal_measures(expected, value)
        else:
            assert value == expected, name


@pytest.mark.parametrize("chosen", [False, True])
def test_measures(surface, rebuild, chosen):
    options = {"by_atom": chosen, "derivatives": chosen, "van_der_waals": chosen,
               "weights": surface.radii if chosen else None}
    for measures in (surface.measure(**options),
                     eses.measure_frames(surface.centers[None], surface.radii, **options)):
        again = rebuild(measures)
        assert_equal_measures(measures, again)
        if chosen:
            assert_equal_measures(measures.by_atom, rebuild(measures.by_atom))
            assert_equal_measures(measures.gradients, rebuild(measures.gradients))


def test_workers_return_results():
    # The test runs in a process of its own, because a fork does not have the threads of this one.
    code = """
import multiprocessing
import numpy as np, eses_blocks as eses
surface = eses.Surface([[0, 0, 0], [2, 0, 0]], [1.5, 1.7])

def compute(spacing):
    return surface.compute(surface.grid(spacing))

with multiprocessing.get_context("fork").Pool(2) as pool:
    for spacing, result in zip((0.2, 0.3), pool.map(compute, (0.2, 0.3))):
        own = compute(spacing)
        print(np.array_equal(result.crossings.normal, own.crossings.normal),
              result.area == own.area)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                          check=False, timeout=300)
    assert (done.stdout, done.stderr) == (2 * "True True\n", "")


@pytest.mark.parametrize("protocol", range(6))
def test_other_classes_are_refused(surface, protocol):
    blocks = surface.blocks(surface.grid(0.5))
    for value in (blocks, next(blocks)):
        with pytest.raises(TypeError, match="pickle"):
            pickle.dumps(value, protocol)


@pytest.mark.parametrize("type_", CLASSES)
def test_objects_without_constructor_do_not_crash(type_, surface):
    value = type_.__new__(type_)
    for name, member in vars(type_).items():
        if isinstance(member, property):
            with pytest.raises((TypeError, RuntimeError)):
                getattr(value, name)
    for action in (pickle.dumps, copy.deepcopy):
        with pytest.raises((TypeError, RuntimeError)):
            action(value)
    with pytest.raises(TypeError):
        surface.compute(value)
    with pytest.raises(TypeError):
        eses.Surface(value, [1])
    if type_ is eses.Surface:
        for action in (len, repr, eses.Surface.grid, lambda s: s.blocks(eses.Grid((0, 0, 0), 1, (2, 2, 2)))):
            with pytest.raises(TypeError, match="not initialized"):
                action(value)
    if type_ is eses.Result:
        for action in (eses.Result.mesh, eses.Result.kappa, eses.Result.dielectric):
            with pytest.raises(TypeError, match="not initialized"):
                action(value)
    if type_ is eses.BlockIterator:
        for action in (next, list, eses.BlockIterator.close):
            with pytest.raises(TypeError, match="not initialized"):
                action(value)


def changed(state, index, value):
    return state[:index] + (value,) + state[index + 1:]


def first_changed(array, value):
    array = array.copy()
    array[(0,) * array.ndim] = value
    return array


def bad_states(value):
    """Yields states that differ from that of an object in one entry."""
    state = value.__getstate__()
    yield from ((), state[:-1], state + (0,), (None,) * len(state), ("x",) * len(state))
    for index, entry in enumerate(state):
        yield changed(state, index, object())
        if isinstance(entry, np.ndarray):
            if not (isinstance(value, eses.Mesh) and index == 4):  # a face less is no contradiction
                yield changed(state, index, entry[:-1])
            yield changed(state, index, entry[..., None])


def all_measures(surface):
    return surface.measure(van_der_waals=True, by_atom=True, derivatives=True, weights=surface.radii)


@pytest.mark.parametrize("make", [
    lambda surface, result: surface,
    lambda surface, result: eses.Grid((0, 0, 0), 1, (2, 2, 2)),
    lambda surface, result: result,
    lambda surface, result: result.crossings,
    lambda surface, result: result.mesh(),
    lambda surface, result: eses.read_atoms(DATA / "fas2.pqr"),
    lambda surface, result: eses.read_atoms(DATA / "fas2.pqr").labels,
    lambda surface, result: all_measures(surface),
    lambda surface, result: all_measures(surface).by_atom,
    lambda surface, result: all_measures(surface).gradients,
    lambda surface, result: all_measures(surface).gradients.ses_area,
    lambda surface, result: eses.measure_frames(surface.centers[None], surface.radii, by_atom=True),
], ids=["Surface", "Grid", "Result", "Crossings", "Mesh", "Atoms", "Labels", "Measures", "AtomAreas", "Gradients",
        "Gradient", "FrameMeasures"])
def test_bad_states_are_refused(surface, result, make):
    value = make(surface, result)
    for state in bad_states(value):
        other = type(value).__new__(type(value))
        with pytest.raises((ValueError, TypeError)):
            other.__setstate__(state)
        with pytest.raises((ValueError, TypeError, RuntimeError)):
            other.__getstate__()
    for state in (None, 3, [], {}):
        with pytest.raises(TypeError):
            type(value).__new__(type(value)).__setstate__(state)


def test_contradictory_states_are_refused(surface, result):
    def refuse(value, index, entry):
        with pytest.raises(ValueError):
            type(value).__new__(type(value)).__setstate__(
                changed(value.__getstate__(), index, entry))

    refuse(surface, 0, first_changed(surface.centers, np.nan))
    mesh, crossings = result.mesh(), result.crossings
    refuse(mesh, 4, first_changed(mesh.faces, len(mesh.vertices)))
    refuse(mesh, 4, first_changed(mesh.faces, -1))
    for index, value in ((0, -1), (1, 3), (4, -1), (4, 2**32), (5, 0), (5, 4)):
        refuse(crossings, index, first_changed(crossings.__getstate__()[index], value))
    # Points and crossings that do not fit each other would make meshes with missing vertices.
    state = result.__getstate__()
    own = crossings.__getstate__()
    inside = result.inside.copy()
    inside[tuple(crossings.lower[0])] ^= True
    refuse(result, 8, inside)
    refuse(result, 9, tuple(array[1:] for array in own))
    refuse(result, 9, tuple(array[::-1] for array in own))
    refuse(result, 9, changed(own, 4, first_changed(own[4], len(surface))))
    refuse(result, 9, changed(own, 6, ~own[6]))
    refuse(result, 7, result.atom_areas[:-1])
    refuse(result, 2, ((0, 0, 0), (1, 1, 1)))
    refuse(result, 2, ((0, 0, 0), tuple(np.add(result.grid.shape, 1))))
    assert len(state) == 10


def test_contradictory_measures_are_refused(surface):
    measures = all_measures(surface)
    frames = eses.measure_frames(np.repeat(surface.centers[None], 2, axis=0), surface.radii, by_atom=True,
                                 derivatives=True)
    other = eses.Surface([[0, 0, 0]], [1]).measure(by_atom=True, derivatives=True)

    def refuse(value, index, entry):
        with pytest.raises(ValueError, match="state"):
            type(value).__new__(type(value)).__setstate__(changed(value.__getstate__(), index, entry))

    by_atom, gradients = 13, 14
    for value in (measures, frames):
        assert value.__getstate__()[by_atom] is value.by_atom
        for entry in (other.by_atom, value.gradients, 1):
            refuse(value, by_atom, entry)
        refuse(value, gradients, other.gradients)
    refuse(measures, by_atom, frames.by_atom)
    refuse(frames, by_atom, measures.by_atom)
    refuse(measures, 0, np.ones(2))
    refuse(frames, 0, 1.0)
    refuse(frames, 0, np.ones(3))
    refuse(measures.gradients, 0, None)
    refuse(measures.gradients, 0, other.gradients.ses_area)
    refuse(measures.by_atom, 0, measures.by_atom.sas.astype(np.float32))
