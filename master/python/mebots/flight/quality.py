# SPDX-License-Identifier: Apache-2.0
"""Finds bad samples of a log by rules, excludes them, and counts them.

Each rule checks one signal; the rules apply in this order. All rules except ``at_limit`` and ``gap`` exclude the samples that they find.

    not_finite    NaN or infinite, or an empty cell
    time_back     not later than the sample before
    gap           the next sample is more than ``GAP_S`` and five sample times later
    impossible    outside the possible range of the quantity
    straight      on a straight line for ``STRAIGHT_S``: interpolation filled a gap
    stuck         the same value for longer than ``STUCK_S`` while the motors are driven
    wrong_speed   a rotor is slower than ``LEAST_SHARE`` of the median rotor, though it is driven like the others
    not_a_turn    a quaternion whose length is not 1
    at_limit      a command at its upper limit: kept
"""

from __future__ import annotations

import collections
import dataclasses
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from mebots.errors import InputError
from mebots.flight.log import COMMANDS, QUATERNION, ROTORS, SPEEDS, Array, FlightLog, Signal

Mask = npt.NDArray[np.bool_]

GAP_S = 0.1
STRAIGHT_S = 0.2
STUCK_S = {"battery.voltage": 5.0, "battery.current": 5.0} | dict.fromkeys(SPEEDS, 0.5)
LEAST_SHARE = 0.6
DRIVEN = 0.05
"""With a smaller command than this, a motor may be at rest."""
AVERAGE_S = 0.2
"""A rotor follows its command within about this time. Therefore comparisons of speeds and commands use means over it.
"""
LIMITS: dict[str, tuple[float, float]] = {
    "motor": (0, 1),
    "rotor": (0, 6000),  # 57,000 rpm; the tips of a propeller of 47 mm would have 140 m/s
    "battery.voltage": (0.5, 60),
    "battery.current": (-500, 500),
    "position": (-1e5, 1e5),
    "velocity": (-150, 150),
    "attitude": (-1.01, 1.01),
    "acceleration": (-400, 400),
    "rate": (-100, 100),
}
MOST_IMPOSSIBLE = 0.5
"""The share of impossible samples above which the log is rejected."""
HIGHEST_CELL_V = 4.4
"""The maximum voltage of any charger for a LiPo cell."""


@dataclasses.dataclass(frozen=True)
class Finding:
    """The number of samples that a rule found in a signal. ``first_s`` is the time of the first, ``total`` the number of the signal's
    samples in the file.
    """

    signal: str
    rule: str
    count: int
    total: int
    first_s: float
    excluded: bool

    def __str__(self) -> str:
        what = "excluded" if self.excluded else "kept"
        return f"{self.signal}: {self.count} of {self.total} samples {what}: {self.rule}, first at {self.first_s:.3f} s"


class _Cleaner:
    def __init__(self, log: FlightLog) -> None:
        self.log = log
        self.signals = dict(log.signals)
        self.findings: list[Finding] = []

    def drop(self, name: str, rule: str, bad: Mask) -> None:
        signal = self.signals[name]
        self.note(name, rule, bad, True)
        if bad.any():
            self.signals[name] = signal.keep(~bad)

    def note(self, name: str, rule: str, found: Mask, excluded: bool) -> None:
        if found.any():
            first_s = float(self.signals[name].times[int(np.argmax(found))])
            self.findings.append(Finding(name, rule, int(found.sum()), len(self.log[name]), first_s, excluded))

    def known(self) -> Iterator[str]:
        """Yields the names of known signals with samples."""
        return (name for name, signal in list(self.signals.items()) if _limits(name) is not None and len(signal))


def clean(log: FlightLog, cells: int | None = None) -> tuple[FlightLog, list[Finding]]:
    """Returns the log without bad samples, and the findings. ``cells`` is the number of LiPo cells in series, if known. Raises InputError
    if the clock jumps back permanently, or if most samples of a signal are impossible."""
    work = _Cleaner(log)
    for name in work.known():
        _check_times(work, name)
    for name in work.known():
        work.note(name, "gap", _before_gap(work.signals[name]), False)
    for name in work.known():
        bad = _beyond(work.signals[name], cells)
        _require_possible(log, work.signals[name], bad, cells)
        work.drop(name, "impossible", bad)
    for name in (*COMMANDS, *SPEEDS):
        if name in work.signals:
            work.drop(name, "straight", _straight(work.signals[name]))
    for name, longest_s in STUCK_S.items():
        if name in work.signals and len(work.signals[name]):
            work.drop(name, "stuck", _stuck(work.signals[name], longest_s) & _driven(work.signals, work.signals[name].times))
    _check_speeds(work)
    _check_attitude(work)
    for name in COMMANDS:
        if name in work.signals:
            work.note(name, "at_limit", work.signals[name].values >= 0.9995, False)
    return dataclasses.replace(log, signals=work.signals), work.findings


def gap_limit_s(signal: Signal) -> float:
    """Returns the maximum time between two samples without a gap."""
    return max(GAP_S, 5 * signal.interval_s)


def covered(signal: Signal, times: Array) -> Mask:
    """True for each time between two successive samples, unless there is a gap between them."""
    if len(signal) < 2:
        return np.zeros(len(times), bool)
    after = np.clip(np.searchsorted(signal.times, times, side="right"), 1, len(signal) - 1)
    inside = (times >= signal.times[0]) & (times <= signal.times[-1])
    return inside & (signal.times[after] - signal.times[after - 1] <= gap_limit_s(signal))


def counts(findings: list[Finding]) -> dict[str, int]:
    """Returns the number of bad samples of all signals by rule."""
    found: collections.Counter[str] = collections.Counter()
    for one in findings:
        found[one.rule] += one.count
    return dict(found)


