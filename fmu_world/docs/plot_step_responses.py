#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws step_responses.png from the traces that the target world_step_responses writes.

    mkdir /tmp/traces && build/release/bin/world_step_responses /tmp/traces
    .venv/bin/python fmu_world/docs/plot_step_responses.py /tmp/traces
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import figure_style as style  # noqa: E402
from figure_style import plt  # noqa: E402

PANELS = [
    ("take_off", "altitude", "Take-off to 1 m", "altitude [m]", 1.0),
    ("altitude", "altitude", "Altitude 1 to 1.3 m", "altitude [m]", 1.3),
    ("velocity", "vx", "Forward velocity, 1 km/h", "forward velocity [m/s]", 1 / 3.6),
    ("yaw_rate", "yaw_rate", "Yaw rate, 0.5 rad/s", "yaw rate [rad/s]", 0.5),
    ("wind", "vy", "Gust of 2 m/s from the right", "sideways velocity [m/s]", 0.0),
    ("velocity", "tilt", "Tilt during the velocity step", "tilt [rad]", None),
]
LAGS = [("50ms", style.SKY), ("100ms", style.BLUE), ("150ms", style.VERMILION)]


def main():
    folder = Path(sys.argv[1])
    figure, axes = plt.subplots(2, 3, figsize=(11, 6), constrained_layout=True)
    for axis, (name, column, title, label, goal) in zip(axes.flat, PANELS):
        if goal is not None:
            axis.axhline(goal, color=style.FAINT, lw=0.8, ls="--")
        for lag, colour in LAGS:
            data = np.genfromtxt(folder / f"{name}_{lag}.csv", delimiter=",", names=True)
            axis.plot(data["time"], data[column], color=colour, lw=1.3, label=f"rotor lag {lag[:-2]} ms")
        axis.set(title=title, xlabel="time [s]", ylabel=label)
        axis.title.set_ha("left")
        axis.title.set_x(0)
        axis.grid(axis="y")
    # Writes the name of each lag once, in its colour, where the curves are farthest apart.
    for place, (lag, colour) in enumerate(LAGS):
        axes[1, 0].text(0.97, 0.34 - 0.11 * place, f"rotor lag {lag[:-2]} ms", color=colour, transform=axes[1, 0].transAxes, ha="right")
    style.save(figure, Path(__file__).parent / "step_responses.png")


if __name__ == "__main__":
    main()
