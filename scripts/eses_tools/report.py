"""Writes a page with the results of many structures: failures, pictures, plots, and a table.

TABLE is a table of eses-blocks measure --csv, the lines of its --json, or a summary of
eses-pdbbind; it may be compressed (.gz). The page needs no network and no other file. Its table
sorts and filters, and its plots show times, areas and volumes against the number of atoms.

Structures that measure has refused are not in its table. --messages reads its standard error:
eses-blocks measure --csv all.csv *.pdb 2> errors.txt; report all.csv --messages errors.txt -o
all.html. --pictures draws structures from the files that the table names. Arguments after -- choose
how eses-blocks reads them, such as -- --radii bondi.
"""

from eses_tools import quiet_interrupt  # before the modules that take time to load

import codecs
import csv
import gzip
import html
import io
import json
import math
import pathlib
import tempfile

from eses_tools.common import (NAME, Failed, Parser, complete_file, describe_build, end_with, files_among, gzip_errors,
                               input_file, printable, require_kind, require_output, say, show)
from eses_tools import measuring, page, thumbnails

ERROR = "eses-blocks: error: "  # begins the messages of files that measure has refused
MIN_SPACING = 0.4  # angstrom, of pictures
MAX_CELLS = 30000  # of the surface of a picture, which are squares of the spacing
OPTIONAL = ("model", "radii", "left_out")  # columns that most files leave empty

PARTS = pathlib.Path(__file__).resolve().parent / "pages/report"
TEXTS = ("id", "input", "file", "radii", "status", "message")  # other columns are numbers if possible
# Columns that are drawn against the number of atoms, if the table has them.
PLOTS = (("seconds", "time, s"), ("peak_bytes", "peak memory, bytes"), ("area", "area, Å²"),
         ("volume", "volume, Å³"), ("ses_area", "SES area, Å²"), ("sas_area", "SAS area, Å²"), ("ses_volume", "SES volume, Å³"))


# ---------------------------------------------------------------------------------------- page


def is_text(rows, name):
    """Whether a column is one of TEXTS or has values that are no numbers."""
    if name in TEXTS:
        return True
    try:
        for row in rows:
            float(row.get(name) or 0)
    except ValueError:
        return True
    return False


def value_of(row, name, texts):
    """Returns a value of a row, which may be text from a file, as JSON stores it. JSON has no NaN
    and no infinite numbers; they are left out."""
    value = row.get(name, "")
    if name in texts:
        return printable(value)
    number = math.nan if value in ("", None) else float(value)
    return number if math.isfinite(number) else ""


def make_report(rows, columns, title, pictures):
    """Returns the page. Each row is a dictionary; the first column names the structures, and
    `pictures` has addresses of pictures by these names."""
    texts = [name for name in columns if is_text(rows, name)]
    data = {"columns": columns, "texts": texts,
            "plots": [plot for plot in PLOTS if plot[0] in columns],
            "rows": [[value_of(row, name, texts) for name in columns] for row in rows],
            "pictures": {printable(name): address for name, address in pictures.items()}}
    return page.fill(PARTS, ("plots.js", "report.js"),
                     {"title": html.escape(title), "rows": page.script_text(data)})


def write_page(path, rows, columns, title, pictures):
    with complete_file(path, encoding="utf-8") as target:
        target.write(make_report(rows, columns, title, pictures))


# --------------------------------------------------------------------------------------- table


def read_text(path):
    data = path.read_bytes()
    with gzip_errors(path):
        data = gzip.decompress(data) if path.suffix.lower() == ".gz" else data
    # Spreadsheets and PowerShell begin a text with its byte order mark.
    is_wide = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    return data.decode("utf-16" if is_wide else "utf-8-sig", "replace")


def flat(record):
    """Returns the columns of measure --csv of an object of measure --json."""
    row = {name: value for name, value in record.items()
           if isinstance(value, (str, int, float)) and not isinstance(value, bool)}
    kinds = record.get("ses_area_by_kind", {})
    return {**row, **{f"{kind}_area": area for kind, area in kinds.items()}}


def parse_json(text):
    rows = [flat(json.loads(line)) for line in text.splitlines() if line.strip()]
    return rows, list(dict.fromkeys(name for row in rows for name in row))


def are_columns(names):
    return names[:1] in (["file"], ["id"]) and bool({"atoms", "error"} & set(names))


def parse_csv(text, path):
    csv.field_size_limit(max(len(text), csv.field_size_limit()))
    reader = csv.reader(io.StringIO(text))
    columns = next(reader, [])
    if len(columns) == 1 and any(are_columns(text.split("\n")[0].split(mark)) for mark in ";\t"):
        raise Failed(f"{path}: the columns must be separated by commas, and numbers have decimal points")
    if not are_columns(columns):
        return [], columns
    rows = []
    for fields in reader:
        if fields and len(fields) != len(columns):
            raise Failed(f"{path}:{reader.line_num}: expected {len(columns)} fields, found {len(fields)}; the table "
                         "seems to be cut off or edited")
        if fields:
            rows.append(dict(zip(columns, fields)))
    return rows, columns


