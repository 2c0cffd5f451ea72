# SPDX-License-Identifier: Apache-2.0
"""Reads and writes the variables of a mission that belong to one linked drone."""

from __future__ import annotations

import collections
import dataclasses
import os
from collections.abc import Mapping
from typing import Any

from mebots.errors import InputError
from mebots.link.control import Inputs
from mebots.link.readings import Readings
from mebots.mission import Mission

_AXES = ("x", "y", "z")
_ROTORS = range(1, 5)


@dataclasses.dataclass(frozen=True)
class Parts:
    """Contains the names of the instances that form one drone."""

    world: str
    battery: str


def find_drones(config: Mapping[str, Any], file: str) -> list[Parts]:
    """Returns the drones in a config. Each consists of an ``fmu_world`` and of the battery that feeds the motors of its rotors."""
    feeds = {end["to"]: end["from"] for end in config.get("connections", [])}
    targets = collections.defaultdict(list)
    for end in config.get("connections", []):
        targets[end["from"]].append(end["to"])
    names = list(config["instances"])
    found = []
    for name, instance in config["instances"].items():
        if not os.path.basename(str(instance.get("fmu", ""))).startswith("fmu_world"):
            continue
        turned = [_instance_of(target, names) for target in targets[f"{name}.rotor[1].command"]]
        sources = [_instance_of(feeds.get(f"{one}.bus.voltage"), names) for one in turned]
        battery = next((source for source in sources if source is not None), None)
        if battery is None:
            raise InputError(
                f"{file}: no battery feeds the drone of '{name}'; connect {name}.rotor[1].command to motors, and a battery's bus.voltage to them",
                "missing_key",
            )
        found.append(Parts(name, battery))
    if not found:
        raise InputError(f"{file}: no instance is an fmu_world; `mebots link` needs one for each drone", "missing_key")
    return found


def _instance_of(variable: str | None, names: list[str]) -> str | None:
    """Returns the instance to which a variable belongs. Names may contain dots, but no instance's name is the beginning of another name."""
    return next((name for name in names if variable is not None and variable.startswith(name + ".")), None)


class Plant:
    """Accesses a drone in a mission that has already started."""

    def __init__(self, mission: Mission, parts: Parts) -> None:
        self._mission = mission
        self._world = parts.world
        estimated = mission.value(f"{parts.world}.stabiliser.state") != 0
        state = f"{parts.world}.{'estimate' if estimated else 'drone'}"
        self._read = [
            *(f"{state}.position.{axis}" for axis in _AXES),
            *(f"{state}.velocity.{axis}" for axis in _AXES),
            *(f"{state}.{angle}" for angle in ("roll", "pitch", "yaw")),
            *(f"{parts.world}.imu.angular_velocity.{axis}" for axis in _AXES),
            *(f"{parts.world}.imu.acceleration.{axis}" for axis in _AXES),
            *(f"{parts.world}.rotor[{i}].command" for i in _ROTORS),
            f"{parts.world}.range.down",
            f"{parts.battery}.bus.voltage",
            f"{parts.world}.drone.crashed",
        ]
        self._write = [
            f"{parts.world}.setpoint.{name}" for name in ("mode", "velocity.x", "velocity.y", "yaw_rate", "altitude")
        ]  # in the order of Inputs
        self._written: Inputs | None = None

    def read(self) -> Readings:
        x, y, z, vx, vy, vz, roll, pitch, yaw, p, q, r, ax, ay, az, m1, m2, m3, m4, below, volt, crashed = map(self._mission.value, self._read)
        return Readings(
            (x, y, z), (vx, vy, vz), roll, pitch, yaw, (p, q, r), (ax, ay, az), (m1, m2, m3, m4), below, volt, bool(crashed)
        )  # fmt: skip

    def write(self, inputs: Inputs) -> None:
        before = self._written or (None,) * len(inputs)
        for name, value, old in zip(self._write, inputs, before, strict=True):
            if value != old:
                self._mission.write(name, value)
        self._written = inputs
