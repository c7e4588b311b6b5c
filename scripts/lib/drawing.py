"""Draws pairs of panels on logarithmic scales as SVG."""

import importlib.util

from eses_tools.common import Failed

WIDTH, HEIGHT = 600 / 72, 315 / 72  # inches; an SVG of 600 pt is 800 px wide
TOP, BOTTOM = 0.87, 0.25  # share of the height: the axes, between legend and caption

# Colours of Okabe and Ito, which colour-blind readers can distinguish. Markers differ as well.
BLUE = {"color": "#0072B2", "marker": "o"}
ORANGE = {"color": "#D55E00", "marker": "s"}
GREEN = {"color": "#009E73", "marker": "^"}
GREY = {"color": "#555555", "marker": "v"}

GUIDE_STYLES = {
    -1: {"linestyle": "--", "label": "ideal"},
    -2: {"linestyle": "--", "label": "$h^{-2}$"},
    -3: {"linestyle": ":", "label": "$h^{-3}$"},
    1: {"linestyle": "--", "label": "linear in $n$"},
}


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


def draw_series(axes, series, styles, x_of, y_of):
    for key, rows in series.items():
        rows = sorted(rows, key=x_of)
        axes.plot([x_of(row) for row in rows], [y_of(row) for row in rows],
                  **{"markersize": 5, **styles[key]})


def draw_guides(axes, anchor, slopes):
    """Draws lines of given slopes through a point across the panel, without changing its scale."""
    x, y = anchor
    ends = axes.get_xlim()
    for slope in slopes:
        axes.plot(ends, [y * (end / x) ** slope for end in ends], color="0.45", linewidth=1.2,
                  zorder=1, scalex=False, scaley=False, **GUIDE_STYLES[slope])


def set_scale(axes, x, y):
    """Leaves room around the points. The y-axis spans at least a decade, so that slopes are
    visible."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(min(x) / 1.15, max(x) * 1.15)
    low, high = min(y) / 1.5, max(y) * 1.5
    spread = max(1, (10 * low / high) ** 0.5)
    axes.set_ylim(low / spread, high * spread)


def panels(pyplot, series, styles, x_of, quantities):
    """Draws two panels with the same data.

    `series`: key -> rows, drawn by `styles[key]`. `quantities`: a title and a function y_of for
    each panel. A row for which y_of returns None is left out of that panel.
    """
    figure, both = pyplot.subplots(1, 2, figsize=(WIDTH, HEIGHT))
    for axes, (name, y_of) in zip(both, quantities):
        known = {key: [row for row in rows if y_of(row) is not None]
                 for key, rows in series.items()}
        shown = [row for rows in known.values() for row in rows]
        set_scale(axes, [x_of(row) for row in shown], [y_of(row) for row in shown])
        draw_series(axes, {key: rows for key, rows in known.items() if rows}, styles, x_of, y_of)
        axes.grid(True, color="0.9", linewidth=0.7)
        axes.set_title(name, loc="left")
        plain_ticks(axes.yaxis)
    return figure, both


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
