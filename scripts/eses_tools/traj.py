"""Measures the surface of a molecule in the frames of a trajectory.

FILES are the trajectories and, behind them, the topology: run.xtc top.pdb. A topology that is no
trajectory may also come first, and one file may be both. MDAnalysis reads all its formats. Areas are
in square angstrom, volumes in cubic angstrom, times in picoseconds. Areas and volumes are exact for
the spheres of the atoms; there is no grid.

--select chooses the atoms that make up the surface, and --report those whose areas are written,
while all others block: --select "not resname SOL" --report protein. Both use MDAnalysis's language and
are evaluated in the first frame. Molecules must not be divided by the periodic box.

--pockets adds the number and the volume of pockets, which come from a grid. --at PLACE takes only those
at a ligand (--at ligand:STI), which is left out of the surface, at the atoms of a selection, or in molecules
that have been fitted to each other at a point (--at=X,Y,Z) or in a box (--at=X0,Y0,Z0,X1,Y1,Z1).

The same command goes on where an interrupted one has stopped: finished frames wait in the hidden file
.TABLE.frames beside the table.
"""

import os
import sys

from eses_tools import quiet_interrupt  # before the modules that take time to load

import argparse
import collections
import concurrent.futures
import contextlib
import csv
import fcntl
import importlib
import io
import json
import math
import pathlib
import re
import shutil
import time
import warnings

from eses_tools.common import (IS_INSTALLED, NAME, PROJECT, Failed, Parser, at_least, complete_file, counted, end_with,
                               imported, input_file, positive, printable, require_kind, require_output, say, show)
from eses_tools import measuring

LEVELS = ("frame", "chain", "residue")
MAX_VALUES = 2_000_000  # atoms by frames that are measured at a time
FRAMES_OF_THREAD = 4  # that are measured at a time
DECIMALS = {"relative_sas": 4, "pockets": 0}  # of columns; 3 for others

# group, radii: the atoms that make up the surface. row: the row of each of these atoms in a frame; `rows`, the
# number of rows, for atoms that are not reported. labels: by row. maximum: the area that a relative area of 1
# stands for, by row. is_polar: by atom. find_pockets: see pocket_finder, None without --pockets. note: for the user.
Plan = collections.namedtuple("Plan", "group radii row labels rows maximum is_polar columns find_pockets note")


# --------------------------------------------------------------------------------------- reading


def divide(files, parsers, guess_format):
    """Returns the topology and the trajectories. `parsers` has the formats of topologies."""
    for at in (-1, 0):
        try:
            is_topology = guess_format(files[at]) in parsers
        except ValueError:  # an unknown suffix
            is_topology = False
        if is_topology:
            return files[at], files[:-1] if at else files[1:]
    raise Failed(f"{files[-1]}: its suffix is that of no topology; give trajectories and then a topology, such as a "
                 "PDB file")


def open_universe(files):
    mda = imported("MDAnalysis", "install it, for example with pip install MDAnalysis")
    for path in files:
        open(path, "rb").close()  # an error with the name of the file
    topology, trajectories = divide(files, mda._PARSERS,  # pylint: disable=protected-access
                                    importlib.import_module("MDAnalysis.lib.util").guess_format)
    try:
        return mda.Universe(topology, *trajectories)
    except Exception as error:  # pylint: disable=broad-except  # any parser's
        raise Failed(f"MDAnalysis cannot read {' '.join(map(printable, files))}: {printable(error)}") from None


def chosen(atoms, option, text):
    try:
        group = atoms.select_atoms(text)
    except Exception as error:  # pylint: disable=broad-except  # its parser raises several
        raise Failed(f"{option} {printable(text)}: {printable(error)}") from None
    if not len(group):
        raise Failed(f"{option} {printable(text)}: no atoms")
    return group


def go_to(universe, frame):
    try:
        return universe.trajectory[frame]
    except (EOFError, IndexError, OSError, ValueError) as error:
        raise Failed(f"{universe.trajectory.filename}: frame {frame} cannot be read: {printable(error)}") from None


def warn_if_divided(numpy, universe, atoms, measured):
    """Warns if successive atoms of a protein's chain are on opposite sides of the periodic box."""
    box = universe.dimensions
    if box is None or not min(box[:3]) > 0:
        return
    table = measured.atoms
    is_protein = numpy.isfinite(table["radius"]) & numpy.isin(atoms.ix, atoms.select_atoms("protein").ix)
    at = numpy.flatnonzero(is_protein)
    steps = numpy.linalg.norm(numpy.diff(atoms.positions[at], axis=0), axis=1)
    is_cut = (table["chain"][at][1:] == table["chain"][at][:-1]) & (steps > min(box[:3]) / 2)
    if is_cut.any():
        i = at[1:][is_cut][0]
        say(f"warning: the periodic box divides a molecule at {table['residue'][i]} "
            f"{table['residue_number'][i]} of chain {table['chain'][i] or '(none)'}; make molecules whole first, "
            "for example with gmx trjconv -pbc mol")


