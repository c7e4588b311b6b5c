"""Runs programs, ends them with their children, and measures their cost."""

import contextlib
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

from eses_tools.common import file_argument


GRACE = 5  # seconds


@contextlib.contextmanager
def delayed_signals():
    """Delays SIGINT, SIGTERM, SIGHUP and SIGQUIT until the end of the block. An exception of their handlers within
    Popen would leave a process that nobody knows."""
    received = []
    handlers = {number: signal.getsignal(number)
                for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)}
    changed = [number for number, handler in handlers.items() if handler != signal.SIG_IGN]
    for number in changed:
        signal.signal(number, lambda number, _: received.append(number))
    try:
        yield
    finally:
        for number in changed:
            signal.signal(number, handlers[number])
        for number in received:
            signal.raise_signal(number)


def argument_of(item):
    """Returns an item of a command as text. Paths are files, and never options."""
    return file_argument(item) if isinstance(item, os.PathLike) else str(item)


def processor_count():
    """Returns the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):  # Linux
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def peak_bytes(usage):
    """Returns the largest memory of a process and its children, of which `usage` tells."""
    return usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def run(command, stdout, stderr, **how):
    """Runs a command and returns exit code, wall seconds and resource usage, including children.

    `how` is passed to Popen.

    Linux gives a new process the peak memory of the process that starts it. Started by Python, a
    small program would seem to need as much memory as Python. A shell is therefore started in
    between, which costs a millisecond. `exit` keeps the shell from replacing itself by the program.
    """
    start = time.perf_counter()
    process = None
    try:
        with delayed_signals():
            process = subprocess.Popen(["/bin/sh", "-c", '"$@"; exit $?', "sh", *map(argument_of, command)],
                                       stdin=subprocess.DEVNULL, stdout=stdout, stderr=stderr,
                                       start_new_session=True, **how)
        _, status, usage = os.wait4(process.pid, 0)
    except BaseException:
        if process:
            end_session(process)
        raise
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, time.perf_counter() - start, usage


def plain(messages):
    """Returns messages of eses-blocks without its name."""
    return re.sub(r"^eses-blocks: (error: )?", "", messages.strip(), flags=re.MULTILINE)


def run_quietly(command, stdout=subprocess.DEVNULL, start=run, **how):
    """Runs a command with `start`. Returns exit code, plain() messages, and what else `start` returns."""
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as messages:
        code, *cost = start(command, stdout=stdout, stderr=messages, **how)
        messages.seek(0)
        return code, plain(messages.read()), *cost


def end_session(process):
    """Ends a process that leads a session, and its children. They have some seconds to remove their
    files and to end programs that they have started."""
    for number, seconds in ((signal.SIGTERM, GRACE), (signal.SIGKILL, 1)):
        end = time.monotonic() + seconds
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, number)
            while time.monotonic() < end:
                process.poll()
                os.killpg(process.pid, 0)  # until the session has no process
                time.sleep(0.01)
    process.wait()
