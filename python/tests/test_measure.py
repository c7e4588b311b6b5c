"""Tests of areas and volumes without a grid. Expected values are closed forms."""

import functools
import math

import numpy as np
import pytest

import eses_blocks as eses

PI = math.pi
NUMBERS = ("ses_area", "ses_volume", "convex_area", "saddle_area", "concave_area", "sas_area", "sas_volume",
           "total_curvature")
QUANTITIES = ("ses_area", "ses_volume", "sas_area", "sas_volume")
AREAS = ("sas", "ses", "convex", "saddle", "concave")


def pair(distance, radius=1.7):
    return eses.Surface([[0, 0, 0], [0.6 * distance, 0, 0.8 * distance]], [radius, radius])


def spheres(radii, gap=20.0):
    """Atoms that are far from each other."""
    centers = np.zeros((len(radii), 3))
    centers[:, 1] = gap * np.arange(len(radii))
    return eses.Surface(centers, radii)


def assert_close(value, expected, relative=1e-10):
    assert value == pytest.approx(expected, rel=relative)


def test_sphere():
    measures = eses.Surface([[1, 2, 3]], [1.5]).measure(van_der_waals=True)
    assert_close(measures.ses_area, 4 * PI * 1.5**2)
    assert_close(measures.ses_volume, 4 / 3 * PI * 1.5**3)
    assert_close(measures.sas_area, 4 * PI * 2.9**2)
    assert_close(measures.sas_volume, 4 / 3 * PI * 2.9**3)
    assert_close(measures.vdw_area, measures.ses_area)
    assert_close(measures.vdw_volume, measures.ses_volume)
    assert (measures.saddle_area, measures.concave_area) == (0, 0)
    assert_close(measures.convex_area, measures.ses_area)
    assert measures.euler_number == 2
    assert_close(measures.total_curvature, 2)
    for name in NUMBERS + ("vdw_area",):
        assert type(getattr(measures, name)) is float, name
    assert type(measures.euler_number) is int


@pytest.mark.parametrize("distance, area, volume",
                         [(3, 66.0779806211, 42.3467039769), (6, 72.7000761036, 41.1849134259)])
def test_two_spheres(distance, area, volume):
    measures = pair(distance).measure()
    assert_close(measures.ses_area, area)
    assert_close(measures.ses_volume, volume)
    # Two caps of height R - distance / 2 are missing from each SAS sphere.
    R = 3.1
    assert_close(measures.sas_area, 2 * 2 * PI * R * (R + distance / 2))
    assert (measures.vdw_area, measures.vdw_volume) == (None, None)
    assert measures.by_atom is None and measures.gradients is None


def test_probe_radius():
    surface = pair(6)
    assert_close(surface.measure(0).ses_area, 2 * 4 * PI * 1.7**2)
    assert_close(surface.measure(1.2).sas_area, 2 * 4 * PI * 2.9**2)
    assert surface.measure(1.4).ses_area == surface.measure().ses_area


def test_areas_by_atom():
    radii = np.array([1.0, 1.5, 2.0])
    areas = spheres(radii).measure(by_atom=True).by_atom
    assert_close(areas.sas, 4 * PI * (radii + 1.4)**2)
    assert_close(areas.convex, 4 * PI * radii**2)
    assert np.array_equal(areas.ses, areas.convex)
    assert not areas.saddle.any() and not areas.concave.any()


def test_areas_by_atom_add_up(chain):
    measures = eses.Surface(*chain).measure(by_atom=True)
    areas = measures.by_atom
    for part, whole in (("sas", measures.sas_area), ("ses", measures.ses_area), ("convex", measures.convex_area),
                        ("saddle", measures.saddle_area), ("concave", measures.concave_area)):
        array = getattr(areas, part)
        assert array.shape == (12,) and array.dtype == np.float64 and not array.flags.writeable
        assert_close(array.sum(), whole)
    # The power diagram divides equal atoms by symmetry.
    saddle = pair(3).measure(by_atom=True).by_atom.saddle
    assert saddle[0] > 1
    assert_close(saddle[0], saddle[1])