def warn_if_nothing_else_blocks(universe, group, measured, options):
    """Warns if --select leaves out all atoms other than those of --report."""
    others = universe.atoms - group
    if options.report is None or not len(others) or not len(others.residues):
        return
    table = measured.atoms
    if (table["sas"] == table["sas"])[measured.molecule.kept].all():
        listed = importlib.import_module("eses_blocks._select").listed
        say(f"warning: --report {printable(options.report)} has all atoms of --select {printable(options.select)}, so that "
            f"nothing else blocks; the residues of other atoms are {printable(listed(others.residues.resnames))}")


# ------------------------------------------------------------------------------------------- plan


def rows_of(numpy, table, level):
    """Returns names of the label columns, the label of each row, and the row of each atom."""
    names = {"frame": (), "chain": ("chain",), "residue": ("chain", "residue_number", "icode", "residue")}[level]
    labels = list(zip(*(table[name].tolist() for name in names))) if names else [()] * len(table)
    if level != "residue":  # a chain may be in several places
        places = {}
        row = [places.setdefault(label, len(places)) for label in labels]
        return names, list(places), numpy.array(row)
    is_first = numpy.array([i == 0 or labels[i] != labels[i - 1] for i in range(len(labels))])
    return names, [labels[i] for i in numpy.flatnonzero(is_first)], numpy.cumsum(is_first) - 1


def make_plan(eses, universe, frames, options):
    import numpy  # pylint: disable=import-outside-toplevel
    go_to(universe, frames[0])
    group = chosen(universe.atoms, "--select", options.select)
    report = None if options.report is None else numpy.isin(
        group.ix, chosen(group, "--report", options.report).ix)
    try:
        measured = eses.measure(group, options.radii, report=report, waters=options.waters,
                                hydrogens=options.hydrogens, unknown_radius=options.unknown_radius,
                                probe_radius=options.probe_radius, threads=options.threads)
    except (ImportError, OSError, ValueError) as error:  # with options in place of the arguments of Python
        raise Failed(re.sub("use unknown_radius=.*", "use --unknown-radius or another set (--radii)", printable(error))) from None
    warn_if_divided(numpy, universe, group, measured)
    warn_if_nothing_else_blocks(universe, group, measured, options)
    table, kept = measured.atoms, measured.molecule.kept
    names, labels, row = rows_of(numpy, table, options.level)
    starts = numpy.unique(row, return_index=True)[1]
    # Rows without a reported atom are left out.
    is_reported = numpy.isfinite(table["sas"])
    used = numpy.unique(row[is_reported])
    number = numpy.full(len(labels), len(used))
    number[used] = numpy.arange(len(used))
    labels = [labels[i] for i in used]
    row = numpy.where(is_reported, number[row], len(used))[kept]
    columns = [*names, *(["ses"] if options.surface != "sas" else []),
               *(["sas", "sas_polar", "sas_apolar"] if options.surface != "ses" else [])]
    maximum = None
    if options.level == "residue" and options.surface != "ses":
        columns.append("relative_sas")
        reference = importlib.import_module("eses_blocks._references").REFERENCES[options.reference]
        atoms = numpy.split(table["name"], starts[1:])
        maximum = numpy.array([reference.maximum(label[3], atoms[i]) for i, label in zip(used, labels)])
    elif options.level == "frame" and report is None:  # volumes are those of all atoms
        columns += [name for name in ("ses_volume", "sas_volume") if options.surface in ("all", name[:3])]
    find_pockets = None
    if options.pockets:
        columns += ["pockets", "pocket_volume", *(["volume_at_place"] if options.at else [])]
        find_pockets = pocket_finder(numpy, eses, measured, options)
    return Plan(group[kept], measured.molecule.radii, row, labels, len(labels), maximum, table["is_polar"][kept],
                columns, find_pockets, description(measured))


