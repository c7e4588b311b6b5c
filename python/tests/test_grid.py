"""Tests of grids."""

import pickle

import numpy as np
import pytest

import eses_blocks as eses


def test_grid_of_a_surface_is_the_one_computed_by_hand():
    # Computed by hand: from -1.5 - 0.75 to 4 + 1 + 0.75 along x, and 8 / 0.5 + 1 points.
    surface = eses.Surface([[0, 0, 0], [4, 0, 0]], [1.5, 1])
    grid = surface.grid(0.5, margin=0.75)
    assert grid.origin == (-2.25, -2.25, -2.25)
    assert grid.spacing == 0.5
    assert grid.shape == (17, 10, 10)
    assert grid.size == 1700
    assert surface.grid() == surface.grid(spacing=0.4, margin=0.8)


def test_chosen_grid_has_its_center_and_shape(chain):
    surface = eses.Surface(*chain)
    grid = surface.grid(0.25, origin=(-1, 2, 3.5), shape=(33, 65, 17))
    assert grid == eses.Grid((-1, 2, 3.5), 0.25, (33, 65, 17))
    assert grid.origin == (-1.0, 2.0, 3.5) and grid.shape == (33, 65, 17)
    centered = surface.grid(0.5, center=np.array([1.0, 2.0, 3.0]), shape=np.array([5, 7, 9]))
    assert centered == eses.Grid((0, 0.5, 1), 0.5, (5, 7, 9))


def test_coordinates_follow_origin_and_spacing():
    grid = eses.Grid((1, 2, 3), 0.5, (3, 1, 2))
    assert grid.coordinates(0).tolist() == [1, 1.5, 2]
    assert grid.coordinates(1).tolist() == [2]
    assert grid.coordinates(2).tolist() == [3, 3.5]
    with pytest.raises(ValueError, match="axis must be 0, 1 or 2"):
        grid.coordinates(3)
    with pytest.raises(TypeError):
        grid.coordinates(-1)


def test_grids_compare_and_print():
    grid = eses.Grid((1, 2, 3), 0.5, (3, 4, 5))
    same = eses.Grid([1, 2, 3], 0.5, [3, 4, 5])
    assert grid == same and hash(grid) == hash(same)
    assert grid != eses.Grid((1, 2, 3), 0.5, (3, 4, 6))
    assert grid != eses.Grid((1, 2, 3), 0.25, (3, 4, 5))
    assert grid != eses.Grid((1, 2, 0), 0.5, (3, 4, 5))
    assert grid != "grid" and not grid == None  # noqa: E711
    assert repr(grid) == "eses_blocks.Grid(origin=(1.0, 2.0, 3.0), spacing=0.5, shape=(3, 4, 5))"
    assert eval(repr(grid), {"eses_blocks": eses}) == grid
    assert pickle.loads(pickle.dumps(grid)) == grid


def test_grids_are_checked(chain):
    for spacing in (0, -1, np.nan, np.inf):
        with pytest.raises(ValueError, match="spacing"):
            eses.Grid((0, 0, 0), spacing, (3, 3, 3))
        with pytest.raises(ValueError, match="spacing"):
            eses.Surface(*chain).grid(spacing)
    for shape in ((0, 3, 3), (3, -1, 3), (3, 3, 3_000_000_000)):
        with pytest.raises(ValueError, match="points along"):
            eses.Grid((0, 0, 0), 0.5, shape)
    with pytest.raises(ValueError, match="limit"):
        eses.Grid((0, 0, 0), 1e-9, (10**9, 10**9, 10**9))
    with pytest.raises(ValueError, match="finite"):
        eses.Grid((0, np.nan, 0), 0.5, (3, 3, 3))
    for arguments in (((0, 0), 0.5, (3, 3, 3)), ((0, 0, 0), 0.5, (3, 3)),
                      ((0, 0, 0), 0.5, (3.5, 3, 3)), ((0, 0, 0), None, (3, 3, 3))):
        with pytest.raises(TypeError):
            eses.Grid(*arguments)


def test_contradictory_choices_are_refused(chain):
    surface = eses.Surface(*chain)
    with pytest.raises(ValueError, match="need a shape"):
        surface.grid(origin=(0, 0, 0))
    with pytest.raises(ValueError, match="need a shape"):
        surface.grid(center=(0, 0, 0))
    with pytest.raises(ValueError, match="either an origin or a center"):
        surface.grid(shape=(3, 3, 3))
    with pytest.raises(ValueError, match="either an origin or a center"):
        surface.grid(shape=(3, 3, 3), origin=(0, 0, 0), center=(0, 0, 0))
    with pytest.raises(ValueError, match="margin"):
        surface.grid(shape=(3, 3, 3), origin=(0, 0, 0), margin=0.8)
    with pytest.raises(ValueError, match="margin"):
        surface.grid(margin=-1)


def test_grid_of_a_file_is_read(tmp_path, ubiquitin_surface, run_program):
    from conftest import DATA
    run_program(DATA / "1ubq.xyzr", "1.4", "0.75", "1.5", "-o", tmp_path, "--inside", "map.dx")
    # The program writes origins with twelve digits.
    for name in ("bounding_box.txt", "map.dx"):
        grid = eses.read_grid(tmp_path / name)
        expected = ubiquitin_surface.grid(0.75, 1.5)
        assert grid.shape == expected.shape
        assert grid.spacing == 0.75
        assert np.allclose(grid.origin, expected.origin, rtol=0, atol=1e-6)
    with pytest.raises(FileNotFoundError):
        eses.read_grid(tmp_path / "nowhere.dx")
    (tmp_path / "bad.dx").write_text("not a map\n")
    with pytest.raises(ValueError, match="bad.dx"):
        eses.read_grid(tmp_path / "bad.dx")
