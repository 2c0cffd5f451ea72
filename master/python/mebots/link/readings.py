# SPDX-License-Identifier: Apache-2.0
"""Contains the measured state of a drone and of its battery at one time."""

from __future__ import annotations

from typing import NamedTuple

from mebots.link.trajectories import Vector


class Readings(NamedTuple):
    position_m: Vector  # in the world frame, as estimated by the drone
    velocity_m_per_s: Vector
    roll_rad: float
    pitch_rad: float  # positive: nose down
    yaw_rad: float
    rates_rad_per_s: Vector  # measured by the gyroscope about the axes of the body
    acceleration_m_per_s2: Vector  # measured by the accelerometer: specific force along the axes of the body
    motors: tuple[float, float, float, float]  # duty cycles of the motors
    range_m: float  # distance measured below the drone
    bus_voltage_v: float
    crashed: bool

    @property
    def motors_run(self) -> bool:
        return any(motor > 0.0 for motor in self.motors)
