"""Makes the page with the results of many structures: failures, pictures, plots and a table.

Used by eses-report, and by eses-pdbbind --report.
"""

import html
import math
import pathlib

from eses_tools.common import complete_file, printable
from eses_tools import page

PARTS = pathlib.Path(__file__).resolve().parent / "pages/report"
TEXTS = ("id", "input", "file", "radii", "status", "message")  # other columns are numbers if possible
# Columns that are drawn against the number of atoms, if the table has them.
PLOTS = (("seconds", "time, s"), ("peak_bytes", "peak memory, bytes"), ("area", "area, Å²"),
         ("volume", "volume, Å³"), ("ses_area", "SES area, Å²"), ("sas_area", "SAS area, Å²"), ("ses_volume", "SES volume, Å³"))


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


def write(path, rows, columns, title, pictures):
    with complete_file(path, encoding="utf-8") as target:
        target.write(make_report(rows, columns, title, pictures))
