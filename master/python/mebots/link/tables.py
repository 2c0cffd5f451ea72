# SPDX-License-Identifier: Apache-2.0
"""The parameters and log variables of the simulated drone, with the firmware's names."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Protocol

from mebots.link.log import Variable
from mebots.link.parameters import Parameter
from mebots.link.power import Power
from mebots.link.readings import Readings
from mebots.link.scalars import FLOAT, INT8, INT16, UINT8, UINT16, UINT32, Scalar
from mebots.link.setpoints import Setpoint
from mebots.link.supervisor import Supervisor

DECKS = ("bcFlow2", "bcFlow", "bcZRanger2", "bcZRanger", "bcMultiranger", "bcAI", "bcLedRing", "bcLighthouse4", "bcLoco", "bcUSD", "bcBuzzer")
PID, KALMAN = 1, 2
"""Values of stabilizer.controller and stabilizer.estimator."""

_DEGREES = 180.0 / math.pi
_G = 9.81
_POSITION_VARIANCE_M2 = 1e-6
_VELOCITY_VARIANCE_M2_PER_S2 = 1e-4


FIXED = {
    "posCtlPid": {"zKp": 2.0, "zKi": 0.5, "zVelMax": 1.0},
    "velCtlPid": {"vxKp": 25.0, "vxKi": 1.0, "vxKd": 0.0, "vyKp": 25.0, "vyKi": 1.0, "vyKd": 0.0, "vzKp": 25.0, "vzKi": 15.0, "vzKd": 0.0},
    "pid_attitude": {"roll_kp": 6.0, "roll_ki": 3.0, "roll_kd": 0.0, "pitch_kp": 6.0, "pitch_ki": 3.0, "pitch_kd": 0.0,
                     "yaw_kp": 6.0, "yaw_ki": 1.0, "yaw_kd": 0.35},
    "pid_rate": {"roll_kp": 250.0, "roll_ki": 500.0, "roll_kd": 2.5, "pitch_kp": 250.0, "pitch_ki": 500.0, "pitch_kd": 2.5,
                 "yaw_kp": 120.0, "yaw_ki": 16.7, "yaw_kd": 0.0},
}  # fmt: skip
"""Gains of the simulated controller, which a client cannot change. Writing them has no effect."""


def parameters(decks: Iterable[str]) -> list[Parameter]:
    """Returns the parameters with the firmware's default values."""
    carried = set(decks)
    return [
        Parameter("stabilizer", "estimator", UINT8, KALMAN),
        Parameter("stabilizer", "controller", UINT8, PID),
        Parameter("stabilizer", "stop", UINT8),
        Parameter("commander", "enHighLevel", UINT8),
        Parameter("hlCommander", "vtoff", FLOAT, 0.5),
        Parameter("hlCommander", "vland", FLOAT, 0.5),
        Parameter("hlCommander", "groupmask", UINT8),
        Parameter("flightmode", "althold", UINT8),
        Parameter("flightmode", "poshold", UINT8),
        Parameter("flightmode", "posSet", UINT8),
        Parameter("posCtlPid", "xKp", FLOAT, 2.0),
        Parameter("posCtlPid", "yKp", FLOAT, 2.0),
        Parameter("posCtlPid", "xVelMax", FLOAT, 1.0),
        Parameter("posCtlPid", "yVelMax", FLOAT, 1.0),
        Parameter("kalman", "resetEstimation", UINT8),
        Parameter("kalman", "initialX", FLOAT),
        Parameter("kalman", "initialY", FLOAT),
        Parameter("kalman", "initialZ", FLOAT),
        Parameter("kalman", "initialYaw", FLOAT),
        Parameter("supervisor", "prefltTimeout", UINT16, 30000, persistent=True),
        Parameter("supervisor", "landedTimeout", UINT16, 3000, persistent=True),
        Parameter("supervisor", "tmblChckEn", UINT8, 1, persistent=True),
        Parameter("pm", "lowVoltage", FLOAT, 3.2, persistent=True),
        Parameter("pm", "criticalLowVoltage", FLOAT, 3.0, persistent=True),
        Parameter("led", "bitmask", UINT8),
        Parameter("ring", "effect", UINT8, 0, persistent=True),
        Parameter("sound", "effect", UINT8),
        Parameter("system", "selftestPassed", INT8, 1, read_only=True),
        Parameter("firmware", "revision0", UINT32, 0x2A18FC29, read_only=True),
        Parameter("firmware", "revision1", UINT16, read_only=True),
        Parameter("firmware", "modified", UINT8, 1, read_only=True),
        *(Parameter(group, name, FLOAT, value) for group, gains in FIXED.items() for name, value in gains.items()),
        *(Parameter("deck", name, UINT8, name in carried, read_only=True) for name in DECKS),
    ]


