# SPDX-License-Identifier: Apache-2.0
"""Converts a set-point to inputs of the simulated drone: velocity along the heading, yaw rate and altitude.

The simulated drone contains the firmware's loops for velocity and altitude, and all inner loops. This module adds the outer loop at the
same 100 Hz: the firmware's proportional controller of the horizontal position, limited to 1.1 times the maximum velocity.

Two set-points differ from the firmware. For a set-point with a yaw, the yaw rate is that of the set-point plus 3 1/s times the error; with
the firmware's 6 1/s, this second-order loop would have a damping of 0.71. For a set-point with a climb rate, the wanted altitude moves.
"""

from __future__ import annotations

import enum
import math
from typing import NamedTuple

from mebots.link.angles import sine_and_cosine, wrapped
from mebots.link.parameters import Parameters
from mebots.link.readings import Readings
from mebots.link.setpoints import Setpoint

PERIOD_MS = 10
_YAW_PER_S = 3.0
_MOST_YAW_RATE_RAD_PER_S = 4.0
_LIMIT_FACTOR = 1.1
_MOST_LEAD_M = 0.55  # maximum distance of wanted and current altitude: the cascade's 1.1 m/s divided by its 2 1/s


class Mode(enum.IntEnum):
    """The values of ``setpoint.mode``."""

    OFF = 0
    FLY = 2


class Inputs(NamedTuple):
    mode: Mode
    forward_m_per_s: float = 0.0
    left_m_per_s: float = 0.0
    yaw_rate_rad_per_s: float = 0.0
    altitude_m: float = 0.0


class PositionLoop:
    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters
        self._climbed_to_m: float | None = None

    def update(self, setpoint: Setpoint, now: Readings, level_out: bool) -> Inputs:
        """Returns the inputs of the simulated drone for the next period.

        :param level_out: keep the present velocity, which keeps the drone level.
        """
        if not setpoint.motors:
            self._climbed_to_m = None
            return Inputs(Mode.OFF)
        altitude_m = self._altitude_m(setpoint, now)
        sine, cosine = sine_and_cosine(now.yaw_rad)
        if level_out:
            forward, left = _along_heading(now.velocity_m_per_s[:2], sine, cosine)
            return Inputs(Mode.FLY, forward, left, 0.0, altitude_m)
        if setpoint.position_m is not None:
            error_m = (setpoint.position_m[0] - now.position_m[0], setpoint.position_m[1] - now.position_m[1])
            ahead_m, aside_m = _along_heading(error_m, sine, cosine)
            forward, left = self._wanted("x", ahead_m), self._wanted("y", aside_m)
        elif setpoint.along_heading:
            forward, left = setpoint.velocity_m_per_s
        else:
            forward, left = _along_heading(setpoint.velocity_m_per_s, sine, cosine)
        return Inputs(Mode.FLY, forward, left, _yaw_rate(setpoint, now), altitude_m)

    def _wanted(self, axis: str, error_m: float) -> float:
        most = _LIMIT_FACTOR * self._parameters[f"posCtlPid.{axis}VelMax"]
        return min(max(self._parameters[f"posCtlPid.{axis}Kp"] * error_m, -most), most)

    def _altitude_m(self, setpoint: Setpoint, now: Readings) -> float:
        if setpoint.height_m is not None:
            self._climbed_to_m = None
            return max(setpoint.height_m, 0.0)
        now_m = now.position_m[2]
        before_m = now_m if self._climbed_to_m is None else self._climbed_to_m
        to_m = before_m + setpoint.climb_m_per_s * PERIOD_MS / 1000.0
        self._climbed_to_m = max(0.0, min(max(to_m, now_m - _MOST_LEAD_M), now_m + _MOST_LEAD_M))
        return self._climbed_to_m


def _along_heading(vector: tuple[float, ...], sine: float, cosine: float) -> tuple[float, float]:
    return cosine * vector[0] + sine * vector[1], cosine * vector[1] - sine * vector[0]


def _yaw_rate(setpoint: Setpoint, now: Readings) -> float:
    rate = setpoint.yaw_rate_rad_per_s
    if setpoint.yaw_rad is not None:
        rate += _YAW_PER_S * wrapped(setpoint.yaw_rad - now.yaw_rad)
        rate = min(max(rate, -_MOST_YAW_RATE_RAD_PER_S), _MOST_YAW_RATE_RAD_PER_S)
    assert math.isfinite(rate)
    return rate
