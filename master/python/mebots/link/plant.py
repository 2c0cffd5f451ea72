# SPDX-License-Identifier: Apache-2.0
"""Reads and writes a linked drone's variables in a mission."""

from __future__ import annotations

import collections
import dataclasses
import os
import re
from collections.abc import Iterable, Mapping
from typing import Any

from mebots.errors import InputError
from mebots.link.control import Inputs
from mebots.link.readings import Readings
from mebots.mission import Mission

_AXES = ("x", "y", "z")
_ROTORS = range(1, 5)


@dataclasses.dataclass(frozen=True)
class Parts:
    """Contains the names of the instances that form one drone. ``number`` is the drone's index in a world of several drones, else None."""

    world: str
    number: int | None
    battery: str

    def variable(self, name: str) -> str:
        """Returns the full name of a variable of this drone, from its name in a world with one drone."""
        return _variable(self.world, self.number, name)

    def is_in(self, mission: Mission) -> bool:
        """Returns True if the drone exists in a mission that has started. A config may connect more drones than ``drone.count``."""
        return self.number is None or self.number <= mission.value(f"{self.world}.drone.count")


def find_drones(config: Mapping[str, Any], file: str) -> list[Parts]:
    """Returns the drones in a config. Each consists of a drone of an ``fmu_world`` and of the battery that feeds the motors of its
    rotors. In a world of several drones, those with connected rotors count."""
    feeds = {end["to"]: end["from"] for end in config.get("connections", [])}
    targets = collections.defaultdict(list)
    for end in config.get("connections", []):
        targets[end["from"]].append(end["to"])
    names = list(config["instances"])
    found = []
    for name, instance in config["instances"].items():
        if not os.path.basename(str(instance.get("fmu", ""))).startswith("fmu_world"):
            continue
        for number in _drones_of(name, targets):
            command = _variable(name, number, "rotor[1].command")
            turned = [_instance_of(target, names) for target in targets[command]]
            sources = [_instance_of(feeds.get(f"{one}.bus.voltage"), names) for one in turned]
            battery = next((source for source in sources if source is not None), None)
            if battery is None:
                raise InputError(
                    f"{file}: no battery feeds the motors of '{command}'; connect {command} to motors, and a battery's bus.voltage to them",
                    "missing_key",
                )
            found.append(Parts(name, number, battery))
    if not found:
        raise InputError(f"{file}: no instance is an fmu_world; `mebots link` needs one", "missing_key")
    return found


def _drones_of(world: str, outputs: Iterable[str]) -> list[int | None]:
    """Returns the indexes of the drones whose rotors are connected, in ascending order; None for a world with one drone."""
    command = re.compile(re.escape(world) + r"\.drone\[(\d+)\]\.rotor\[1\]\.command")
    return sorted(int(match[1]) for output in outputs if (match := command.fullmatch(output))) or [None]


def _variable(world: str, number: int | None, name: str) -> str:
    return f"{world}.{name}" if number is None else f"{world}.drone[{number}].{name.removeprefix('drone.')}"


def _instance_of(variable: str | None, names: list[str]) -> str | None:
    """Returns the instance of a variable. Names may contain dots, but no instance's name starts another name."""
    return next((name for name in names if variable is not None and variable.startswith(name + ".")), None)


class Plant:
    """A drone in a started mission."""

    def __init__(self, mission: Mission, parts: Parts) -> None:
        self._mission = mission
        estimated = mission.value(parts.variable("stabiliser.state")) != 0
        state = "estimate" if estimated else "drone"
        names = [
            *(f"{state}.position.{axis}" for axis in _AXES),
            *(f"{state}.velocity.{axis}" for axis in _AXES),
            *(f"{state}.{angle}" for angle in ("roll", "pitch", "yaw")),
            *(f"imu.angular_velocity.{axis}" for axis in _AXES),
            *(f"imu.acceleration.{axis}" for axis in _AXES),
            *(f"rotor[{i}].command" for i in _ROTORS),
            "range.down",
            "drone.crashed",
        ]
        self._read = [*map(parts.variable, names), f"{parts.battery}.bus.voltage"]
        self._write = [
            parts.variable(f"setpoint.{name}") for name in ("mode", "velocity.x", "velocity.y", "yaw_rate", "altitude")
        ]  # in the order of Inputs
        self._written: Inputs | None = None

    def read(self) -> Readings:
        x, y, z, vx, vy, vz, roll, pitch, yaw, p, q, r, ax, ay, az, m1, m2, m3, m4, below, crashed, volt = map(self._mission.value, self._read)
        return Readings(
            (x, y, z), (vx, vy, vz), roll, pitch, yaw, (p, q, r), (ax, ay, az), (m1, m2, m3, m4), below, volt, bool(crashed)
        )  # fmt: skip

    def write(self, inputs: Inputs) -> None:
        before = self._written or (None,) * len(inputs)
        for name, value, old in zip(self._write, inputs, before, strict=True):
            if value != old:
                self._mission.write(name, value)
        self._written = inputs
