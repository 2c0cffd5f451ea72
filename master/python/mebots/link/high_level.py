# SPDX-License-Identifier: Apache-2.0
"""Handles commands to the high-level commander (port 8)."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from typing import NamedTuple

from mebots.link.crtp import Errno, Packet
from mebots.link.parameters import Parameters
from mebots.link.planner import Planner
from mebots.link.supervisor import Supervisor
from mebots.link.trajectories import PIECE_BYTES, Piece

_DEFINITIONS = 31
_IN_MEMORY, _POLYNOMIALS = 1, 0


class _Trajectory(NamedTuple):
    place: int = 0  # 0: undefined trajectory
    kind: int = 0
    offset: int = 0
    pieces: int = 0


class HighLevel:
    """Decodes commands and passes them to the planner.

    :param supervisor: permits or rejects flights.
    :param memory: the uploaded trajectories.
    """

    def __init__(self, planner: Planner, supervisor: Supervisor, parameters: Parameters, memory: bytearray) -> None:
        self._planner = planner
        self._supervisor = supervisor
        self._parameters = parameters
        self._memory = memory
        self._trajectories = [_Trajectory()] * _DEFINITIONS

    def handle(self, packet: Packet, time_s: float) -> list[Packet]:
        command = packet.data[0] if packet.data else -1
        return [packet.answer(packet.data[:3].ljust(3, b"\0") + bytes([self._execute(command, packet.data[1:], time_s)]))]

    def _execute(self, command: int, data: bytes, time_s: float) -> Errno:
        layout, work = _COMMANDS.get(command, ("", None))
        if work is None:
            return Errno.NO_COMMAND
        if len(data) < struct.calcsize(layout):
            return Errno.INVALID
        values = struct.unpack_from(layout, data)
        if not all(math.isfinite(one) for one in values):
            return Errno.INVALID
        return work(self, values, time_s)

    def _fly(self, group: int) -> Errno | None:
        """Returns None if a command for this group can be executed. Otherwise, returns the answer: BUSY if the drone cannot fly, NONE (no
        error) if it is not in the group."""
        if not self._supervisor.can_fly:
            return Errno.BUSY
        return None if self._is_in(group) else Errno.NONE

    def _is_in(self, group: int) -> bool:
        return group == 0 or (group & int(self._parameters["hlCommander.groupmask"])) != 0

    def _set_group(self, values: tuple, _time_s: float) -> Errno:
        self._parameters.set("hlCommander.groupmask", values[0])
        return Errno.NONE

    def _stop(self, values: tuple, _time_s: float) -> Errno:
        if self._is_in(values[0]):
            self._planner.stop()
        return Errno.NONE

    def _vertical(self, values: tuple, time_s: float, start: Callable[[float, float, float, float], bool]) -> Errno:
        group, height_m, *more, duration_s = values
        refused = self._fly(group)
        if refused is not None:
            return refused
        yaw_rad, keeps_yaw = more or (0.0, False)
        return Errno.NONE if start(height_m, self._planner.last.yaw_rad if keeps_yaw else yaw_rad, duration_s, time_s) else Errno.NOT_PERMITTED

    def _take_off(self, values: tuple, time_s: float) -> Errno:
        return self._vertical(values, time_s, self._planner.take_off)

    def _land(self, values: tuple, time_s: float) -> Errno:
        return self._vertical(values, time_s, self._planner.land)

    def _take_off_at(self, values: tuple, time_s: float) -> Errno:
        return self._vertical(self._timed(values, 1.0, "vtoff"), time_s, self._planner.take_off)

    def _land_at(self, values: tuple, time_s: float) -> Errno:
        return self._vertical(self._timed(values, -1.0, "vland"), time_s, self._planner.land)

    def _timed(self, values: tuple, direction: float, default: str) -> tuple:
        """Converts the values of a take-off or landing that states a speed to those with a duration."""
        group, height_m, relative, yaw_rad, keeps_yaw, speed_m_per_s = values
        now_m = self._planner.last.position_m[2]
        if relative:
            height_m = now_m + direction * height_m
        if not speed_m_per_s > 0.0:
            speed_m_per_s = self._parameters[f"hlCommander.{default}"]
        duration_s = abs(height_m - now_m) / speed_m_per_s if speed_m_per_s > 0.0 else 0.0
        return group, height_m, yaw_rad, keeps_yaw, duration_s

    def _go_to(self, values: tuple, time_s: float) -> Errno:
        group, relative, *more = values
        linear, x, y, z, yaw_rad, duration_s = more if len(more) == 6 else (False, *more)
        refused = self._fly(group)
        if refused is None:
            self._planner.go_to((x, y, z), yaw_rad, duration_s, time_s, relative=bool(relative), linear=bool(linear))
        return refused or Errno.NONE

    def _spiral(self, values: tuple, time_s: float) -> Errno:
        group, sideways, clockwise, angle_rad, first_m, last_m, ascent_m, duration_s = values
        refused = self._fly(group)
        if refused is not None:
            return refused
        if not duration_s > 0.0:
            return Errno.INVALID
        self._planner.spiral(angle_rad, (first_m, last_m), ascent_m, duration_s, time_s, sideways=bool(sideways), clockwise=bool(clockwise))
        return Errno.NONE

    def _define(self, values: tuple, _time_s: float) -> Errno:
        if values[0] >= _DEFINITIONS:
            return Errno.NO_COMMAND
        self._trajectories[values[0]] = _Trajectory(*values[1:])
        return Errno.NONE

    def _start(self, values: tuple, time_s: float) -> Errno:
        group, relative, *more = values
        turned, backwards, number, time_scale = more if len(more) == 4 else (False, *more)
        refused = self._fly(group)
        if refused is not None:
            return refused
        if number >= _DEFINITIONS or self._trajectories[number].place != _IN_MEMORY:
            return Errno.NONE  # same answer as the firmware
        trajectory = self._trajectories[number]
        pieces = self._pieces(trajectory)
        if trajectory.kind != _POLYNOMIALS or not pieces or not time_scale > 0.0:
            return Errno.NO_COMMAND
        self._planner.follow(pieces, time_scale, time_s, relative=bool(relative), turned=bool(turned), backwards=bool(backwards))
        return Errno.NONE

    def _pieces(self, trajectory: _Trajectory) -> list[Piece]:
        """Returns the pieces of a trajectory. Empty if the trajectory is not inside the memory."""
        end = trajectory.offset + trajectory.pieces * PIECE_BYTES
        if end > len(self._memory):
            return []
        return [Piece.unpack(self._memory[at : at + PIECE_BYTES]) for at in range(trajectory.offset, end, PIECE_BYTES)]


_COMMANDS: dict[int, tuple[str, Callable[[HighLevel, tuple, float], Errno]]] = {
    0: ("<B", HighLevel._set_group),
    1: ("<Bff", HighLevel._take_off),
    2: ("<Bff", HighLevel._land),
    3: ("<B", HighLevel._stop),
    4: ("<BBfffff", HighLevel._go_to),
    5: ("<BBBBf", HighLevel._start),
    6: ("<BBBIB", HighLevel._define),
    7: ("<Bff?f", HighLevel._take_off),
    8: ("<Bff?f", HighLevel._land),
    9: ("<Bf?f?f", HighLevel._take_off_at),
    10: ("<Bf?f?f", HighLevel._land_at),
    11: ("<BBBfffff", HighLevel._spiral),
    12: ("<BBBfffff", HighLevel._go_to),
    13: ("<BBBBBf", HighLevel._start),
}
