# SPDX-License-Identifier: Apache-2.0
"""Draws the study's figures from its data."""

import base64
import io
import sys

import numpy as np
from matplotlib.collections import LineCollection
from PIL import Image

from experiments import EASY_SPEEDS
from missions import BATTERIES, ROOT, scene

sys.path.insert(0, str(ROOT / "scripts"))
import figure_style as style  # noqa: E402
from figure_style import plt  # noqa: E402

COLOURS = dict(zip(BATTERIES, style.PALETTE))
SMALL = ("chip", "camera", "converters")  # consumers whose energy is too small to be visible next to the motors
PASSED, TOUCHED, FAILED = style.GOOD, style.MIDDLING, style.BAD
HALF_DRONE_M = 0.046  # half the width of the drone


def svg(figure):
    """Returns a figure as SVG text for a page."""
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None})
    text = out.getvalue()
    return text[text.index("<svg"):]


def batteries(used):
    """Draws the charge that the easy flights use. `used[battery][speed]` is {"real": charge, "equal": charge} in %, with real and
    with equal masses.
    """
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
    axes.legend()
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
    """Draws four flights from above, coloured by speed. The first plot contains the drone's first view."""
    figure, axes = plt.subplots(2, 2, figsize=(10, 5.2), constrained_layout=True, sharex=True, sharey=True)
    lines = None
    for plot, flight, title in zip(axes.flat, flights, titles):
        way = flight["way"]
        points = np.column_stack([way["x"], way["y"]]).reshape(-1, 1, 2)
        lines = LineCollection(np.concatenate([points[:-1], points[1:]], axis=1), cmap=style.SEQUENCE,
                               norm=plt.Normalize(0, 1.0), linewidth=2.5)
        lines.set_array(np.array(way["km_h"])[1:])
        plot.add_collection(lines)
        draw_gate(plot, name)
        plot.plot(way["x"][0], way["y"][0], "o", color=style.INK, markersize=5)
        plot.set_title(title, fontsize=10)
        plot.set_aspect("equal")
        plot.set_xlim(-0.4, 7.0)
        plot.set_ylim(-0.3, 2.9)
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
    """Draws the energy by phase and consumer: {flight: {phase: {consumer: J}}}. The right plot shows only the small energies."""
    figure, axes = plt.subplots(len(tables), 2, figsize=(10, 2.3 * len(tables)), constrained_layout=True,
                                squeeze=False)
    for row, (flight, table) in zip(axes, tables.items()):
        consumers = list(next(iter(table.values())))
        colours = dict(zip(consumers, style.PALETTE))
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
    """Draws the chip's mean energy up to the gate over the cluster's clock, on eight cores and on one core."""
    figure, axes = plt.subplots(figsize=(8, 3.6), constrained_layout=True)
    for cores, marker, colour in ((8, "o", style.BLUE), (1, "s", style.VERMILION)):
        group = [row for row in rows if row["cores"] == cores and row["crossed"]]
        axes.plot([row["clock_mhz"] for row in group], [row["chip_j"] for row in group], marker, color=colour, linestyle=":")
        style.label_line(axes, f"{cores} core{'s' if cores > 1 else ''}", colour)
        for row in group:
            axes.annotate(f"{row['crossed']} of {row['flights']}", (row["clock_mhz"], row["chip_j"]), xytext=(0, 7),
                          textcoords="offset points", ha="center", fontsize=7, color=style.FAINT)
    axes.set(xlabel="clock of the cluster [MHz]", ylabel="chip, energy up to the gate [J]", ylim=(0, None))
    axes.set_title("Mean over the flights that crossed the opening: so many of those that were flown", loc="left")
    return figure


