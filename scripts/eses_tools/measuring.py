"""Measures the cost of a run of the program, for the scripts that measure."""

import contextlib
import datetime
import json
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time

from eses_tools.common import Failed, command_of, complete_file, file_argument, machine


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


def peak_bytes(usage, report):
    """Returns the peak memory. wait4 gives the largest of program, shell and Python (see above),
    so the report counts if Python's is the largest."""
    peak = usage.ru_maxrss * 1024
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    return peak if peak > own else report["peak_memory_bytes"]


def run_program(program, arguments, directory):
    """Runs the program. Returns its report and the cost of the run; its files are in
    `directory`/out."""
    with open(directory / "report", "w+", encoding="utf-8") as report_file, \
            open(directory / "messages", "w+", encoding="utf-8") as messages:
        command = [program, *arguments, "--output-dir", directory / "out", "--json"]
        code, wall, usage = run(command, report_file, messages)
        report_file.seek(0)
        messages.seek(0)
        if code != 0:
            raise Failed(messages.read().strip() or f"exit code {code}")
        report = json.load(report_file)
    return report, {"user": usage.ru_utime, "system": usage.ru_stime, "wall": wall,
                    "peak_bytes": peak_bytes(usage, report), "seconds": report["seconds"]}


def measure_once(program, arguments, scratch):
    """Runs the program in a new directory and removes its files."""
    with tempfile.TemporaryDirectory(dir=scratch) as name:
        return run_program(program, arguments, pathlib.Path(name))


def summarize(measured):
    """Combines several runs: least time, highest memory, and the costs of all runs."""
    report = measured[0][0]
    costs = [cost for _, cost in measured]
    return {
        "atoms": report["atoms"], "points": report["grid"]["points"],
        "output_bytes": report["output"]["bytes"],
        "area": report["area"], "volume": report["volume"],
        "cpu": min(cost["user"] + cost["system"] for cost in costs),
        "wall": min(cost["wall"] for cost in costs),
        "peak_bytes": max(cost["peak_bytes"] for cost in costs),
        "runs": costs,
    }


def rings_for(copies):
    """Returns the largest divisor up to the square root, for a shape that is neither tall nor
    wide."""
    return max(n for n in range(1, copies + 1) if copies % n == 0 and n * n <= copies)


def assemble(program, source, copies, target):
    """Writes a complex of copies of the structure with eses-assemble."""
    command = [*command_of("assemble"), file_argument(source), "--copies", str(copies),
               "--rings", str(rings_for(copies)), "--output", target, "--program", program]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                          check=False)
    if done.returncode != 0:
        raise Failed(done.stderr.strip())


# ------------------------------------------------------------------- measurements that are saved


def save(path, build, settings, **results):
    figures = {"date": datetime.datetime.now().astimezone().isoformat(timespec="seconds"),
               "build": build, "machine": machine(), "settings": settings, **results}
    with complete_file(path, encoding="utf-8") as target:
        json.dump(figures, target, indent=1)
        target.write("\n")


def load(path, *results):
    """Loads saved measurements that have at least these results."""
    try:
        figures = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise Failed(f"{path}: no JSON: {error}") from None
    expected = {"date", "machine", "settings", *results}
    if not isinstance(figures, dict) or not expected <= set(figures):
        raise Failed(f"{path} is not what this script writes")
    return figures
