#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the pictures in the READMEs of fmu_battery and fmu_motors. Uses the built FMUs.

    PYTHONPATH=build/release/python .venv/bin/python scripts/plot_fmus.py build/release/fmus
"""
import json
import sys
from pathlib import Path

import fmpy
import numpy as np

import figure_style as style
import mebots
from figure_style import plt

ROOT = Path(__file__).resolve().parent.parent


CELLS = ("ufx_250_scaled", "bitcraze_250_flights", "cyclone_300_scaled", "lipol_350_scaled")
ROTORS = ("crazyflie_bench", "crazyflie_legacy")


def discharge(_):
    """Draws a discharge: a hover mission of a drone of 32.9 g plus its cell, until the cell's protection opens."""
    figure, axis = plt.subplots(figsize=(7, 3.6))
    for cell in CELLS:
        with mebots.Mission(ROOT / "configs/hover.json", set={"battery.cell.name": cell, "world.drone.dry_mass": 0.0329},
                            record=["battery.bus.voltage"]) as run:
            run.run()
            on = run["battery.bus.voltage"] > 0
            axis.plot(run.times[on], run["battery.bus.voltage"][on], label=f"{cell}: {run.times[on][-1]:.0f} s")
    axis.axhline(2.8, color=style.FAINT, lw=0.8, ls="--")
    axis.text(0, 2.8, "cut-off", va="bottom", fontsize=8, color=style.FAINT)
    axis.set(xlabel="time [s]", ylabel="bus voltage [V]", title="Hover of 32.9 g and the cell until the protection opens")
    axis.legend(fontsize=8)
    return figure


def settled(fmus, rotor, rows):
    """Returns the steady thrust [g] and power [W] of four rotors at the duty cycles and voltages of the bench measurements
    ``rows``."""
    points = []
    for _, _, voltage, duty, _ in rows:
        start = {f"rotor[{i}].command": duty / 100 for i in range(1, 5)} | {"bus.voltage": voltage, "rotor_data": rotor}
        last = fmpy.simulate_fmu(str(fmus / "fmu_motors.fmu"), stop_time=8, step_size=0.1, output_interval=1,
                                 start_values=start)[-1]
        points.append((4 * last["rotor[1].thrust"] / 9.80665e-3, last["bench.power"] + last["avionics.power"]))
    return np.array(points)


def thrust(fmus):
    """Draws thrust and power for both rotor files, and the bench measurements of 2015 in crazyflie_bench.json."""
    data = json.loads((ROOT / "fmu_motors/params/rotors/crazyflie_bench.json").read_text())
    rows = np.array(data["bench"]["rows"])
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.4))
    left.plot(rows[:, 3], rows[:, 1], "o", label="bench of 2015")
    right.plot(rows[:, 1], rows[:, 0] * rows[:, 2], "o", label="bench of 2015")
    for rotor in ROTORS:
        points = settled(fmus, rotor, rows)
        left.plot(rows[:, 3], points[:, 0], "-", label=rotor)
        right.plot(points[:, 0], points[:, 1], "-", label=rotor)
    left.set(xlabel="duty cycle [%]", ylabel="thrust of four rotors [g]")
    right.set(xlabel="thrust of four rotors [g]", ylabel="electrical power with electronics [W]")
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