def read_table(path):
    """Returns rows and columns. The first column names the structures."""
    text = read_text(path)
    try:
        rows, columns = parse_json(text) if text.lstrip().startswith("{") else parse_csv(text, path)
    except (AttributeError, TypeError, ValueError, csv.Error):
        columns = []
    if not are_columns(columns):
        raise Failed(f"{path}: no table of eses-blocks measure --csv, no lines of its --json, and no "
                     "summary of pdbbind")
    return rows, columns


def failure_of(message, file=""):
    """Returns the row of a file that measure has refused."""
    return {**({"file": file} if file else {}), "status": "failed", "message": message}


def failures_in(path):
    """Returns rows for the errors in the messages of eses-blocks measure."""
    return [failure_of(line.removeprefix(ERROR))
            for line in read_text(path).splitlines() if line.startswith(ERROR)]


def file_of(table, row):
    """Returns the file of a structure, which measure names as the command line did."""
    path = pathlib.Path(row["file"])
    return path if path.is_file() else table.parent / path


def draw(options, path, row):
    """Returns the address of a picture. Throws Failed."""
    try:
        area, probe = float(row["ses_area"]), float(row["probe_radius"])
    except (KeyError, ValueError):
        area = probe = math.nan
    if not (math.isfinite(area) and area >= 0 and math.isfinite(probe)):
        raise Failed("no picture: the table has no area or probe radius of this structure")
    spacing = max(MIN_SPACING, math.sqrt(area / MAX_CELLS))
    with tempfile.TemporaryDirectory(prefix="report-") as scratch:
        folder = pathlib.Path(scratch)
        thumbnails.draw(
            measuring.run, [options.program, path, "--probe-radius", probe, "--spacing", spacing,
             "--margin", 2 * spacing, "--independent", *options.arguments], folder,
            folder / "surface.png")
        return thumbnails.uri(folder / "surface.png")


def draw_all(options, rows):
    """Returns the addresses of pictures by file. Prints which structures cannot be drawn."""
    chosen = [row for row in rows if thumbnails.is_chosen(row.get("file", ""), options.pictures)]
    if not chosen:
        raise Failed("--pictures: no file of the table matches")
    if "ses_area" not in chosen[0]:
        raise Failed("--pictures needs a table of eses-blocks measure; eses-pdbbind has an option "
                     "of this name")
    describe_build(options.program)
    thumbnails.require_renderer()
    pictures = {}
    for row in {row["file"]: row for row in chosen}.values():
        show(f"picture of {printable(row['file'])}")
        try:
            pictures[row["file"]] = draw(options, file_of(options.table, row), row)
        except Failed as error:
            say(f"{printable(row['file'])}: {printable(error)}")
    show("")
    return pictures


def parse():
    parser = Parser(__doc__, examples=(("all.csv -o all.html", "a table of eses-blocks measure --csv all.csv"),
                              ("out/summary.csv -o all.html", "the summary of eses-pdbbind"),
                              ("all.csv --pictures '1a*' -o all.html", "with pictures")),
                    usage=f"{NAME} [OPTION...] TABLE -o PAGE.html [-- ARGUMENT...]")
    parser.add_argument("table", metavar="TABLE", type=input_file,
                        help="table of eses-blocks measure, or summary of eses-pdbbind")
    parser.add_argument("-o", "--output", required=True, metavar="PAGE.html", type=pathlib.Path,
                        help="page to write; - for standard output")
    parser.add_argument("--title", help="title of the page (default: the name of the table)")
    parser.add_argument("--messages", metavar="FILE", type=pathlib.Path,
                        help="standard error of eses-blocks measure, whose errors are shown, too")
    parser.add_argument("--pictures", type=thumbnails.patterns_of, default=[], metavar="PATTERNS",
                        help=thumbnails.HELP.format("files in the table"))
    parser.add_program(", for --pictures")
    options, options.arguments = parser.parse_before_dashes()
    require_kind(parser, options.output, "a page", ".html", ".htm")
    if options.arguments and not options.pictures:
        parser.error("arguments after -- need --pictures")
    return options


def main():
    options = parse()
    rows, columns = read_table(options.table)
    failures = failures_in(options.messages) if options.messages else []
    if "status" not in columns:
        columns = [name for name in columns if name != "error" and (
            name not in OPTIONAL or any(row.get(name) for row in rows))] + ["status", "message"]
        failed = [failure_of(row["error"], row["file"]) for row in rows if row.get("error")]
        named = {row["message"] for row in failed}
        failures = failed + [row for row in failures if row["message"] not in named]
        rows = [{**row, "status": "done", "message": ""} for row in rows if not row.get("error")]
        for row in rows:
            row.pop("error", None)
        if "model" in columns and len({row["file"] for row in rows}) < len(rows):
            columns.insert(1, columns.pop(columns.index("model")))  # tells the rows of a file apart
    read = [options.table, *([options.messages] if options.messages else ()),
            *files_among(options.arguments),
            *(file_of(options.table, row) for row in rows if options.pictures and "file" in row)]
    require_output(options.output, read)
    pictures = draw_all(options, rows) if options.pictures else {}
    write_page(options.output, rows + failures, columns, options.title or options.table.name,
               pictures)


def start():
    end_with(main)