def test_derivatives_of_spheres():
    radii = np.array([1.0, 1.5])
    gradients = spheres(radii).measure(derivatives=True).gradients
    assert gradients.are_smooth is True
    for quantity, by_radius, by_probe in (
            ("ses_area", 8 * PI * radii, 0), ("ses_volume", 4 * PI * radii**2, 0),
            ("sas_area", 8 * PI * (radii + 1.4), 8 * PI * (radii + 1.4)),
            ("sas_volume", 4 * PI * (radii + 1.4)**2, 4 * PI * (radii + 1.4)**2)):
        gradient = getattr(gradients, quantity)
        assert_close(gradient.radii, by_radius)
        assert gradient.probe == pytest.approx(np.sum(by_probe), abs=1e-10)
        assert np.abs(gradient.centers).max() < 1e-10


def test_derivative_by_the_distance():
    # The SAS of two spheres: area 4 pi R (R + d / 2), volume 4/3 pi R^3 + pi R^2 d - pi d^3 / 12.
    R, distance = 3.1, 3.0
    gradients = pair(distance).measure(derivatives=True).gradients
    along = np.array([0.6, 0, 0.8])
    for quantity, slope in (("sas_area", 2 * PI * R), ("sas_volume", PI * (R**2 - distance**2 / 4))):
        centers = getattr(gradients, quantity).centers
        assert centers.shape == (2, 3)
        assert np.allclose(centers, [-slope * along, slope * along], rtol=0, atol=1e-9)


def test_derivatives_are_homogeneous(chain):
    """Euler's theorem: areas are homogeneous functions of all lengths, of degree 2, volumes of degree 3."""
    centers, radii = chain
    measures = eses.Surface(centers, radii).measure(derivatives=True)
    for quantity, degree in zip(QUANTITIES, (2, 3, 2, 3)):
        gradient = getattr(measures.gradients, quantity)
        sum_of_products = ((gradient.centers * centers).sum() + gradient.radii @ radii + 1.4 * gradient.probe)
        assert_close(sum_of_products, degree * getattr(measures, quantity), 1e-9)


def test_weighted_areas():
    radii, weights = np.array([1.0, 1.5]), np.array([0.5, -2.0])
    measures = spheres(radii).measure(weights=weights, derivatives=True)
    assert_close(measures.weighted_ses_area, weights @ (4 * PI * radii**2))
    assert_close(measures.weighted_sas_area, weights @ (4 * PI * (radii + 1.4)**2))
    assert_close(measures.gradients.weighted_ses_area.radii, weights * 8 * PI * radii)
    gradient = measures.gradients.weighted_sas_area
    assert_close(gradient.radii, weights * 8 * PI * (radii + 1.4))
    assert_close(gradient.probe, weights @ (8 * PI * (radii + 1.4)))
    frames = np.repeat(spheres(radii).centers[None], 3, axis=0)
    assert_close(eses.measure_frames(frames, radii, weights=weights).weighted_sas_area,
                 measures.weighted_sas_area)
    without = spheres(radii).measure(derivatives=True)
    assert without.weighted_ses_area is None and without.gradients.weighted_sas_area is None
    with pytest.raises(ValueError, match=r"weights must have shape \(2,\)"):
        spheres(radii).measure(weights=[1])
    with pytest.raises(ValueError, match="weight of atom 1"):
        spheres(radii).measure(weights=[1, math.nan])


def test_result_does_not_depend_on_threads(chain):
    surface = eses.Surface(*chain)
    one, two = (surface.measure(by_atom=True, threads=threads) for threads in (1, 2))
    for name in NUMBERS:
        assert getattr(one, name) == getattr(two, name), name
    assert np.array_equal(one.by_atom.ses, two.by_atom.ses)


def test_arguments_of_measure_are_checked(chain):
    surface = eses.Surface(*chain)
    for probe_radius in (-1, 0.001, 1e4, math.nan):
        with pytest.raises(ValueError, match="probe radius"):
            surface.measure(probe_radius)
    with pytest.raises(ValueError, match="threads"):
        surface.measure(threads=-1)
    with pytest.raises(TypeError):
        surface.measure(1.4, True)
    with pytest.raises(TypeError):
        surface.measure(probe_radius="1.4")


