# SPDX-License-Identifier: Apache-2.0
"""Fits a cell to the voltages of flights: its series resistance, its polarisation and its capacity.

Runs the battery FMU alone with the power of each log, and minimises the sum of squared voltage errors. The power is measured if the log has
a current. Otherwise, it is that of the rotor model at the measured voltage, and the fitted resistances absorb the error of this model. Each
flight has two more unknowns: the state of charge at the start and, if the log begins in flight, the flight time before.

The fitted properties are three factors on values of the base cell: on R0; on R1 and R2 (C1 and C2 get the inverse, which keeps the time
constants); and on the capacity. If the flights do not determine a factor, the cell keeps the base's value.
"""

from __future__ import annotations

import copy
import dataclasses
import json
import pathlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from mebots.flight.fitting import Fit, clusters_of, solve
from mebots.flight.log import COMMANDS, Array, FlightLog
from mebots.flight.quality import DRIVEN
from mebots.flight.traces import SETTLE_S, Traces
from mebots.mission import Mission

FACTORS = ("series_resistance", "polarisation", "capacity")
STEP_S = 0.05
BLOCK_S = 0.5
"""Residuals are means over this duration, because the voltage contains no more information."""
CLUSTER_S = 15.0
MOST_DEVIATION = 0.35
"""A factor whose logarithm has a larger standard error (a factor of two at 95 %) is not determined."""
_LEAST, _MOST = np.log(0.2), np.log(5.0)
_LONGEST_S = 300.0
"""If the drone flew longer than this before the log, the polarisation does not change further."""
_BEFORE_S = 60.0
_STARTS = (1.0, 1.8)
"""Start values of the factor on both resistances; the search does not converge from too distant charges."""
_CHARGES = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.97)


@dataclasses.dataclass
class Flight:
    """The power that a cell delivered in a flight, and its voltage."""

    name: str
    power_w: Array
    voltage_v: Array
    """The values are in blocks of ``BLOCK_S``; NaN if nothing was measured."""
    charge: float
    began_aloft: bool

    @property
    def unknowns(self) -> int:
        return 2 if self.began_aloft else 1


@dataclasses.dataclass(frozen=True)
class CellFit:
    """The result of a fit. ``factors`` maps names to (value, low, high) relative to the base cell. ``kept`` are the factors that the
    flights do not determine."""

    factors: dict[str, tuple[float, float, float]]
    kept: dict[str, str]
    rms_v: float
    before_v: float
    """The rms error of the base cell with fitted charges."""
    count: int


def flight_of(log: FlightLog, traces: Traces) -> Flight | None:
    """Returns power and voltage of the cell in a replayed log, or None if the log has no voltage."""
    if not log.has(["battery.voltage"]):
        return None
    times = np.arange(traces.times[0], traces.times[-1], STEP_S)
    if log.has(["battery.current"]):
        volts, amperes = (np.interp(times, log[name].times, log[name].values) for name in ("battery.voltage", "battery.current"))
        power_w = np.maximum(volts * amperes, 0)
    else:
        own = "motors_at_measured" if traces.has_measured_voltage else "motors"
        energy = traces[f"{own}.energy"] + np.cumsum(np.r_[0.0, traces[f"{own}.avionics.power"][1:] * np.diff(traces.times)])
        power_w = np.maximum(np.gradient(np.interp(times, traces.times, energy), STEP_S), 0)
    settled = int(SETTLE_S / STEP_S)
    if len(power_w) > 2 * settled:  # the model's rotors accelerate in this time
        power_w[:settled] = power_w[settled : 2 * settled].mean()
    first = [float(log[name].values[:20].mean()) for name in COMMANDS if name in log]
    aloft = bool(first) and max(first) > DRIVEN
    return Flight(log.file.name, power_w, _blocks(log, traces, len(times)), traces.initial_charge, aloft)


def _blocks(log: FlightLog, traces: Traces, steps: int) -> Array:
    """Returns the mean measured voltage in each of the consecutive blocks from the start of the log."""
    voltage = log["battery.voltage"]
    count = int(steps * STEP_S / BLOCK_S)
    place = np.floor((voltage.times - traces.times[0]) / BLOCK_S).astype(int)
    inside = (place >= int(SETTLE_S / BLOCK_S)) & (place < count)
    total = np.bincount(place[inside], voltage.values[inside], count)
    samples = np.bincount(place[inside], minlength=count)
    return np.where(samples > 0, total / np.maximum(samples, 1), np.nan)


