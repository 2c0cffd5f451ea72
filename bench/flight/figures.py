#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the figures of flights and endurance.

Flights that no fit has used give docs/img/flight_unseen.png and flight_errors.png. Hover flights of the model give
flight_endurance.png.

    .venv/bin/python bench/flight/figures.py FOLDER [--jobs N]

FOLDER is described in flight_data.py. The 80 hover flights take two minutes of processor time.
"""
import argparse
import json
import sys
import tempfile
from pathlib import Path

import numpy as np

import flight_data as data
from cell_model import Cell, Rotors, Set, rms
from fit_rotor import flight_coefficient
from judge_cell import START_S

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "bench/world")]
import figure_style as style  # noqa: E402
import hover_table  # noqa: E402
from figure_style import plt  # noqa: E402

CELLS = (("bitcraze_250", style.VERMILION), ("bitcraze_250_flights", style.BLUE))
ROTORS = (("crazyflie_bench", style.VERMILION), ("crazyflie_legacy", style.BLUE))
THRUST_FLIGHT = "jana01"
LEAST_SHOWN_S = 100.0
CHARGED = "bitcraze_250_charged"
HOVERING_CELL = "bitcraze_250_flights"
BARE_G = 27.0
STATED = (("Bitcraze, bare drone", BARE_G, 420.0), ("MEbots paper, 40 g", 40.0, 410.0))  # mass [g], hover time [s]


def quantity(kind, name, key):
    return json.loads((ROOT / kind / f"{name}.json").read_text())[key]


def voltage(axis, flights):
    """Draws the voltage of the long flight with the median error, and the interval of the cell's resistances."""
    long = [f for f in flights if len(f.voltage_v) * data.STEP_S > LEAST_SHOWN_S]
    off = rms(Set(long, Rotors()).errors(Cell.load("bitcraze_250_flights"), 1.0))
    flight = long[int(np.argsort(off)[len(off) // 2])]
    flown = Set([flight], Rotors())
    times = data.STEP_S * (np.arange(flown.steps) + 0.5)
    modelled = lambda cell, factor: (flown.errors(cell, factor) + flown.voltage_v)[0]
    new = Cell.load("bitcraze_250_flights")
    low, high = quantity("fmu_battery/params/cells", "bitcraze_250_flights", "resistance_factor")["interval"]
    axis.fill_between(times, modelled(new, high), modelled(new, low), color=style.BLUE, alpha=0.15, lw=0,
                      label="interval of resistance_factor")
    axis.plot(times, flight.voltage_v, color=style.INK, label="measured")
    for name, colour in CELLS:
        axis.plot(times, modelled(Cell.load(name), 1.0), color=colour, label=f"{name}, blind")
    axis.plot(times, modelled(new, flown.best_factor(new, START_S)), color=style.GREEN, ls="--",
              label=f"resistance from the first {START_S:.0f} s")
    axis.set(xlabel="time since take-off [s]", ylabel="voltage [V]", title=f"Craciun, {flight.name}")
    axis.legend(fontsize=8)


def thrust(axis, folder):
    """Draws the thrust over time: from weight and measured acceleration, and from the measured rotor speeds with each rotor
    file's coefficient."""
    flight = data.flight(folder, THRUST_FLIGHT)
    pulls = [np.mean((flight.speed_rad_per_s[:, s]**2).sum(axis=0) * flight.upright[s]) for s in flight.blocks()]
    times = [flight.time_s[s].mean() for s in flight.blocks()]
    to_grams = 1e3 / data.GRAVITY * np.array(pulls)
    low, high = quantity("fmu_motors/params/rotors", "crazyflie_legacy", "thrust_coefficient")["interval"]
    axis.fill_between(times, low * to_grams, high * to_grams, color=style.BLUE, alpha=0.15, lw=0, label="interval of k")
    axis.plot(times, flight_coefficient(flight) * to_grams, color=style.INK, label="measured: m (g + dv/dt)")
    for name, colour in ROTORS:
        axis.plot(times, quantity("fmu_motors/params/rotors", name, "thrust_coefficient")["value"] * to_grams, color=colour, label=name)
    axis.set(xlabel="time [s]", ylabel="vertical thrust [g]", title=f"IMRCLab, {THRUST_FLIGHT}", ylim=(31, 44))
    axis.legend(fontsize=8, loc="upper right", ncols=2)


def voltage_errors(axis, title, flights):
    """Draws the share of flights whose error is below a limit: for three cells without a fit, and for one of them with a fit to
    the first seconds."""
    flown = Set(flights, Rotors())
    curves = [(name, colour, "-", rms(flown.errors(Cell.load(name), 1.0)), "blind") for name, colour in CELLS]
    curves.append((CHARGED, style.PALETTE[3], "-", rms(flown.errors(Cell.load(CHARGED), 1.0)), "blind"))
    new = Cell.load("bitcraze_250_flights")
    later = flown.errors(new, flown.best_factor(new, START_S))[:, round(START_S / data.STEP_S):]
    later = later[(~np.isnan(later)).sum(axis=1) > 10 / data.STEP_S]
    curves.append(("bitcraze_250_flights", style.GREEN, "--", rms(later), f"resistance from the first {START_S:.0f} s"))
    for name, colour, line, off, how in curves:
        axis.plot(1e3 * np.sort(off), 100 * (np.arange(len(off)) + 1) / len(off), ls=line, color=colour, label=f"{name}, {how}")
    axis.axvline(50, color=style.FAINT, lw=0.8, ls=":")
    axis.set(xlim=(0, 300), ylim=(0, 100), xlabel="root mean square of the voltage's error [mV]", ylabel="flights [%]",
             title=f"{title}: {len(flights)} flights")


def thrust_errors(axis, folder):
    sets = (("same drone", data.JUDGED_FLIGHTS, 1), ("second drone", data.SECOND_DRONE_FLIGHTS, 0))
    for name, colour in ROTORS:
        k = quantity("fmu_motors/params/rotors", name, "thrust_coefficient")["value"]
        for _, flights, row in sets:
            off = [100 * np.mean(k / flight_coefficient(data.flight(folder, f)) - 1) for f in flights]
            axis.plot(off, np.full(len(off), row) + (0.12 if name == ROTORS[0][0] else -0.12), "o", ms=5, alpha=0.6, color=colour,
                      label=name if row else None)
    axis.axvline(0, color=style.FAINT, lw=0.8)
    axis.axvspan(-5, 5, color=style.FAINT, alpha=0.15, lw=0)
    axis.set(yticks=[row for _, _, row in sets], ylim=(-0.6, 1.9), xlim=(-8, 18), xlabel="error of thrust at measured speed [%]",
             yticklabels=[f"{name}:\n{len(flights)} flights" for name, flights, _ in sets], title="Thrust, one mark a flight")
    axis.legend(fontsize=8, loc="upper center", ncols=2)


def endurance(axis, jobs):
    """Draws hover time over payload: computed with the values of the data files, the interval of 19 runs with random parameters,
    and published times."""
    with tempfile.TemporaryDirectory() as scratch:
        values = hover_table.flown(Path(scratch) / "values", jobs, [HOVERING_CELL])
        draws = hover_table.flown(Path(scratch) / "draws", jobs, [HOVERING_CELL], **hover_table.DRAWS)
    grams = hover_table.PAYLOADS_G
    seconds = [sorted(time for time, _ in draws[HOVERING_CELL, g]) for g in grams]
    axis.fill_between(grams, [s[0] for s in seconds], [s[-1] for s in seconds], color=style.BLUE, alpha=0.15, lw=0, label="19 draws")
    for g, times in zip(grams, seconds):
        axis.plot([g] * len(times), times, "_", ms=6, color=style.BLUE, alpha=0.5)
    axis.plot(grams, [values[HOVERING_CELL, g][0][0] for g in grams], "o-", ms=4, color=style.BLUE, label=f"{HOVERING_CELL}, values of the files")
    for (name, mass, time), mark in zip(STATED, "^s"):
        axis.plot(mass - BARE_G, time, mark, color=style.VERMILION, label=f"stated: {name}")
    axis.set(xlabel="payload of a bare Crazyflie 2.1 [g]", ylabel="hover [s]", ylim=(0, None), title="Endurance: an interval, not a check")
    axis.legend(fontsize=8, loc="lower left")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--jobs", type=int)
    given = parser.parse_args()
    folder = given.folder
    unseen = [f for f in data.craciun(folder) if not f.fitted]
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
    voltage(left, unseen)
    thrust(right, folder)
    style.save(figure, ROOT / "docs/img/flight_unseen.png")
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.6), layout="constrained")
    thrust_errors(axes[0], folder)
    voltage_errors(axes[1], "Craciun", unseen)
    voltage_errors(axes[2], "NanoBench", data.nanobench(folder))
    figure.legend(*axes[1].get_legend_handles_labels(), fontsize=8, loc="outside lower right", ncols=2)
    style.save(figure, ROOT / "docs/img/flight_errors.png")
    figure, axis = plt.subplots(figsize=(6.4, 3.8), layout="constrained")
    endurance(axis, given.jobs)
    style.save(figure, ROOT / "docs/img/flight_endurance.png")


if __name__ == "__main__":
    main()
