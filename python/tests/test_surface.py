"""Tests of surfaces made from arrays."""

import copy
import pickle
import warnings

import numpy as np
import pytest

import eses_blocks as eses


def area_of(surface):
    return surface.compute(surface.grid(0.5)).area


def test_surface_has_its_atoms(chain):
    centers, radii = chain
    surface = eses.Surface(centers, radii, 1.2)
    assert len(surface) == 12
    assert surface.probe_radius == 1.2
    assert np.array_equal(surface.centers, centers)
    assert np.array_equal(surface.radii, radii)
    assert eses.Surface(centers, radii).probe_radius == 1.4
    assert repr(surface) == "<eses_blocks.Surface: 12 atoms, probe radius 1.2>"
    with pytest.raises(ValueError, match="read-only"):
        surface.radii[0] = 2


def test_surface_does_not_follow_changes_of_the_arrays(chain):
    centers, radii = chain[0].copy(), chain[1].copy()
    surface = eses.Surface(centers, radii)
    area = area_of(surface)
    centers[:] = 0
    radii[:] = 1
    assert area_of(surface) == area


@pytest.mark.parametrize("change", [
    lambda a: a.tolist(),
    np.asfortranarray,
    lambda a: np.repeat(a, 2, axis=0)[::2],
    lambda a: a[::-1].copy()[::-1],
    lambda a: a.astype(">f8"),
    lambda a: a.astype(np.longdouble),
    lambda a: np.frombuffer(a.tobytes()).reshape(a.shape),
])
def test_any_memory_layout_is_accepted(chain, change):
    centers, radii = chain
    surface = eses.Surface(change(centers), change(radii))
    assert np.array_equal(surface.centers, centers)
    assert np.array_equal(surface.radii, radii)


def test_columns_of_one_array_are_accepted(chain):
    table = np.column_stack(chain)
    surface = eses.Surface(table[:, :3], table[:, 3])
    assert np.array_equal(surface.centers, chain[0])


@pytest.mark.parametrize("dtype", [np.float32, np.float16, np.int64, np.int8, np.uint16])
def test_other_types_are_converted(dtype):
    centers = np.array([[0, 0, 0], [4, 1, 2]], dtype)
    surface = eses.Surface(centers, np.array([1, 2], dtype))
    assert surface.centers.dtype == np.float64
    assert surface.centers.tolist() == [[0, 0, 0], [4, 1, 2]]


def test_float32_keeps_its_values(chain):
    centers = chain[0].astype(np.float32)
    surface = eses.Surface(centers, chain[1])
    assert np.array_equal(surface.centers, centers.astype(np.float64))


@pytest.mark.parametrize("type", ["Float64", "Float32", "Int64"])
def test_columns_of_pandas_are_taken(chain, type):
    pandas = pytest.importorskip("pandas")
    centers, radii = np.round(chain[0]), np.round(chain[1])
    expected = eses.Surface(centers, radii).measure().ses_area
    frame = pandas.DataFrame(centers, columns=list("xyz")).astype(type)
    column = pandas.Series(radii).astype(type)
    assert eses.Surface(frame[["x", "y", "z"]], column).measure().ses_area == expected
    assert eses.measure((frame, column)).ses_area == expected
    column[3] = pandas.NA
    with pytest.raises(ValueError):
        eses.Surface(frame, column)
    with pytest.raises(TypeError, match="^radii must be an array of real numbers"):
        eses.Surface(frame, column.astype(str))


@pytest.mark.parametrize("values", [
    np.zeros((2, 3), complex), np.zeros((2, 3), bool), np.full((2, 3), "1"),
    np.full((2, 3), None), None, "atoms", {"x": 1},
])
def test_other_kinds_are_refused(values):
    message = "radii: a file needs the name" if isinstance(values, str) else "centers must be an array of real numbers"
    with pytest.raises(TypeError, match=message):
        eses.Surface(values, np.ones(2))
    message = "radii must be an array of real numbers" if not (values is None or isinstance(values, str)) else "an array of centres needs radii"
    with pytest.raises(TypeError, match=message):
        eses.Surface(np.zeros((2, 3)), values)


@pytest.mark.parametrize("shape", [(3,), (2, 2), (2, 4), (2, 3, 1), (), (3, 2)])
def test_wrong_shape_of_centers_is_refused(shape):
    with pytest.raises(ValueError, match=r"centers must have shape \(N, 3\), not \("):
        eses.Surface(np.zeros(shape), np.ones(2))


