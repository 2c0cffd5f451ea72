# SPDX-License-Identifier: Apache-2.0
"""Computes errors of the model: computed minus measured values."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np

from mebots.flight.log import SPEEDS, Array, FlightLog, Signal
from mebots.flight.motion import Motion
from mebots.flight.quality import Mask, covered
from mebots.flight.traces import Traces

PERCENTILES = (5, 50, 95)


@dataclasses.dataclass(frozen=True)
class ErrorRow:
    """Statistics of a quantity's errors. ``model`` describes the inputs of the model. ``excluded`` counts samples that the comparison
    omits: excluded by ``quality``, near gaps, or in windows with a gap."""

    quantity: str
    unit: str
    model: str
    n: int
    excluded: int
    measured: float
    mean: float
    rms: float
    p5: float
    p50: float
    p95: float

    @property
    def relative(self) -> float:
        """Returns the mean error divided by the mean measured value."""
        return self.mean / self.measured if self.measured else np.nan


COMMANDS_ONLY, MEASURED_VOLTAGE, MEASURED_SPEEDS = "commands", "commands, measured voltage", "measured speeds"


def row(quantity: str, unit: str, model: str, computed: Array, measured: Array, excluded: int) -> ErrorRow | None:
    """Returns the statistics of the errors ``computed`` - ``measured``, or None without values."""
    if not len(measured):
        return None
    error = computed - measured
    low, middle, high = (float(one) for one in np.percentile(error, PERCENTILES))
    rms = float(np.sqrt(np.mean(error**2)))
    return ErrorRow(quantity, unit, model, len(error), excluded, float(measured.mean()), float(error.mean()), rms, low, middle, high)


def errors(raw: FlightLog, log: FlightLog, traces: Traces, motion: Motion | None) -> list[ErrorRow]:
    """Returns the errors of all measured quantities. ``raw`` is the log with all samples."""
    rows: list[ErrorRow | None] = [_signal(raw, log, traces, "battery.voltage", "battery.bus.voltage", COMMANDS_ONLY)]
    rows.append(_signal(raw, log, traces, "battery.current", "battery.cell.current", COMMANDS_ONLY))
    for instance, given in (("motors", COMMANDS_ONLY), ("motors_at_measured", MEASURED_VOLTAGE)):
        rows += [_signal(raw, log, traces, name, f"{instance}.{name}", given) for name in SPEEDS]
    if motion is not None and len(motion.start):
        rows += _balance(traces, motion, log)
    return [one for one in rows if one is not None]


def thrusts(traces: Traces, log: FlightLog) -> Iterator[tuple[str, Array, Mask]]:
    """Yields the thrust of all rotors at the times of the traces, by up to three methods: from the commands alone, at the measured voltage,
    and from the measured speeds. Each item contains the method, the thrust, and a mask of the times at which it is known."""
    everywhere = np.ones(len(traces.times), bool)
    yield COMMANDS_ONLY, traces.thrust_n(), everywhere
    if traces.has_measured_voltage:
        yield MEASURED_VOLTAGE, traces.thrust_n("motors_at_measured"), everywhere
    if log.has(SPEEDS):
        each_n = (_at_measured_speed(traces, log[name], i + 1) for i, name in enumerate(SPEEDS))
        thrust_n = sum(each_n, start=np.zeros(len(traces.times)))
        yield MEASURED_SPEEDS, thrust_n, np.logical_and.reduce([covered(log[name], traces.times) for name in SPEEDS])


def _at_measured_speed(traces: Traces, speed: Signal, rotor: int) -> Array:
    """Returns the thrust of a rotor at its measured speed: the model's thrust at that time, times (measured speed / model's speed)^2."""
    own = f"{'motors_at_measured' if traces.has_measured_voltage else 'motors'}.rotor[{rotor}]"
    turning = np.maximum(traces[f"{own}.speed"], 1.0)
    return traces[f"{own}.thrust"] * (np.interp(traces.times, speed.times, speed.values) / turning) ** 2


def _signal(raw: FlightLog, log: FlightLog, traces: Traces, name: str, variable: str, given: str) -> ErrorRow | None:
    if not log.has([name]) or variable not in traces.values:
        return None
    signal = log[name]
    first, last = _compared(traces)
    inside = (signal.times >= first) & (signal.times <= last)
    near = np.clip(np.searchsorted(traces.times, signal.times), 0, len(traces.times) - 1)
    used = inside & traces.good[near]
    total = int(((raw[name].times >= first) & (raw[name].times <= last)).sum())
    computed = np.interp(signal.times[used], traces.times, traces[variable])
    return row(name, signal.unit, given, computed, signal.values[used], total - int(used.sum()))


def _compared(traces: Traces) -> tuple[float, float]:
    """Returns the times of the first and last good points. Returns an empty interval without a good point."""
    times = traces.times[traces.good]
    return (float(times[0]), float(times[-1])) if len(times) else (np.inf, -np.inf)


def _balance(traces: Traces, motion: Motion, log: FlightLog) -> list[ErrorRow | None]:
    forces, accelerations = [], []
    for given, thrust_n, known in thrusts(traces, log):
        whole = motion.mean(np.where(known, 0.0, 1.0)) == 0
        excluded = motion.rejected + int((~whole).sum())
        needed_n, wanted = motion.needed_thrust_n[whole], motion.acceleration[whole]
        forces.append(row("thrust.vertical", "N", given, motion.vertical_thrust_n(thrust_n)[whole], needed_n, excluded))
        predicted = motion.predicted_acceleration(thrust_n)[whole]
        accelerations.append(row("acceleration.vertical", "m/s2", given, predicted, wanted, excluded))
    return forces + accelerations
