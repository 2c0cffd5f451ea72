# SPDX-License-Identifier: Apache-2.0
"""Connects the simulated firmware of drones to their missions."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import pathlib
import struct
from collections.abc import Mapping
from typing import Any

from mebots import _mebots
from mebots.errors import InputError
from mebots.link.control import PERIOD_MS, Inputs
from mebots.link.crtp import Packet
from mebots.link.drone import Drone
from mebots.link.plant import Parts, Plant, find_drones
from mebots.link.readings import Readings
from mebots.link.tables import DECKS
from mebots.mission import Mission, Scalar

MOST_DRONES = 100


@dataclasses.dataclass(frozen=True)
class Settings:
    """The settings of a run, which its recording contains.

    :param drones: number of runs of the config, each with its own world.
    :param spacing: distance between the starts of these runs along y [m].
    :param decks: decks that the drones report.
    :param set: values for parameters and start values, by "instance.variable".
    :param stop_time: end of the run [s], in place of the config's.
    """

    drones: int = 1
    spacing: float = 1.0
    decks: tuple[str, ...] = ("bcFlow2",)
    set: Mapping[str, Scalar] = dataclasses.field(default_factory=dict)
    stop_time: float | None = None

    def __post_init__(self) -> None:
        if not 1 <= self.drones <= MOST_DRONES:
            raise InputError(f"--drones {self.drones}: a number from 1 to {MOST_DRONES} is expected", "invalid_value")
        strange = [deck for deck in self.decks if deck not in DECKS]
        if strange:
            raise InputError(f"--decks: '{strange[0]}' is no deck that can be reported; these are: {', '.join(DECKS)}", "invalid_value")


class Session:
    """Simulates drones on a common clock. Only ``handle`` and ``advance`` change the state, so equal calls give equal bits.

    :param out: folder for the results; None = no files. With several runs, each has a subfolder "drone1" and so on.
    """

    def __init__(self, config: str | os.PathLike[str], settings: Settings, out: pathlib.Path | None) -> None:
        content = json.loads(_mebots.BaseConfig(config).config)
        parts = find_drones(content, os.fspath(config))
        self._missions: list[Mission] = []
        self._plants: list[Plant] = []
        try:
            for index in range(settings.drones):
                folder = out if out is None or settings.drones == 1 else out / f"drone{index + 1}"
                offsets = _offsets(content, parts, index * settings.spacing) if index > 0 else {}
                mission = Mission(
                    config, set={**offsets, **settings.set}, out=folder, in_memory=False, stop_time=settings.stop_time, uncertainty="none"
                )
                self._missions.append(mission)
                mission.start()
                _check_step(mission, os.fspath(config))
                self._plants += [Plant(mission, one) for one in parts if one.is_in(mission)]
            _check_drones(self._plants, parts, os.fspath(config))
        except BaseException:
            self.close()
            raise
        self.drones = [Drone(settings.decks, plant.read()) for plant in self._plants]
        self._start_s = self._missions[0].time
        self.time_ms = 0  # since the start
        self._hash = hashlib.sha256()

    @property
    def fingerprint(self) -> str:
        """Returns a hash of all readings, inputs and packets so far."""
        return self._hash.hexdigest()[:16]

    @property
    def ended(self) -> bool:
        """Returns True if a mission has ended, or if no drone has power."""
        return any(mission.ended for mission in self._missions) or not any(drone.is_powered for drone in self.drones)

    @property
    def end_text(self) -> str:
        if not any(drone.is_powered for drone in self.drones):
            return "no drone has power: the batteries' protection has opened"
        return next((mission.end_text for mission in self._missions if mission.ended), "")

    def handle(self, index: int, packet: Packet) -> list[Packet]:
        """Returns a drone's answers to a packet that arrives now."""
        answers = self.drones[index].handle(packet)
        self._note_packets(index, [packet, *answers])
        return answers

    def advance(self) -> list[tuple[int, Packet]]:
        """Runs the missions for one period, which no signal interrupts. Returns packets that drones send without a request, with the index
        of the drone."""
        for plant, drone in zip(self._plants, self.drones, strict=True):
            inputs = drone.control()
            plant.write(inputs)
            self._note_numbers(inputs)
        self.time_ms += PERIOD_MS
        for mission in self._missions:
            mission.run_through(self._start_s + self.time_ms / 1000.0)
        sent = []
        for index, (plant, drone) in enumerate(zip(self._plants, self.drones, strict=True)):
            now = plant.read()
            self._note_numbers(_flat(now))
            packets = drone.advance(now)
            self._note_packets(index, packets)
            sent += [(index, packet) for packet in packets]
        return sent

    def close(self) -> None:
        """Ends the missions at the current point and writes their reports."""
        for mission in self._missions:
            mission.close()

    def _note_packets(self, index: int, packets: list[Packet]) -> None:
        for packet in packets:
            data = packet.encode()
            self._hash.update(struct.pack("<IIB", self.time_ms, index, len(data)) + data)

    def _note_numbers(self, numbers: tuple[float, ...] | Inputs) -> None:
        self._hash.update(struct.pack(f"<{len(numbers)}d", *numbers))


def _flat(now: Readings) -> tuple[float, ...]:
    return tuple(number for one in now for number in (one if isinstance(one, tuple) else (one,)))


def _offsets(config: Mapping[str, Any], parts: list[Parts], distance_m: float) -> dict[str, Scalar]:
    """Returns start offsets that place the drones of another run next to those of the first run, at ``distance_m`` along y."""
    offsets: dict[str, Scalar] = {}
    for one in parts:
        name = one.variable("start.offset.y")
        given = config["instances"][one.world].get("parameters", {})
        offsets[name] = given.get(name.removeprefix(f"{one.world}."), 0) + distance_m
    return offsets


def _check_drones(plants: list[Plant], parts: list[Parts], file: str) -> None:
    """Raises InputError if no drone exists whose rotors are connected."""
    if not plants:
        names = ", ".join(sorted({one.world for one in parts}))
        least = min(one.number or 1 for one in parts)
        raise InputError(
            f"{file}: no drone with connected rotors exists in: {names}; set drone.count to at least {least}, or connect the rotors of drone[1]",
            "invalid_value",
        )


def _check_step(mission: Mission, file: str) -> None:
    """Raises InputError unless ``PERIOD_MS``, the period of the controller, is a multiple of the communication step."""
    steps = PERIOD_MS / 1000.0 / mission.step_size
    if abs(steps - round(steps)) > 1e-9 or round(steps) < 1:
        raise InputError(
            f"{file}: step {mission.step_size:g} s: `mebots link` needs a step that divides {PERIOD_MS} ms, such as 0.002", "invalid_value"
        )