def test_all_results_have_a_representation(chain):
    surface = eses.Surface(*chain)
    gradients = surface.measure(derivatives=True).gradients
    assert repr(gradients) == "<eses_blocks.Gradients: ses_area, ses_volume, sas_area, sas_volume>"
    blocks = surface.blocks(surface.grid(spacing=1))
    assert repr(blocks) == "<eses_blocks.BlockIterator: not at its end>"
    list(blocks)
    assert repr(blocks) == "<eses_blocks.BlockIterator: all blocks taken>"
    for name in eses.__all__:
        if isinstance(found := getattr(eses, name), type):
            assert found.__repr__ is not object.__repr__, name


def test_representation():
    assert repr(eses.Surface([[0, 0, 0]], [1]).measure()) == "<eses_blocks.Measures: SES area 12.5664, SES volume 4.18879>"
    assert repr(eses.measure_frames(np.zeros((3, 1, 3)), [1])) == "<eses_blocks.FrameMeasures: 3 frames>"
    assert repr(eses.measure_frames(np.zeros((1, 1, 3)), [1])) == "<eses_blocks.FrameMeasures: 1 frame>"


def moving_pairs(distances):
    frames = np.zeros((len(distances), 2, 3))
    frames[:, 1, 2] = distances
    return frames


def test_frames_have_closed_values():
    distances = np.linspace(1, 6, 11)
    measures = eses.measure_frames(moving_pairs(distances), [1.7, 1.7], van_der_waals=True, by_atom=True,
                                   derivatives=True)
    R = 3.1
    assert len(measures) == 11
    assert_close(measures.sas_area, 4 * PI * R * (R + distances / 2))
    assert_close(measures.sas_volume, 4 / 3 * PI * R**3 + PI * R**2 * distances - PI * distances**3 / 12)
    apart = distances > 2 * 1.7
    assert_close(measures.vdw_area[apart], 2 * 4 * PI * 1.7**2)
    assert np.array_equal(measures.euler_number, np.full(11, 2))
    assert_close(measures.by_atom.sas[:, 0], measures.sas_area / 2)
    assert_close(measures.gradients.sas_area.centers[:, 1, 2], 2 * PI * R)
    assert measures.gradients.are_smooth.dtype == bool
    for array, shape in ((measures.ses_area, (11,)), (measures.euler_number, (11,)), (measures.vdw_volume, (11,)),
                         (measures.by_atom.ses, (11, 2)), (measures.gradients.ses_volume.centers, (11, 2, 3)),
                         (measures.gradients.ses_volume.radii, (11, 2)),
                         (measures.gradients.ses_volume.probe, (11,)), (measures.gradients.are_smooth, (11,))):
        assert array.shape == shape and not array.flags.writeable


@pytest.mark.parametrize("threads", [1, 2, 0])
@pytest.mark.parametrize("count", [1, 2, 7])
def test_frames_equal_surfaces(chain, threads, count):
    centers, radii = chain
    frames = centers + np.random.default_rng(3).normal(0, 0.2, (count, 12, 3))
    measures = eses.measure_frames(frames, radii, 1.1, by_atom=True, derivatives=True, threads=threads)
    for frame in range(count):
        own = eses.Surface(frames[frame], radii, 1.1).measure(by_atom=True, derivatives=True, threads=1)
        for name in NUMBERS:
            assert getattr(measures, name)[frame] == getattr(own, name), name
        for name in AREAS:
            assert np.array_equal(getattr(measures.by_atom, name)[frame], getattr(own.by_atom, name)), name
        for name in QUANTITIES:
            mine, other = getattr(measures.gradients, name), getattr(own.gradients, name)
            assert np.array_equal(mine.centers[frame], other.centers), name
            assert np.array_equal(mine.radii[frame], other.radii), name
            assert mine.probe[frame] == other.probe, name
        assert measures.gradients.are_smooth[frame] == own.gradients.are_smooth


