# SPDX-License-Identifier: Apache-2.0
"""Decodes set-points, which a client sends repeatedly (ports 3 and 7)."""

from __future__ import annotations

import dataclasses
import math
import struct
from collections.abc import Callable, Mapping

from mebots.link.angles import arc_tangent
from mebots.link.crtp import Packet, Port

_RADIANS = math.pi / 180.0
_LEAST_THRUST = 1000
_FULL_CLIMB = 32767.0


@dataclasses.dataclass(frozen=True)
class Setpoint:
    """A set-point. Position, height and yaw take precedence over velocity, climb rate and yaw rate."""

    motors: bool = True
    position_m: tuple[float, float] | None = None  # horizontal
    velocity_m_per_s: tuple[float, float] = (0.0, 0.0)  # horizontal
    along_heading: bool = False  # True: relative to the heading; False: in the world frame
    height_m: float | None = None
    climb_m_per_s: float = 0.0
    yaw_rad: float | None = None
    yaw_rate_rad_per_s: float = 0.0


OFF = Setpoint(motors=False)


class Unsupported(Exception):
    """Raised for a set-point that the simulated drone cannot follow."""


def decode(packet: Packet, flags: Mapping[str, bool]) -> Setpoint | None:
    """Returns the set-point in a packet, or None. Raises Unsupported if the simulated drone cannot follow it.

    :param flags: the parameters flightmode.althold, poshold and posSet.
    """
    layout, make = ("<fffH", None) if packet.port == Port.SETPOINT else _KINDS.get(packet.data[0] if packet.data else -1, ("", None))
    body = packet.data if packet.port == Port.SETPOINT else packet.data[1:]
    if not layout or len(body) < struct.calcsize(layout):
        return None
    values = struct.unpack_from(layout, body)
    if not all(math.isfinite(value) for value in values):
        raise Unsupported("a number is not finite")
    return _sticks(values, flags) if make is None else make(values)


def _sticks(values: tuple, flags: Mapping[str, bool]) -> Setpoint:
    """Decodes roll, pitch, yaw and thrust. Parameters can change their meanings."""
    roll, pitch, yaw, thrust = values
    if flags["posSet"] and thrust != 0:
        return Setpoint(position_m=(-pitch, roll), height_m=thrust / 1000.0, yaw_rad=yaw * _RADIANS)
    if flags["poshold"] and flags["althold"]:
        climb_m_per_s = (thrust - _FULL_CLIMB) / _FULL_CLIMB
        return Setpoint(velocity_m_per_s=(pitch / 30.0, roll / 30.0), climb_m_per_s=climb_m_per_s, yaw_rate_rad_per_s=-yaw * _RADIANS)
    if thrust < _LEAST_THRUST and not flags["althold"]:
        return OFF
    raise Unsupported("a set-point of roll, pitch and thrust; send velocities or positions")


def _attitude(_values: tuple) -> Setpoint:
    raise Unsupported("a set-point of roll and pitch; send velocities or positions")


def _stop(_values: tuple) -> Setpoint:
    return OFF


def _velocity(values: tuple, turn: float = 1.0) -> Setpoint:
    x, y, z, yaw_rate = values
    return Setpoint(velocity_m_per_s=(x, y), climb_m_per_s=z, yaw_rate_rad_per_s=turn * yaw_rate * _RADIANS)


def _hover(values: tuple, turn: float = 1.0) -> Setpoint:
    x, y, yaw_rate, height_m = values
    return Setpoint(velocity_m_per_s=(x, y), along_heading=True, height_m=height_m, yaw_rate_rad_per_s=turn * yaw_rate * _RADIANS)


def _position(values: tuple) -> Setpoint:
    x, y, z, yaw = values
    return Setpoint(position_m=(x, y), height_m=z, yaw_rad=yaw * _RADIANS)


def _full_state(values: tuple) -> Setpoint:
    """Decodes position, velocity and acceleration in mm, attitude, and rates. Uses only position and yaw, as the PID controller does."""
    w, x, y, z = _quaternion(values[9])
    yaw_rad = arc_tangent(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return Setpoint(position_m=(values[0] / 1000.0, values[1] / 1000.0), height_m=values[2] / 1000.0, yaw_rad=yaw_rad)


def _quaternion(packed: int) -> tuple[float, float, float, float]:
    """Decodes a quaternion of 32 bits to w, x, y, z. Two bits are the number of the largest component in the order x, y, z, w. That
    component is positive and omitted. Each other component has a sign and nine bits, in units of 1 / (511 sqrt 2)."""
    largest = packed >> 30
    components = [0.0, 0.0, 0.0, 0.0]
    for index in (3, 2, 1, 0):
        if index == largest:
            continue
        size = (packed & 0x1FF) / 511.0 * math.sqrt(0.5)
        components[index] = -size if packed & 0x200 else size
        packed >>= 10
    components[largest] = math.sqrt(max(0.0, 1.0 - sum(one * one for one in components)))
    x, y, z, w = components
    return w, x, y, z


_KINDS: dict[int, tuple[str, Callable[[tuple], Setpoint]]] = {
    0: ("<", _stop),
    1: ("<ffff", lambda values: _velocity(values, -1.0)),
    2: ("<ffff", _attitude),
    3: ("<BHHHH", _attitude),
    4: ("<ffff", _attitude),
    5: ("<ffff", lambda values: _hover(values, -1.0)),
    6: ("<hhhhhhhhhIhhh", _full_state),
    7: ("<ffff", _position),
    8: ("<ffff", _velocity),
    9: ("<ffff", _attitude),
    10: ("<ffff", _hover),
    11: ("<fffHB", _attitude),
}
