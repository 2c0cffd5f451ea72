#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints seconds of hover over mass by the cell and rotor files fitted on flights, with the interval of the cell's factors.

    .venv/bin/python bench/flight/endurance.py

The cell starts full and ends at its cut-off voltage. The power is that of crazyflie_legacy at the weight, with the
electronics of a bare drone. The ends of the interval are the least resistance_factor with the whole capacity, and the
greatest one with the least capacity_factor.
"""
import json
from dataclasses import replace

import numpy as np

from cell_model import AVIONICS_W, PARAMS, Cell, Rotors, discharge
from flight_data import STEP_S

NAME = "bitcraze_250_flights"
MASSES_G = (27, 32, 34.7, 37.6, 40)
LONGEST_S = 900


def seconds(cell, cut_off_v, factor, rotors, mass_g):
    full = cell.open_circuit[-1:]
    voltage = discharge(cell, full, np.array([factor]), lambda k, volt: rotors.hovering(mass_g / 1000, volt) + AVIONICS_W,
                        round(LONGEST_S / STEP_S), 0.0)[0]
    low = np.flatnonzero(voltage < cut_off_v)
    if not low.size:
        raise SystemExit(f"{mass_g} g: above {cut_off_v} V after {LONGEST_S} s")
    return STEP_S * low[0]


def main():
    data = json.loads((PARAMS / f"fmu_battery/params/cells/{NAME}.json").read_text())
    cell, rotors, cut_off = Cell.load(NAME), Rotors(), data["cut_off_voltage"]["value"]
    least, most = data["resistance_factor"]["interval"]
    aged = replace(cell, capacity_c=cell.capacity_c * data["capacity_factor"]["interval"][0])
    print("| mass | power | hover | interval |\n|---|---|---|---|")
    for mass in MASSES_G:
        power = rotors.hovering(mass / 1000, np.array(3.6)) + AVIONICS_W
        print(f"| {mass} g | {power:.1f} W | {seconds(cell, cut_off, 1.0, rotors, mass):.0f} s | "
              f"{seconds(aged, cut_off, most, rotors, mass):.0f} to {seconds(cell, cut_off, least, rotors, mass):.0f} s |")


if __name__ == "__main__":
    main()