@pytest.mark.parametrize("change", [
    lambda frames: frames.tolist(),
    np.asfortranarray,
    lambda frames: frames[::-1].copy()[::-1],
    lambda frames: np.repeat(frames, 2, axis=1)[:, ::2],
    lambda frames: frames.astype(np.float32),
    lambda frames: np.asfortranarray(frames.astype(np.float32)),
    lambda frames: frames.astype(">f8"),
    lambda frames: frames.astype(np.int16),
    lambda frames: np.ma.masked_array(frames),
])
def test_any_memory_layout_of_frames_is_accepted(change):
    frames = moving_pairs(np.arange(1.0, 7.0))
    expected = 4 * PI * 3.1 * (3.1 + np.arange(1, 7) / 2)
    assert_close(eses.measure_frames(change(frames), [1.7, 1.7]).sas_area, expected)


def test_frames_can_be_mapped_from_a_file(tmp_path):
    np.save(tmp_path / "frames.npy", moving_pairs(np.arange(1, 7)).astype(np.float32))
    frames = np.load(tmp_path / "frames.npy", mmap_mode="r")
    assert_close(eses.measure_frames(frames, [1.7, 1.7]).sas_area, 4 * PI * 3.1 * (3.1 + np.arange(1, 7) / 2))


@pytest.mark.parametrize("distances", [[3, 6], [3], []])
def test_frames_may_share_a_buffer(distances):
    """Readers of trajectories yield the same buffer for each frame."""
    def read():
        buffer = np.zeros((2, 3))
        for distance in distances:
            buffer[1] = 0, 0, distance
            yield buffer

    if not distances:
        with pytest.raises(ValueError, match="shape"):
            eses.measure_frames(read(), [1.7, 1.7])
        return
    areas = {3: 66.0779806211, 6: 72.7000761036}
    np.testing.assert_allclose(eses.measure_frames(read(), [1.7, 1.7]).ses_area,
                               [areas[distance] for distance in distances], rtol=1e-10)


def test_a_reader_that_begins_anew_after_its_end_is_read_once():
    centers, radii = [[0, 0, 0], [3, 0, 0]], [1.7, 1.7]

    class Reader:
        """Behaves as the readers of MDAnalysis: one buffer, and StopIteration only between two rounds."""

        def __init__(self):
            self.buffer, self.frame = np.array(centers, float), -1

        def __iter__(self):
            return self

        def __next__(self):
            self.frame += 1
            if self.frame == 3:
                self.frame = -1
                raise StopIteration
            self.buffer[1, 0] = self.buffer[0, 0] + 3 + self.frame
            return self.buffer

    areas = eses.measure_frames(Reader(), radii).sas_area
    assert len(areas) == 3 and len(set(areas.tolist())) == 3

    class Broken(Reader):
        def __next__(self):
            raise RuntimeError("broken")

    with pytest.raises(RuntimeError, match="broken"):
        eses.measure_frames(Broken(), radii)


def test_no_frames():
    measures = eses.measure_frames(np.zeros((0, 2, 3)), [1, 1], by_atom=True)
    assert len(measures) == 0 and measures.ses_area.shape == (0,) and measures.by_atom.sas.shape == (0, 2)


@pytest.mark.parametrize("threads", [1, 2])
def test_first_bad_frame_is_named(chain, threads):
    frames = np.repeat(chain[0][None], 40, axis=0)
    frames[31, 4, 2] = np.nan
    frames[17, 5, 1] = np.inf
    with pytest.raises(ValueError, match=r"^frame 17 \(counted from 0\): atom 5 .* y coordinate inf"):
        eses.measure_frames(frames, chain[1], threads=threads)


def test_frames_of_different_shapes_are_named():
    """In lists and generators, and a frame that is no array itself."""
    four, five = np.zeros((4, 3)), np.zeros((5, 3))
    for frames in ([four, four.copy(), five], (frame for frame in (four, four, five))):
        with pytest.raises(ValueError, match=r"^all frames must have the same atoms: frame 2 has shape \(5, 3\), frame 0 "
                                             r"has \(4, 3\)$"):
            eses.measure_frames(frames, np.ones(4))
    for ragged in ([four, [[0, 0, 0], [1, 2]]], iter([four, [[0, 0, 0], [1, 2]]])):
        with pytest.raises(ValueError, match="^frame 1 is no array of numbers: "):
            eses.measure_frames(ragged, np.ones(4))
    with pytest.raises(ValueError, match="^centers is no array of numbers: "):
        eses.Surface([[0, 0, 0], [1, 2]], [1, 1])