def _limits(name: str) -> tuple[float, float] | None:
    return LIMITS.get(name) or LIMITS.get(name.split(".")[0].split("[")[0])


def _check_times(work: _Cleaner, name: str) -> None:
    signal = work.signals[name]
    work.drop(name, "not_finite", ~(np.isfinite(signal.times) & np.isfinite(signal.values)))
    times = work.signals[name].times
    if len(times) < 2:
        return
    back = np.r_[False, times[1:] <= np.maximum.accumulate(times)[:-1]]
    if back.mean() > 0.5 and times[-1] < times[0] + np.ptp(times):
        first = int(np.argmax(back))
        raise InputError(
            f"{work.log.file}: {signal.column}: the clock goes back at sample {first + 1}, from {times[first - 1]:.6g} to "
            f"{times[first]:.6g} s after the start, and stays behind; split the log there, and use each part as a log",
            "invalid_value",
        )
    work.drop(name, "time_back", back)


def _bounds(signal: Signal, cells: int | None) -> tuple[float, float]:
    low, high = _limits(signal.name) or (-np.inf, np.inf)
    return low, HIGHEST_CELL_V * cells if signal.name == "battery.voltage" and cells else high


def _beyond(signal: Signal, cells: int | None) -> Mask:
    low, high = _bounds(signal, cells)
    return (signal.values < low) | (signal.values > high)


def _require_possible(log: FlightLog, signal: Signal, bad: Mask, cells: int | None) -> None:
    """Raises InputError if most samples are bad. The column then has another unit or quantity."""
    if not bad.size or bad.mean() <= MOST_IMPOSSIBLE:
        return
    low, high = _bounds(signal, cells)
    raise InputError(
        f"{log.file}: {signal.column}: {int(bad.sum())} of {bad.size} values are impossible for {signal.name}, whose range is {low:g} to "
        f"{high:g} {signal.unit}; their median is {np.median(signal.values):g}. Check the unit of the column in the mapping",
        "wrong_unit",
    )


def _runs(same: Mask) -> Iterator[tuple[int, int]]:
    """Yields the first and last sample of each run of samples that ``same`` marks. Entry i of ``same`` is for the samples i and i + 1."""
    edges = np.flatnonzero(np.diff(np.r_[False, same, False].astype(np.int8)))
    return zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def _stuck(signal: Signal, longest_s: float) -> Mask:
    bad = np.zeros(len(signal), bool)
    for first, last in _runs(np.diff(signal.values) == 0):
        if signal.times[last] - signal.times[first] > longest_s and signal.values[first] != 0:
            bad[first : last + 1] = True
    return bad


def _straight(signal: Signal) -> Mask:
    """True for samples on straight rising or falling lines, within the rounding of the file's digits."""
    bad = np.zeros(len(signal), bool)
    if len(signal) < 4:
        return bad
    slopes = np.diff(signal.values) / np.diff(signal.times)
    rounding = 1e-3 * np.maximum(np.abs(slopes[1:]), np.abs(slopes[:-1]))
    same = (np.abs(np.diff(slopes)) <= rounding) & (slopes[1:] != 0)
    for first, last in _runs(same):
        if signal.times[last + 1] - signal.times[first] > STRAIGHT_S:
            bad[first : last + 2] = True
    return bad


def mean_over(signal: Signal, times: Array) -> Array:
    """Returns the mean of a signal over ``AVERAGE_S`` before each time."""
    if len(signal) < 2:
        return np.full(len(times), signal.values[0] if len(signal) else np.nan)
    total = np.r_[0.0, np.cumsum((signal.values[1:] + signal.values[:-1]) / 2 * np.diff(signal.times))]
    start = np.maximum(times - AVERAGE_S, signal.times[0])
    length = np.maximum(np.minimum(times, signal.times[-1]) - start, 1e-9)
    return (np.interp(times, signal.times, total) - np.interp(start, signal.times, total)) / length


def _driven(signals: dict[str, Signal], times: Array) -> Mask:
    """True when a motor is driven. Always true without a known command."""
    commands = [signals[name] for name in COMMANDS if name in signals and len(signals[name]) > 1]
    if not commands:
        return np.ones(len(times), bool)
    return np.max([np.interp(times, one.times, one.values) for one in commands], axis=0) > DRIVEN


def _check_speeds(work: _Cleaner) -> None:
    present = [i for i in ROTORS if len(work.signals.get(SPEEDS[i - 1], ())) > 1]
    if len(present) < 3:
        return
    speeds = {i: work.signals[SPEEDS[i - 1]] for i in present}
    for i in present:
        times = speeds[i].times
        median = np.median([np.interp(times, one.times, one.values) for one in speeds.values()], axis=0)
        slow = speeds[i].values < LEAST_SHARE * median
        if all(len(work.signals.get(name, ())) > 1 for name in COMMANDS):
            own, *others = (mean_over(work.signals[COMMANDS[j - 1]], times) for j in (i, *(j for j in ROTORS if j != i)))
            slow &= (own > DRIVEN) & (own > 0.7 * np.median(others, axis=0))
        work.drop(SPEEDS[i - 1], "wrong_speed", slow)


def _check_attitude(work: _Cleaner) -> None:
    parts = [work.signals[name] for name in QUATERNION if len(work.signals.get(name, ())) > 1]
    if len(parts) < 4 or any(len(one) != len(parts[0]) for one in parts):
        return
    length = np.sqrt(sum(one.values**2 for one in parts))
    for one in parts:
        work.drop(one.name, "not_a_turn", np.abs(length - 1) > 0.02)


def _before_gap(signal: Signal) -> Mask:
    if len(signal) < 2:
        return np.zeros(len(signal), bool)
    return np.r_[np.diff(signal.times) > gap_limit_s(signal), False]
