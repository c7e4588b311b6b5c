"""Tests of Ctrl-C during each kind of call."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import eses_blocks as eses
from conftest import DATA

ATTEMPTS = 2


def seconds_to_interrupt(action, delay):
    """Returns the CPU time from SIGINT to KeyboardInterrupt, or None if the action ended before.

    On an idle machine the CPU time is at least the wall-clock time, and at most that of all threads.
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


def assert_interrupts(action, delay=0.3, most=1.0):
    times = [seconds_to_interrupt(action, delay) for _ in range(ATTEMPTS)]
    assert None not in times, "the action was too quick to be interrupted"
    assert max(times) < most


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


@pytest.mark.parametrize("name", ["dielectric", "kappa"])
def test_ctrl_c_ends_maps(medium, name):
    # With one thread CPU time is wall-clock time.
    result = medium.compute(medium.grid(0.5), threads=1, inside=False, crossings=False)
    assert_interrupts(getattr(result, name))


def test_ctrl_c_ends_the_making_of_a_mesh(medium):
    result = medium.compute(medium.grid(0.35))
    assert_interrupts(result.mesh, 0.2)


def test_ctrl_c_ends_an_iteration_over_blocks(medium):
    grid = medium.grid(0.15)

    def loop():
        for _ in medium.blocks(grid):
            pass

    assert_interrupts(loop)


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_measure(lattice, threads):
    surface = eses.Surface(*lattice(40))
    assert_interrupts(lambda: surface.measure(by_atom=True, derivatives=True, threads=threads), 0.1)


@pytest.fixture(scope="module")
def cavernous():
    """Returns 190,000 atoms with cavities: copies of a protein side by side."""
    atoms = eses.read_atoms(DATA / "achbp.xyzr")
    copies = [atoms.centers + [200 * k, 0, 0] for k in range(190_000 // len(atoms))]
    return eses.Surface(np.concatenate(copies), np.tile(atoms.radii, len(copies)))


def filled(surface):
    return eses.Surface(surface.centers, surface.radii, fill_cavities=True)


CAVITIES = {
    "cavities": lambda surface, threads: surface.cavities(threads=threads),
    "pockets": lambda surface, threads: surface.pockets(spacing=1.4, threads=threads),
    "filled": lambda surface, threads: filled(surface).compute(
        surface.grid(2.0, 2.0), threads=threads, inside=False, crossings=False),
    "blocks": lambda surface, threads: list(filled(surface).blocks(surface.grid(2.0, 2.0), threads=threads)),
}


@pytest.mark.parametrize("name", CAVITIES)
@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_the_search_for_cavities(cavernous, name, threads):
    """The delays are in several phases of the search."""
    for delay in (0.1, 0.4):
        assert_interrupts(lambda: CAVITIES[name](cavernous, threads), delay, 0.5 * threads)


@pytest.mark.parametrize("count, n", [(100_000, 4), (4, 40)])
@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_measure_frames(lattice, count, n, threads):
    centers, radii = lattice(n)
    frames = np.broadcast_to(centers, (count, n**3, 3))
    assert_interrupts(lambda: eses.measure_frames(frames, radii, threads=threads))


def test_ctrl_c_ends_reading(tmp_path):
    path = tmp_path / "large.xyzr"
    line = b"12.345 23.456 34.567 1.75\n"
    with open(path, "wb") as file:
        for _ in range(60):
            file.write(line * 100_000)
    assert_interrupts(lambda: eses.read_atoms(path), 0.1)


def write_mmcif(path, atoms):
    """A file of one table, with an atom at each point of a line."""
    tags = ("group_PDB id type_symbol label_atom_id label_alt_id label_comp_id label_asym_id label_entity_id "
            "label_seq_id pdbx_PDB_ins_code Cartn_x Cartn_y Cartn_z occupancy B_iso_or_equiv auth_seq_id "
            "auth_asym_id pdbx_PDB_model_num").split()
    with open(path, "w", encoding="ascii") as file:
        file.write("data_LINE\nloop_\n" + "".join(f"_atom_site.{tag}\n" for tag in tags))
        for i in range(atoms):
            residue, chain = i % 1000 + 1, f"A{i // 1000}"
            file.write(f"ATOM {i + 1} C CA . ALA {chain} 1 {residue} ? {i % 4001}.5 0.0 {i / 1000} 1.0 10.0 "
                       f"{residue} {chain} 1\n")


@pytest.mark.usefixtures("needs_gemmi")
def test_read_mmcif(tmp_path):
    path = tmp_path / "large.cif"
    write_mmcif(path, 400_000)
    # The times are those of all phases of reading, of which one never looks for interrupts.
    start = time.process_time()
    assert len(eses.read_atoms(path)) == 400_000
    total = time.process_time() - start
    for part in (0.1, 0.4, 0.6, 0.8):
        seconds = seconds_to_interrupt(lambda: eses.read_atoms(path), part * total)
        assert seconds is None or seconds < 1, part
    assert_interrupts(lambda: eses.read_atoms(path), 0.1)


@pytest.mark.usefixtures("needs_gemmi")
def test_exit_after_an_interrupt(tmp_path):
    """The thread that still reads when the interpreter exits does no harm."""
    path = tmp_path / "large.cif"
    write_mmcif(path, 200_000)
    program = f"""
import eses_blocks as eses, signal
signal.signal(signal.SIGALRM, signal.default_int_handler)
signal.setitimer(signal.ITIMER_REAL, 0.1)
try:
    eses.read_atoms({str(path)!r})
except KeyboardInterrupt:
    print("interrupted")
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "interrupted\n", "")


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


@pytest.mark.parametrize("chosen", [None, "active"])
def test_waiting_threads_sleep_unless_the_environment_chooses(chosen):
    environment = {name: value for name, value in os.environ.items() if name not in ("OMP_WAIT_POLICY", "GOMP_SPINCOUNT")}
    environment["OMP_DISPLAY_ENV"] = "verbose"
    if chosen:
        environment["OMP_WAIT_POLICY"] = chosen
    done = subprocess.run([sys.executable, "-c", "import eses_blocks, os; print(os.environ.get('OMP_WAIT_POLICY'))"],
                          env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == f"{chosen}\n"
    if "GOMP_SPINCOUNT" not in done.stderr:
        pytest.skip("the OpenMP of clang reads the environment later")
    assert ("GOMP_SPINCOUNT = '0'" in done.stderr) == (chosen is None)
