"""Tests of the iteration over blocks."""

import gc
import pathlib
import re
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import eses_blocks as eses

needs_thread_list = pytest.mark.skipif(not pathlib.Path("/proc/self/task").is_dir(),
                                       reason="this system does not list threads in /proc")


def thread_count():
    with open("/proc/self/status", encoding="ascii") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("Threads:"))


def wait_for_threads(count):
    deadline = time.monotonic() + 30
    while thread_count() > count and time.monotonic() < deadline:
        time.sleep(0.01)
    return thread_count()


def switches_of_sleepers():
    """Returns how often each other thread was taken off its processor, or nothing if one of them
    does not sleep."""
    switches = {}
    for task in pathlib.Path("/proc/self/task").iterdir():
        if int(task.name) != threading.get_native_id():
            status = (task / "status").read_text(encoding="ascii")
            if "\nState:\tS" not in status:
                return None
            switches[task.name] = re.findall(r"ctxt_switches:\t(\d+)", status)
    return switches


def wait_until_others_sleep():
    deadline = time.monotonic() + 60
    while (before := switches_of_sleepers()) is None or switches_of_sleepers() != before:
        assert time.monotonic() < deadline
        time.sleep(0.001)


@pytest.fixture(name="slow")
def fixture_slow(lattice):
    """Returns a surface and a grid with many blocks."""
    surface = eses.Surface(*lattice(10))
    return surface, surface.grid(0.3)


@pytest.mark.parametrize("threads", [1, 3])
def test_blocks_make_up_the_grid(ubiquitin_surface, threads):
    grid = ubiquitin_surface.grid(0.8)
    whole = ubiquitin_surface.compute(grid)
    inside = np.zeros(grid.shape, np.int8) - 1
    lower, axis, position, atoms = [], [], [], []
    blocks = ubiquitin_surface.blocks(grid, threads=threads, block_size=17)
    for block in blocks:
        assert (inside[block.slices] == -1).all()
        inside[block.slices] = block.inside
        begin, end = block.region
        assert block.inside.shape == tuple(np.subtract(end, begin))
        assert ((block.crossings.lower >= begin) & (block.crossings.lower < end)).all()
        lower.append(block.crossings.lower)
        axis.append(block.crossings.axis)
        position.append(block.crossings.position)
        atoms.append(block.crossings.atoms)
    assert np.array_equal(inside, whole.inside)
    lower, axis, position, atoms = map(np.concatenate, (lower, axis, position, atoms))
    order = np.lexsort((axis, lower[:, 0], lower[:, 1], lower[:, 2]))
    assert np.array_equal(lower[order], whole.crossings.lower)
    assert np.array_equal(position[order], whole.crossings.position)
    assert np.array_equal(atoms[order], whole.crossings.atoms)
    assert blocks.area == whole.area and blocks.volume == whole.volume
    assert blocks.divergence_volume == whole.divergence_volume
    assert np.array_equal(blocks.atom_areas, whole.atom_areas)
    assert list(blocks) == []


def test_region_and_range_of_blocks_are_iterated(ubiquitin_surface):
    grid = ubiquitin_surface.grid(0.8)
    for arguments in ({"region": ((3, 4, 5), (20, 30, 25))},
                      {"blocks": ((0, 1, 0), (2, 2, 1)), "block_size": 17}):
        part = ubiquitin_surface.compute(grid, **arguments)
        inside = np.zeros(grid.shape, bool)
        count = 0
        for block in ubiquitin_surface.blocks(grid, **arguments):
            inside[block.slices] = block.inside
            count += block.inside.size
        assert count == part.inside.size
        assert np.array_equal(inside[tuple(map(slice, *part.region))], part.inside)


def test_totals_wait_for_the_last_block(slow):
    surface, grid = slow
    blocks = surface.blocks(grid)
    next(blocks)
    with pytest.raises(RuntimeError, match="after the last block"):
        blocks.area
    blocks.close()
    with pytest.raises(RuntimeError):
        blocks.volume
    with pytest.raises(RuntimeError):
        blocks.atom_areas


