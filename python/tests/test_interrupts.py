"""Tests of Ctrl-C during each kind of call."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import eses

ATTEMPTS = 2


def seconds_to_interrupt(action, delay):
    """Returns the CPU time from SIGINT to KeyboardInterrupt, or None if the action ended before.

    On an idle machine the CPU time is at least the wall-clock time.
    """
    sent = []

    def send():
        sent.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(delay, send)
    timer.start()
    try:
        action()
    except KeyboardInterrupt:
        return time.process_time() - sent[0]
    finally:
        try:
            timer.cancel()
            timer.join()
        except KeyboardInterrupt:
            pass
    return None


def assert_interrupts(action, delay=0.3):
    times = [seconds_to_interrupt(action, delay) for _ in range(ATTEMPTS)]
    assert None not in times, "the action was too quick to be interrupted"
    assert max(times) < 1


@pytest.fixture(scope="module")
def large():
    rng = np.random.default_rng(1)
    n = 1_500_000
    return rng.uniform(0, 250, (n, 3)), rng.uniform(1, 2, n)


@pytest.fixture(scope="module")
def medium(lattice):
    return eses.Surface(*lattice(24))


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_the_making_of_a_surface(large, threads):
    assert_interrupts(lambda: eses.Surface(*large, threads=threads))


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_compute(medium, threads):
    grid = medium.grid(0.15)
    assert_interrupts(lambda: medium.compute(grid, threads=threads, crossings=False))


def test_ctrl_c_ends_compute_with_large_blocks(medium):
    grid = medium.grid(0.15)
    assert_interrupts(lambda: medium.compute(grid, threads=1, block_size=128, crossings=False))


def test_ctrl_c_ends_the_making_of_a_mesh(medium):
    result = medium.compute(medium.grid(0.35))
    assert_interrupts(result.mesh, 0.2)


def test_ctrl_c_ends_an_iteration_over_blocks(medium):
    grid = medium.grid(0.15)

    def loop():
        for _ in medium.blocks(grid):
            pass

    assert_interrupts(loop)


def test_ctrl_c_ends_reading(tmp_path):
    path = tmp_path / "large.xyzr"
    line = b"12.345 23.456 34.567 1.75\n"
    with open(path, "wb") as file:
        for _ in range(60):
            file.write(line * 100_000)
    assert_interrupts(lambda: eses.read_atoms(path), 0.1)


def test_computation_goes_on_after_an_interrupt(medium):
    grid = medium.grid(0.15)
    assert_interrupts(lambda: medium.compute(grid, crossings=False))
    sphere = eses.Surface([[0, 0, 0]], [2])
    assert sphere.compute(sphere.grid(0.2)).area == pytest.approx(16 * np.pi, rel=0.01)


def test_own_signal_handlers_run_during_a_computation(medium):
    class Alarm(Exception):
        pass

    def handle(*_):
        raise Alarm

    grid = medium.grid(0.15)
    before = signal.signal(signal.SIGALRM, handle)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    try:
        with pytest.raises(Alarm):
            medium.compute(grid, crossings=False)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
