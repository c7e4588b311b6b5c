"""Computes the surface of one structure for pdbbind: prepares its atoms, runs eses-blocks, and keeps a status."""

import collections
import fcntl
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import threading
import time

from eses_tools.common import Failed, complete_file, file_argument, unpacked
from eses_tools import measuring, pdb_to_pqr, summary, thumbnails

# The files that --keep leaves, as values of eses-blocks --write.
WRITE = {"none": "none", "edges": "edges,areas", "all": "grid,edges,areas"}

TEXT_FILES = ("bounding_box.txt", "grid_info.txt", "intersection_info.txt", "partition_area.txt")
RESULTS = (*TEXT_FILES, *(name + ".gz" for name in TEXT_FILES))  # compressed ones with -- --gzip
STATUS = "status.json"
LOG = "pdb2pqr.log"
ATOMS = "atoms.pqr"  # the atoms that PDB2PQR has made
PICTURE = "surface.png"
SCRATCH = ".work-"
PROGRAM_LOCK = ".eses-blocks.lock"


class Stopped(Exception):
    """The run is being ended. Incomplete structures are computed the next time."""


# The settings of all structures. Paths are absolute, so they do not begin with a dash.
# radii: a set of eses-blocks --radii, or None if PDB2PQR prepares PDB and mmCIF files. pictures:
# patterns of the ids of structures that are drawn.
Job = collections.namedtuple("Job", "program version options output keep radii pictures children")


# ----------------------------------------------------------------------------------- processes


class Children:
    """The processes started by several threads, which can be ended together."""

    def __init__(self):
        self.lock = threading.Lock()
        self.running = set()
        self.stopped = False

    def run(self, command, **how):
        """Returns exit code and wall seconds. Throws Stopped if the process was stopped."""
        with self.lock:
            if self.stopped:
                raise Stopped
            start = time.perf_counter()
            # The child gets its own session, so that Ctrl-C reaches only this script, which passes
            # it on.
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, start_new_session=True,
                                       **how)
            self.running.add(process)
        code = process.wait()
        seconds = time.perf_counter() - start
        with self.lock:
            self.running.remove(process)
        if self.stopped and code != 0:
            raise Stopped
        return code, seconds

    def stop(self):
        with self.lock:
            self.stopped = True
            for process in self.running:
                try:
                    os.killpg(process.pid, signal.SIGTERM)
                except ProcessLookupError:
                    pass


# --------------------------------------------------------------------------- status of a structure


def make_request(job, structure):
    """Returns everything that a result depends on. While it is unchanged, a complete result is
    kept."""
    return {"input": {"name": structure.path.name, "bytes": structure.bytes,
                      "mtime_ns": structure.mtime_ns},
            "options": job.options, "keep": job.keep, "version": job.version,
            **({"radii": job.radii} if is_read_directly(job, structure) else {})}


def has_radii(structure):
    """Whether the file itself has radii."""
    return structure.layout not in ("pdb", "mmcif")


def is_prepared(job, structure):
    """Whether PDB2PQR makes the atoms of this structure."""
    return not has_radii(structure) and job.radii is None


def is_read_directly(job, structure):
    """Whether eses-blocks reads this structure and assigns radii."""
    return not has_radii(structure) and job.radii is not None


def radii_text(job, structure):
    """Returns the radii of a structure as in the table."""
    return "file" if has_radii(structure) else job.radii or pdb_to_pqr.RADII