def pocket_finder(numpy, eses, measured, options):
    """Returns a function that returns the columns of the pockets for the centres of the atoms in a frame."""
    place, is_ligand, marks = {}, False, None
    numbers = numbers_of(options.at)
    if len(numbers) > 1:
        place["at"] = numbers if len(numbers) == 3 else (numbers[:3], numbers[3:])
    elif options.at:
        try:
            marks, is_ligand = importlib.import_module("eses_blocks._places").atoms_of_selection(measured.surface, options.at)
        except ValueError as error:
            raise Failed(f"--{printable(error)}") from None
    radii = measured.molecule.radii
    others = numpy.flatnonzero(~marks) if is_ligand else numpy.arange(len(radii))
    if not len(others):
        raise Failed(f"--at {printable(options.at)}: there are no other atoms")
    if marks is not None and not is_ligand:
        place["atoms"] = numpy.flatnonzero(marks)
    try:  # fails for wrong options, before frames are measured
        eses.Surface([[0, 0, 0]], [1], options.probe_radius).pockets(
            options.large_probe, spacing=options.spacing, min_volume=options.min_pocket_volume)
    except ValueError as error:
        raise Failed(printable(error)) from None

    def find(centers):
        surface = eses.Surface(centers[others], radii[others], options.probe_radius, threads=options.threads)
        balls = {"balls": (centers[marks], radii[marks])} if is_ligand else {}
        found = surface.pockets(options.large_probe, spacing=options.spacing, min_volume=options.min_pocket_volume,
                                threads=options.threads, **place, **balls)
        values = {"pockets": len(found), "pocket_volume": sum(each["volume"] for each in found)}
        if options.at:
            values["volume_at_place"] = sum(each["volume_at_place"] for each in found)
        return values

    return find


def description(measured):
    notes = [f"radii {measured.radii.name}"]
    if len(measured.radii.guessed):
        notes.append(f"{len(measured.radii.guessed)} radii or elements guessed")
    notes += [f"{counted(count, 'atom')} left out: {what}" for what, count in measured.left_out.items()]
    return f"{counted(len(measured.molecule.kept), 'atom')}; {'; '.join(notes)}"


# ------------------------------------------------------------------------------------- measuring


def read_frames(universe, plan, numbers):
    """Returns times and centres of the frames with these numbers."""
    times, centers = [], []
    for number in numbers:
        times.append(go_to(universe, number).time)
        centers.append(plan.group.positions.astype(float))
    return times, centers


def sums_of(plan, areas):
    """Returns the sums of the areas of kept atoms by row."""
    import numpy  # pylint: disable=import-outside-toplevel
    return numpy.bincount(plan.row, areas, plan.rows + 1)[:plan.rows]


def number_text(value, decimals=3):
    return "" if value != value else f"{value:.{decimals}f}"


def measure(eses, plan, numbers, times, centers, options):
    """Returns the lines of these frames."""
    try:
        measures = eses.measure_frames(centers, plan.radii, options.probe_radius, ses=options.surface != "sas",
                                       by_atom=True, threads=options.threads)
        pockets = [plan.find_pockets(each) for each in centers] if plan.find_pockets else []
    except ValueError as error:
        which = f"frame {numbers[0]}" if len(numbers) == 1 else f"frames {numbers[0]} to {numbers[-1]}"
        raise Failed(f"{which}: {printable(error)}") from None
    text = io.StringIO()
    target = csv.writer(text, lineterminator="\n")
    for i, (number, when) in enumerate(zip(numbers, times)):
        values = {}
        if options.surface != "sas":
            values["ses"] = sums_of(plan, measures.by_atom.ses[i])
            values["ses_volume"] = [measures.ses_volume[i]]
        if options.surface != "ses":
            sas = measures.by_atom.sas[i]
            values["sas"], values["sas_volume"] = sums_of(plan, sas), [measures.sas_volume[i]]
            values["sas_polar"] = sums_of(plan, sas * plan.is_polar)
            values["sas_apolar"] = sums_of(plan, sas * ~plan.is_polar)
        if plan.maximum is not None:
            values["relative_sas"] = values["sas"] / plan.maximum
        if pockets:
            values.update((name, [value]) for name, value in pockets[i].items())
        shown = [name for name in plan.columns if name in values]
        for label, *row in zip(plan.labels, *(values[name] for name in shown)):
            target.writerow([number, f"{when:.10g}", *label,
                             *(number_text(value, DECIMALS.get(name, 3)) for name, value in zip(shown, row))])
    return text.getvalue()


# ----------------------------------------------------------------------------------------- output


