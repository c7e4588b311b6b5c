"""Tests of the cavities and pockets of a surface. Expected values are closed forms."""

import math
import pickle

import numpy as np
import pytest

import eses_blocks as eses


def octahedron(distance):
    """Six atoms of radius 1 at this distance from the origin, and one far away."""
    return np.vstack([[[0, 0, 20]], distance * np.eye(3), -distance * np.eye(3)])


def test_a_place_that_just_holds_a_probe():
    probe = 0.7
    surface = eses.Surface(octahedron(1 + probe), np.ones(7), probe_radius=probe)
    (cavity,) = surface.cavities()
    assert cavity["void_volume"] == pytest.approx(4 / 3 * math.pi * probe**3, rel=1e-6)
    assert cavity["ses_area"] == pytest.approx(4 * math.pi * probe**2, rel=1e-6)
    assert cavity["probe_center_volume"] == pytest.approx(0, abs=1e-12)
    assert cavity["largest_probe"] == pytest.approx(probe, abs=1e-8)
    np.testing.assert_allclose(cavity["centroid"], 0, atol=1e-7)
    np.testing.assert_allclose([cavity["low"], cavity["high"]], [[-probe] * 3, [probe] * 3],
                               atol=1e-7)
    np.testing.assert_array_equal(cavity["atoms"], np.arange(1, 7))
    assert cavity["walls"] == 1
    assert cavity["overlaps"] == [] and not cavity["overlaps_outside"]
    assert surface.cavities(probe_radius=0.72) == []


def test_filled_cavities_are_inside():
    probe = 0.7
    centers, radii = octahedron(1 + probe), np.ones(7)
    plain = eses.Surface(centers, radii, probe_radius=probe)
    assert plain.fill_cavities is False
    sphere = 4 / 3 * math.pi * probe**3
    for choice, is_filled in ((True, True), (sphere * 1.001, True), (sphere * 0.999, False),
                              (False, False), (np.bool_(True), True), (np.bool_(False), False),
                              (np.float64(sphere * 0.999), False)):
        surface = eses.Surface(centers, radii, probe_radius=probe, fill_cavities=choice)
        assert surface.fill_cavities == choice
        change = surface.measure().ses_volume - plain.measure().ses_volume
        assert change == pytest.approx(sphere if is_filled else 0, rel=1e-6, abs=1e-9)
        assert len(surface.cavities()) == (0 if is_filled else 1)
        grid = surface.grid(0.5, origin=(0.2, 0.1, 0), shape=(2, 2, 2))
        assert bool(surface.compute(grid).inside[0, 0, 0]) == is_filled
    with pytest.raises(ValueError, match="void"):
        eses.Surface(centers, radii, fill_cavities=-1.0)
    for wrong in ("yes", None, [1.0]):
        with pytest.raises(TypeError, match="^fill_cavities must be a boolean or a volume"):
            eses.Surface(centers, radii, fill_cavities=wrong)