@needs_thread_list
@pytest.mark.parametrize("leave", ["break", "raise", "close", "with", "delete", "unused"])
def test_loops_that_end_early_leave_no_threads(slow, leave):
    surface, grid = slow
    surface.compute(surface.grid(2.0), threads=2)  # starts the OpenMP threads, which stay alive
    before = thread_count()
    if leave == "break":
        for _ in surface.blocks(grid, threads=2):
            break
    elif leave == "raise":
        with pytest.raises(LookupError):
            for _ in surface.blocks(grid, threads=2):
                raise LookupError
    elif leave == "close":
        blocks = surface.blocks(grid, threads=2)
        next(blocks)
        blocks.close()
        blocks.close()
        assert list(blocks) == []
    elif leave == "with":
        with surface.blocks(grid, threads=2) as blocks:
            next(blocks)
        assert list(blocks) == []
    elif leave == "delete":
        blocks = surface.blocks(grid, threads=2)
        next(blocks)
        del blocks
    else:
        surface.blocks(grid, threads=2)
    gc.collect()
    assert wait_for_threads(before) <= before


def test_close_from_another_thread_ends_the_loop(slow):
    surface, grid = slow
    blocks = surface.blocks(grid)
    count = 0
    for _ in blocks:
        count += 1
        if count == 2:
            closer = threading.Thread(target=blocks.close)
            closer.start()
            closer.join()
    assert count == 2


def test_blocks_outlive_the_iterator(ubiquitin_surface):
    grid = ubiquitin_surface.grid(0.8)
    blocks = ubiquitin_surface.blocks(grid, block_size=17)
    kept = [(block.slices, block.inside, block.crossings.normal) for block in blocks]
    del blocks
    whole = ubiquitin_surface.compute(grid)
    for slices, inside, normal in kept:
        assert np.array_equal(inside, whole.inside[slices])
        assert np.allclose(np.linalg.norm(normal, axis=1), 1)
        with pytest.raises(ValueError, match="read-only"):
            inside[...] = False


def test_iterator_of_the_parent_is_refused_after_a_fork():
    # An open iterator, one whose computation has ended, and one with all totals.
    code = """
import os, time
import numpy as np, eses_blocks as eses
centers = np.stack(np.meshgrid(*[3.9 * np.arange(10)] * 3), axis=-1).reshape(-1, 3)
surface = eses.Surface(centers, np.full(len(centers), 1.7))
blocks = surface.blocks(surface.grid(0.2), threads=1)
next(blocks)
ended = surface.blocks(surface.grid(2.0), threads=1)
area = (list(ended), ended.area)[1]
ended.close()
child = os.fork()
if child == 0:
    for action in (lambda: next(blocks), lambda: list(blocks), lambda: blocks.area):
        try:
            action()
        except RuntimeError as error:
            print(error)
    print(ended.area == area)
    with blocks:
        pass
    blocks.close()
    del blocks
    raise SystemExit(3)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
print(next(blocks).inside.size > 0)
"""
    # Python 3.12 and later warn of every fork of a process with threads.
    done = subprocess.run([sys.executable, "-W", "ignore::DeprecationWarning", "-c", code],
                          capture_output=True, text=True, check=False, timeout=120)
    message = ("the iterator belongs to the process that made it; call blocks in the forked "
               "process\n")
    assert (done.stdout, done.stderr) == (3 * message + "True\n3\nTrue\n", "")


def test_interpreter_ends_while_an_iterator_is_open():
    code = """
import numpy as np, eses_blocks as eses
centers = np.stack(np.meshgrid(*[3.9 * np.arange(10)] * 3), axis=-1).reshape(-1, 3)
surface = eses.Surface(centers, np.full(len(centers), 1.7))
blocks = surface.blocks(surface.grid(0.2), threads=2)
print(next(blocks).inside.size > 0)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                          check=False, timeout=120)
    assert (done.returncode, done.stdout, done.stderr) == (0, "True\n", "")


@needs_thread_list
def test_queue_is_bounded(slow):
    """The thread that computes the blocks waits in its middle, until more blocks are taken."""
    surface, grid = slow
    before = thread_count()
    blocks = surface.blocks(grid, threads=1, block_size=33)
    next(blocks)
    wait_until_others_sleep()
    assert thread_count() == before + 1
    assert sum(1 for _ in blocks) > 50
    assert wait_for_threads(before) == before