class FinishedFrames:
    """The lines of finished frames, which a later run finds. The first line tells what they belong to."""

    def __init__(self, table, identity, rows):
        self.path = table.with_name(f".{table.name}.frames")
        try:
            # A link would lead somewhere else.
            self.file = os.fdopen(os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666), "r+b")
        except OSError as error:
            raise Failed(f"{self.path}: {error.strerror}") from None
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise Failed(f"{self.path}: another {NAME} writes this table") from None
        self.count = self._keep_whole_frames(identity, rows)

    def _keep_whole_frames(self, identity, rows):
        """Returns the number of finished frames. Removes what is not a whole frame of this table."""
        first = json.dumps(identity, sort_keys=True).encode() + b"\n"
        self.start = len(first)
        if self.file.readline() != first:
            self.file.seek(0)
            self.file.truncate()
            self.file.write(first)
            self.file.flush()
            return 0
        lines, end, position = 0, self.start, self.start
        for line in self.file:
            position += len(line)
            if not line.endswith(b"\n"):
                break
            lines += 1
            if lines % rows == 0:
                end = position
        self.file.seek(end)
        self.file.truncate()
        return lines // rows

    def add(self, text):
        self.file.write(text.encode())
        self.file.flush()

    def write_table(self, name, header):
        os.fsync(self.file)
        self.file.seek(self.start)
        with complete_file(name, compressed=name.lower().endswith(".gz"), encoding="utf-8", newline="\n") as target:
            target.write(header)
            shutil.copyfileobj(io.TextIOWrapper(self.file, encoding="utf-8", newline="\n"), target)
        self.path.unlink(missing_ok=True)


class Directly:
    """Lines that go to standard output, a pipe or a device at once."""

    count = 0

    def __init__(self, target, header):
        self.target = target
        target.write(header)

    def add(self, text):
        self.target.write(text)
        self.target.flush()


@contextlib.contextmanager
def opened(options, identity, plan):
    """Opens the output, and completes it at the end."""
    header = ",".join(["frame", "time", *plan.columns]) + "\n"
    if options.output == "-" or (os.path.exists(options.output) and not os.path.isfile(options.output)):
        with complete_file(options.output, encoding="utf-8", newline="\n") as target:
            yield Directly(target, header)
        return
    finished = FinishedFrames(pathlib.Path(os.path.realpath(options.output)), identity, plan.rows)
    with finished.file:
        yield finished
        finished.write_table(options.output, header)


def inputs_of(options):
    return [*options.files, *([options.radii] if options.radii and os.path.exists(options.radii) else [])]


def identity_of(version, frames, options):
    """Returns everything on which the table depends."""
    return {"version": version, "frames": [frames.start, frames.stop, frames.step],
            "files": [[os.path.realpath(path), os.stat(path).st_size, os.stat(path).st_mtime_ns]
                      for path in inputs_of(options)],
            "options": {name: value for name, value in vars(options).items()
                        if name not in ("files", "output", "threads", "start", "stop", "stride")}}


# ------------------------------------------------------------------------------------ command line


def numbers_of(text):
    """Returns the numbers of a point or box; nothing for another text."""
    try:
        return [float(field) for field in (text or "").split(",")]
    except ValueError:
        return []


def place(text):
    numbers = numbers_of(text)
    is_box = len(numbers) == 6 and all(low < high for low, high in zip(numbers, numbers[3:]))
    if not text or (numbers and not (all(map(math.isfinite, numbers)) and (len(numbers) in (1, 3) or is_box))):
        raise argparse.ArgumentTypeError("expected a selection, three numbers X,Y,Z, or six of the lowest and highest corner")
    return text


