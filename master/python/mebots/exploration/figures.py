# SPDX-License-Identifier: Apache-2.0
"""Formats numbers for readers, with units and SI prefixes. The interval of a number determines its digits."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from mebots import _mebots
from mebots.errors import Error
from mebots.exploration.comparison import Estimate
from mebots.exploration.study import Objective, Study, Values

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
_SCALED = ("Hz", "J", "W", "Wh", "A", "Ah", "V", "F", "N", "Pa")
_MOST_DIGITS = 6
"""The number of significant digits of a value with an interval."""
_SCALED_DOWN = ("s", "m")
"""Units whose multiples above 1 have other names or are not in common use."""


def scale_of(unit: str, values: Iterable[float]) -> tuple[float, str]:
    """Returns the factor and the unit with which the largest value is from 1 to 1000, if the unit permits prefixes."""
    known = [abs(value) for value in values if math.isfinite(value) and value != 0]
    if unit == "1":
        return 1.0, ""
    if not known or unit not in (*_SCALED, *_SCALED_DOWN):
        return 1.0, unit
    largest = max(known)
    for size, prefix in _PREFIXES:
        if (size <= 1 or unit in _SCALED) and largest >= size * (1 - 1e-12):
            return 1 / size, prefix + unit
    return 1e9, "n" + unit


def number(value: float, digits: int = 4) -> str:
    """Formats a number with this many significant digits, without trailing zeros."""
    return f"{float(f'{value:.{digits}g}'):.12g}"


def quantity(value: Any, unit: str = "") -> str:
    """Formats a value and its unit, such as 102.7 MHz."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return json.dumps(value) if isinstance(value, bool) else str(value)
    factor, shown = scale_of(unit, [value])
    return " ".join(filter(None, (number(value * factor), shown)))


def percent(share: float) -> str:
    """Formats a share as a percentage. Adds digits near 0 and 100 %, so that 0.9999 does not appear as 100 %."""
    text = f"{100 * share:.0f}"
    if (text == "100" and share < 1) or (text == "0" and share > 0):
        text = f"{100 * share:.2g}" if share < 0.5 else f"{100 * share:.4g}"
    return f"{text} %"


def estimate_text(found: Estimate, objective: Objective, unit: str) -> str:
    """Formats a design's value and interval, such as 263 J (262 to 264), or 40 of 40 (91 to 100 %)."""
    if found.mean is None:
        return "-"
    low, high = found.interval
    if objective.is_share:
        return f"{found.successes} of {found.count} ({percent(low).removesuffix(' %')} to {percent(high)})"
    factor, shown = scale_of(unit, [found.mean, low, high])
    if not (math.isfinite(low) and math.isfinite(high)):
        return " ".join(filter(None, (number(found.mean * factor), shown)))
    width = (high - low) * factor
    # Rounding may move an end by at most a quarter of the interval's width.
    decimals = max(0, math.ceil(-math.log10(width / 2))) if width > 0 else _decimals_of(found.mean * factor)
    size = max(abs(low), abs(high)) * factor
    decimals = min(decimals, max(0, _MOST_DIGITS - 1 - math.floor(math.log10(size)))) if size > 0 else decimals
    mean, least, most = (f"{value * factor:.{decimals}f}" for value in (found.mean, low, high))
    head = " ".join(filter(None, (mean, shown)))
    return head if least == most else f"{head} ({least} to {most})"


def _decimals_of(value: float) -> int:
    """Returns the number of decimals that a number with at most four significant digits has."""
    text = number(value)
    return len(text.partition(".")[2]) if "e" not in text else 0


class Units:
    """The units of a study's factors and objectives: those that the study states, otherwise those of the FMUs' variables."""

    def __init__(self, study: Study, summary: Mapping[str, Any]) -> None:
        try:
            self._of_variables: dict[str, str] = _mebots.variable_units(study.mission)
        except Error:  # the check of the study reports errors of the mission
            self._of_variables = {}
        self._summary = summary

    def of_factor(self, name: str) -> str:
        return "s" if name == "/stop_time" else self._of_variables.get(name, "")

    def of(self, objective: Objective) -> str:
        """Returns the unit of an objective, or "". The study states the units of expressions."""
        if objective.unit or objective.is_share or objective.source == "expression":
            return objective.unit
        if objective.source == "summary":
            return {"simulated_time": "s"}.get(objective.what) or self._of_variables.get(self._variable_of(objective.what), "")
        return "s" if objective.reduction == "first_true" else self._of_variables.get(objective.what, "")

    def _variable_of(self, label: str) -> str:
        """Returns the name of the variable that the summary shows under this label."""
        found: Any = self._summary
        for part in label.split("."):
            if isinstance(found, list):  # a group, whose members have the same unit
                return "" if part in ("count", "of") else str(found[0].get("variable", ""))
            found = found.get(part, "") if isinstance(found, dict) else ""
        return found.get("variable", "") if isinstance(found, dict) else str(found)


def design_names(factors: Sequence[str], designs: Sequence[Values], units: Units) -> list[str]:
    """Returns a name for each design, such as "lipol_350, 0.37 m/s", from the factors that differ between designs."""
    varied = [name for name in factors if len({repr(design[name]) for design in designs}) > 1]
    shown = [units.of_factor(name) for name in varied]
    plain = [bool(unit) and unit != "1" and shown.count(unit) == 1 for unit in shown]

    def part(name: str, unit: str, is_plain: bool, value: Any) -> str:
        text = quantity(value, unit)
        return text if is_plain or isinstance(value, str) else f"{name.rpartition('.')[2].removeprefix('/')} {text}"

    return [
        ", ".join(part(name, unit, is_plain, design[name]) for name, unit, is_plain in zip(varied, shown, plain, strict=True)) or f"design {number}"
        for number, design in enumerate(designs)
    ]
