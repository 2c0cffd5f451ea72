# SPDX-License-Identifier: Apache-2.0
"""The study's figures, drawn from its data."""

import base64
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402
from PIL import Image  # noqa: E402

from experiments import EASY_SPEEDS  # noqa: E402
from missions import BATTERIES, scene  # noqa: E402

COLOURS = {"bitcraze_250": "#4878a8", "ufx_250": "#6aa84f", "cyclone_300": "#e69138", "lipol_350": "#a64d79"}
SMALL = ("chip", "camera", "converters")  # consumers too small to see beside the motors
PASSED, FAILED = "#2e8b57", "#c0392b"
plt.rcParams.update({"font.size": 10, "svg.hashsalt": "mebots", "axes.spines.top": False, "axes.spines.right": False})


def svg(figure):
    """A figure as an SVG text for a page."""
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None})
    text = out.getvalue()
    return text[text.index("<svg"):]


def batteries(used):
    """used[battery][speed] = {real, equal}: charge used in %."""
    figure, axes = plt.subplots(figsize=(8, 4.2), constrained_layout=True)
    width = 0.2
    for i, (battery, (label, _, mass)) in enumerate(BATTERIES.items()):
        places = np.arange(len(EASY_SPEEDS)) + (i - 1.5) * width
        real, equal = ([used[battery][str(speed)][kind] for speed in EASY_SPEEDS] for kind in ("real", "equal"))
        axes.bar(places, equal, 0.9 * width, color=COLOURS[battery], alpha=0.35)
        axes.bar(places, real, 0.9 * width, color=COLOURS[battery], label=f"{label}, {mass} g")
        for x, high in zip(places, real):
            axes.text(x, high / 2, f"{high:.2f}", ha="center", va="center", rotation=90, color="white", fontsize=9)
    axes.set(xticks=range(len(EASY_SPEEDS)), xticklabels=[f"{s} km/h" for s in EASY_SPEEDS],
             ylabel="charge used [%]", xlabel="cruise speed")
    axes.set_title("Charge used by the easy flight; light: all batteries as heavy as the heaviest", fontsize=11)
    axes.legend(frameon=False)
    return figure


def draw_gate(axes, name):
    gate = scene(name)["gates"][0]
    x, y = gate["position"]
    for side in (-1, 1):
        axes.plot([x, x], [y + side * gate["inner"] / 2, y + side * gate["outer"] / 2], color="black", linewidth=4,
                  solid_capstyle="butt")


def decoded(url):
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(url.split(",", 1)[1]))))


def trajectories(flights, titles, name, first_view):
    """Four flights seen from above, coloured by speed, with the first view in the first plot."""
    figure, axes = plt.subplots(2, 2, figsize=(10, 6.4), constrained_layout=True, sharex=True, sharey=True)
    lines = None
    for plot, flight, title in zip(axes.flat, flights, titles):
        way = flight["way"]
        points = np.column_stack([way["x"], way["y"]]).reshape(-1, 1, 2)
        lines = LineCollection(np.concatenate([points[:-1], points[1:]], axis=1), cmap="viridis",
                               norm=plt.Normalize(0, 1.0), linewidth=2.5)
        lines.set_array(np.array(way["km_h"])[1:])
        plot.add_collection(lines)
        draw_gate(plot, name)
        plot.plot(way["x"][0], way["y"][0], "o", color="tab:red", markersize=5)
        plot.set_title(title, fontsize=10)
        plot.set_aspect("equal")
        plot.set_xlim(-0.4, 7.0)
        plot.set_ylim(-0.5, 3.6)
    for plot in axes[1]:
        plot.set_xlabel("x [m]")
    for plot in axes[:, 0]:
        plot.set_ylabel("y [m]")
    inset = axes[0, 0].inset_axes([0.03, 0.46, 0.28, 0.5])
    inset.imshow(decoded(first_view), cmap="gray", vmin=0, vmax=255)
    inset.set(xticks=[], yticks=[])
    inset.spines[["top", "right"]].set_visible(True)
    inset.set_xlabel("first view", fontsize=8)
    figure.colorbar(lines, ax=axes, label="speed [km/h]", shrink=0.8)
    return figure


def phases(tables):
    """Energy by phase and consumer: {flight: {phase: {consumer: J}}}. The right side shows the small ones alone."""
    figure, axes = plt.subplots(len(tables), 2, figsize=(10, 2.3 * len(tables)), constrained_layout=True,
                                squeeze=False)
    for row, (flight, table) in zip(axes, tables.items()):
        consumers = list(next(iter(table.values())))
        colours = dict(zip(consumers, plt.cm.Set2.colors))
        for plot, shown, unit, scale in zip(row, (consumers, SMALL), ("J", "mJ"), (1, 1e3)):
            left = np.zeros(len(table))
            for consumer in shown:
                joules = scale * np.array([table[phase][consumer] for phase in table])
                plot.barh(list(table), joules, left=left, label=consumer, color=colours[consumer])
                left += joules
            plot.invert_yaxis()
            plot.set_xlabel(f"energy [{unit}]")
        row[0].set_title(f"{flight}: all", fontsize=10)
        row[1].set_title(f"{flight}: {', '.join(SMALL)} alone", fontsize=10)
        row[1].set_yticklabels([])
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncol=len(labels), frameon=False)
    return figure


def clocks(rows):
    """Mean time to the gate, the chip's mean energy until then and the share of flights that passed, at each clock."""
    figure, axes = plt.subplots(figsize=(8, 4.2), constrained_layout=True)
    shown = [row for row in rows if row["passed"]]
    for cores, marker in ((8, "o"), (1, "s")):
        group = [row for row in shown if row["cores"] == cores]
        dots = axes.scatter([row["gate_s"] for row in group], [row["chip_j"] for row in group], s=70, marker=marker,
                            c=[100 * row["passed"] / row["flights"] for row in group], cmap="viridis", vmin=0, vmax=100,
                            edgecolors=["black" if row["front"] else "none" for row in group],
                            label=f"{cores} core{'s' if cores > 1 else ''}; number: MHz", zorder=2)
        for row in group:
            axes.annotate(row["clock_mhz"], (row["gate_s"], row["chip_j"]), xytext=(7, 4),
                          textcoords="offset points", fontsize=9)
    axes.set(xlabel="mean time to the gate [s]", ylabel="mean energy of the chip up to the gate [J]")
    axes.set_title("Ringed: on the front of time, energy and success", fontsize=11)
    figure.colorbar(dots, ax=axes, label="passed [%]")
    axes.margins(0.12)
    axes.legend(frameon=False)
    return figure


def starts(ways, name):
    """Ways of flights from random starts, seen from above."""
    figure, axes = plt.subplots(figsize=(8, 3.6), constrained_layout=True)
    for way in ways:
        passed = way["passed"]
        axes.plot(way["x"], way["y"], color=PASSED if passed else FAILED, linewidth=0.7 if passed else 1.4,
                  alpha=0.35 if passed else 1.0, zorder=1 if passed else 2)
    draw_gate(axes, name)
    # A flight straight ahead is a thin line: its width is stretched.
    wide = max(max(way["y"]) for way in ways) - min(min(way["y"]) for way in ways)
    stretched = 3 if wide < 1.0 else 1
    axes.set_aspect(stretched)
    axes.set(xlabel="x [m]", ylabel="y [m]" + (f", stretched {stretched} times" if stretched > 1 else ""))
    return figure
