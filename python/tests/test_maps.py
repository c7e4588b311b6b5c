"""Maps for Poisson-Boltzmann solvers: equality with the program's files, and closed forms."""

import itertools

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA

SOLUTE, SOLVENT = 4.0, 80.0


def read_dx(path):
    """The words of the values of a map, as an array (nx, ny, nz)."""
    header, _, rest = path.read_text(encoding="ascii").partition("data follows\n")
    counts = [int(word) for word in header.partition("gridpositions counts")[2].split()[:3]]
    return np.array(rest.partition("attribute")[0].split()).reshape(counts)


def as_words(values, pattern):
    return np.array([pattern % value for value in values.ravel()]).reshape(values.shape)


@pytest.mark.parametrize("region", [None, ((3, 2, 0), (30, 31, 28))])
def test_files(run_program, ubiquitin_surface, tmp_path, region):
    grid = ubiquitin_surface.grid(0.9, 1.8)
    arguments = []
    if region:
        corners = [[grid.coordinates(axis)[corner[axis] - is_end] for axis in range(3)]
                   for is_end, corner in enumerate(region)]
        corners = np.array(corners) + [[-0.01], [0.01]]
        arguments = ["--region=" + ",".join(map(str, corners.ravel()))]
    run_program(DATA / "1ubq.xyzr", "--spacing", 0.9, "--margin", 1.8, "-o", tmp_path, "--write", "none",
                "--dielectric", "d", "--solute-dielectric", SOLUTE, "--solvent-dielectric", SOLVENT,
                "--kappa", "k.dx", "--ion-radius", 1.5, *arguments)
    result = ubiquitin_surface.compute(grid, region=region, inside=False, crossings=False)
    maps = result.dielectric(SOLUTE, SOLVENT)
    assert len(maps) == 3
    for values, axis in zip(maps, "xyz"):
        expected = read_dx(tmp_path / f"d{axis}.dx")
        assert values.dtype == np.float64 and values.shape == expected.shape
        assert np.array_equal(as_words(values, "%.6e"), expected)
    kappa = result.kappa(ion_radius=1.5)
    assert kappa.dtype == bool
    assert np.array_equal(as_words(kappa, "%d"), read_dx(tmp_path / "k.dx"))


def test_ion():
    """Of an edge in a sphere, the part inside is a part of a chord."""
    center, radius, h = np.array([0.1, -0.2, 0.3]), 3.0, 0.6
    grid = eses.Grid(origin=(-4, -4, -4), spacing=h, shape=(14, 15, 16))
    result = eses.Surface([center], [radius]).compute(grid)
    points = np.stack(np.meshgrid(*map(grid.coordinates, range(3)), indexing="ij"), axis=-1) - center
    for axis, values in enumerate(result.dielectric(solute=SOLUTE, solvent=SOLVENT)):
        aside = (points**2).sum(axis=-1) - points[..., axis]**2
        chord = np.sqrt(np.maximum(0, radius**2 - aside))
        low = points[..., axis]
        inside = np.maximum(0, np.minimum(low + h, chord) - np.maximum(low, -chord)) / h
        assert ((inside > 0) & (inside < 1)).sum() > 100
        assert values == pytest.approx(1 / (inside / SOLUTE + (1 - inside) / SOLVENT), rel=1e-6)
    for ion_radius in (0, 0.75):
        reached = (points**2).sum(axis=-1) > (radius + ion_radius)**2
        assert np.array_equal(result.kappa(ion_radius), reached)


def test_defaults_and_threads(chain):
    surface = eses.Surface(*chain)
    grid = surface.grid(0.4)
    results = [surface.compute(grid, threads=1, block_size=8), surface.compute(grid, threads=2)]
    for a, b in itertools.chain(zip(results[0].dielectric(), results[1].dielectric(2, 78.54)),
                                [(results[0].kappa(), results[1].kappa(2))]):
        assert a.shape == grid.shape and np.array_equal(a, b)


def test_arrays_own_their_memory(chain):
    surface = eses.Surface(*chain)
    result = surface.compute(surface.grid(1.0))
    first, second = result.dielectric()[0], result.dielectric()[0]
    before = second.copy()
    assert first.flags.writeable and first.flags.f_contiguous
    first[...] = 1
    del result
    assert np.array_equal(second, before)


def test_errors(chain):
    surface = eses.Surface(*chain)
    result = surface.compute(surface.grid(1.0))
    for wrong in (0, -2, np.nan, 1e10):
        with pytest.raises(ValueError, match="dielectric of the solute must be between"):
            result.dielectric(solute=wrong)
        with pytest.raises(ValueError, match="dielectric of the solvent must be between"):
            result.dielectric(solvent=wrong)
    for wrong in (-1, np.nan, 1001):
        with pytest.raises(ValueError, match="radius of the ions must be between"):
            result.kappa(wrong)
    for wrong in ("2", None, [2]):
        with pytest.raises(TypeError):
            result.dielectric(wrong)
        with pytest.raises(TypeError):
            result.kappa(wrong)


def test_memory_limit(ubiquitin_surface):
    grid = ubiquitin_surface.grid(0.25)
    result = ubiquitin_surface.compute(grid, inside=False, crossings=False, threads=1,
                                       max_memory=400 * 2**20)
    assert grid.size * 24 < 400 * 2**20
    result.kappa()
    large = ubiquitin_surface.compute(ubiquitin_surface.grid(0.1), inside=False, crossings=False,
                                      threads=1, max_memory=400 * 2**20)
    with pytest.raises(MemoryError):
        large.dielectric()
