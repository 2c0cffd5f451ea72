# SPDX-License-Identifier: Apache-2.0
"""Builds systems of FMUs in Python."""

from __future__ import annotations

import copy
import dataclasses
import json
import os
import pathlib
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from mebots.errors import InputError
from mebots.mission import Mission, Path, Scalar


@dataclasses.dataclass(frozen=True)
class Variable:
    """A variable of an instance. An instance returns it, as in ``battery["bus.voltage"]``."""

    instance: str
    name: str

    def __str__(self) -> str:
        return f"{self.instance}.{self.name}"


@dataclasses.dataclass(frozen=True)
class Instance:
    """An instance of a system. ``instance[name]`` returns one of its variables."""

    name: str

    def __getitem__(self, variable: str) -> Variable:
        return Variable(self.name, variable)


class System:
    """A system of FMUs that a program builds. It is equivalent to a config of ``mebots run``: ``config`` returns that config, and
    ``write`` saves it.

        system = mebots.System(step=0.002, stop_time=10)
        battery = system.add("battery", "fmu_battery")
        motors = system.add("motors", "fmu_motors", {f"rotor[{i}].command": 0.6 for i in range(1, 5)})
        system.connect(battery["bus.voltage"], motors["bus.voltage"])
        system.connect(motors["power"], battery["motors.power"])
        system.connect(motors["avionics.power"], battery["avionics.power"])
        with system.mission() as mission:
            mission.run()
            print(mission["battery.bus.voltage"].min())

    :param step: communication step [s], or a ratio such as "1/60".
    :param stop_time: end of a run [s].
    :param keys: other keys of a config, such as ``summary``, ``outcomes``, ``stop_when``, ``record``.
    """

    def __init__(self, *, step: float | str | Fraction, stop_time: float, **keys: Any) -> None:
        shown = str(step) if isinstance(step, Fraction) else step
        self._config: dict[str, Any] = {"step": shown, "stop_time": stop_time, "instances": {}, "connections": [], **copy.deepcopy(keys)}

    def add(self, name: str, fmu: Path, parameters: Mapping[str, Scalar] | None = None, **keys: Any) -> Instance:
        """Adds an instance of an FMU. ``fmu`` is the name of a shipped FMU, or a file. ``keys`` are further keys of an instance in a
        config."""
        if name in self._config["instances"]:
            raise InputError(f"add('{name}'): the system has an instance with this name", "duplicate_name")
        self._config["instances"][name] = {"fmu": os.fspath(fmu), **({"parameters": dict(parameters)} if parameters else {}), **keys}
        return Instance(name)

    def connect(self, source: Variable | str, target: Variable | str, **keys: Any) -> None:
        """Connects an output to an input. ``keys`` are further keys of a connection, such as ``sum`` or ``map``."""
        self._config["connections"].append({"from": str(source), "to": str(target), **keys})

    @property
    def config(self) -> dict[str, Any]:
        """Returns a copy of the config, for ``mebots.Mission`` and ``mebots.gym.MissionEnv``. Paths are relative to the working folder."""
        return copy.deepcopy(self._config)

    def write(self, file: Path) -> pathlib.Path:
        """Writes the config to a file, for ``mebots run`` and for studies. Makes paths of FMUs absolute."""
        content = self.config
        for instance in content["instances"].values():
            if os.path.isfile(instance["fmu"]):
                instance["fmu"] = os.path.abspath(instance["fmu"])
        path = pathlib.Path(file)
        path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
        return path

    def mission(self, **options: Any) -> Mission:
        """Returns a mission that runs the system. ``options`` are options of ``mebots.Mission``."""
        return Mission(self.config, **options)
