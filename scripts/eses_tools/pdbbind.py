"""Computes the surface of every structure below a folder, and one table of all.

Structures are files with the suffixes .xyzr, .pqr, .pdb, .ent, .cif, .mmcif, .mcif and .pdbx, and
assemblies with the suffixes .pdb1, .pdb2 and so on, each also .gz. The id of 1a30/1a30_protein.pdb,
in the layout of PDBbind, is 1a30. Without --radii, PDB2PQR prepares PDB and mmCIF files with CHARMM
radii, as for the table of Zhao et al. (2018). With --radii, they are read directly, with their
ligands and ions. OUT/ID/ receives the files of eses-blocks and a report, status.json.
OUT/summary.csv has a line for each structure. A second call skips complete structures, unless the
structure or the options have changed. Arguments after -- are passed to eses-blocks. Arguments that
choose files, formats or threads are refused, and so are those that compute nothing.

`pdbbind merge OUT` joins the summaries of the tasks of a job array (--task).
"""

import os
import sys

from eses_tools import quiet_interrupt  # before the modules that take time to load

import argparse
import collections
import concurrent.futures
import fcntl
import json
import pathlib
import re
import signal
import subprocess
import time

from eses_tools.common import (NAME, Failed, Parser, describe_build, end_with, positive, printable,
                               require_writable, require_output, say, show)
from eses_tools.one_structure import (PICTURE, WRITE, Children, Job, Stopped, compute, is_complete, is_prepared,
                                      make_request, radii_text, read_status)
from eses_tools import measuring, pdb_to_pqr, report
from eses_tools.structures import KINDS, find_structures
from eses_tools import summary, thumbnails

PROGRESS_SECONDS = 30  # interval of the progress lines without a terminal


def clock(seconds):
    minutes, seconds = divmod(max(0, round(seconds)), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes}:{seconds:02}"


class Progress:
    """Prints counts, rate and time left on standard error: a line that is renewed, or a log."""

    def __init__(self, todo):
        self.total = len(todo)
        self.weight_left = self.weight_total = sum(map(weight, todo))
        self.done = self.failed = 0
        self.start = self.last_line = time.monotonic()

    def count(self, structure, status):
        self.done += 1
        self.weight_left -= weight(structure)
        if status["status"] != "done":
            self.failed += 1
            say(f"{printable(structure.id)}: {printable(status['message'])}")

    def text(self):
        elapsed = max(1e-9, time.monotonic() - self.start)
        text = f"{self.done}/{self.total} done, {self.failed} failed"
        if self.done:
            rate = self.done / elapsed
            text += f", {rate:.1f}/s" if rate >= 1 else f", {60 * rate:.1f}/min"
            solved = self.weight_total - self.weight_left
            text += f", {clock(elapsed * self.weight_left / solved)} left"
        return text

    def show(self):
        if sys.stderr.isatty():
            show(self.text())
        elif time.monotonic() - self.last_line >= PROGRESS_SECONDS:
            self.last_line = time.monotonic()
            say(self.text())


def weight(structure):
    """Returns a number that is roughly proportional to the time of the structure; never 0."""
    return 1 + structure.bytes * (4 if structure.path.suffix.lower() == ".gz" else 1)


