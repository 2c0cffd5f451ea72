# SPDX-License-Identifier: Apache-2.0
"""Draws. Each is a function of seed, name and index alone: more replicates or another variable change none of those
that were there, and every design gets the same."""

from __future__ import annotations

import hashlib
import math
import statistics
from typing import Any

_NORMAL = statistics.NormalDist()


def unit(seed: int, name: str, index: int) -> float:
    """A number of the uniform distribution on the open interval (0, 1): 53 bits of a SHA-256."""
    digest = hashlib.sha256(f"{seed}\0{name}\0{index}".encode()).digest()
    return (int.from_bytes(digest[:8], "big") >> 11) * 2.0**-53 + 2.0**-54


def value(spread: dict[str, Any] | list[Any], u: float) -> Any:
    """The value at quantile ``u`` of a distribution or a span, as the study file writes it; a list is a choice."""
    if isinstance(spread, list):
        return _choice(spread, u)
    ((kind, arguments),) = spread.items()
    return _KINDS[kind](arguments, u)


def extremes(spread: dict[str, Any] | list[Any]) -> list[Any]:
    """Values that stand for all others when the study is checked."""
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
    return min(max(math.exp(_between([math.log(least), math.log(most)], u)), least), most)


def _integer(bounds: list[int], u: float) -> int:
    least, most = int(bounds[0]), int(bounds[1])
    return min(least + int(u * (most - least + 1)), most)


_KINDS = {
    "uniform": _between,
    "log_uniform": _log_between,
    "integer": _integer,
    "normal": lambda arguments, u: arguments[0] + arguments[1] * _NORMAL.inv_cdf(u),
    "choice": _choice,
    "options": lambda options, u: _choice(list(options), u),
}