def parse_options():
    parser = Parser(__doc__, usage=f"{NAME} [OPTION...] FILES -o TABLE.csv",
                    advanced=("--large-probe", "--spacing", "--min-pocket-volume", "--unknown-radius", "--reference"),
                    examples=(("run.xtc top.pdb -o areas.csv", "a row for each frame"),
                              ("run.xtc top.pdb --level residue --stride 10 -o r.csv.gz", "residues of every tenth frame"),
                              ("run.xtc top.pdb --pockets --at ligand:STI -o p.csv", "the pocket of a ligand")))
    parser.add_argument("files", metavar="FILES", nargs="+", type=lambda text: str(input_file(text)), help="trajectories and topology")
    parser.add_argument("-o", "--output", required=True, metavar="TABLE.csv",
                        help="table to write, gzipped if it ends in .gz; - for standard output")
    parser.add_argument("--level", choices=LEVELS, default="frame",
                        help="what a row is, in each frame: the molecule (frame, the default), a chain or a residue")
    parser.add_argument("--surface", choices=("all", "ses", "sas"), default="all",
                        help="surfaces that are measured; sas takes a third of the time (default: all)")
    parser.add_argument("--select", default="all", metavar="SELECTION",
                        help="atoms that make up the surface (default: all)")
    parser.add_argument("--report", metavar="SELECTION",
                        help="atoms of --select whose areas are written (default: all)")
    parser.add_argument("--pockets", action="store_true", help="also find pockets, in rows of frames")
    parser.add_argument("--at", type=place, metavar="PLACE",
                        help="only pockets at ligand:NAME, atoms of a selection, a point or a box")
    parser.add_argument("--large-probe", type=at_least(0), default=3.0, metavar="A",
                        help="radius of the probe that closes pockets (default: 3)")
    parser.add_argument("--spacing", type=at_least(0), default=0.4, metavar="A",
                        help="distance of the grid points for pockets (default: 0.4)")
    parser.add_argument("--min-pocket-volume", type=at_least(0), metavar="VOLUME",
                        help="leave out smaller pockets (default: twice the volume of the probe)")
    parser.add_argument("--start", type=int, metavar="N", help="first frame, from 0; -10 is the tenth from the end")
    parser.add_argument("--stop", type=int, metavar="N", help="frame before which to stop (default: the end)")
    parser.add_argument("--stride", type=positive, default=1, metavar="N", help="take every N-th frame (default: 1)")
    parser.add_argument("--radii", metavar="SET",
                        help="protor, protor+ccd, bondi, msms, naccess or oons, each also with +shannon, or a file in "
                             "FreeSASA's format (default: protor, or bondi without names of residues)")
    parser.add_argument("--unknown-radius", type=at_least(0), metavar="A",
                        help="radius of atoms without one in the set")
    parser.add_argument("--probe-radius", type=at_least(0), default=1.4, metavar="A",
                        help="radius of the probe (default: 1.4)")
    parser.add_argument("--waters", action="store_true", help="keep waters")
    parser.add_argument("--hydrogens", choices=("auto", "keep", "drop"), default="auto",
                        help="auto (the default) drops hydrogens if the radii are those of united atoms")
    parser.add_argument("--reference", choices=("tien", "miller", "sander"), default="tien",
                        help="maximum areas for relative_sas (default: tien)")
    parser.add_argument("--threads", type=positive, default=0, metavar="N", help="number of threads (default: all)")
    options = parser.parse_args()
    require_kind(parser, pathlib.Path(options.output), "a table", ".csv", ".txt")
    if options.at and not options.pockets:
        parser.error("--at needs --pockets")
    if options.pockets and options.level != "frame":
        parser.error("--pockets needs --level frame")
    return options


def show_warning(message, category, filename, *_):
    """Prints warnings of this project on one line. MDAnalysis has many that do not matter here."""
    del category
    if "MDAnalysis" not in filename:
        say(f"warning: {printable(message)}")


def measure_all(eses, universe, plan, frames, options, finished):
    """Measures the frames that are left. Reads the next ones meanwhile."""
    threads = options.threads or measuring.processor_count()
    batch = max(1, min(FRAMES_OF_THREAD * threads, MAX_VALUES // len(plan.radii)))
    if plan.find_pockets:
        batch = 1  # a frame takes long
    begin, start = finished.count, time.monotonic()
    done, waiting = begin, None

    def finish(future):
        nonlocal done
        text, count = future.result(), plan.rows
        finished.add(text)
        done += text.count("\n") // count
        left = (time.monotonic() - start) / (done - begin) * (len(frames) - done)
        show(f"{done} of {len(frames)} frames, about {left:.0f} s left")

    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        for at in range(begin, len(frames), batch):
            numbers = frames[at:at + batch]
            times, centers = read_frames(universe, plan, numbers)
            if waiting:
                finish(waiting)
            waiting = pool.submit(measure, eses, plan, numbers, times, centers, options)
        if waiting:
            finish(waiting)
    show("")


def main():
    options = parse_options()
    require_output(options.output, inputs_of(options))
    if not IS_INSTALLED:
        sys.path.append(str(PROJECT / "build/python"))
    warnings.showwarning = show_warning
    warnings.filterwarnings("ignore", "Reader has no dt")  # of single frames
    eses = imported("eses_blocks", "install it with pip install eses-blocks")
    universe = open_universe(options.files)
    frames = range(universe.trajectory.n_frames)[slice(options.start, options.stop, options.stride)]
    if not frames:
        raise Failed(f"no frames are chosen; there are {universe.trajectory.n_frames}")
    plan = make_plan(eses, universe, frames, options)
    with opened(options, identity_of(eses.__version__, frames, options), plan) as finished:
        say(plan.note)
        if finished.count:
            say(f"{counted(finished.count, 'frame')} finished before")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # those of the first frame have been printed
            measure_all(eses, universe, plan, frames, options, finished)
    say(f"{counted(len(frames), 'frame')}, {counted(plan.rows * len(frames), 'row')}")


def start():
    end_with(main)