@pytest.mark.parametrize("shape", [(1,), (3,), (2, 1), ()])
def test_wrong_shape_of_radii_is_refused(shape):
    with pytest.raises(ValueError, match=r"radii must have shape \(2,\), .* not \("):
        eses.Surface(np.zeros((2, 3)), np.ones(shape))


def test_masked_entries_are_refused(chain):
    centers, radii = chain
    masked = np.ma.masked_array(radii, mask=radii > 1.5)
    with pytest.raises(ValueError, match="radii has masked entries"):
        eses.Surface(centers, masked)
    with pytest.raises(ValueError, match="centers has masked entries"):
        eses.Surface(np.ma.masked_greater(centers, 3), radii)
    # A masked array without masked entries is like any other array.
    surface = eses.Surface(np.ma.masked_array(centers), np.ma.masked_array(radii, mask=False))
    assert np.array_equal(surface.centers, centers)


def test_surface_without_atoms_is_refused():
    for centers in (np.zeros((0, 3)), np.zeros((0, 3), np.float32)):
        with pytest.raises(ValueError, match="at least one atom"):
            eses.Surface(centers, [])
    with pytest.raises(ValueError, match="shape"):
        eses.Surface([], [])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_values_that_are_not_finite_are_refused(value):
    centers, radii = np.zeros((5, 3)), np.ones(5)
    centers[3, 1] = value
    with pytest.raises(ValueError, match=rf"atom 3 .* y coordinate {value}"):
        eses.Surface(centers, radii)
    radii[2] = value
    with pytest.raises(ValueError, match=rf"atom 2 .* radius {value}"):
        eses.Surface(np.zeros((5, 3)), radii)


def test_negative_radius_is_refused():
    with pytest.raises(ValueError, match=r"atom 1 .* radius -0.5"):
        eses.Surface(np.zeros((2, 3)), [1, -0.5])


def test_other_arguments_are_checked(chain):
    for probe_radius in (0.001, -1, np.nan, 1e4):
        with pytest.raises(ValueError, match="probe radius"):
            eses.Surface(*chain, probe_radius)
    with pytest.raises(ValueError, match="threads"):
        eses.Surface(*chain, threads=-1)
    with pytest.raises(TypeError):
        eses.Surface(*chain, 1.4, 2)
    with pytest.raises(TypeError):
        eses.Surface(*chain, probe_radius="1.4")
    with pytest.raises(TypeError):
        eses.Surface(chain[0])


def test_sas_and_van_der_waals_surfaces():
    centers, radii = [[0, 0, 0], [0, 0, 2.0]], np.array([1.7, 1.2])

    def area(a, b):  # of two spheres at a distance of 2
        x = (4 + a * a - b * b) / 4
        return 2 * np.pi * (a * (a + x) + b * (b + 2 - x))

    for kind, growth in (("sas", 1.4), ("vdw", 0)):
        surface = eses.Surface(centers, radii, surface=kind)
        assert surface.radii.tolist() == radii.tolist()
        result = surface.compute(surface.grid(spacing=0.1))
        assert result.area == pytest.approx(area(*(radii + growth)), rel=0.01)
        mesh = result.mesh()
        distances = np.linalg.norm(mesh.vertices[:, None] - np.array(centers), axis=2) - (radii + growth)
        assert np.abs(distances.min(axis=1)).max() < 0.02 and (mesh.kind == 1).all()
        other = pickle.loads(pickle.dumps(result))
        assert (other.mesh().vertices == mesh.vertices).all()
    assert eses.Surface(centers, radii, 0).measure().ses_area == pytest.approx(area(*radii))
    with pytest.raises(ValueError, match="surface must be 'ses', 'sas' or 'vdw', not 'gauss'"):
        eses.Surface(centers, radii, surface="gauss")
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # radii above 4 angstrom are no mistake
        eses.Surface(centers, radii + 1.5, surface="sas")


def test_surfaces_say_which_they_are():
    atom = [[0, 0, 0]], [1.5]
    for arguments, kind, probe, text in (({}, "ses", 1.4, "probe radius 1.4"),
                                         ({"surface": "sas", "probe_radius": 1.2}, "sas", 1.2, "sas, probe radius 1.2"),
                                         ({"surface": "vdw"}, "vdw", 0, "vdw")):
        surface = eses.Surface(*atom, **arguments)
        for each in (surface, pickle.loads(pickle.dumps(surface)), copy.deepcopy(surface)):
            assert (each.surface, each.probe_radius, each.radii.tolist()) == (kind, probe, [1.5])
            assert repr(each) == f"<eses_blocks.Surface: 1 atoms, {text}>"