def capacity_c(cell: dict[str, Any]) -> float:
    """Returns the charge in a cell file, reduced by its ageing factor."""
    return cell["capacity"]["value"] * cell.get("capacity_factor", {"value": 1.0})["value"]


def scaled_cell(base: dict[str, Any], factors: dict[str, float]) -> dict[str, Any]:
    """Returns a copy of the base cell with these factors."""
    cell = copy.deepcopy(base)
    _scale(cell["series_resistance"], factors.get("series_resistance", 1.0))
    for pair in ("pair1", "pair2"):
        _scale(cell[f"{pair}_resistance"], factors.get("polarisation", 1.0))
        _scale(cell[f"{pair}_capacitance"], 1 / factors.get("polarisation", 1.0))
    cell["capacity"]["value"] *= factors.get("capacity", 1.0)
    cell["capacity"].pop("interval", None)
    return cell


def _scale(curve: dict[str, Any], factor: float) -> None:
    if "value" in curve:
        curve["value"] = [factor * one for one in curve["value"]]
    else:
        curve["exponential"] = [factor * curve["exponential"][0], curve["exponential"][1]]
        curve["polynomial"] = [factor * one for one in curve["polynomial"]]


class _Problem:
    """Computes the residuals of all flights from the free factors and the unknowns of each flight."""

    def __init__(self, base: dict[str, Any], flights: Sequence[Flight], free: Sequence[str], folder: pathlib.Path) -> None:
        self.base, self.flights, self.free, self.folder = base, flights, list(free), folder
        self.blocks = [np.flatnonzero(np.isfinite(one.voltage_v)) for one in flights]
        self.starts = np.cumsum([len(free), *(one.unknowns for one in flights)])[:-1]
        for number, flight in enumerate(flights):
            self._write_power(number, flight)

    def start(self, resistances: float) -> Array:
        """Returns the values at which the fit starts. The factor of the resistances is ``resistances``. The initial charge of each flight
        is the one of ``_CHARGES`` with the smallest errors."""
        values = np.zeros(int(self.starts[-1]) + self.flights[-1].unknowns)
        for i, name in enumerate(self.free):
            values[i] = 0.0 if name == "capacity" else np.log(resistances)
        for number, flight in enumerate(self.flights):
            place = self.starts[number]
            values[place : place + flight.unknowns] = [0.5, _BEFORE_S][: flight.unknowns]
            sums = []
            for charge in _CHARGES:
                values[place] = charge
                sums.append(float(np.sum(self._residuals(number, values) ** 2)))
            values[place] = _CHARGES[int(np.argmin(sums))]
        return values

    def bounds(self) -> tuple[Array, Array]:
        low, high = [_LEAST] * len(self.free), [_MOST] * len(self.free)
        for one in self.flights:
            low += [0.005, 0.0][: one.unknowns]
            high += [1.0, _LONGEST_S][: one.unknowns]
        return np.array(low), np.array(high)

    def clusters(self) -> np.ndarray:
        logs = np.concatenate([np.full(len(blocks), i) for i, blocks in enumerate(self.blocks)])
        return clusters_of(logs, np.concatenate(self.blocks) // int(CLUSTER_S / BLOCK_S))

    def residuals(self, values: Array) -> Array:
        return np.concatenate([self._residuals(i, values) for i in range(len(self.flights))])

    def jacobian(self, values: Array) -> Array:
        """Computes the Jacobian matrix by finite differences. An unknown of a flight affects only this flight."""
        result = []
        for number, flight in enumerate(self.flights):
            own = [*range(len(self.free)), *range(self.starts[number], self.starts[number] + flight.unknowns)]
            before = self._residuals(number, values)
            slopes = np.zeros((len(before), len(values)))
            for place in own:
                is_time = flight.began_aloft and place == self.starts[number] + 1
                step = 1.0 if is_time else 1e-3  # a time is an integer number of steps
                moved = values.copy()
                moved[place] += step if moved[place] + step <= self._highest(number, place) else -step
                slopes[:, place] = (self._residuals(number, moved) - before) / (moved[place] - values[place])
            result.append(slopes)
        return np.concatenate(result)

    def _highest(self, number: int, place: int) -> float:
        if place < len(self.free):
            return np.inf
        return 1.0 if place == self.starts[number] else _LONGEST_S

    def _residuals(self, number: int, values: Array) -> Array:
        flight = self.flights[number]
        factors = {name: float(np.exp(values[i])) for i, name in enumerate(self.free)}
        cell = self.folder / "cell.json"
        content = scaled_cell(self.base, factors)
        content["cut_off_voltage"]["value"] = 0.0  # the protection must not open and hide the voltage error
        content.pop("release_voltage", None)
        cell.write_text(json.dumps(content), encoding="utf-8")
        charge = float(values[self.starts[number]])
        before_s = float(values[self.starts[number] + 1]) if flight.began_aloft else 0.0
        voltage_v = self._voltage(number, cell, charge, before_s)
        return voltage_v[self.blocks[number]] - flight.voltage_v[self.blocks[number]]

    def _voltage(self, number: int, cell: pathlib.Path, charge: float, before_s: float) -> Array:
        """Returns the model's voltage in blocks. ``charge`` is the state of charge at the start of the log, after ``before_s`` of
        flight."""
        flight = self.flights[number]
        per_block = round(BLOCK_S / STEP_S)
        earlier = round(before_s / STEP_S)
        content = json.loads(cell.read_text(encoding="utf-8"))
        # The charge drawn before the log begins, relative to the capacity. Uses the mean voltage of the log for this time.
        drawn = before_s * float(flight.power_w[:per_block].mean()) / float(np.nanmean(flight.voltage_v)) / capacity_c(content)
        mission = self.folder / f"flight{number}.json"
        config = {
            "step": STEP_S,
            "start_time": -earlier * STEP_S,
            "stop_time": (len(flight.power_w) - 1) * STEP_S,
            "instances": {
                "battery": {
                    "fmu": "fmu_battery",
                    "parameters": {"cell.name": str(cell), "cell.initial_state_of_charge": min(charge + drawn, 1.0)},
                }
            },
            "connections": [],
            "inputs": {"file": f"power{number}.csv", "to": {"power": "battery.motors.power"}},
        }
        mission.write_text(json.dumps(config), encoding="utf-8")
        with Mission(mission, record=["battery.cell.voltage"]) as run:
            run.run()
            voltage_v = run["battery.cell.voltage"][run.times >= -1e-9]
        count = len(flight.voltage_v)
        return voltage_v[: count * per_block].reshape(count, per_block).mean(axis=1)

    def _write_power(self, number: int, flight: Flight) -> None:
        """Writes the power of a flight to a file. For times before the log begins, uses the mean power of the log's first seconds."""
        times = np.r_[-2 * _LONGEST_S, np.arange(len(flight.power_w)) * STEP_S]
        rows = np.column_stack([times, np.r_[flight.power_w[: round(SETTLE_S / STEP_S)].mean(), flight.power_w]])
        np.savetxt(self.folder / f"power{number}.csv", rows, fmt="%.9g", delimiter=",", header="time,power", comments="")


def fit_cell(base: dict[str, Any], flights: Sequence[Flight], folder: pathlib.Path, wanted: Sequence[str] = FACTORS) -> CellFit:
    """Fits the cell to the flights. ``folder`` is for temporary files."""
    free = list(wanted)
    kept = {name: "not requested" for name in FACTORS if name not in free}
    before = _solve(base, flights, [], folder)
    while True:
        fit = _solve(base, flights, free, folder)
        loose = [(fit.deviation(i), name) for i, name in enumerate(free)]
        worst = max(loose, default=(0.0, ""))
        if worst[0] <= MOST_DEVIATION:
            break
        kept[worst[1]] = f"not determined: the factor's logarithm has a standard error of {worst[0]:.2g}"
        free.remove(worst[1])
    factors = {}
    for i, name in enumerate(free):
        low, high = map(float, np.exp(fit.interval(i)))
        factors[name] = (float(np.exp(fit.values[i])), low, high)
    return CellFit(factors, kept, fit.rms, before.rms, len(fit.residuals))


def _solve(base: dict[str, Any], flights: Sequence[Flight], free: Sequence[str], folder: pathlib.Path) -> Fit:
    """Returns the best fit from several start values."""
    problem = _Problem(base, flights, free, folder)
    low, high = problem.bounds()
    starts = [problem.start(resistances) for resistances in (_STARTS if free else _STARTS[:1])]
    fits = [solve(problem.residuals, problem.jacobian, np.clip(start, low + 1e-6, high - 1e-6), low, high, problem.clusters()) for start in starts]
    return min(fits, key=lambda fit: fit.rms)
