# SPDX-License-Identifier: Apache-2.0
"""The vertical momentum balance of a flight, over short windows.

    m dv_z/dt = F R33 - m g - c v_z

F is the thrust of all rotors, R33 is the cosine of the tilt, and c is the vertical drag in the drone file. The equation
needs no controller: it gives the change of the vertical speed from the start of a window to its end. A simulation of
the whole flight without a controller would show little: an error of 1 % in thrust moves the drone by 5 m within 10 s.
In the real flight, a pilot or controller corrects such errors.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from mebots.flight.airframe import Airframe
from mebots.flight.log import COMMANDS, POSITION, Array, FlightLog, Signal
from mebots.flight.quality import DRIVEN, Mask, covered, mean_over

GRAVITY_M_PER_S2 = 9.80665
LEAST_COMMAND = 0.6
"""A mean command below this share of the flight's median command cannot lift a drone."""
GROUND_HEIGHT_M = 0.05
GROUND_MARGIN_S = 0.3
_SLOPE_S = 0.1
"""If the log has no vertical speed, it is computed as the slope of the height over this duration."""


@dataclasses.dataclass(frozen=True)
class Motion:
    """The measured vertical motion at ``times``. ``start`` and ``end`` are the indices of the windows."""

    times: Array
    upright: Array
    speed_m_per_s: Array
    start: np.ndarray
    end: np.ndarray
    rejected: int
    notes: list[str]
    mass_kg: float
    drag_ns_per_m: float

    def mean(self, values: Array) -> Array:
        """Returns the mean of ``values`` over each window."""
        total = np.r_[0.0, np.cumsum((values[1:] + values[:-1]) / 2 * np.diff(self.times))]
        return (total[self.end] - total[self.start]) / self.lengths_s

    @property
    def lengths_s(self) -> Array:
        return self.times[self.end] - self.times[self.start]

    @property
    def middles_s(self) -> Array:
        return (self.times[self.end] + self.times[self.start]) / 2

    @property
    def acceleration(self) -> Array:
        """Returns the measured acceleration of each window [m/s2]."""
        return (self.speed_m_per_s[self.end] - self.speed_m_per_s[self.start]) / self.lengths_s

    def predicted_acceleration(self, thrust_n: Array) -> Array:
        force_n = self.mean(thrust_n * self.upright) - self.drag_ns_per_m * self.mean(self.speed_m_per_s)
        return force_n / self.mass_kg - GRAVITY_M_PER_S2

    @property
    def needed_thrust_n(self) -> Array:
        """Returns the vertical thrust that the measured motion requires in each window."""
        return self.mass_kg * (GRAVITY_M_PER_S2 + self.acceleration) + self.drag_ns_per_m * self.mean(self.speed_m_per_s)

    def vertical_thrust_n(self, thrust_n: Array) -> Array:
        return self.mean(thrust_n * self.upright)


def motion_of(log: FlightLog, airframe: Airframe, times: Array, good: Mask, window_s: float, hover: bool) -> Motion | None:
    """Returns the motion at ``times``. Windows have the length ``window_s`` and contain only times with all signals. Returns None if the
    log has neither a height nor a vertical speed, and ``hover`` is False."""
    notes: list[str] = []
    speed = vertical_speed(log, notes)
    if speed is None and hover:
        notes.append("the log has no motion: hovering is assumed (--hover)")
        speed = Signal("velocity.z", "m/s", times, np.zeros(len(times)), "")
    if speed is None:
        return None
    good = good & covered(speed, times) & ~_on_ground(log, times)
    upright = np.ones(len(times))
    tilt = [log.signals.get(f"attitude.q{part}") for part in "xy"]
    known = [one for one in tilt if one is not None and len(one) > 1]
    if len(known) == len(tilt):
        x, y = (np.interp(times, one.times, one.values) for one in known)
        upright = 1 - 2 * (x**2 + y**2)
        good = good & covered(known[0], times)
    else:
        notes.append("the log has no attitude: a level drone is assumed")
    start, end, rejected = _windows(times, good, window_s)
    speeds = np.interp(times, speed.times, speed.values)
    return Motion(times, upright, speeds, start, end, rejected, notes, airframe.mass_kg, airframe.vertical_drag_ns_per_m)


def _on_ground(log: FlightLog, times: Array) -> Mask:
    """True when the drone may be on the ground, and ``GROUND_MARGIN_S`` before and after. The drone may be on the ground if the rotors are
    too slow to fly and, if known, the height is less than ``GROUND_HEIGHT_M`` above the lowest."""
    command = np.mean([mean_over(log[name], times) for name in COMMANDS], axis=0)
    driven = command[command > DRIVEN]
    ground = command < LEAST_COMMAND * (np.median(driven) if len(driven) else 1.0)
    if log.has([POSITION[2]]):
        height = log[POSITION[2]]
        ground &= np.interp(times, height.times, height.values) < height.values.min() + GROUND_HEIGHT_M
    places = times[ground]
    if not len(places):
        return ground
    next_ = np.searchsorted(places, times)
    before, after = places[np.maximum(next_ - 1, 0)], places[np.minimum(next_, len(places) - 1)]
    return np.minimum(np.abs(times - before), np.abs(times - after)) <= GROUND_MARGIN_S


def vertical_speed(log: FlightLog, notes: list[str]) -> Signal | None:
    if log.has(["velocity.z"]):
        return log["velocity.z"]
    if not log.has([POSITION[2]]):
        return None
    height = log[POSITION[2]]
    notes.append(f"the log has no vertical speed: it is computed as the slope of the height over {_SLOPE_S:g} s")
    ahead, behind = (np.interp(height.times + shift, height.times, height.values) for shift in (_SLOPE_S / 2, -_SLOPE_S / 2))
    inside = (height.times >= height.times[0] + _SLOPE_S / 2) & (height.times <= height.times[-1] - _SLOPE_S / 2)
    return Signal("velocity.z", "m/s", height.times, (ahead - behind) / _SLOPE_S, height.column).keep(inside)


def _windows(times: Array, good: Mask, window_s: float) -> tuple[np.ndarray, np.ndarray, int]:
    """Returns consecutive windows from the first to the last good time. Omits windows with a bad time."""
    places = np.flatnonzero(good)
    if len(places) < 2:
        return np.zeros(0, int), np.zeros(0, int), 0
    edges = np.arange(times[places[0]], times[places[-1]] + 1e-9, window_s)
    at = np.searchsorted(times, edges - 1e-9)
    bad = np.r_[0, np.cumsum(~good)]
    start, end = at[:-1], at[1:]
    whole = bad[np.minimum(end + 1, len(good))] - bad[start] == 0
    return start[whole], end[whole], int((~whole).sum())
