# SPDX-License-Identifier: Apache-2.0
"""The measured state of a drone and its battery at one time."""

from __future__ import annotations

from typing import NamedTuple

from mebots.link.trajectories import Vector


class Readings(NamedTuple):
    position_m: Vector  # in the world frame, as the drone estimates it
    velocity_m_per_s: Vector
    roll_rad: float
    pitch_rad: float  # positive: nose down
    yaw_rad: float
    rates_rad_per_s: Vector  # about the body's axes, from the gyroscope
    acceleration_m_per_s2: Vector  # specific force along the body's axes, from the accelerometer
    motors: tuple[float, float, float, float]  # duty cycles
    range_m: float  # measured distance below the drone
    bus_voltage_v: float
    crashed: bool

    @property
    def motors_run(self) -> bool:
        return any(motor > 0.0 for motor in self.motors)
