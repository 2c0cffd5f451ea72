# SPDX-License-Identifier: Apache-2.0
"""Stores the current set-point. Priorities decide whether a new set-point replaces it."""

from __future__ import annotations

import enum

from mebots.link.setpoints import OFF, Setpoint


class Priority(enum.IntEnum):
    DISABLED = 0
    HIGH_LEVEL = 1
    CLIENT = 2


class Commander:
    def __init__(self) -> None:
        self.setpoint = OFF
        self.priority = Priority.DISABLED
        self._stamp_ms = 0

    def set(self, setpoint: Setpoint, priority: Priority, now_ms: int) -> bool:
        """Replaces the current set-point. If the current one has a higher priority, returns False without effect."""
        if priority < self.priority:
            return False
        self.setpoint = setpoint
        self.priority = priority
        self._stamp_ms = now_ms
        return True

    def relax(self) -> None:
        """Lowers the priority of the current set-point, so that the high-level commander can replace it."""
        self.priority = Priority.HIGH_LEVEL

    def age_ms(self, now_ms: int) -> int:
        return now_ms - self._stamp_ms
