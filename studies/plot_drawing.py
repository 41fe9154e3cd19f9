# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""What the plots of doc_plots.py have in common: tables, colours, axes, lines of dots, curves with their names at their ends."""
import csv
import textwrap
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

TABLES = Path(__file__).resolve().parent.parent / "docs/tables"
WIDTH = 600                                                           # pt: 800 px
COLORS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#777777"]  # of Okabe and Ito: for colour-blind readers, too
MARKERS = ["o", "s", "^", "D", "v", "P"]
SIGNS = "●■▲◆▼✚"                                                      # the same in text
STYLE = {"svg.fonttype": "none", "svg.hashsalt": "palpate", "font.family": "DejaVu Sans", "font.size": 8.5, "axes.axisbelow": True,
         "axes.edgecolor": "#999999", "axes.grid": True, "grid.color": "#dddddd", "grid.linewidth": 0.7, "lines.markersize": 4.5,
         "axes.spines.top": False, "axes.spines.right": False, "xtick.color": "#333333", "ytick.color": "#333333"}


def read(name):
    """The rows of a table: numbers where they are, None in empty cells."""
    def value(cell):
        try:
            return float(cell) if cell else None
        except ValueError:
            return cell

    with open(TABLES / f"{name}.csv", newline="") as lines:
        return [{key: value(cell) for key, cell in row.items()} for row in csv.DictReader(line for line in lines if line[0] != "#")]


def names(rows, column):
    """The different values of a column, in their order."""
    return list(dict.fromkeys(row[column] for row in rows))


def number(value):
    """As the pages write it, with an exponent from 1e5 on."""
    return f"{value:.0e}".replace("e+0", "e") if value >= 1e5 else f"{value:.10g}"


def set_scale(axis, direction, kind):
    """`kind`: linear, log, or the end of the linear part of a scale that is logarithmic beyond and has zero."""
    scale = getattr(axis, f"set_{direction}scale")
    along = getattr(axis, f"{direction}axis")
    if kind == "linear":
        along.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    elif kind == "log":
        scale("log")
        low, high = getattr(axis, f"get_{direction}lim")()
        steps = (1,) if direction == "x" and high > 150 * low else (1, 3) if high > 9 * low else (1, 2, 5)
        along.set_major_locator(LogLocator(subs=steps, numticks=4 if direction == "x" else 7))
    else:
        scale("symlog", linthresh=kind)
    along.set_minor_locator(NullLocator())
    along.set_minor_formatter(NullFormatter())
    along.set_major_formatter(FuncFormatter(lambda value, _: number(value)))


def width_of(text):
    """About the width of a text [pt]."""
    return 4.8 * len(text)


def new_figure(height, key=(), signs=SIGNS):
    """A figure of this height [pt], with a line that says which sign stands for what."""
    figure = Figure(figsize=(WIDTH / 72, height / 72))
    x = 8
    for k, name in enumerate(key):
        figure.text(x / WIDTH, 1 - 14 / height, f"{signs[k]} {name}", color=COLORS[k], fontsize=9.5, weight="bold")
        x += 1.4 * width_of(name) + 30
    return figure


def add_axes(figure, left, bottom, width, height, title, pad=6):
    """Axes at a place [pt] of a figure, with a title."""
    tall = figure.get_figheight() * 72
    axis = figure.add_axes([left / WIDTH, bottom / tall, width / WIDTH, height / tall])
    axis.set_title(title, loc="left", fontsize=8.5, y=1, pad=pad)
    axis.tick_params(length=2)
    return axis


def set_lines(axis, lines, texts=()):
    """Gives a plot this number of lines, from top to bottom, with texts at the left; quicker than ticks."""
    axis.set_xlim(axis.get_xlim())  # as the points need
    axis.set_yticks([])
    axis.set_ylim(lines - 0.4, -0.6)
    axis.spines["left"].set_visible(False)
    axis.hlines(range(lines), 0, 1, transform=axis.get_yaxis_transform(), color="#dddddd", linewidth=0.7, zorder=0.5)
    for y, text in enumerate(texts):
        axis.annotate(text, (0, y), (-6, 0), xycoords=axis.get_yaxis_transform(), textcoords="offset points", ha="right",
                      va="center", color="#333333", annotation_clip=False)


