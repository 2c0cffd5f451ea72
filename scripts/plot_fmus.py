#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the pictures in the READMEs of fmu_battery and fmu_motors from the built FMUs.

    .venv/bin/python scripts/plot_fmus.py build/release/fmus
"""
import json
import sys
from pathlib import Path

import fmpy
import numpy as np

import figure_style as style
from figure_style import plt

ROOT = Path(__file__).resolve().parent.parent


def discharge(fmus):
    """Hover of a drone of 32.9 g plus its cell, at the bench's power for that mass, until the protection opens."""
    figure, axis = plt.subplots(figsize=(7, 3.6))
    for cell, mass_g in (("ufx_250", 5.8), ("bitcraze_250", 7.1), ("cyclone_300", 8.1), ("lipol_350", 9.2)):
        power = 0.11 + 0.235 * (32.9 + mass_g)
        result = fmpy.simulate_fmu(
            str(fmus / "fmu_battery.fmu"), stop_time=450, step_size=1, output_interval=1,
            start_values={"cell.name": cell, "motors.power": power, "avionics.power": 0.96, "soc.power": 0.06})
        on = result["cell.connected"] > 0
        axis.plot(result["time"][on], result["bus.voltage"][on],
                  label=f"{cell}, {power + 1.02:.1f} W: {on.sum() - 1} s")
    axis.axhline(2.8, color=style.FAINT, lw=0.8, ls="--")
    axis.text(0, 2.8, "protection opens", va="bottom", fontsize=8, color=style.FAINT)
    axis.set(xlabel="time [s]", ylabel="bus voltage [V]", title="Hover until the protection opens")
    axis.legend(fontsize=8)
    return figure


def thrust(fmus):
    """Settled thrust and power at the bench's duty cycles and voltages, beside the bench."""
    data = json.loads((ROOT / "fmu_motors/params/rotors/crazyflie_bench.json").read_text())
    rows = np.array(data["bench"]["rows"])
    points = []
    for _, _, voltage, duty, _ in rows:
        start = {f"rotor[{i}].command": duty / 100 for i in range(1, 5)} | {"bus.voltage": voltage}
        last = fmpy.simulate_fmu(str(fmus / "fmu_motors.fmu"), stop_time=8, step_size=0.1, output_interval=1,
                                 start_values=start)[-1]
        points.append((4 * last["rotor[1].thrust"] / 9.80665e-3, last["bench.power"] + last["avionics.power"],
                       last["hover.power"]))
    points = np.array(points)
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.4))
    left.plot(rows[:, 3], rows[:, 1], "o", label="bench")
    left.plot(rows[:, 3], points[:, 0], "-", label="model")
    left.set(xlabel="duty cycle [%]", ylabel="thrust of four rotors [g]")
    right.plot(rows[:, 1], rows[:, 0] * rows[:, 2], "o", label="bench")
    right.plot(points[:, 0], points[:, 1], "-", label="model: bench.power + avionics.power")
    right.set(xlabel="thrust of four rotors [g]", ylabel="electrical power [W]")
    for axis in (left, right):
        axis.legend(fontsize=8)
    return figure


def main():
    fmus = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release/fmus")
    folder = ROOT / "docs/img"
    folder.mkdir(exist_ok=True)
    for name, draw in (("fmu_battery", discharge), ("fmu_motors", thrust)):
        figure = draw(fmus)
        figure.tight_layout()
        style.save(figure, folder / f"{name}.png")


if __name__ == "__main__":
    main()
