# SPDX-License-Identifier: Apache-2.0
"""Paths of polynomials of degree 7 over time for x, y, z and yaw (Mellinger and Kumar, ICRA 2011)."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from typing import NamedTuple

from mebots.link.angles import sine_and_cosine

Vector = tuple[float, float, float]
ZERO: Vector = (0.0, 0.0, 0.0)
COEFFICIENTS = 8
PIECE_BYTES = 4 * (4 * COEFFICIENTS + 1)


class Goal(NamedTuple):
    """A point of a path."""

    position_m: Vector
    velocity_m_per_s: Vector
    acceleration_m_per_s2: Vector
    yaw_rad: float
    yaw_rate_rad_per_s: float

    @property
    def is_finite(self) -> bool:
        numbers = (*self.position_m, *self.velocity_m_per_s, *self.acceleration_m_per_s2, self.yaw_rad, self.yaw_rate_rad_per_s)
        return all(math.isfinite(number) for number in numbers)


class Ends(NamedTuple):
    """Value and first two derivatives at one end of a polynomial."""

    value: float
    rate: float = 0.0
    acceleration: float = 0.0


def between(start: Ends, end: Ends, duration_s: float) -> list[float]:
    """Returns the coefficients of the polynomial of degree 7 from ``start`` to ``end``, the constant first. The jerk is zero at both ends.

    With s = t / T and d = end - (start + v s T + a (s T)^2 / 2) and its derivatives at s = 1, d0, d1, d2, the terms of degree 4 to 7 in s
    solve p(1) = d0, p'(1) = d1, p''(1) = d2, p'''(1) = 0. With a duration of 0, returns a polynomial that starts at ``end``.
    """
    if not duration_s > 0.0:
        return [end.value, end.rate, 0.5 * end.acceleration, 0.0, 0.0, 0.0, 0.0, 0.0]
    t = duration_s
    d0 = end.value - (start.value + start.rate * t + 0.5 * start.acceleration * t * t)
    d1 = (end.rate - (start.rate + start.acceleration * t)) * t
    d2 = (end.acceleration - start.acceleration) * t * t
    scaled = [
        35.0 * d0 - 15.0 * d1 + 2.5 * d2,
        -84.0 * d0 + 39.0 * d1 - 7.0 * d2,
        70.0 * d0 - 34.0 * d1 + 6.5 * d2,
        -20.0 * d0 + 10.0 * d1 - 2.0 * d2,
    ]
    coefficients = [start.value, start.rate, 0.5 * start.acceleration, 0.0]
    power = t * t * t
    for number in scaled:
        power *= t
        coefficients.append(number / power if power > 0.0 else math.inf)
    return coefficients


def _evaluate(coefficients: Sequence[float], t: float) -> tuple[float, float, float]:
    """Returns the value and its first two derivatives by Horner's method."""
    value = rate = half_acceleration = 0.0
    for coefficient in reversed(coefficients):
        half_acceleration = half_acceleration * t + rate
        rate = rate * t + value
        value = value * t + coefficient
    return value, rate, 2.0 * half_acceleration


class Piece(NamedTuple):
    """Polynomials of x, y, z and yaw, and their duration."""

    axes: tuple[Sequence[float], Sequence[float], Sequence[float], Sequence[float]]
    duration_s: float

    @staticmethod
    def unpack(data: bytes | bytearray) -> Piece:
        """Reads a piece from ``PIECE_BYTES`` bytes of an uploaded trajectory: the coefficients for x, y, z and yaw, and the duration."""
        numbers = struct.unpack(f"<{4 * COEFFICIENTS + 1}f", data)
        x, y, z, yaw = (numbers[COEFFICIENTS * i : COEFFICIENTS * (i + 1)] for i in range(4))
        return Piece((x, y, z, yaw), numbers[-1])

    def at(self, t: float) -> Goal:
        (x, vx, ax), (y, vy, ay), (z, vz, az), (yaw, yaw_rate, _) = (_evaluate(one, t) for one in self.axes)
        return Goal((x, y, z), (vx, vy, vz), (ax, ay, az), yaw, yaw_rate)


class Path:
    """A sequence of pieces, scaled in time, rotated and shifted. After its end, it stays at the last point.

    :param time_scale: factor of the duration; with 2, the path takes twice as long.
    :param backwards: True follows the path from its end to its start.
    """

    def __init__(self, pieces: Sequence[Piece], begin_s: float, time_scale: float = 1.0, backwards: bool = False) -> None:
        assert pieces
        self._pieces = tuple(reversed(pieces)) if backwards else tuple(pieces)
        self._begin_s = begin_s
        self._scale = time_scale
        self._backwards = backwards
        self._turn_rad = 0.0
        self._shift_m = ZERO

    def move(self, turn_rad: float, to_m: Vector) -> None:
        """Rotates the path about the vertical axis through the origin. Then shifts it to start at this point."""
        self._turn_rad = turn_rad
        self._shift_m = ZERO
        x, y, z = self.at(self._begin_s).position_m
        self._shift_m = (to_m[0] - x, to_m[1] - y, to_m[2] - z)

    def has_ended(self, time_s: float) -> bool:
        return not time_s - self._begin_s < self._scale * sum(piece.duration_s for piece in self._pieces)

    def at(self, time_s: float) -> Goal:
        since_s = time_s - self._begin_s
        for piece in self._pieces:
            duration_s = self._scale * piece.duration_s
            if since_s <= duration_s:
                return self._placed(self._scaled(piece, since_s))
            since_s -= duration_s
        last = self._pieces[-1]
        end = self._placed(last.at(0.0 if self._backwards else last.duration_s))
        return end._replace(velocity_m_per_s=ZERO, acceleration_m_per_s2=ZERO, yaw_rate_rad_per_s=0.0)

    def _scaled(self, piece: Piece, since_s: float) -> Goal:
        if not self._scale > 0.0:
            return piece.at(0.0)
        own_s = since_s / self._scale
        goal = piece.at(piece.duration_s - own_s if self._backwards else own_s)
        speed = (-1.0 if self._backwards else 1.0) / self._scale
        vx, vy, vz = (speed * one for one in goal.velocity_m_per_s)
        ax, ay, az = (speed * speed * one for one in goal.acceleration_m_per_s2)
        return Goal(goal.position_m, (vx, vy, vz), (ax, ay, az), goal.yaw_rad, speed * goal.yaw_rate_rad_per_s)

    def _placed(self, goal: Goal) -> Goal:
        x, y, z = _turned(goal.position_m, self._turn_rad)
        dx, dy, dz = self._shift_m
        return Goal(
            (x + dx, y + dy, z + dz),
            _turned(goal.velocity_m_per_s, self._turn_rad),
            _turned(goal.acceleration_m_per_s2, self._turn_rad),
            goal.yaw_rad + self._turn_rad,
            goal.yaw_rate_rad_per_s,
        )


def _turned(vector: Vector, angle_rad: float) -> Vector:
    if angle_rad == 0.0:
        return vector
    sine, cosine = sine_and_cosine(angle_rad)
    return cosine * vector[0] - sine * vector[1], sine * vector[0] + cosine * vector[1], vector[2]
