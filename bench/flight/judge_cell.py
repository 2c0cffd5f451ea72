#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Predicts the voltage of flights that no cell was fitted to, and prints the distribution of the errors.

    .venv/bin/python bench/flight/judge_cell.py FOLDER

FOLDER is described in flight_data.py. Sets: Craciun's flights with an odd SHA-256, and NanoBench's flights, whose power follows
from the logged duty cycles. There are three predictions. `blind` uses the cell file and the voltage at rest before the flight.
`own start` fits one factor of all resistances to the first 20 s, and is judged on the remaining time. `flight before` uses the
factor of a whole earlier flight. In NanoBench, this flight used the same cell, started less than 5 minutes earlier, and ended
within 0.1 V below the judged flight's voltage at rest. In Craciun's set, which does not name cells, this is the flight with the
previous number.
"""
import argparse

import numpy as np

import flight_data as data
from cell_model import Cell, Rotors, Set, rms

CELLS = ("bitcraze_250", "bitcraze_250_flights", "bitcraze_250_charged")
START_S = 20.0
SAME_CELL_S = 300.0
RECOVERY_V = (-0.01, 0.1)
SAG_AT_S = 5.0


def spread(values):
    """Returns a text with the median, mean, 90th percentile and maximum of the values in mV. The argument is in V."""
    mv = 1e3 * np.asarray(values)
    return f"{np.median(mv):.0f}, {mv.mean():.0f}, {np.percentile(mv, 90):.0f}, {mv.max():.0f}"


def before(flights, judged):
    """Returns a list with one element for each judged flight: the earlier flight whose resistance factor is used for the
    prediction, or None if there is no such flight."""
    found = []
    for flight in judged:
        earlier = [f for f in flights if f.start_s < flight.start_s]
        last = max(earlier, key=lambda f: f.start_s, default=None)
        if last and flight.duty is not None:
            recovered = flight.rest_v - last.end_rest_v
            if flight.start_s - last.start_s > SAME_CELL_S or not RECOVERY_V[0] <= recovered <= RECOVERY_V[1]:
                last = None
        found.append(last)
    return found


def sag_and_slope(voltage, rest):
    """Returns a text with two medians: the voltage drop from rest to 5 s after the start [mV], and the slope from 10 s to the end
    [mV/s]."""
    sag = rest - voltage[:, round(SAG_AT_S / data.STEP_S)]
    slopes = []
    for row in voltage:
        row = row[~np.isnan(row)][round(10 / data.STEP_S):]
        slopes.append(np.polyfit(data.STEP_S * np.arange(len(row)), row, 1)[0])
    return f"sag {1e3 * np.median(sag):.0f} mV, slope {1e3 * np.median(slopes):.2f} mV/s"


def judge(name, flights, judged):
    flown = Set(judged, Rotors())
    minutes = sum(len(f.voltage_v) for f in judged) * data.STEP_S / 60
    print(f"\n{name}: {len(judged)} flights, {minutes:.0f} minutes; measured median {sag_and_slope(flown.voltage_v, flown.rest_v)}")
    print("rms in a flight [mV]: median, mean, 90 %, largest\n| | blind | own start | flight before |\n|---|---|---|---|")
    partners = before(flights, judged)
    have = np.array([p is not None for p in partners])
    for cell_name in CELLS:
        cell = Cell.load(cell_name)
        blind = flown.errors(cell, 1.0)
        own = flown.errors(cell, flown.best_factor(cell, START_S))[:, round(START_S / data.STEP_S):]
        long_enough = (~np.isnan(own)).sum(axis=1) > 10 / data.STEP_S
        factors = Set([p for p in partners if p], flown.rotors).best_factor(cell)
        growth = np.median(flown.subset(have).best_factor(cell) / factors)
        prior = flown.subset(have).errors(cell, factors)
        print(f"| {cell_name} | {spread(rms(blind))} | {spread(rms(own[long_enough]))} ({long_enough.sum()} flights) | "
              f"{spread(rms(prior))} ({have.sum()} flights) |")
        print(f"{cell_name}: median {sag_and_slope(blind + flown.voltage_v, flown.rest_v)}; mean error "
              f"{1e3 * np.nanmean(blind):+.0f} mV; share of flights within 50 mV: blind {100 * np.mean(rms(blind) < 0.05):.0f} %, "
              f"own start {100 * np.mean(rms(own[long_enough]) < 0.05):.0f} %, flight before {100 * np.mean(rms(prior) < 0.05):.0f} %; "
              f"resistance over that of the flight before, median {growth:.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    folder = parser.parse_args().folder
    craciun, nanobench = data.craciun(folder), data.nanobench(folder)
    judge("Craciun, odd SHA-256", craciun, [f for f in craciun if not f.fitted])
    judge("NanoBench", nanobench, nanobench)


if __name__ == "__main__":
    main()