@pytest.mark.parametrize("threads", [5000, 2**31, 2**63, 10**30, np.int64(2**40), np.uint64(2**63), -1, -2**31 - 1, -10**30])
def test_numbers_of_threads_out_of_range_are_value_errors(threads, chain):
    surface = eses.Surface(*chain)
    for call in (surface.measure, surface.cavities, surface.pockets, functools.partial(surface.compute, surface.grid(1)),
                 functools.partial(eses.Surface, *chain), functools.partial(eses.measure_frames, chain[0][None], chain[1])):
        with pytest.raises(ValueError, match="the number of threads must"):
            call(threads=threads)
        for wrong in (1.5, "2", None):
            with pytest.raises(TypeError):
                call(threads=wrong)


def test_arguments_of_measure_frames_are_checked(chain):
    centers, radii = chain
    with pytest.raises(ValueError, match=r"frames must have shape \(F, N, 3\), not \(12, 3\)"):
        eses.measure_frames(centers, radii)
    with pytest.raises(ValueError, match=r"radii must have shape \(12,\), .* not \(11,\)"):
        eses.measure_frames(centers[None], radii[:-1])
    with pytest.raises(ValueError, match="at least one atom"):
        eses.measure_frames(np.zeros((1, 0, 3)), [])
    with pytest.raises(ValueError, match="radius -1"):
        eses.measure_frames(centers[None], -np.ones(12))
    with pytest.raises(ValueError, match="frames has masked entries"):
        eses.measure_frames(np.ma.masked_greater(centers[None], 1), radii)
    for values in ("frames", None, np.zeros((1, 12, 3), complex), np.zeros((1, 12, 3), bool)):
        with pytest.raises(TypeError, match="frames must be an array of real numbers"):
            eses.measure_frames(values, radii)
    with pytest.raises(TypeError, match="radii must be an array of real numbers"):
        eses.measure_frames(centers[None], "radii")
    for count in (0, 1):
        with pytest.raises(ValueError, match="^the probe radius must be"):
            eses.measure_frames(np.zeros((count, 12, 3)), radii, -1)
        with pytest.raises(ValueError, match="^the number of threads"):
            eses.measure_frames(np.zeros((count, 12, 3)), radii, threads=-1)


def test_the_sas_alone_is_that_of_all_surfaces():
    rng = np.random.default_rng(5)
    frames, radii = rng.uniform(0, 12, (3, 60, 3)), rng.uniform(1, 2, 60)
    surface = eses.Surface(frames[0], radii)
    both, sas = surface.measure(by_atom=True), surface.measure(ses=False, by_atom=True)
    assert sas.sas_area == pytest.approx(both.sas_area, rel=1e-12)
    assert sas.sas_volume == pytest.approx(both.sas_volume, rel=1e-12)
    np.testing.assert_allclose(sas.by_atom.sas, both.by_atom.sas, rtol=1e-9, atol=1e-9)
    assert np.isnan([sas.ses_area, sas.ses_volume, sas.convex_area, sas.total_curvature]).all()
    assert np.isnan(sas.by_atom.ses).all() and sas.by_atom.ses.shape == (60,)
    assert sas.euler_number == 0 and sas.vdw_area is None
    by_frame = eses.measure_frames(frames, radii, ses=False, by_atom=True, van_der_waals=True)
    assert by_frame.sas_area[0] == sas.sas_area
    assert np.isnan(by_frame.by_atom.concave).all() and by_frame.by_atom.concave.shape == (3, 60)
    assert by_frame.vdw_area[0] == pytest.approx(surface.measure(0).sas_area, rel=1e-12)
    with pytest.raises(ValueError, match="solvent excluded surface"):
        surface.measure(ses=False, derivatives=True)
