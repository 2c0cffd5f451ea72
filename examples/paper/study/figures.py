# SPDX-License-Identifier: Apache-2.0
"""The study's figures, as SVG texts."""

import io
import json
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402

from experiments import EASY_SPEEDS  # noqa: E402
from missions import BATTERIES, ROOT  # noqa: E402

COLOURS = {"bitcraze_250": "#4878a8", "ufx_250": "#6aa84f", "cyclone_300": "#e69138", "lipol_350": "#a64d79"}
plt.rcParams.update({"font.size": 10, "svg.hashsalt": "mebots", "axes.spines.top": False, "axes.spines.right": False})


def svg(figure):
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None})
    plt.close(figure)
    text = out.getvalue()
    return text[text.index("<svg"):]


def batteries(consumed):
    """consumed[battery][speed] = (real, equal mass) charge used in %."""
    figure, axes = plt.subplots(figsize=(8, 4.2), constrained_layout=True)
    width = 0.2
    for i, (battery, (label, _, mass)) in enumerate(BATTERIES.items()):
        places = np.arange(len(EASY_SPEEDS)) + (i - 1.5) * width
        real = [consumed[battery][speed][0] for speed in EASY_SPEEDS]
        equal = [consumed[battery][speed][1] for speed in EASY_SPEEDS]
        axes.bar(places, equal, 0.9 * width, color=COLOURS[battery], alpha=0.35)
        axes.bar(places, real, 0.9 * width, color=COLOURS[battery], label=f"{label}, {mass} g")
        for x, high in zip(places, real):
            axes.text(x, high / 2, f"{high:.2f}", ha="center", va="center", rotation=90, color="white", fontsize=9)
    axes.set(xticks=range(len(EASY_SPEEDS)), xticklabels=[f"{s} km/h" for s in EASY_SPEEDS],
             ylabel="charge used [%]", xlabel="cruise speed")
    axes.set_title("Charge used by the easy flight (light: all batteries as heavy as the heaviest)", fontsize=11)
    axes.legend(frameon=False)
    return svg(figure)


def gate_of(scene):
    gate = json.loads((ROOT / f"fmu_world/params/scenes/{scene}.json").read_text())["gates"][0]
    return gate["position"], gate.get("inner", 0.4), gate.get("outer", 0.6)


def draw_gate(axes, scene):
    (x, y), inner, outer = gate_of(scene)
    for side in (-1, 1):
        axes.plot([x, x], [y + side * inner / 2, y + side * outer / 2], color="black", linewidth=4,
                  solid_capstyle="butt")


def read_pgm(path):
    magic, size, limit, pixels = path.read_bytes().split(b"\n", 3)
    width, height = (int(n) for n in size.split())
    if magic != b"P5" or limit != b"255":
        raise ValueError(f"{path}: not an 8-bit binary PGM")
    return np.frombuffer(pixels, np.uint8, width * height).reshape(height, width)


def trajectories(traces, titles, scene, first_picture):
    """Four flights seen from above, coloured by speed, with the first picture in the first plot."""
    figure, axes = plt.subplots(2, 2, figsize=(10, 6.6), constrained_layout=True, sharex=True, sharey=True)
    lines = None
    for plot, trace, title in zip(axes.flat, traces, titles):
        x, y = trace["world.drone.position.x"], trace["world.drone.position.y"]
        points = np.column_stack([x, y]).reshape(-1, 1, 2)
        lines = LineCollection(np.concatenate([points[:-1], points[1:]], axis=1), cmap="viridis",
                               norm=plt.Normalize(0, 1.0), linewidth=2.5)
        lines.set_array(3.6 * trace["world.drone.speed"][1:])
        plot.add_collection(lines)
        draw_gate(plot, scene)
        plot.plot(x[0], y[0], "o", color="tab:red", markersize=5)
        plot.set_title(title, fontsize=10)
        plot.set_aspect("equal")
        plot.set_xlim(-0.4, 7.0)
        plot.set_ylim(-0.7, 3.2)
    for plot in axes[1]:
        plot.set_xlabel("x [m]")
    for plot in axes[:, 0]:
        plot.set_ylabel("y [m]")
    if first_picture is not None:
        inset = axes[0, 0].inset_axes([0.02, 0.55, 0.3, 0.43])
        inset.imshow(read_pgm(pathlib.Path(first_picture)), cmap="gray", vmin=0, vmax=255)
        inset.set(xticks=[], yticks=[])
        inset.set_title("first view", fontsize=8)
    figure.colorbar(lines, ax=axes, label="speed [km/h]", shrink=0.8)
    return svg(figure)


def phases(table):
    """Energy by phase and consumer: {phase: {consumer: J}}."""
    figure, axes = plt.subplots(figsize=(8, 3.6), constrained_layout=True)
    consumers = list(next(iter(table.values())))
    names = [name for name in table if sum(table[name].values()) > 0.01]
    left = np.zeros(len(names))
    for consumer, colour in zip(consumers, plt.cm.Set2.colors):
        joules = np.array([table[name][consumer] for name in names])
        axes.barh(names, joules, left=left, label=consumer, color=colour)
        left += joules
    axes.invert_yaxis()
    axes.set_xlabel("energy [J]")
    axes.legend(frameon=False, ncol=3)
    return svg(figure)


def starts(points, scene):
    """Ways of randomised flights: [(trace x, trace y, passed)]."""
    figure, axes = plt.subplots(figsize=(8, 4.6), constrained_layout=True)
    for x, y, passed in points:
        axes.plot(x, y, color="tab:green" if passed else "tab:red", linewidth=0.7 if passed else 1.4,
                  alpha=0.5 if passed else 1.0, zorder=1 if passed else 2)
    draw_gate(axes, scene)
    axes.set_aspect("equal")
    axes.set(xlabel="x [m]", ylabel="y [m]")
    return svg(figure)
