"""Reads and writes the summary of many structures as CSV, with the columns of the paper's table."""

import collections
import csv
import re

from eses_tools.common import Failed, complete_file, printable

NAME = "summary.csv"
AREAS = {f"{kind}_area": kind for kind in ("convex", "saddle", "concave")}
COLUMNS = ("id", "input", "radii", "atoms", "nx", "ny", "nz", "bx", "by", "bz", "area", *AREAS,
           "volume", "divergence_volume", "exact_area", "exact_volume", "seconds", "peak_bytes",
           "threads", "status", "message")


def row(name, path, radii, status):
    """Returns the row of a structure with this status; None if it has not been computed."""
    result = {"id": name, "input": path, "radii": radii, "status": "pending"}
    if status:
        result.update(status=status["status"], message=printable(status["message"]))
    if result["status"] == "done":
        report = status["report"]
        result.update(zip(("nx", "ny", "nz"), report["grid"]["size"]))
        result.update(zip(("bx", "by", "bz"), report["blocks"]["along_axes"]))
        result.update({column: report["area_by_kind"][kind] for column, kind in AREAS.items()})
        result.update({key: report[key] for key in
                       ("atoms", "area", "volume", "divergence_volume", "exact_area",
                        "exact_volume", "threads")},
                      seconds=round(status["seconds"], 4), peak_bytes=report["peak_memory_bytes"])
    return result


def write(path, rows, columns=COLUMNS):
    # Names of files are bytes and not always text, so they are written unchanged.
    with complete_file(path, encoding="utf-8", errors="surrogateescape", newline="") as target:
        writer = csv.DictWriter(target, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def read(path, needed=COLUMNS):
    """Returns the rows, with all values as text.

    Throws Failed if a needed column is missing, or if a row has more or fewer fields than the
    header.
    """
    rows = []
    with open(path, encoding="utf-8", errors="surrogateescape", newline="") as source:
        reader = csv.reader(source)
        try:
            header = next(reader, [])
            for name in needed:
                if name not in header:
                    raise Failed(f"{path}: no summary of pdbbind, as there is no column {name!r}")
            for fields in reader:
                if fields and len(fields) != len(header):
                    raise Failed(f"{path}:{reader.line_num}: expected {len(header)} fields, as in "
                                 f"the header, found {len(fields)}")
                if fields:
                    rows.append(dict(zip(header, fields)))
        except csv.Error as error:
            raise Failed(f"{path}:{reader.line_num}: {error}") from None
    return rows


def counts_text(rows):
    counts = collections.Counter(row["status"] for row in rows)
    parts = ", ".join(f"{counts[status]} {status}" for status in ("done", "failed", "pending")
                      if counts[status] or status == "done")
    return f"{len(rows)} structure{'s' if len(rows) != 1 else ''}: {parts}"


# ---------------------------------------------------------------------------------- job arrays


def share_name(task, tasks):
    return f"summary-{task}-of-{tasks}.csv"


def share_in(name):
    """Returns the task and the number of tasks in the name of a share, or None for other names."""
    match = re.fullmatch(r"summary-(\d+)-of-(\d+)\.csv", name)
    return match and (int(match[1]), int(match[2]))


def is_name(name):
    """Whether this is the name of a summary, of all structures or of a share."""
    return name == NAME or share_in(name) is not None


def share_paths(folder):
    """Returns the shares of all tasks in order. Throws Failed if there are none, too few or too
    many."""
    shares = {}
    for path in folder.iterdir():
        if share := share_in(path.name):
            shares.setdefault(share[1], set()).add(share[0])
    if not shares:
        raise Failed(f"{folder}: no summaries of tasks, {share_name('I', 'N')}")
    if len(shares) > 1:
        counts = " and ".join(map(str, sorted(shares)))
        raise Failed(f"{folder}: summaries of {counts} tasks; remove those that are old")
    (tasks, found), = shares.items()
    missing = sorted(set(range(1, tasks + 1)) - found)
    if missing:
        raise Failed(f"{folder}: no summary yet of task " + ", ".join(map(str, missing))
                     + f" of {tasks}")
    return [folder / share_name(task, tasks) for task in range(1, tasks + 1)]


def merge(folder):
    """Joins the summaries of all tasks into one. Returns its rows and its path."""
    rows = sorted((row for path in share_paths(folder) for row in read(path)),
                  key=lambda row: row["id"])
    for one, next_one in zip(rows, rows[1:]):
        if one["id"] == next_one["id"]:
            raise Failed(f"{folder}: {printable(one['id'])} is in the summaries of two tasks: the "
                         "structures have changed in between; run all tasks again")
    write(folder / NAME, rows)
    return rows, folder / NAME
