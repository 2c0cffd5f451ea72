# SPDX-License-Identifier: Apache-2.0
"""The supervisor, which determines whether the drone may fly, flies, has crashed or is locked (port 9).

States and conditions are those of the firmware, for a drone that arms itself. A crash of the simulated drone counts as tumbled. This state
is permanent, because the motors do not restart.
"""

from __future__ import annotations

import enum

from mebots.link.crtp import Packet
from mebots.link.readings import Readings

PERIOD_MS = 40
_G = 9.81
_FLYING_AFTER_THRUST_MS = 2000
_TILTED_G, _TILTED_MS = 0.5, 1000
_UPSIDE_DOWN_G, _UPSIDE_DOWN_MS = -0.2, 100
_FREE_FALL_G = 0.1
_EMERGENCY_WATCHDOG_MS = 1000
WARNING_MS, TIMEOUT_MS = 500, 2000

_INFO_CHANNEL, _COMMAND_CHANNEL = 0, 1
_ANSWER = 0x80
_ARM, _RECOVER, _EMERGENCY_STOP, _EMERGENCY_WATCHDOG = 1, 2, 3, 4
_FIRST_BIT, _LAST_BIT, _BITS = 1, 11, 12


class State(enum.Enum):
    CHECKS_NOT_PASSED = enum.auto()
    CHECKS_PASSED = enum.auto()
    ARMING = enum.auto()
    READY = enum.auto()
    FLYING = enum.auto()
    LANDED = enum.auto()
    RESET = enum.auto()
    LEVEL_OUT = enum.auto()
    FREE_FALL = enum.auto()
    LOCKED = enum.auto()
    CRASHED = enum.auto()


_CAN_FLY = frozenset({State.READY, State.FLYING, State.LEVEL_OUT, State.LANDED})
_STAYS_ARMED = _CAN_FLY | {State.ARMING}
_TEXTS = {
    State.FREE_FALL: "SUP: motors off in flight\n",
    State.LOCKED: "SUP: locked until a restart\n",
    State.CRASHED: "SUP: crashed\n",
}


