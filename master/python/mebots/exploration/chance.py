# SPDX-License-Identifier: Apache-2.0
"""Computes random draws. A draw depends only on seed, name and index, so more replicates or another variable do not change it, and all
designs have the same draws. Uses decimal logarithms with a single rounding, because the last bits of the C library's log() and exp() depend
on the processor."""

from __future__ import annotations

import decimal
import math
import statistics
from collections.abc import Callable
from typing import Any

from mebots import _mebots

_NORMAL = statistics.NormalDist()
_DIGITS = decimal.Context(prec=40)
# Numerator and denominator of Wichura's Algorithm AS 241 (Applied Statistics 37, 1988), highest power first, for the tails of the normal
# distribution up to and beyond 5 standard deviations. Between the tails, Python's algorithm needs no logarithm.
_TAIL = (
    (7.74545014278341407640e-4, 2.27238449892691845833e-2, 2.41780725177450611770e-1, 1.27045825245236838258,
     3.64784832476320460504, 5.76949722146069140550, 4.63033784615654529590, 1.42343711074968357734),
    (1.05075007164441684324e-9, 5.47593808499534494600e-4, 1.51986665636164571966e-2, 1.48103976427480074590e-1,
     6.89767334985100004550e-1, 1.67638483018380384940, 2.05319162663775882187, 1.0),
)  # fmt: skip
_FAR_TAIL = (
    (2.01033439929228813265e-7, 2.71155556874348757815e-5, 1.24266094738807843860e-3, 2.65321895265761230930e-2,
     2.96560571828504891230e-1, 1.78482653991729133580, 5.46378491116411436990, 6.65790464350110377720),
    (2.04426310338993978564e-15, 1.42151175831644588870e-7, 1.84631831751005468180e-5, 7.86869131145613259100e-4,
     1.48753612908506148525e-2, 1.36929880922735805310e-1, 5.99832206555887937690e-1, 1.0),
)  # fmt: skip


def _log(x: float) -> float:
    return float(_DIGITS.ln(decimal.Decimal(x)))


def _exp(x: float) -> float:
    return float(_DIGITS.exp(decimal.Decimal(x)))


def _polynomial(factors: tuple[float, ...], x: float) -> float:
    total = 0.0
    for factor in factors:
        total = total * x + factor
    return total


def normal(u: float) -> float:
    """Returns the quantile ``u`` of the standard normal distribution."""
    if abs(u - 0.5) <= 0.425:
        return _NORMAL.inv_cdf(u)
    r = math.sqrt(-_log(u if u < 0.5 else 1.0 - u))
    (numerator, denominator), r = (_TAIL, r - 1.6) if r <= 5.0 else (_FAR_TAIL, r - 5.0)
    x = _polynomial(numerator, r) / _polynomial(denominator, r)
    return -x if u < 0.5 else x


def unit(seed: int, name: str, index: int) -> float:
    """Returns a random number in the open interval (0, 1), computed from 53 bits of a SHA-256."""
    return _mebots.unit_draw(seed, name, index)


def value(spread: dict[str, Any] | list[Any], u: float) -> Any:
    """Returns the quantile ``u`` of a distribution of the study file. For a list, returns one of its values."""
    if isinstance(spread, list):
        return _choice(spread, u)
    ((kind, arguments),) = spread.items()
    return _KINDS[kind](arguments, u)


def extremes(spread: dict[str, Any] | list[Any]) -> list[Any]:
    """Returns values at which the check of a study tries a distribution: its ends, all its options, or the mean of a normal
    distribution."""
    if isinstance(spread, list):
        return list(spread)
    ((kind, arguments),) = spread.items()
    if kind in ("options", "choice"):
        return list(arguments)
    return [arguments[0]] if kind == "normal" else list(arguments)


def _choice(values: list[Any], u: float) -> Any:
    return values[min(int(u * len(values)), len(values) - 1)]


def _between(bounds: list[float], u: float) -> float:
    least, most = bounds
    return min(max(least + (most - least) * u, least), most)


def _log_between(bounds: list[float], u: float) -> float:
    least, most = bounds
    return min(max(_exp(_between([_log(least), _log(most)], u)), least), most)


def _integer(bounds: list[int], u: float) -> int:
    least, most = int(bounds[0]), int(bounds[1])
    return min(least + int(u * (most - least + 1)), most)


_KINDS: dict[str, Callable[[Any, float], Any]] = {
    "uniform": _between,
    "log_uniform": _log_between,
    "integer": _integer,
    "normal": lambda arguments, u: arguments[0] + arguments[1] * normal(u),
    "choice": _choice,
    "options": lambda options, u: _choice(list(options), u),
}
