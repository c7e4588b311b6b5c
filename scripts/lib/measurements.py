"""Measures runs of the program, saves measurements with date, build and machine, and draws them as SVG with
matplotlib."""

import datetime
import importlib.util
import json
import pathlib
import platform

from eses_tools import measuring
from eses_tools.common import (PROJECT, Failed, complete_file, describe_build, require_output, require_writable)

WIDTH, HEIGHT = 600 / 72, 315 / 72  # inches; an SVG of 600 pt is 800 px wide
TOP, BOTTOM = 0.87, 0.25  # share of the height: the axes, between legend and caption

# Colours of Okabe and Ito, which colour-blind readers can distinguish. Markers differ as well.
BLUE = {"color": "#0072B2", "marker": "o"}
ORANGE = {"color": "#D55E00", "marker": "s"}
GREEN = {"color": "#009E73", "marker": "^"}


def machine():
    model = platform.machine()
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                model = line.partition(":")[2].strip()
                break
    except OSError:
        pass
    return {"cpu": model, "cores": measuring.processor_count(), "system": platform.system()}


def run_program(program, arguments, directory):
    """Runs the program. Returns its report and the cost of the run; its files are in
    `directory`/out."""
    with open(directory / "report", "w+", encoding="utf-8") as report_file:
        command = [program, *arguments, "--output-dir", directory / "out", "--json"]
        code, messages, wall, usage = measuring.run_quietly(command, report_file)
        if code != 0:
            raise Failed(messages or f"exit code {code}")
        report_file.seek(0)
        report = json.load(report_file)
    return report, {"user": usage.ru_utime, "system": usage.ru_stime, "wall": wall,
                    "peak_bytes": report["peak_memory_bytes"]}


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


def add_options(parser):
    """Adds the options that measured() needs."""
    parser.add_program()
    parser.add_argument("-o", "--output", type=pathlib.Path, default=PROJECT / "doc", metavar="DIR",
                        help="directory of the figure and the numbers (default: doc)")
    parser.add_argument("--continue", dest="resumed", action="store_true",
                        help="keep the saved rows and measure only what is missing")
    parser.add_argument("--from", dest="saved", type=pathlib.Path, metavar="FILE",
                        help="plot the numbers of this file and measure nothing")


def measured(options, name, measure_missing):
    """Returns the measurements of OUTPUT/NAME.json, which `measure_missing(options, rows, path, build)`
    completes, or those of --from."""
    require_matplotlib()  # fail now rather than after an hour of measuring
    require_writable(options.output)
    path = options.saved or options.output / f"{name}.json"
    if not options.saved:
        require_output(path)
        rows = load(path, "rows")["rows"] if options.resumed else []
        measure_missing(options, rows, path, describe_build(options.program))
    return load(path, "build", "rows")


def require_matplotlib():
    """Fails if matplotlib is missing. Does not load it, as its memory would be counted
    (measuring.run)."""
    if importlib.util.find_spec("matplotlib") is None:
        raise Failed("matplotlib is missing; install it with `apt-get install python3-matplotlib`")


def load_pyplot():
    import matplotlib
    matplotlib.use("svg")  # no display
    matplotlib.rcParams.update({
        "svg.hashsalt": "eses-blocks",  # otherwise identifiers change from run to run
        "svg.fonttype": "path",  # outlines look the same whatever fonts the reader has
        "font.family": "DejaVu Sans", "font.size": 10, "axes.titlesize": 10,
        "legend.fontsize": 10, "axes.spines.top": False, "axes.spines.right": False,
        "axes.axisbelow": True,
    })
    from matplotlib import pyplot
    return pyplot


def plain_ticks(axis, places=None):
    """Labels an axis with 0.1, 1, 10, not powers of ten: at `places`, or at 1, 2, 5 on short
    scales."""
    from matplotlib import ticker
    if places is None:
        low, high = axis.get_view_interval()
        subs = (1, 2, 5) if high / low < 300 else (1,)
        axis.set_major_locator(ticker.LogLocator(subs=subs, numticks=20))
        axis.set_minor_locator(ticker.LogLocator(subs=range(2, 10), numticks=20))
    else:
        axis.set_major_locator(ticker.FixedLocator(places))
        axis.set_minor_locator(ticker.NullLocator())
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:,.12g}"))
    axis.set_minor_formatter(ticker.NullFormatter())


def origin(figures):
    """Returns program, machine and day of the measurements, for a caption."""
    cpu = figures["machine"]["cpu"].replace("(R)", "").replace("(TM)", "")
    cores = figures["machine"]["cores"]
    return (f"{figures['build'][0]}; {cpu}, {cores} core{'s' if cores > 1 else ''}; "
            f"{figures['date'][:10]}")


def finish(figure, axes, text, path, top=TOP, wspace=0.24):
    """Adds one legend above all panels and a caption, and saves the figure without its date."""
    # The legend is that of the first panel; the second one has the same series.
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", ncol=len(labels), frameon=False,
                  borderaxespad=0.2, handlelength=1.8, columnspacing=1.5)
    figure.text(0.5, 0.02, text, ha="center", va="bottom", fontsize=8.5, color="0.3",
                linespacing=1.4)
    figure.subplots_adjust(left=0.085, right=0.985, top=top, bottom=BOTTOM, wspace=wspace)
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)
