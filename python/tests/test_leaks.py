"""Checks that thousands of calls take no more memory than a few."""

import gc
import os

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as numbers:
        return int(numbers.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def growth(action, calls):
    """Returns the growth of resident memory over `calls` calls, after as many calls to warm up."""
    for _ in range(calls):
        action()
    gc.collect()
    before = resident_bytes()
    for _ in range(calls):
        action()
    gc.collect()
    return resident_bytes() - before


# A leaked object of each call takes at least 32 bytes. A leaked array takes several kilobytes.
CALLS = 2000
BOUND = 2_000_000


def test_small_calls_do_not_leak(chain):
    def action():
        surface = eses.Surface(*chain)
        grid = surface.grid(1.0)
        result = surface.compute(grid, threads=1)
        crossings, mesh = result.crossings, result.mesh()
        for array in (result.inside, result.atom_areas, crossings.atoms, crossings.position,
                      crossings.kind, crossings.inside_point, mesh.vertices, mesh.faces,
                      surface.centers):
            array.copy()
        surface.diagnostics, repr(grid), grid.coordinates(0)

    assert growth(action, CALLS) < BOUND


def test_measures_do_not_leak(chain):
    surface = eses.Surface(*chain)
    frames = np.repeat(chain[0][None], 3, axis=0)

    def action():
        measures = surface.measure(by_atom=True, derivatives=True, threads=1)
        measures.by_atom.ses.copy(), measures.gradients.ses_area.centers.copy()
        eses.measure_frames(frames, chain[1], by_atom=True, derivatives=True, threads=1)
        with pytest.raises(ValueError):
            eses.measure_frames(np.full((1, 12, 3), np.nan), chain[1])

    assert growth(action, CALLS // 4) < BOUND


def test_iterators_do_not_leak(chain):
    surface = eses.Surface(*chain)
    grid = surface.grid(0.5)

    def action():
        for block in surface.blocks(grid, threads=1, block_size=9):
            block.inside, block.crossings.normal
        for block in surface.blocks(grid, threads=1, block_size=9):
            break

    assert growth(action, CALLS // 4) < BOUND


def test_files_and_errors_do_not_leak(tmp_path):
    (tmp_path / "bad.xyzr").write_text("0 0 0 x\n")

    def fail(action, error):
        with pytest.raises(error):
            action()

    def action():
        eses.read_atoms(DATA / "c60.xyzr").centers
        fail(lambda: eses.read_atoms(tmp_path / "bad.xyzr"), ValueError)
        fail(lambda: eses.read_atoms(tmp_path / "none.xyzr"), OSError)
        fail(lambda: eses.Surface([[0, 0, np.nan]], [1]), ValueError)
        fail(lambda: eses.Surface([[0, 0, 0]], ["x"]), TypeError)
        fail(lambda: eses.Surface([[0, 0]], [1]), ValueError)

    assert growth(action, CALLS) < BOUND


def test_callbacks_do_not_leak(chain):
    surface = eses.Surface(*chain)
    grid = surface.grid(1.0)

    def fail(*_):
        raise LookupError

    def action():
        surface.compute(grid, threads=2, progress=lambda done, total: None)
        with pytest.raises(LookupError):
            surface.compute(grid, threads=2, progress=fail)

    assert growth(action, CALLS // 2) < BOUND


def test_large_results_do_not_leak(ubiquitin_surface):
    grid = ubiquitin_surface.grid(0.5)

    def action():
        result = ubiquitin_surface.compute(grid)
        result.inside.any(), result.crossings.atoms, result.mesh()

    # A result with its mesh takes several megabytes.
    assert growth(action, 40) < 20_000_000