def chips(both):
    """Draws the chip's mean energy up to the gate, with one plot for eight cores and one for one core. `both` is {chip: (rows,
    tolerance)}. The tolerance is the least and the greatest energy relative to the computed energy, from checks against silicon.
    """
    figure, plots = plt.subplots(1, 2, figsize=(8, 3.4), constrained_layout=True, sharey=True)
    for axes, cores in zip(plots, (8, 1)):
        for (chip, (rows, (low, high))), marker, colour in zip(both.items(), "os", (style.BLUE, style.VERMILION)):
            group = [row for row in rows if row["cores"] == cores and row["crossed"]]
            clocks_mhz, energy = np.array([[row["clock_mhz"], row["chip_j"]] for row in group]).T
            axes.fill_between(clocks_mhz, low * energy, high * energy, color=colour, alpha=0.15, linewidth=0)
            axes.plot(clocks_mhz, energy, marker, color=colour, linestyle=":", label=chip)
        axes.set_title(f"{cores} core{'s' if cores > 1 else ''}", loc="left")
        axes.set_xlabel("clock of the cluster [MHz]")
    plots[0].set(ylabel="chip, energy up to the gate [J]", ylim=(0, None))
    plots[0].legend(loc="upper left", title="shaded: what checks against silicon allow", fontsize=8, title_fontsize=8)
    return figure


def starts(part, name):
    """Draws flights from random starts from above, in separate plots for flights that passed and flights that did not. Another
    plot shows where the drone's centre crossed the gate's plane."""
    ways, gate = part["ways"], scene(name)["gates"][0]
    groups = [("passed", [w for w in ways if w["outcome"] in ("passed", "touched_passed")], PASSED),
              ("not passed", [w for w in ways if w["outcome"] not in ("passed", "touched_passed")], FAILED)]
    groups = [group for group in groups if group[1]]
    wide = max(max(way["y"]) for way in ways) - min(min(way["y"]) for way in ways)
    stretched = 3 if wide < 1.0 else 1  # stretches the plot, because a flight straight ahead is a thin line
    figure = plt.figure(figsize=(10, 2.6 * len(groups) + 0.4), constrained_layout=True)
    grid = figure.add_gridspec(len(groups), 2, width_ratios=(1.7, 1))
    above = None
    for row, (label, group, colour) in enumerate(groups):
        above = figure.add_subplot(grid[row, 0], sharex=above, sharey=above)
        for way in group:
            above.plot(way["x"], way["y"], color=colour, linewidth=0.8, alpha=max(0.12, 0.6 - len(group) / 300))
            above.plot(way["x"][-1], way["y"][-1], ".", color=colour, markersize=4, alpha=0.7)
        draw_gate(above, name)
        touched = sum(way["outcome"] == "touched_passed" for way in group)
        more = "" if not touched else ", all touched the frame" if touched == len(group) else f", {touched} touched the frame"
        above.set_title(f"{label}: {len(group)} of {len(ways)}{more}; dot: the end", loc="left", color=colour)
        above.set_aspect(stretched)
        above.set_ylabel("y [m]" + (f", {stretched} times" if stretched > 1 else ""))
        if row + 1 < len(groups):
            above.tick_params(labelbottom=False)
    above.set_xlabel("x [m]")
    crossings(figure.add_subplot(grid[:, 1]), part, gate)
    return figure


def crossings(axes, part, gate):
    """Draws a histogram of the places at which the drone's centre crossed the gate's plane: flights per centimetre to the left of
    the gate's centre."""
    half = gate["inner"] / 2
    places = [100 * x for x in part["lateral_m"] if x is not None and abs(x) < gate["outer"]]
    low, high = min([*places, -100 * half]) - 2, max([*places, 100 * half]) + 2
    axes.axvspan(-100 * (half - HALF_DRONE_M), 100 * (half - HALF_DRONE_M), color=style.GREEN, alpha=0.10, linewidth=0)
    for side in (-1, 1):
        axes.axvline(side * 100 * half, color="black", linewidth=3)
    axes.hist(places, bins=np.arange(np.floor(low), np.ceil(high) + 1), color=style.BLUE)
    axes.text(0, axes.get_ylim()[1], "room for a drone that flies straight through", ha="center", va="bottom", fontsize=8, color=style.GREEN)
    never = len(part["lateral_m"]) - len(places)
    more = f"\n{never} of {len(part['lateral_m'])} never came to the plane" if never else ""
    axes.set(xlabel="left of the middle, at the gate's plane [cm]" + more, ylabel="flights", xlim=(high, low))