def test_cavities_of_frames_are_filled():
    """Six atoms just hold a probe in the first frame, and leave more space in the second one."""
    probe = 0.7
    frames = np.stack([octahedron(1 + probe), octahedron(1.1 + probe)])
    voids = [eses.Surface(frame, np.ones(7), probe_radius=probe).cavities()[0]["void_volume"]
             for frame in frames]
    assert voids[0] == pytest.approx(4 / 3 * math.pi * probe**3, rel=1e-6) and voids[1] > 1.1 * voids[0]

    def volumes(**how):
        return eses.measure_frames(frames, np.ones(7), probe, **how).ses_volume

    np.testing.assert_allclose(volumes(fill_cavities=True) - volumes(), voids, rtol=1e-9)
    np.testing.assert_allclose(volumes(fill_cavities=voids[0] * 1.01) - volumes(), [voids[0], 0],
                               rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(volumes(fill_cavities=False), volumes())
    with pytest.raises(ValueError, match="^the maximum void"):
        volumes(fill_cavities=-1.0)


def test_a_ring_has_a_pocket_with_two_mouths():
    turns = np.linspace(0, 2 * math.pi, 60, endpoint=False)
    centers = 5.2 * np.column_stack([np.cos(turns), np.sin(turns), 0 * turns])
    surface = eses.Surface(centers, np.full(60, 3.0))
    (pocket,) = surface.pockets(3.5, spacing=0.1, min_volume=0)
    assert pocket["mouths"] == 2
    np.testing.assert_allclose(pocket["centroid"], 0, atol=0.05)
    np.testing.assert_array_equal(np.diff(pocket["atoms"]) > 0, True)
    filled = eses.Surface(centers, np.full(60, 3.0), fill_cavities=True)
    difference = filled.measure(3.5).ses_volume - filled.measure(1.4).ses_volume
    assert 0 < pocket["probe_center_volume"] < pocket["volume"] < difference
    # The two spherical caps with which probes touch the ring have this area together.
    height = math.sqrt(6.5**2 - 5.2**2)
    cap = 3 / 6.5 * height - (height - 3.5)
    assert 0 < pocket["mouth_area"] < 4 * math.pi * 3.5 * cap
    assert surface.pockets(2) == []
    assert surface.pockets(3.5, min_volume=difference) == []
    assert surface.pockets(3.5, probe_radius=2.3) == []


def test_arguments_are_checked():
    surface = eses.Surface(octahedron(2), np.ones(7))
    with pytest.raises(ValueError, match="probe radius"):
        surface.cavities(-1)
    with pytest.raises(ValueError, match="threads"):
        surface.cavities(threads=-1)
    with pytest.raises(ValueError, match="large probe"):
        surface.pockets(1.4)
    with pytest.raises(ValueError, match="spacing"):
        surface.pockets(spacing=2)
    with pytest.raises(ValueError, match="minimum volume"):
        surface.pockets(min_volume=-1)


def test_mesh_has_the_components_of_its_vertices():
    probe = 0.7
    # The second cavity is larger.
    centers = np.vstack([octahedron(1 + probe)[1:], octahedron(1.02 + probe)[1:] + [9, 0.1, 0.2]])
    surface = eses.Surface(centers, np.ones(12), probe_radius=probe)
    cavities = surface.cavities()
    assert [round(cavity["centroid"][0]) for cavity in cavities] == [9, 0]
    result = surface.compute(surface.grid(0.25, 1))
    assert result.mesh().component is None
    for quality in (False, True):
        mesh = result.mesh(quality=quality, component=True)
        assert mesh.component.dtype == np.uint32 and len(mesh.component) == len(mesh.vertices)
        assert not mesh.component.flags.writeable
        for k, cavity in enumerate(cavities):
            # Probes outside are farther from the centre than 1.2.
            near = np.linalg.norm(mesh.vertices - cavity["centroid"], axis=1) < 1.2
            assert near.any() and np.array_equal(near, mesh.component == k + 1)
        again = pickle.loads(pickle.dumps(mesh))
        assert np.array_equal(again.component, mesh.component)
    assert pickle.loads(pickle.dumps(result.mesh())).component is None
    with pytest.raises(ValueError, match="component=True"):
        result.mesh().show("component")
    assert '"color": "component"' in str(mesh.show("component"))


def test_cavities_at_a_place(ubiquitin_surface):
    every = ubiquitin_surface.cavities()
    assert [each["index"] for each in every] == [0, 1, 2]
    for cavity in every:
        center = cavity["largest_probe_center"]
        found = ubiquitin_surface.cavities(balls=([center], [1e-6]))
        assert [each["index"] for each in found] == [cavity["index"]]
        assert cavity["index"] in [each["index"] for each in ubiquitin_surface.cavities(at=center)]
        by_atoms = ubiquitin_surface.cavities(atoms=cavity["atoms"][:1].tolist())
        assert cavity["index"] in [each["index"] for each in by_atoms]
    assert ubiquitin_surface.cavities(at=[[0, 0, 0], [1, 1, 1]]) == []
    assert len(ubiquitin_surface.cavities(at=[[0, 0, 0], [99, 99, 99]])) == 3


def test_pockets_at_a_place(ubiquitin_surface):
    every = ubiquitin_surface.pockets()
    everywhere = ubiquitin_surface.pockets(at=[[-99, -99, -99], [99, 99, 99]])
    assert [each["volume"] for each in everywhere] == [each["volume"] for each in every]
    for pocket in everywhere:
        assert pocket["volume_at_place"] == pocket["volume"]
        assert (pocket["low"] <= pocket["centroid"]).all() and (pocket["centroid"] <= pocket["high"]).all()
        assert 0 < pocket["depth"] < np.linalg.norm(pocket["high"] - pocket["low"])
        by_atoms = ubiquitin_surface.pockets(atoms=pocket["atoms"].tolist())
        assert pocket["volume"] in [each["volume"] for each in by_atoms]
    half = (everywhere[0]["low"] + everywhere[0]["high"]) / 2
    sides = [ubiquitin_surface.pockets(at=[low, high])[0]["volume_at_place"]
             for low, high in ((everywhere[0]["low"] - 0.1, [half[0], 99, 99]),
                               ([half[0] + 1e-9, *(everywhere[0]["low"][1:] - 0.1)], everywhere[0]["high"] + 0.1))]
    assert sum(sides) == pytest.approx(everywhere[0]["volume"])


@pytest.mark.parametrize("place", [{"at": [1, 2]}, {"at": [[1, 2, 3]] * 3}, {"at": [0, 0, np.nan]},
                                   {"atoms": [602]}, {"atoms": [-1]}, {"balls": ([[0, 0, 0]], [-1])}])
def test_impossible_places_are_refused(ubiquitin_surface, place):
    with pytest.raises(ValueError):
        ubiquitin_surface.pockets(**place)
    with pytest.raises(ValueError):
        ubiquitin_surface.cavities(**place)
