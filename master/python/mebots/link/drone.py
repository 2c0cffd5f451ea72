# SPDX-License-Identifier: Apache-2.0
"""The part of a drone's firmware between the link and the simulated controller.

Its behaviour depends only on packets, readings and simulated time, so that a recorded run can be repeated.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from mebots.link import power, supervisor
from mebots.link.commander import Commander, Priority
from mebots.link.control import PERIOD_MS, Inputs, PositionLoop
from mebots.link.crtp import MAX_DATA, Packet, Port
from mebots.link.high_level import HighLevel
from mebots.link.log import Log
from mebots.link.memory import Memories
from mebots.link.parameters import Parameters
from mebots.link.planner import Planner
from mebots.link.planner import State as PlannerState
from mebots.link.readings import Readings
from mebots.link.setpoints import OFF, Setpoint, Unsupported, decode
from mebots.link.tables import FIXED, KALMAN, PID, parameters, variables
from mebots.link.trajectories import Goal

_PROTOCOL_VERSION = 12
_FIRMWARE, _DEVICE = b"MEbots", b"Crazyflie 2.1, simulated"
_GREETING = b"Bitcraze Crazyflie"
_LEAST_SUPPLY_V = 1.0
_NULL = Packet(15, 3, b"")
_META_CHANNEL, _SETPOINTS_STOP = 1, 0
_ECHO_CHANNEL, _SOURCE_CHANNEL = 0, 1
_COMMAND_CHANNEL, _VERSION_CHANNEL = 0, 1
_LIMITED = ("posCtlPid.xKp", "posCtlPid.yKp", "posCtlPid.xVelMax", "posCtlPid.yVelMax")
_MOST_GAIN = 100.0


class Drone:
    """:param decks: names of the decks that the drone reports, such as "bcFlow2"."""

    def __init__(self, decks: Iterable[str], now: Readings) -> None:
        self.now = now
        self.now_ms = 0
        self.power = power.Power()
        self.power.voltage_v = now.bus_voltage_v
        self.supervisor = supervisor.Supervisor()
        self._commander = Commander()
        self._planner = Planner()
        self._parameters = Parameters(parameters(decks), self._changed)
        self._log = Log(variables(self))
        self._memories = Memories()
        self._high_level = HighLevel(self._planner, self.supervisor, self._parameters, self._memories.trajectories)
        self._loop = PositionLoop(self._parameters)
        self._console: list[Packet] = []
        self._printed: set[str] = set()

    @property
    def is_powered(self) -> bool:
        """Returns False if the battery's protection has opened. The drone then does not answer."""
        return self.now.bus_voltage_v >= _LEAST_SUPPLY_V

    @property
    def setpoint(self) -> Setpoint:
        return self._commander.setpoint

    @property
    def info(self) -> int:
        finished = self._planner.has_finished(self.now_ms / 1000.0)
        return self.supervisor.info(self._planner.is_active, finished, self._planner.state == PlannerState.DISABLED)

    def handle(self, packet: Packet) -> list[Packet]:
        """Returns the drone's answers to a packet that arrives now."""
        if not self.is_powered:
            return []
        if packet == _NULL:
            return [_NULL]
        return self._dispatch(packet) + self._printed_texts()

    def control(self) -> Inputs:
        """Returns the inputs of the simulated drone for the next period."""
        if not self.is_powered:
            return self._loop.update(OFF, self.now, False)
        if self.supervisor.can_fly:
            self._follow_planner()
        else:
            if self._planner.is_active:
                self._planner.stop()
            self._rest()
        if self.now_ms % supervisor.PERIOD_MS == 0:
            self._supervise()
        allowed = self.supervisor.can_fly
        return self._loop.update(self.setpoint if allowed else OFF, self.now, self.supervisor.state == supervisor.State.LEVEL_OUT)

    def advance(self, now: Readings) -> list[Packet]:
        """Stores the readings at the end of a period. Returns packets that the drone sends without a request."""
        self.now = now
        self.now_ms += PERIOD_MS
        if not self.is_powered:
            return []
        if self.now_ms % power.PERIOD_MS == 0:
            self._print(self.power.update(now.bus_voltage_v, self._parameters["pm.lowVoltage"], self.now_ms))
        return self._log.due(self.now_ms) + self._parameters.updates() + self._printed_texts()

    def _dispatch(self, packet: Packet) -> list[Packet]:
        match packet.port:
            case Port.PARAMETERS:
                return self._parameters.handle(packet)
            case Port.MEMORY:
                return self._memories.handle(packet)
            case Port.LOG:
                return self._log.handle(packet, self.now_ms)
            case Port.HIGH_LEVEL:
                return self._high_level.handle(packet, self.now_ms / 1000.0)
            case Port.SUPERVISOR:
                return self.supervisor.handle(packet, self.info, self.now_ms)
            case Port.SETPOINT | Port.GENERIC_SETPOINT:
                self._take_setpoint(packet)
            case Port.PLATFORM:
                return self._about(packet)
            case Port.LINK:
                if packet.channel == _ECHO_CHANNEL:
                    return [packet]
                if packet.channel == _SOURCE_CHANNEL:
                    return [packet.answer(_GREETING.ljust(MAX_DATA, b"\0"))]
        return []

    def _about(self, packet: Packet) -> list[Packet]:
        command = packet.data[0] if packet.data else -1
        if packet.channel == _VERSION_CHANNEL:
            answers = {0: _PROTOCOL_VERSION.to_bytes(4, "little"), 1: _FIRMWARE, 2: _DEVICE}
            return [packet.answer(packet.data[:1] + answers[command])] if command in answers else []
        if packet.channel != _COMMAND_CHANNEL:
            return []
        if command == 1 and len(packet.data) > 1:  # older clients arm on this port
            armed = self.supervisor.arm(packet.data[1] != 0)
            return [packet.answer(bytes([command, armed, self.info >> 1 & 1]))]
        if command == 2:
            recovered = self.supervisor.recover()
            return [packet.answer(bytes([command, recovered, ~self.info >> 7 & 1]))]
        return [packet.answer(b"")] if command == 3 else [packet]

    def _take_setpoint(self, packet: Packet) -> None:
        if packet.port == Port.GENERIC_SETPOINT and packet.channel == _META_CHANNEL:
            if packet.data[:1] == bytes([_SETPOINTS_STOP]):
                self._rest()
                self._commander.relax()
            return
        if packet.channel != 0 or self._is_farewell(packet):
            return
        flags = {name: self._parameters[f"flightmode.{name}"] != 0 for name in ("althold", "poshold", "posSet")}
        try:
            setpoint = decode(packet, flags)
        except Unsupported as reason:
            self._print_once(f"LINK: ignored {reason}\n")
            return
        if setpoint is not None:
            self._commander.set(setpoint, Priority.CLIENT, self.now_ms)
            self._planner.stop()

    def _is_farewell(self, packet: Packet) -> bool:
        """True for the zero set-points that cflib sends when it closes a link. With a real radio, the driver closes before they are sent.
        Under the high-level commander, the drone would treat them as new set-points, and lock itself because no others follow."""
        return packet.port == Port.SETPOINT and not any(packet.data) and self._commander.priority != Priority.CLIENT

    def _follow_planner(self) -> None:
        goal = self._planner.goal(self.now_ms / 1000.0)
        if goal is not None:
            self._commander.set(_setpoint_of(goal), Priority.HIGH_LEVEL, self.now_ms)
            return
        self._rest()
        if self._planner.state == PlannerState.IDLE:
            self._commander.set(OFF, Priority.HIGH_LEVEL, self.now_ms)

    def _rest(self) -> None:
        if not self._planner.is_active:
            self._planner.rest(self.now.position_m, self.now.velocity_m_per_s, self.now.yaw_rad)

    def _supervise(self) -> None:
        limits_ms = (self._parameters["supervisor.prefltTimeout"], self._parameters["supervisor.landedTimeout"])
        checks = self._parameters["supervisor.tmblChckEn"] != 0
        self._print(self.supervisor.update(self.now, self._commander.age_ms(self.now_ms), limits_ms, checks, self.now_ms))

    def _changed(self, name: str) -> None:
        value = self._parameters[name]
        if name == "stabilizer.stop":
            self.supervisor.emergency = value != 0
        elif name == "stabilizer.controller" and value not in (0, PID):
            self._parameters.set(name, PID)
            self._print("LINK: the simulated controller is PID (1)\n")
        elif name == "stabilizer.estimator" and value not in (0, KALMAN):
            self._print_once("LINK: only the config can select the estimator\n")
        elif name in _LIMITED and not 0.0 <= value <= _MOST_GAIN:  # also false for NaN
            self._parameters.set(name, min(max(value, 0.0), _MOST_GAIN) if math.isfinite(value) else 0.0)
            self._print(f"LINK: {name} must be from 0 to {_MOST_GAIN:g}\n")
        elif name.partition(".")[2] in FIXED.get(name.partition(".")[0], ()):
            self._print_once(f"LINK: {name} has no effect\n")

    def _print(self, text: str | None) -> None:
        """Sends a text to the client's console."""
        data = (text or "").encode()
        self._console += [Packet(Port.CONSOLE, 0, data[at : at + MAX_DATA]) for at in range(0, len(data), MAX_DATA)]

    def _print_once(self, text: str) -> None:
        if text not in self._printed:
            self._printed.add(text)
            self._print(text)

    def _printed_texts(self) -> list[Packet]:
        packets, self._console = self._console, []
        return packets


def _setpoint_of(goal: Goal) -> Setpoint:
    x, y, z = goal.position_m
    return Setpoint(position_m=(x, y), height_m=z, yaw_rad=goal.yaw_rad, yaw_rate_rad_per_s=goal.yaw_rate_rad_per_s)
