#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fits the resistances of a 250 mAh cell to half of Craciun's flights.

    .venv/bin/python bench/flight/fit_cell.py FOLDER [--full VOLTS]

FOLDER is described in flight_data.py. The fit uses only the flights whose SHA-256 is even. The flights contain no current: the
power is that of crazyflie_legacy at the weight of the drone (cell_model.py). Open-circuit voltage and the shape of all curves
over charge are those of Chen and Rincon-Mora. The capacity is the nominal capacity: flights that use less than half of the charge
cannot distinguish the capacity from slow changes of the resistance. `--full` raises the open-circuit voltage in proportion to the
charge, so that the full cell has this voltage. The fitted values are the series resistance, and resistance and time constant of
one pair. Each flight also has a factor of all resistances, because the data do not identify the cells. A second pair gets 0 Ohm
in the fit.
"""
import argparse
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

import flight_data as data
from cell_model import GRID, Cell, Rotors, Set, rms

EMPTY_V = 3.7   # voltage at rest; at lower voltages, the fit would depend on the end of the curve
TRUST_V = 0.05  # larger errors have linear weight
SHAPE = "bitcraze_250"
COMMON = 3      # number of values that all flights share: series resistance, resistance and time constant of the pair


def scaled(base, series, pairs):
    """Scales the curves of cell ``base``. At full charge, the resistance and the RC pairs then have the given values.
    """
    return replace(base, series=base.series / base.series[-1] * series,
                   pairs=[(ohm / ohm[-1] * value, tau / tau[-1] * time) for (ohm, tau), (value, time) in zip(base.pairs, pairs)])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--full", type=float, help="open-circuit voltage of the full cell; by default the published one, 4.103 V")
    given = parser.parse_args()
    flights = [f for f in data.craciun(given.folder) if f.fitted and f.rest_v > EMPTY_V]
    flown, base = Set(flights, Rotors()), Cell.load(SHAPE)
    if given.full:
        base = replace(base, open_circuit=base.open_circuit + (given.full - base.open_circuit[-1]) * GRID)
    count = len(flights)
    known = ~np.isnan(flown.voltage_v)
    weight = 1 / np.sqrt(known.sum(axis=1))[:, None] / TRUST_V

    def cell_of(values):
        series, ohm, tau = np.exp(values)
        return scaled(base, series, [(ohm, tau)])

    def errors(x):
        return (flown.errors(cell_of(x[:COMMON]), np.exp(x[COMMON:])) * weight)[known]

    def slopes(x):
        """Returns numerical derivatives. The factor of a flight affects only the errors of this flight, so one run suffices for
        the derivatives with respect to all factors.
        """
        ground, step = errors(x), 1e-4
        matrix = np.zeros((ground.size, x.size))
        for i in range(COMMON):
            moved = x.copy()
            moved[i] += step
            matrix[:, i] = (errors(moved) - ground) / step
        own = (errors(np.r_[x[:COMMON], x[COMMON:] + step]) - ground) / step
        matrix[np.arange(ground.size), COMMON + np.nonzero(known)[0]] = own
        return matrix

    start = np.r_[np.log([0.15, 0.03, 2.0]), np.zeros(count)]
    found = least_squares(errors, start, jac=slopes, loss="soft_l1", max_nfev=60)
    x = found.x
    middle = np.median(x[COMMON:])
    series, ohm, tau = np.exp(x[:COMMON] + middle * np.array([1, 1, 0]))
    factors = np.exp(x[COMMON:] - middle)
    off = rms(flown.errors(cell_of(x[:COMMON]), np.exp(x[COMMON:])))
    print(f"{count} flights fitted, {sum(len(f.voltage_v) for f in flights) * data.STEP_S / 60:.0f} minutes, cost {found.cost:.1f}")
    print(f"series {series:.4f} Ohm, pair {ohm:.4f} Ohm {tau:.2f} s, at full charge")
    print("factor of all resistances, 5, 25, 50, 75, 95 %: " + ", ".join(f"{np.percentile(factors, p):.2f}" for p in (5, 25, 50, 75, 95)))
    print(f"rms of a flight with its own factor: median {1e3 * np.median(off):.0f} mV, 90 % {1e3 * np.percentile(off, 90):.0f} mV")


if __name__ == "__main__":
    main()
