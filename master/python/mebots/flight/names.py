# SPDX-License-Identifier: Apache-2.0
"""Maps columns of logs to signals and units.

The names of the Crazyflie are those of the log groups in its firmware (crazyflie-firmware, LOG_GROUP_START): ``pwm`` in
motors.c, ``motor`` and ``stateEstimate`` in stabilizer.c, ``pm`` in pm_stm32f4.c, ``rpm`` in the RPM deck's driver.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping

from mebots import _mebots
from mebots.flight.log import UNITS, Array, Signal

DUTY = "1/65535"
"""Motor values of the Crazyflie's firmware: 65535 is a duty cycle of 1."""


@dataclasses.dataclass(frozen=True)
class Meaning:
    """The meaning of a column: its signal, its unit, and an additional factor."""

    signal: str
    unit: str
    scale: float = 1.0


def _per_rotor(pattern: str, signal: str, unit: str) -> dict[str, Meaning]:
    return {pattern.format(i): Meaning(signal.format(i), unit) for i in range(1, 5)}


def _per_axis(pattern: str, signal: str, unit: str) -> dict[str, Meaning]:
    return {pattern.format(axis): Meaning(signal.format(axis), unit) for axis in "xyz"}


CRAZYFLIE: dict[str, Meaning] = (
    _per_rotor("pwm.m{}_pwm", "motor[{}].command", DUTY)
    | _per_rotor("motor.m{}", "motor[{}].command", DUTY)
    | _per_rotor("rpm.m{}", "rotor[{}].speed", "rpm")
    | _per_rotor("motor.m{}_rpm", "rotor[{}].speed", "rpm")
    | {"pm.vbatMV": Meaning("battery.voltage", "mV"), "pm.vbat": Meaning("battery.voltage", "V")}
    | _per_axis("stateEstimate.{}", "position.{}", "m")
    | _per_axis("stateEstimate.v{}", "velocity.{}", "m/s")
    | _per_axis("stateEstimateZ.{}", "position.{}", "mm")
    | _per_axis("stateEstimateZ.v{}", "velocity.{}", "mm/s")
    | {f"stateEstimate.q{part}": Meaning(f"attitude.q{part}", "1") for part in "xyzw"}
    | _per_axis("acc.{}", "acceleration.{}", "g0")
    | _per_axis("gyro.{}", "rate.{}", "deg/s")
)
"""Columns of the firmware's logs. If two columns have the same signal, the earlier one counts."""


def signal_of(column: str, meaning: Meaning, times: Array, values: Array) -> Signal:
    """Returns the signal that the mapping assigns to a column, converted to the signal's unit."""
    unit = UNITS[meaning.signal]
    return Signal(meaning.signal, unit, times, values * (_mebots.log_unit_factor(meaning.unit, unit) * meaning.scale), column)


def named(columns: Iterable[tuple[str, Array, Array]], meanings: Mapping[str, Meaning]) -> list[Signal]:
    """Returns signals for columns (name, times, values). Columns in ``meanings`` become known signals; others keep their names."""
    found: dict[str, Signal] = {}
    order = {column: place for place, column in enumerate(meanings)}
    for column, times, values in sorted(columns, key=lambda one: order.get(one[0], len(order))):
        meaning = meanings.get(column)
        if meaning is None or meaning.signal in found:
            found.setdefault(column, Signal(column, "", times, values, column))
        else:
            found[meaning.signal] = signal_of(column, meaning, times, values)
    return list(found.values())