def read_status(folder):
    """Returns the saved status, or {} if there is none that can be used."""
    try:
        status = json.loads((folder / STATUS).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return status if is_usable(status) else {}


def is_usable(status):
    """Whether a status has the needed entries with values of the right types.

    A user may have edited the file.
    """
    if not isinstance(status, dict):
        return False
    prepared = status.get("prepared", {})
    if not isinstance(prepared, dict) or not isinstance(prepared.get("remark", ""), str):
        return False
    if status.get("status") != "done":
        return True
    try:
        summary.row("", "", "", status)
    except (KeyError, TypeError):
        return False
    return isinstance(status.get("files"), dict)


def write_status(folder, status):
    with complete_file(folder / STATUS, encoding="utf-8") as target:
        json.dump(status, target, indent=1)
        target.write("\n")


def sizes(folder, names):
    return {name: (folder / name).stat().st_size for name in names}


def is_complete(folder, status, request, needs_picture):
    """Whether the structure is done with these settings and all its files exist."""
    if status.get("status") != "done" or status.get("request") != request:
        return False
    if needs_picture and PICTURE not in status["files"]:
        return False
    try:
        return sizes(folder, status["files"]) == status["files"]
    except (OSError, ValueError):  # ValueError: null character in a name
        return False


def refuse_if_locked(folder):
    """Fails if a program from a killed run is still writing. It holds the lock of its files."""
    try:
        descriptor = os.open(folder / PROGRAM_LOCK, os.O_RDONLY)
    except FileNotFoundError:
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        raise Failed(f"another run is writing into {folder}") from None
    except OSError:
        pass  # some network file systems do not support locks
    finally:
        os.close(descriptor)


def clear(folder):
    """Removes the files of an earlier run, and first the status that says that they are complete.

    The prepared atoms stay, because prepare() may use them again.
    """
    refuse_if_locked(folder)
    (folder / STATUS).unlink(missing_ok=True)
    for path in folder.iterdir():
        if path.name.startswith(SCRATCH):
            shutil.rmtree(path)
        elif path.name.startswith(".") and path.name.endswith(".part"):
            path.unlink()
    for name in (*RESULTS, PICTURE):
        (folder / name).unlink(missing_ok=True)


# ------------------------------------------------------------------------------- one structure


def run_pdb2pqr(job, structure, folder, scratch):
    """Runs PDB2PQR, with its log in the folder. Returns atoms, seconds and remark."""
    pdb_to_pqr.write_protein(structure.path, structure.layout, scratch / "protein.pdb")
    command = [pdb_to_pqr.find_program(), *pdb_to_pqr.OPTIONS, "protein.pdb", ATOMS]
    with open(folder / LOG, "w", encoding="utf-8") as log:
        code, seconds = job.children.run(command, cwd=scratch, stdout=log, stderr=log)
    log = (folder / LOG).read_text(encoding="utf-8", errors="replace")
    if code != 0 or not (scratch / ATOMS).exists():
        raise Failed(f"PDB2PQR: {pdb_to_pqr.failure(log)} (see {folder / LOG})")
    return scratch / ATOMS, seconds, pdb_to_pqr.remark(log)


def prepare(job, structure, request, before, folder, scratch):
    """Returns the input of eses-blocks, and its part of the status; {} if nothing was prepared."""
    made_from = [request["input"], pdb_to_pqr.OPTIONS]
    made = before.get("prepared", {})
    if (is_prepared(job, structure) and made.get("from") == made_from
            and (folder / ATOMS).exists()):
        return folder / ATOMS, made  # the same atoms with other options: PDB2PQR is slow
    for name in (ATOMS, LOG):
        (folder / name).unlink(missing_ok=True)
    if is_read_directly(job, structure):
        return structure.path, {}
    if not is_prepared(job, structure):
        return unpacked(structure.path, scratch), {}
    atoms, seconds, remark = run_pdb2pqr(job, structure, folder, scratch)
    return (atoms.replace(folder / ATOMS),
            {"from": made_from, "seconds": seconds, "remark": remark})


def command_for(job, structure, atoms, threads):
    """Returns the command of eses-blocks for a structure, without its outputs."""
    command = [job.program, file_argument(atoms), *job.options, "--threads", str(threads),
               "--independent",  # srun may start several tasks, each with its share
               "--format", "pqr" if is_prepared(job, structure) else structure.layout]
    return command + (["--radii", job.radii] if is_read_directly(job, structure) else [])


def solve(job, structure, atoms, threads, folder, scratch):
    """Runs eses-blocks. Returns its report, wall seconds and warnings."""
    command = [*command_for(job, structure, atoms, threads), "--write", WRITE[job.keep],
               "--output-dir", str(folder), "--json"]
    with open(scratch / "report", "w+b") as report:
        code, warnings, seconds = measuring.run_quietly(command, report, job.children.run)
        if code != 0:
            warnings = warnings.replace(str(atoms), str(structure.path))
            raise Failed(warnings or f"eses-blocks: exit code {code}")
        report.seek(0)
        return json.load(report), seconds, warnings


def prepare_and_solve(job, structure, threads, folder, status):
    """Computes a structure and adds the result to its status. Throws on errors."""
    folder.mkdir(parents=True, exist_ok=True)
    before = read_status(folder)
    clear(folder)
    with tempfile.TemporaryDirectory(prefix=SCRATCH, dir=folder) as name:
        scratch = pathlib.Path(name)
        atoms, prepared = prepare(job, structure, status["request"], before, folder, scratch)
        if prepared:
            status["prepared"] = prepared
        report, seconds, warnings = solve(job, structure, atoms, threads, folder, scratch)
        kept, remarks = report["output"]["files"], [prepared.get("remark"), warnings]
        if thumbnails.is_chosen(structure.id, job.pictures):
            try:
                thumbnails.draw(job.children.run, command_for(job, structure, atoms, threads),
                                scratch, folder / PICTURE)
                kept = [*kept, PICTURE]
            except Failed as error:
                remarks.append(str(error))
    if job.keep == "none":
        (folder / ATOMS).unlink(missing_ok=True)
    elif prepared:
        kept = [*kept, ATOMS]
    status.update(status="done", message="; ".join(text for text in remarks if text),
                  seconds=seconds, files=sizes(folder, kept), report=report)


def compute(job, structure, threads):
    """Computes a structure. Writes results and status into its folder, and returns the status."""
    folder = job.output / structure.id
    status = {"id": structure.id, "status": "failed", "request": make_request(job, structure)}
    try:
        prepare_and_solve(job, structure, threads, folder, status)
    except Failed as error:
        status["message"] = str(error)
    except OSError as error:
        status["message"] = f"{error.filename or structure.path}: {error.strerror or error}"
    except ValueError as error:  # the report is not JSON
        status["message"] = f"{structure.path}: {error}"
    try:
        write_status(folder, status)
    except OSError as error:
        # The most likely reason is a full disk. Without a status the structure is computed the next
        # time.
        status.update(status="failed", message=f"{error.filename}: {error.strerror}")
    return status
