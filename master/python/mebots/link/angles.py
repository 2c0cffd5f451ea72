# SPDX-License-Identifier: Apache-2.0
"""Computes sine, cosine and arc tangent with the same bits on every machine. Uses only additions, multiplications and divisions, because
the C library's functions depend on its version."""

from __future__ import annotations

import math

_QUARTER_HIGH = 1.5707963267341256  # pi / 2 rounded to 33 bits, so that small multiples are exact
_QUARTER_LOW = 6.077100506506192e-11


def _series(square: float, first: int) -> float:
    """Returns 1 - x^2 / (n (n + 1)) + ... with n = first. For |x| up to pi / 4, the first omitted term is below 1e-18."""
    result = 1.0
    for n in range(first + 16, first - 1, -2):
        result = 1.0 - square / (n * (n + 1)) * result
    return result


def sine_and_cosine(angle: float) -> tuple[float, float]:
    """Returns sine and cosine of an angle [rad]. For |angle| up to 1000, the error is below 1e-15."""
    quarters = round(angle / (_QUARTER_HIGH + _QUARTER_LOW))
    rest = (angle - quarters * _QUARTER_HIGH) - quarters * _QUARTER_LOW
    sine, cosine = rest * _series(rest * rest, 2), _series(rest * rest, 1)
    return ((sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine))[quarters % 4]


def arc_tangent(y: float, x: float) -> float:
    """Returns the angle of the direction (x, y) [rad]. Applies Newton's method to the sine; each step doubles the number of correct
    digits."""
    length = math.sqrt(x * x + y * y)
    if length == 0.0:
        return 0.0
    x, y = x / length, y / length
    if x < 0.0:  # reduces the angle by half a turn to at most pi / 2
        turned = arc_tangent(-y, -x)
        return turned + math.pi if y >= 0.0 else turned - math.pi
    angle = y / (0.5 + 0.5 * x)  # 2 tan(angle / 2), at most 27 % too large
    for _ in range(6):
        sine, cosine = sine_and_cosine(angle)
        angle += (y * cosine - x * sine) / (x * cosine + y * sine)
    return angle


def wrapped(angle: float) -> float:
    """Returns the equivalent angle from -pi to pi."""
    return math.remainder(angle, 2.0 * math.pi)
