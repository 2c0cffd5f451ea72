# SPDX-License-Identifier: Apache-2.0
"""A flight log in memory: named signals, each with its unit and its own times.

Signals in the following list have these names. All other columns of a log keep their own names.

    motor[1..4].command    1       duty cycle of a motor's driver
    rotor[1..4].speed      rad/s
    battery.voltage        V
    battery.current        A       positive = discharge
    position.x, y, z       m       world, z up
    velocity.x, y, z       m/s     world, z up
    attitude.qx, .. qw     1       rotation from body to world
    acceleration.x, y, z   m/s2    specific force along body axes
    rate.x, y, z           rad/s   angular velocity about body axes
"""

from __future__ import annotations

import dataclasses
import pathlib
from collections.abc import Iterable, Mapping

import numpy as np
import numpy.typing as npt

from mebots import _mebots
from mebots.errors import InputError

Array = npt.NDArray[np.float64]

ROTORS = (1, 2, 3, 4)
COMMANDS = tuple(f"motor[{i}].command" for i in ROTORS)
SPEEDS = tuple(f"rotor[{i}].speed" for i in ROTORS)
QUATERNION = tuple(f"attitude.q{part}" for part in "xyzw")
VELOCITY = tuple(f"velocity.{axis}" for axis in "xyz")
POSITION = tuple(f"position.{axis}" for axis in "xyz")

UNITS: dict[str, str] = dict(_mebots.log_signals())
"""The unit of every known signal."""


@dataclasses.dataclass(frozen=True)
class Signal:
    """A column of a log. ``times`` are in seconds since the start of the log."""

    name: str
    unit: str
    times: Array
    values: Array
    column: str
    """The name of the column in the file."""

    def __len__(self) -> int:
        return len(self.values)

    def keep(self, good: npt.NDArray[np.bool_]) -> Signal:
        """Returns a signal with the samples for which ``good`` is true."""
        return dataclasses.replace(self, times=self.times[good], values=self.values[good])

    @property
    def interval_s(self) -> float:
        """Returns the median time between samples. Returns 0 for fewer than two samples."""
        return float(np.median(np.diff(self.times))) if len(self) > 1 else 0.0


@dataclasses.dataclass(frozen=True)
class FlightLog:
    """The content of a log file. ``notes`` describes the parts that the reader omitted."""

    file: pathlib.Path
    kind: str
    signals: Mapping[str, Signal]
    notes: tuple[str, ...] = ()

    def __contains__(self, name: str) -> bool:
        return name in self.signals

    def __getitem__(self, name: str) -> Signal:
        return self.signals[name]

    def has(self, names: Iterable[str]) -> bool:
        """True if the log contains all these signals with at least two samples."""
        return all(name in self.signals and len(self.signals[name]) > 1 for name in names)

    def require(self, names: Iterable[str], purpose: str) -> None:
        """Raises InputError if the log lacks one of these signals."""
        absent = [name for name in names if not self.has([name])]
        emptied = [name for name in absent if name in self.signals]
        if emptied:
            raise InputError(
                f"{self.file}: {purpose} needs {', '.join(emptied)}, but fewer than two samples are valid. Samples are invalid if they "
                "are not finite, their time does not increase, or their value is impossible; check units and times in the mapping",
                "invalid_value",
            )
        if absent:
            columns = ", ".join(sorted(signal.column for signal in self.signals.values())[:30]) or "no columns"
            raise InputError(
                f"{self.file}: {purpose} needs {', '.join(absent)}, which the log does not have. It has: {columns}. "
                "--mapping names a file that says which column is which signal",
                "missing_key",
            )

    @property
    def duration_s(self) -> float:
        """Returns the time from the start to the last sample of a known signal."""
        return max((float(one.times[-1]) for one in self.signals.values() if len(one) and one.unit), default=0.0)


def log_of(file: pathlib.Path, kind: str, signals: Iterable[Signal], notes: Iterable[str] = ()) -> FlightLog:
    """Creates a log with times from 0. Raises InputError without samples."""
    filled = [one for one in signals if len(one)]
    # Uses only signals with known names for the start time, because other messages of the log may have another clock.
    clocks = [one for one in filled if one.name in UNITS] or filled
    finite = [float(one.times[np.isfinite(one.times)].min()) for one in clocks if np.isfinite(one.times).any()]
    if not finite:
        raise InputError(f"{file}: the log has no samples", "invalid_value")
    start_s = min(finite)
    moved = {one.name: dataclasses.replace(one, times=one.times - start_s) for one in filled}
    return FlightLog(file, kind, moved, tuple(notes))