def test_arguments_that_do_not_fit_the_surface_are_refused():
    def refuse(message, surface, probe_radius=None, radii=(1, 1.2), **others):
        with pytest.raises(ValueError, match=message):
            eses.Surface([[0, 0, 0], [0, 0, 2]], radii, probe_radius, surface=surface, **others)

    refuse("radius.*-1", "sas", radii=(-1, 1.2))
    for probe in (0, 0.001, 1001, np.nan, -1):
        refuse("surface='sas' needs a probe_radius from 0.01 to 1000, not", "sas", probe)
    for probe in (0, 1.4):
        refuse("surface='vdw' has no probe; leave out probe_radius", "vdw", probe)
    for kind in ("sas", "vdw"):
        refuse("fill_cavities needs the solvent excluded surface", kind, fill_cavities=True)
        surface = eses.Surface([[0, 0, 0]], [1.5], surface=kind)
        for method in ("measure", "cavities", "pockets"):
            with pytest.raises(ValueError, match=f"Surface.{method} needs the solvent excluded surface, not"):
                getattr(surface, method)()


def test_diagnostics_of_a_sas_are_those_of_the_given_radii():
    centers = [[0, 0, 0], [0, 0, 9], [0, 0, 18]]
    for radii, kinds in (([0.1, 0.2, 0.1], ["small_radii"]), ([1, 5, 1], ["large_radius"]),
                         ([1, 0, 1], ["zero_radius"]), ([3, 3, 3], [])):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = eses.Surface(centers, radii, surface="sas").diagnostics
        assert [each.kind for each in found] == kinds
        assert len(caught) == sum(not each.is_usual for each in found)
        assert kinds == [each.kind for each in eses.Surface(centers, radii, surface="vdw").diagnostics]


def test_diagnostics_are_reported():
    surface = eses.Surface([[0, 0, 0], [0, 0, 0], [9, 0, 0]], [1.5, 1.5, 5])
    kinds = {diagnostic.kind: diagnostic for diagnostic in surface.diagnostics}
    assert set(kinds) == {"duplicate", "large_radius"}
    assert kinds["duplicate"].count == 1
    assert kinds["duplicate"].examples == [(1, 0)]
    assert kinds["large_radius"].examples == [(2, 2)]
    assert not kinds["duplicate"].is_usual
    assert repr(kinds["duplicate"]) == "<eses_blocks.Diagnostic: duplicate (count 1)>"
    again = {each.kind: each for each in eses.Surface([[0, 0, 0], [0, 0, 0], [9, 0, 0]], [1.5, 1.5, 5]).diagnostics}
    assert again == kinds
    assert len({*again.values(), *kinds.values()}) == 2
    assert kinds["duplicate"] != kinds["large_radius"]
    others = eses.Surface([[5, 0, 0], [9, 0, 0], [0, 0, 0], [0, 0, 0]], [1.5, 5, 1.5, 1.5]).diagnostics
    assert others != list(kinds.values())  # other atoms
    assert kinds["duplicate"] != "duplicate"
    zero = eses.Surface([[0, 0, 0], [9, 0, 0]], [1.5, 0]).diagnostics
    assert [(each.kind, each.is_usual) for each in zero] == [("zero_radius", True)]


def test_arrays_outlive_the_surface(chain):
    centers = (lambda surface: surface.centers)(eses.Surface(*chain))
    assert np.array_equal(centers, chain[0])


def test_progress_is_served_while_cavities_are_searched(lattice):
    """Ctrl-C and callbacks are served before the number of blocks is known."""
    class Stop(Exception):
        pass

    calls = []

    def progress(done, total):
        calls.append((done, total))
        raise Stop

    surface = eses.Surface(*lattice(10), fill_cavities=True)
    with pytest.raises(Stop):
        surface.compute(surface.grid(0.3), progress=progress, block_size=8)
    assert calls == [(0, 1)]


def test_centres_in_nanometres_are_warned_about(ubiquitin):
    with pytest.warns(UserWarning, match="coordinates look like nanometres"):
        eses.Surface(ubiquitin.centers / 10, ubiquitin.radii)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        eses.Surface(ubiquitin.centers, ubiquitin.radii)