def dots(rows, label, series, key, panels, good=None):
    """One line for each value of the column `label`, one column of dots for each panel: (title, scale, column of each of the
    series, or one column). `series`: the column that tells the series apart, unless each has columns of its own. `good`: the
    range to be in."""
    lines = names(rows, label)
    wrapped = max(map(len, lines)) > 46
    texts = [textwrap.fill(line, 34) if wrapped else line for line in lines]
    left = 12 + max(width_of(part) for text in texts for part in text.split("\n"))
    tall = (21 if wrapped else 12.5) * len(lines)
    both = len(lines) > 25  # ticks above, too
    figure = new_figure(tall + (74 if both else 62), key)
    gap = 16
    wide = (WIDTH - left - 12 - gap * (len(panels) - 1)) / len(panels)
    for p, (title, kind, columns) in enumerate(panels):
        axis = add_axes(figure, left + p * (wide + gap), 24, wide, tall, title, 16 if both else 6)
        found = {}
        for row in rows:
            for k, column in enumerate([columns] if isinstance(columns, str) else columns):
                index = names(rows, series).index(row[series]) if series else k
                if row[column] is not None:
                    found[lines.index(row[label]), index] = row[column]
        spans = []
        for y in range(len(lines)):
            values = [value for (line, _), value in found.items() if line == y]
            spans += [(min(values), y), (max(values), y), (float("nan"), y)]
        axis.plot(*zip(*spans), color="#bbbbbb", linewidth=1.5, zorder=1)
        for k in range(len(key)):
            points = [(value, line) for (line, index), value in found.items() if index == k]
            if points:
                axis.plot(*zip(*points), MARKERS[k], color=COLORS[k], clip_on=False, zorder=2 + len(key) - k,
                          markersize=6 if k == 1 else 4.5, markerfacecolor="white" if k == 1 else COLORS[k])
        axis.margins(x=0.06)
        set_scale(axis, "x", kind)
        if good:
            axis.axvspan(*good, facecolor="#f7f1a5", edgecolor="#d8cc50", linewidth=1, zorder=0)
        set_lines(axis, len(lines), texts if p == 0 else ())
        if both:
            axis.tick_params(top=True, labeltop=True)
    return figure


def label_ends(axis, ends, gap=9.5):
    """Names at the ends of curves, (x, y, text, colour), moved apart [pt]."""
    axis.get_xlim(), axis.get_ylim()  # scales the axes, which transData needs

    def to_points(x, y):
        return axis.transData.transform((x, y)) * 72 / axis.figure.dpi

    placed = sorted(((*to_points(x, y), text, color) for x, y, text, color in ends), key=lambda end: end[1])
    heights = [end[1] for end in placed]
    for _ in range(200):
        for k in range(len(heights) - 1):
            overlap = gap - (heights[k + 1] - heights[k])
            if overlap > 0:
                heights[k] -= overlap / 2
                heights[k + 1] += overlap / 2
    for (x, y, text, color), height in zip(placed, heights):
        axis.annotate(text, (x, y), (x + 6, height), xycoords="figure points", textcoords="figure points", color=color, va="center",
                      fontsize=8, annotation_clip=False)


def curves(axis, found, scales, labels=True):
    """Curves, name -> (points, style), with their names at their ends."""
    for k, (name, (points, style)) in enumerate(found.items()):
        plain = {"color": COLORS[k % 6], "marker": MARKERS[k % 6], "markersize": 3.5, "linewidth": 1.3, "clip_on": False}
        axis.plot(*zip(*points), **plain | style)
    for direction, kind in zip("xy", scales):
        set_scale(axis, direction, kind)
    if labels:
        label_ends(axis, [(*points[-1], name, style.get("color", COLORS[k % 6]))
                          for k, (name, (points, style)) in enumerate(found.items())])
