"""Makes the page that scripts/pdbbind --report writes: failures, plots and a table."""

import html
import pathlib

from common import complete_file, printable
import page
import summary

PARTS = pathlib.Path(__file__).resolve().parent / "report"
TEXTS = ("id", "input", "radii", "status", "message")


def value_of(row, name):
    """Returns a value of a row, which may be text from a file, as JSON stores it."""
    value = row.get(name, "")
    if name in TEXTS:
        return printable(value)
    return "" if value in ("", None) else float(value)


def make_report(rows, title):
    data = {"columns": summary.COLUMNS,
            "rows": [[value_of(row, name) for name in summary.COLUMNS] for row in rows]}
    return page.fill(PARTS, ("report.js",),
                     {"title": html.escape(title), "rows": page.script_text(data)})


def write(path, rows, title):
    with complete_file(path, encoding="utf-8") as target:
        target.write(make_report(rows, title))
