# SPDX-License-Identifier: Apache-2.0
"""The battery: voltage, warnings, and the time without supply."""

from __future__ import annotations

import enum

PERIOD_MS = 100
_LOW_AFTER_MS = 5000
_CHARGE_CURVE_V = (3.00, 3.78, 3.83, 3.87, 3.89, 3.92, 3.96, 4.00, 4.04, 4.10)  # at 0, 10, ... 90 %


class State(enum.IntEnum):
    """The values of ``pm.state``."""

    BATTERY = 0
    LOW_POWER = 3


class Power:
    def __init__(self) -> None:
        self.voltage_v = 3.7
        self.state = State.BATTERY
        self._good_ms = 0

    @property
    def level(self) -> int:
        """Returns the state of charge for the voltage, in % and steps of 10."""
        return 10 * min(sum(self.voltage_v > one for one in _CHARGE_CURVE_V), 9)

    def update(self, voltage_v: float, low_v: float, now_ms: int) -> str | None:
        """Stores the voltage. If the state changes, returns a text for the console."""
        before = self.state
        self.voltage_v = voltage_v
        if voltage_v > low_v:
            self._good_ms = now_ms
        self.state = State.LOW_POWER if now_ms - self._good_ms > _LOW_AFTER_MS else State.BATTERY
        if self.state == before:
            return None
        return "PM: low battery\n" if self.state == State.LOW_POWER else "PM: battery recovered\n"