def failures(found):
    """Draws one picture for each flight that did not pass, from a metre before the gate or from the end."""
    columns = min(6, len(found))
    rows = -(-len(found) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(10, 2.3 * rows), constrained_layout=True, squeeze=False)
    for plot in axes.flat:
        plot.axis("off")
    for plot, failed in zip(axes.flat, found):
        plot.imshow(decoded(failed["picture"]), cmap="gray", vmin=0, vmax=255)
        plot.set_title(f"{short_name(failed['name'])}: {failed['outcome'].replace('_', ' ')}", fontsize=8, color=FAILED)
    return figure


def short_name(name):
    """Returns a short name of a flight, such as "start 2" for "hard-1-002-pictures"."""
    return f"start {int(name.split('-')[2])}"


def landing(found):
    """Draws the charges at which landings started, by cell and motors. Marks whether the drone reached the ground under power."""
    figure, axes = plt.subplots(figsize=(8, 3.6), constrained_layout=True)
    places = {}
    for i, (battery, (label, _, _)) in enumerate(BATTERIES.items()):
        for j, (motors, cells) in enumerate(found.items()):
            x = i + 0.4 * (j - 0.5 * (len(found) - 1))
            places[x] = f"{label}\n{motors}"
            entry = cells[battery]
            axes.plot([x - 0.1, x + 0.1], [entry["opens"]] * 2, color="black", linewidth=1.5)
            for flight in entry["flights"]:
                axes.plot(x, flight["charge"], "o" if flight["landed"] else "x",
                          color=PASSED if flight["landed"] else FAILED, markersize=7)
    axes.axhline(10, color=style.FAINT, linewidth=0.8, linestyle="--")
    axes.plot([], [], color="black", label="protection opens in hover")
    axes.plot([], [], "o", color=PASSED, label="landed under power")
    axes.plot([], [], "x", color=FAILED, label="fell")
    axes.plot([], [], color=style.FAINT, linewidth=0.8, linestyle="--", label="the paper's 10 %")
    axes.set(ylabel="charge when the landing begins [%]", ylim=(4, 13))
    axes.set_xticks(list(places), list(places.values()), fontsize=7)
    axes.legend(fontsize=8, ncol=2)
    return figure


COURSE = (("z_m", "altitude [m]"), ("km_h", "speed [km/h]"), ("v", "cell [V]"), ("w", "power [W]"))


def draw_course(column, course, quantities, colour=style.BLUE):
    for plot, (name, label) in zip(column, quantities):
        plot.plot(course["s"], course[name], color=colour, linewidth=1.2)
        plot.set_ylabel(label)
    column[-1].set_xlabel("time [s]")


def course(values):
    """Draws altitude, speed, voltage and power of a flight over time."""
    figure, axes = plt.subplots(len(COURSE), 1, figsize=(8, 6), constrained_layout=True, sharex=True)
    draw_course(axes, values, COURSE)
    return figure


def ends(flights):
    """Draws the last seconds of several flights: [{charge at which the landing starts [%], landed, course}]."""
    quantities = [q for q in COURSE if q[0] != "km_h"]
    figure, axes = plt.subplots(len(quantities), len(flights), figsize=(8, 5), constrained_layout=True, sharex="col",
                                sharey="row", squeeze=False)
    for column, flight in zip(axes.T, flights):
        draw_course(column, flight["course"], quantities, PASSED if flight["landed"] else FAILED)
        how = "lands under power" if flight["landed"] else "falls"
        column[0].set_title(f"landing begins at {flight['charge']:.1f} %: {how}", fontsize=10)
    return figure
