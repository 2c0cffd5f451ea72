# SPDX-License-Identifier: Apache-2.0
"""Computes commands for a log without commands, so that the model's rotors produce the thrust of the measured motion. A replay of these
commands tests the cell under the power of the rotor model. It does not test the thrust, from which the commands were computed.
"""

from __future__ import annotations

import dataclasses
import json
import pathlib
import tempfile

import numpy as np

from mebots.flight.airframe import Airframe
from mebots.flight.log import COMMANDS, POSITION, ROTORS, Array, FlightLog, Signal
from mebots.flight.motion import GRAVITY_M_PER_S2, vertical_speed
from mebots.flight.traces import RAMP_S
from mebots.mission import Mission

NOTE = "the log has no commands: they are computed from the thrust that the motion needs, so thrust is not compared"
INTERVAL_S = 0.02
GROUND_HEIGHT_M = 0.15
"""A drone that is not higher than this above the lowest height of the log counts as on the ground, because estimated
heights drift by this amount."""
_SLOPE_S = 0.5
"""The vertical acceleration is the slope of the speed over this duration."""
_LEVELS = np.linspace(0.0, 1.0, 21)
_HOLD_S = 1.5
"""Rotors have reached a constant speed after this time."""
_TABLE_V = 3.8


def with_commands(log: FlightLog, airframe: Airframe) -> FlightLog:
    """Returns the log with commands that produce its motion. The log must have a voltage, and a height or a vertical speed."""
    notes: list[str] = []
    speed = vertical_speed(log, notes)
    assert speed is not None  # the log has a height
    height, voltage = log[POSITION[2]], log["battery.voltage"]
    times = np.arange(max(speed.times[0], voltage.times[0]), min(speed.times[-1], voltage.times[-1]), INTERVAL_S)
    climb = [np.interp(times + shift, speed.times, speed.values) for shift in (-_SLOPE_S / 2, _SLOPE_S / 2)]
    needed_n = airframe.mass_kg * np.maximum(GRAVITY_M_PER_S2 + (climb[1] - climb[0]) / _SLOPE_S, 0)
    volts = np.interp(times, voltage.times, voltage.values)
    duty = np.interp(needed_n / len(ROTORS), _thrusts(airframe), _LEVELS) * _TABLE_V / volts
    lowest = np.percentile(height.values, 1)
    on_ground = np.interp(times, height.times, height.values) < lowest + GROUND_HEIGHT_M
    duty = _smooth(np.where(on_ground, 0.0, np.clip(duty, 0, 1)))
    made = {name: Signal(name, "1", times, duty, "from the motion") for name in COMMANDS}
    return dataclasses.replace(log, signals={**log.signals, **made}, notes=(*log.notes, *notes, NOTE))


def _smooth(duty: Array) -> Array:
    """Returns the mean over ``RAMP_S`` around each sample, which smooths the take-off: the log shows when the drone leaves the ground, but
    not how its motors start."""
    width = round(RAMP_S / INTERVAL_S)
    padded = np.pad(duty, (width // 2, width - 1 - width // 2), mode="edge")
    return np.convolve(padded, np.full(width, 1 / width), mode="valid")


def _thrusts(airframe: Airframe) -> Array:
    """Returns the steady thrust of a rotor at ``_TABLE_V`` for each of ``_LEVELS``, from the motors FMU."""
    with tempfile.TemporaryDirectory(prefix="mebots-replay-") as name:
        folder = pathlib.Path(name)
        starts = np.arange(len(_LEVELS)) * _HOLD_S
        rows = np.column_stack([np.repeat(starts, 2)[1:], np.repeat(_LEVELS, 2)[:-1]])
        np.savetxt(folder / "levels.csv", rows, fmt="%.9g", delimiter=",", header="time,level", comments="")
        config = {
            "step": 0.01,
            "stop_time": len(_LEVELS) * _HOLD_S,
            "instances": {
                "motors": {"fmu": "fmu_motors", "parameters": {"rotor_data": airframe.path("rotor"), "bus.voltage": _TABLE_V}}
            },
            "connections": [],
            "inputs": {"file": "levels.csv", "to": {"level": "motors.rotor[1].command"}},
        }
        (folder / "levels.json").write_text(json.dumps(config), encoding="utf-8")
        with Mission(folder / "levels.json", record=["motors.rotor[1].thrust"]) as mission:
            mission.run()
            ends = np.searchsorted(mission.times, starts + _HOLD_S - 0.02)
            return np.maximum.accumulate(mission["motors.rotor[1].thrust"][ends])