class Source(Protocol):
    """The values of a drone from which log variables are read."""

    now: Readings
    power: Power
    supervisor: Supervisor

    @property
    def setpoint(self) -> Setpoint: ...

    @property
    def info(self) -> int: ...


def variables(drone: Source) -> list[Variable]:
    groups: dict[str, list[tuple[str, Scalar, Callable[[], float]]]] = {
        "stabilizer": [*_attitude(drone, ("roll", "pitch", "yaw")), ("thrust", FLOAT, lambda: 65535.0 * sum(drone.now.motors) / 4.0)],
        "stateEstimate": [
            *_vector(lambda: drone.now.position_m, "x y z"),
            *_vector(lambda: drone.now.velocity_m_per_s, "vx vy vz"),
            *_attitude(drone, ("roll", "pitch", "yaw")),
        ],
        "stateEstimateZ": [
            *_vector(lambda: drone.now.position_m, "x y z", 1000.0, INT16),
            *_vector(lambda: drone.now.velocity_m_per_s, "vx vy vz", 1000.0, INT16),
        ],
        "kalman": [
            *_vector(lambda: drone.now.position_m, "stateX stateY stateZ"),
            *((name, FLOAT, lambda: _POSITION_VARIANCE_M2) for name in ("varX", "varY", "varZ")),
            *((name, FLOAT, lambda: _VELOCITY_VARIANCE_M2_PER_S2) for name in ("varPX", "varPY", "varPZ")),
        ],
        "acc": _vector(lambda: drone.now.acceleration_m_per_s2, "x y z", 1.0 / _G),
        "gyro": _vector(lambda: drone.now.rates_rad_per_s, "x y z", _DEGREES),
        "motor": [(f"m{i + 1}", UINT16, lambda i=i: 65535.0 * drone.now.motors[i]) for i in range(4)],
        "range": [("zrange", UINT16, lambda: 1000.0 * drone.now.range_m)],
        "pm": [
            ("vbat", FLOAT, lambda: drone.power.voltage_v),
            ("vbatMV", UINT16, lambda: 1000.0 * drone.power.voltage_v),
            ("chargeCurrent", FLOAT, lambda: 0.0),
            ("state", INT8, lambda: drone.power.state),
            ("batteryLevel", UINT8, lambda: drone.power.level),
        ],
        "sys": [
            ("canfly", UINT8, lambda: drone.supervisor.can_fly),
            ("isFlying", UINT8, lambda: drone.supervisor.is_flying),
            ("isTumbled", UINT8, lambda: drone.supervisor.tumbled),
        ],
        "supervisor": [("info", UINT16, lambda: drone.info)],
        "ctrltarget": [
            *((axis, FLOAT, lambda i=i: (drone.setpoint.position_m or (0.0, 0.0))[i]) for i, axis in enumerate("xy")),
            ("z", FLOAT, lambda: drone.setpoint.height_m or 0.0),
            *((name, FLOAT, lambda i=i: drone.setpoint.velocity_m_per_s[i]) for i, name in enumerate(("vx", "vy"))),
            ("vz", FLOAT, lambda: drone.setpoint.climb_m_per_s),
            ("yaw", FLOAT, lambda: _DEGREES * (drone.setpoint.yaw_rad or 0.0)),
        ],
        "radio": [("rssi", UINT8, lambda: 0)],
    }
    return [Variable(group, name, scalar, read) for group, members in groups.items() for name, scalar, read in members]


def _vector(read: Callable[[], tuple[float, ...]], names: str, factor: float = 1.0, scalar: Scalar = FLOAT) -> list:
    return [(name, scalar, lambda i=i: factor * read()[i]) for i, name in enumerate(names.split())]


def _attitude(drone: Source, names: tuple[str, str, str]) -> list:
    """Returns the log variables of the attitude in degrees. The firmware's pitch is positive with the nose up."""
    reads = (lambda: drone.now.roll_rad, lambda: -drone.now.pitch_rad, lambda: drone.now.yaw_rad)
    return [(name, FLOAT, lambda read=read: _DEGREES * read()) for name, read in zip(names, reads, strict=True)]