def compute_all(job, todo, jobs, threads, received):
    """Returns the statuses of the finished structures by id. Ends early, in good order, once
    `received` holds a signal.

    The largest structures come first, so that none of them runs alone at the end. A structure that
    starts gets an equal share of the free threads for each free place.
    """
    waiting = collections.deque(sorted(todo, key=weight, reverse=True))
    statuses, running, free = {}, {}, threads
    progress = Progress(todo)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        while running or (waiting and not received):
            while waiting and len(running) < jobs and not received:
                places = min(len(waiting), jobs - len(running))
                share = max(1, free // places)
                free -= share
                structure = waiting.popleft()
                running[pool.submit(compute, job, structure, share)] = structure, share
            if received and not job.children.stopped:
                job.children.stop()
            ended, _ = concurrent.futures.wait(
                running, timeout=0.2, return_when=concurrent.futures.FIRST_COMPLETED)
            for future in ended:
                structure, share = running.pop(future)
                free += share
                try:
                    statuses[structure.id] = future.result()
                    progress.count(structure, statuses[structure.id])
                except Stopped:
                    pass
            progress.show()
    show("")
    return statuses


# -------------------------------------------------------------------------------- command line

GRID_OPTIONS = ("probe_radius", "spacing", "margin", "block_size")

# Options that must not follow --, and the reason.
NO_RESULT = "it computes nothing"
OURS = "pdbbind sets it"
BY_KEEP = "--keep, before --, chooses the files"
BY_THREADS = "use --threads before --"
REFUSED = {
    **dict.fromkeys(("--dry-run", "-h", "--help", "--help-all", "--version"), NO_RESULT),
    **dict.fromkeys(("--json", "--format", "-o", "--output-dir"), OURS),
    "--radii": "use --radii before --",
    **dict.fromkeys(("--write", "--mesh", "--ply-ascii", "--color", "--potential",
                     "--potential-offset", "--potential-limit", "--inside", "--dielectric",
                     "--kappa"), BY_KEEP),
    **dict.fromkeys(("-t", "--threads"), BY_THREADS),
}
SHORT_WITH_VALUE = "bot"  # the rest of the same word is the value: -b32


def task_of(text):
    match = re.fullmatch(r"(\d+)/(\d+)", text)
    if not match or not 1 <= int(match[1]) <= int(match[2]):
        raise argparse.ArgumentTypeError(f"{text!r} is not I/N with I from 1 to N")
    return int(match[1]), int(match[2])


def options_in(word):
    """Yields the names of options in a word of a command line: --spacing=0.5, -q, -qb32."""
    if word.startswith("--"):
        yield word.partition("=")[0]
    elif word.startswith("-"):
        for letter in word[1:]:
            yield "-" + letter
            if letter in SHORT_WITH_VALUE:
                return


def refuse(parser, arguments):
    """Ends with exit code 2 if an argument for eses-blocks is one that the script sets itself."""
    for word in arguments:
        for name in options_in(word):
            if name in REFUSED:
                parser.error(f"{name} is refused after --: {REFUSED[name]}")


def parse_options():
    """Returns the options of the script and the arguments for eses-blocks."""
    parser = Parser(__doc__, examples=(("structures", "all structures, with PDB2PQR"),
                              ("structures --radii protor --report", "PDB files directly, and a page"),
                              ("structures --jobs 4 --threads 16 -o out", "four at once")),
                    advanced=("--task", "--margin", "--block-size", "--program"),
                    usage=f"{NAME} [OPTION...] DIR [-- ARGUMENT...]\n       {NAME} merge OUT")
    parser.add_argument("folder", metavar="DIR", type=pathlib.Path, help="folder with structures")
    parser.add_argument("-o", "--output", metavar="OUT", type=pathlib.Path,
                        default=pathlib.Path("out"), help="folder of the results (default: out)")
    parser.add_argument("--jobs", type=positive, metavar="N",
                        help="number of structures at once (default: as many as threads)")
    parser.add_argument("--threads", type=positive, metavar="N",
                        help="number of threads for all running structures together (default: "
                             "all that eses-blocks may use)")
    parser.add_argument("--keep", choices=WRITE, default="edges",
                        help="files that stay on disk: none; edges, with areas and prepared atoms "
                             "(the default); or all, which adds the large grid_info.txt")
    parser.add_argument("--only", default="*", metavar="PATTERN",
                        help="only structures whose path below DIR matches, for example "
                             "'*_protein.pdb'")
    parser.add_argument("--task", type=task_of, metavar="I/N",
                        help="compute only the I-th of N shares, for a job array; writes "
                             f"OUT/{summary.share_name('I', 'N')}")
    parser.add_argument("--probe-radius", metavar="A",
                        help="radius of the solvent probe in angstrom (default: 1.4)")
    parser.add_argument("--spacing", metavar="A",
                        help="distance between grid points in angstrom (default: 0.4)")
    parser.add_argument("--margin", metavar="A",
                        help="distance between molecule and grid boundary in angstrom (default: 0.8)")
    parser.add_argument("--block-size", metavar="N",
                        help="grid points on a side of a block (default: chosen by eses-blocks)")
    parser.add_argument("--report", action="store_true",
                        help="write a page with failures, plots and a table beside the summary, such "
                             "as OUT/summary.html")
    parser.add_argument("--pictures", type=thumbnails.patterns_of, default=[], metavar="PATTERNS",
                        help=thumbnails.HELP.format("ids") + f"; writes OUT/ID/{PICTURE}, which "
                             "the report contains")
    parser.add_argument("--radii", metavar="NAME",
                        help="read PDB and mmCIF files directly, with these radii of eses-blocks: "
                             "protor, bondi, msms, naccess, oons, also with +shannon, or a file (default: prepared by PDB2PQR with "
                             "CHARMM radii)")
    parser.add_program()
    options, arguments = parser.parse_before_dashes()
    refuse(parser, arguments)
    given = [word for name in GRID_OPTIONS if (value := getattr(options, name)) is not None
             for word in (f"--{name.replace('_', '-')}", value)]
    return options, given + arguments


ONE_ATOM = "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n"


def ask_program(program, options, radii):
    """Returns the version and the default number of threads of the program. Throws Failed."""
    version = describe_build(program)[0]
    layout = "pdb" if radii else "xyzr"  # the program accepts options of structures with PDB only

    def answer(*arguments, atoms="0 0 0 1\n"):
        return subprocess.run([program, *arguments], input=atoms, capture_output=True, text=True,
                              check=False)

    def refuse(done, otherwise=""):
        say(measuring.plain(done.stderr).partition("\n")[0] or otherwise)
        sys.exit(2)

    # An empty file is an error of the input. Errors of the command line come first.
    refused = answer("/dev/null", *options, "--format", layout, "--write", "none", "--threads", "1",
                     "--output-dir", ".", "--json", "--independent")
    if refused.returncode != 1:
        refuse(refused, "these arguments run nothing: " + " ".join(options))
    if radii:
        tried = answer("-", "--format", "pdb", "--radii", radii, "--unknown-radius", "1", "--write",
                       "none", "--quiet", atoms=ONE_ATOM)
        if tried.returncode != 0:
            refuse(tried)
    # A block for every point gives more blocks than threads.
    asked = answer("-", "--format", "xyzr", "--write", "none", "--json", "--block-size", "2")
    if asked.returncode != 0:
        raise Failed(f"{program}: {asked.stderr.strip()}")
    return version, json.loads(asked.stdout)["threads"]


def check_folders(options):
    if not options.folder.is_dir():
        raise Failed(f"{options.folder}: "
                     + ("not a folder" if options.folder.exists() else "no such folder"))
    if options.output.resolve() == options.folder.resolve():
        raise Failed(f"{options.output} is the folder of the structures; results go elsewhere (-o)")


def lock(folder, is_task):
    """Keeps two runs from using one folder, except for tasks of one array. Held until the script
    ends."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, (fcntl.LOCK_SH if is_task else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        raise Failed(f"another run is working in {folder}") from None
    except OSError:
        pass  # some network file systems do not support locks


def require_pdb2pqr(job, todo):
    prepared = [structure for structure in todo if is_prepared(job, structure)]
    if prepared and pdb_to_pqr.find_program() is None:
        raise Failed(f"PDB2PQR is needed for PDB and mmCIF files ({prepared[0].path}"
                     + (f" and {len(prepared) - 1} more" if len(prepared) > 1 else "")
                     + f") and missing; install it with `apt-get install {pdb_to_pqr.PACKAGE}`, or "
                     "read them directly with --radii protor")


def end_in_order_on_signals():
    """Returns a list to which a signal's number is added. A second signal ends the script at
    once."""
    received = []

    def take(number, _):
        received.append(number)
        signal.signal(number, signal.SIG_DFL)

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:  # stays ignored, as under nohup
            signal.signal(number, take)
    return received


def find_all(options):
    def on_error(error):
        say(f"{error.filename}: {error.strerror}")

    def on_areas(path):
        print(f"{NAME}: {printable(path)} is left out: eses-blocks has written its areas", file=sys.stderr)

    structures = find_structures(options.folder.absolute(), options.output, options.only, on_error, on_areas)
    for structure in structures:
        folder = structure.id.partition("/")[0]
        if summary.is_name(folder):
            raise Failed(f"{structure.path}: its results would go to {options.output / folder}, "
                         "which is the name of a summary; rename it, or leave it out by --only")
    if not structures:
        like = "" if options.only == "*" else f" like {options.only}"
        raise Failed(f"{options.folder}: no structures{like} ({KINDS})")
    return structures


def share_of(structures, task, tasks):
    """Returns the share of a task. Every task gets large and small structures, in the same
    order."""
    by_weight = sorted(structures, key=lambda structure: (-weight(structure), structure.id))
    return sorted(by_weight[task - 1::tasks], key=lambda structure: structure.id)


def find_complete(job, structures):
    """Returns the statuses by id of the structures that need not be computed."""
    statuses = {}
    for structure in structures:
        folder = job.output / structure.id
        status = read_status(folder)
        if is_complete(folder, status, make_request(job, structure),
                       thumbnails.is_chosen(structure.id, job.pictures)):
            statuses[structure.id] = status
    return statuses


def radii_of(options):
    """Returns an absolute path if the radii are a file, because the program runs elsewhere."""
    path = pathlib.Path(options.radii or "")
    return str(path.absolute()) if options.radii and path.is_file() else options.radii


def run(options, arguments):
    """Returns the rows and path of the summary, the number that was complete before, and the
    signal."""
    check_folders(options)
    structures = find_all(options)
    if options.task:
        structures = share_of(structures, *options.task)
    version, threads = ask_program(options.program, arguments, radii_of(options))
    require_writable(options.output)
    path = options.output / (summary.share_name(*options.task) if options.task else summary.NAME)
    require_output(path)
    lock(options.output, options.task)

    received = end_in_order_on_signals()
    job = Job(str(options.program), version, arguments, options.output.absolute(),
              options.keep, radii_of(options), options.pictures, Children())
    statuses = find_complete(job, structures)
    before = len(statuses)
    todo = [structure for structure in structures if structure.id not in statuses]
    require_pdb2pqr(job, todo)
    if any(thumbnails.is_chosen(structure.id, job.pictures) for structure in todo):
        thumbnails.require_renderer()
    threads = options.threads or threads
    statuses.update(compute_all(job, todo, min(options.jobs or threads, max(1, len(todo))),
                                threads, received))
    root = options.folder.absolute()
    rows = [summary.row(structure.id, structure.path.relative_to(root), radii_text(job, structure),
                        statuses.get(structure.id)) for structure in structures]
    summary.write(path, rows)
    if options.report:
        write_report(path, rows)
    return rows, path, before, received


def write_report(path, rows):
    """Writes the page of a summary, with the pictures in the folders of the structures."""
    found = {row["id"]: path.parent / row["id"] / PICTURE for row in rows}
    pictures = {name: thumbnails.uri(picture) for name, picture in found.items()
                if picture.is_file()}
    report.write_page(path.with_suffix(".html"), rows, summary.COLUMNS,
                      f"Surfaces of {path.absolute().parent.name}", pictures)


def main():
    if sys.argv[1:2] == ["merge"]:
        parser = Parser(description="Joins the summaries of the tasks of a job array.",
                        prog=f"{NAME} merge")
        parser.add_argument("output", metavar="OUT", type=pathlib.Path)
        parser.add_argument("--report", action="store_true",
                            help="write a page with failures, plots and a table, OUT/summary.html")
        options = parser.parse_args(sys.argv[2:])
        rows, path = summary.merge(options.output)
        if options.report:
            write_report(path, rows)
        note, received = "", []
    else:
        rows, path, before, received = run(*parse_options())
        note = f"; {before} were complete before" if before else ""
    print(f"{summary.counts_text(rows)}{note}; {printable(path)}")
    if received:
        say("interrupted; the same command goes on from here")
        sys.exit(128 + received[0])
    sys.exit(any(row["status"] != "done" for row in rows))


def start():
    end_with(main)