class Supervisor:
    def __init__(self) -> None:
        self.state = State.CHECKS_NOT_PASSED
        self.tumbled = False
        self.emergency = False  # also set by the parameter stabilizer.stop
        self._armed = False
        self._crashed = False
        self._thrust_ms: int | None = None
        self._tilted_ms: int | None = None
        self._landed_ms = 0
        self._ready_ms = 0
        self._watchdog_ms: int | None = None
        self._stopped = False

    @property
    def can_fly(self) -> bool:
        return self.state in _CAN_FLY

    @property
    def is_flying(self) -> bool:
        return self.state in (State.FLYING, State.LEVEL_OUT)

    def info(self, path_active: bool, path_finished: bool, path_disabled: bool) -> int:
        """Returns the bits of ``supervisor.info``."""
        bits = (
            self.state == State.CHECKS_PASSED,
            self._armed,
            True,  # the drone arms itself
            self.can_fly,
            self.is_flying,
            self.tumbled,
            self.state == State.LOCKED,
            self._crashed,
            path_active,
            path_finished,
            path_disabled,
        )
        return sum(1 << number for number, bit in enumerate(bits) if bit)

    def handle(self, packet: Packet, info: int, now_ms: int) -> list[Packet]:
        command = packet.data[0] if packet.data else 0
        if packet.channel == _INFO_CHANNEL:
            if command == _BITS:
                return [packet.answer(bytes([_ANSWER | command]) + info.to_bytes(2, "little"))]
            if _FIRST_BIT <= command <= _LAST_BIT:
                return [packet.answer(bytes([_ANSWER | command, info >> (command - _FIRST_BIT) & 1]))]
        elif packet.channel == _COMMAND_CHANNEL:
            if command == _EMERGENCY_STOP:
                self._stopped = True
            elif command == _EMERGENCY_WATCHDOG:
                self._watchdog_ms = now_ms
            elif command == _ARM:
                done = self.arm(packet.data[1:2] not in (b"", b"\0"))
                return [packet.answer(bytes([_ANSWER | command, done, self._armed]))]
            elif command == _RECOVER:
                done = self.recover()
                return [packet.answer(bytes([_ANSWER | command, done, not self._crashed]))]
        return []

    def arm(self, arms: bool) -> bool:
        """Arms or disarms the drone. Returns False if it rejects the request."""
        if arms == self._armed:
            return True
        if arms and self.state != State.CHECKS_PASSED:
            return False
        self._armed = arms
        return True

    def recover(self) -> bool:
        """Handles a request to recover from a crash. Returns False if the drone cannot fly again."""
        if self._crashed and self.tumbled:
            return False
        self._crashed = False
        return True

    def update(self, now: Readings, setpoint_age_ms: int, limits_ms: tuple[float, float], checks_tumbling: bool, now_ms: int) -> str | None:
        """Updates the state. If it changes, returns a text for the console.

        :param limits_ms: longest times for which the drone stays armed on the ground: before a flight, and after a landing.
        """
        if now.motors_run:
            self._thrust_ms = now_ms
        flying = self._thrust_ms is not None and now_ms - self._thrust_ms < _FLYING_AFTER_THRUST_MS
        self.tumbled = now.crashed or (checks_tumbling and self._is_tilted(now, now_ms))
        late = self._watchdog_ms is not None and now_ms >= self._watchdog_ms + _EMERGENCY_WATCHDOG_MS
        after = self._next(flying, self._stopped or self.emergency or late, setpoint_age_ms, limits_ms, now_ms)
        if after is None:
            return None
        self.state = after
        if after == State.READY:
            self._ready_ms = now_ms
        if after == State.LANDED:
            self._landed_ms = now_ms
        if after == State.CRASHED:
            self._crashed = True
        if after not in _STAYS_ARMED:
            self._armed = after == State.CHECKS_PASSED
        return _TEXTS.get(after)

    def _is_tilted(self, now: Readings, now_ms: int) -> bool:
        """True if the drone was tilted for a long time, or upside down for a shorter time. Free fall does not count."""
        x, y, z = (one / _G for one in now.acceleration_m_per_s2)
        if max(abs(x), abs(y), abs(z)) < _FREE_FALL_G:
            self._tilted_ms = None
        if z >= _TILTED_G:
            self._tilted_ms = None
            return False
        if self._tilted_ms is None:
            self._tilted_ms = now_ms
        since_ms = now_ms - self._tilted_ms
        return since_ms > _TILTED_MS or (z < _UPSIDE_DOWN_G and since_ms > _UPSIDE_DOWN_MS)

    def _next(self, flying: bool, stop: bool, age_ms: int, limits_ms: tuple[float, float], now_ms: int) -> State | None:
        """Returns the state that follows the current state, or None if it stays the same. The first transition of the current state whose
        condition is true is taken."""
        timed_out = age_ms > TIMEOUT_MS
        transitions: dict[State, tuple[tuple[bool, State], ...]] = {
            State.CHECKS_NOT_PASSED: ((stop, State.FREE_FALL), (not self.tumbled, State.CHECKS_PASSED)),
            State.CHECKS_PASSED: ((stop, State.FREE_FALL), (self.tumbled, State.CHECKS_NOT_PASSED), (self._armed, State.ARMING)),
            State.ARMING: ((stop, State.FREE_FALL), (self.tumbled or not self._armed, State.CHECKS_NOT_PASSED), (True, State.READY)),
            State.READY: (
                (stop, State.FREE_FALL),
                (self.tumbled or not self._armed or now_ms - self._ready_ms > limits_ms[0], State.CHECKS_NOT_PASSED),
                (flying, State.FLYING),
            ),
            State.FLYING: (
                (stop or timed_out, State.FREE_FALL),
                (self.tumbled, State.CRASHED),
                (not self._armed, State.RESET),
                (age_ms > WARNING_MS, State.LEVEL_OUT),
                (not flying, State.LANDED),
            ),
            State.LANDED: ((not self._armed or now_ms - self._landed_ms > limits_ms[1], State.RESET), (flying, State.FLYING)),
            State.RESET: ((True, State.CHECKS_NOT_PASSED),),
            State.LEVEL_OUT: ((stop or timed_out or self.tumbled, State.FREE_FALL), (age_ms <= WARNING_MS, State.FLYING)),
            State.FREE_FALL: ((True, State.LOCKED),),
            State.LOCKED: (),
            State.CRASHED: ((not self._crashed and not self.tumbled, State.CHECKS_NOT_PASSED), (stop, State.LOCKED)),
        }
        return next((after for condition, after in transitions[self.state] if condition), None)
