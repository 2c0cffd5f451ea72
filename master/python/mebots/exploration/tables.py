# SPDX-License-Identifier: Apache-2.0
"""Rows of missions.csv and designs.csv. Equal studies give equal bytes for any number of workers."""

from __future__ import annotations

import array
import math
from collections.abc import Sequence
from typing import Any

from mebots.exploration.comparison import Evidence
from mebots.exploration.files import csv_text
from mebots.exploration.study import Objective, Study, Values


def cell(value: Any) -> str:
    """Returns a value as a CSV cell. Numbers have the fewest digits that preserve their bits. A missing value is an empty cell."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        if math.isinf(value):
            return ""
        return repr(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    return str(value)


def mission_head(factors: Sequence[str], study: Study) -> list[str]:
    objectives = [_titled(one) for one in study.objectives]
    return ["design", "replicate", *factors, *study.draws, "outcome", *objectives, "simulated_time [s]", "message", "mission"]


MISSING = "missing"
"""Outcome of a mission without a result."""
MISSING_MESSAGE = "no result: the same command runs the mission again"


def values_text(values: Values) -> str:
    """Returns the values of factors or draws as CSV cells, each followed by a comma."""
    return "".join([csv_text([cell(value)]) + "," for value in values.values()])


def number_text(value: float) -> str:
    """Returns a number as a cell; NaN is an empty cell."""
    return "" if value != value else cell(value)


def number_texts(values: array.array[float]) -> list[str]:
    """Returns ``number_text`` of each value."""
    plain = [repr(value) for value in values]
    known: dict[float, str] = {}
    for at, text in enumerate(plain):
        if text[-1] in "0fn" and (text[-2:] == ".0" or text[-1] != "0"):  # an integer, inf or nan
            value = values[at]
            found = known.get(value)
            if found is None:
                found = known[value] = number_text(value)
            plain[at] = found
    return plain


def design_head(factors: Sequence[str], study: Study) -> list[str]:
    head = ["design", *factors, "missions", "failed", "missing", "status", "front"]
    for one in study.objectives:
        title = _titled(one)
        if one.is_share:
            head += [f"{one.label}: successes", f"{one.label}: of"]
        else:
            head += [f"{one.label}: of"]
        head += [f"{title}: {one.statistic}", f"{title}: low", f"{title}: high"]
    return head


def design_row(
    design: int, values: Values, factors: Sequence[str], evidence: Evidence, failed: int, status: str, place: str
) -> list[str]:
    row = [str(design), *(cell(values[name]) for name in factors), str(evidence.missions_of(design)), str(failed), str(evidence.missing_of(design)), status, place]
    for one in evidence.study.objectives:
        estimate = evidence.shown(design, one)
        if one.is_share:
            row.append(cell(estimate.successes))
        row += [cell(estimate.count), cell(estimate.mean), cell(estimate.interval[0]), cell(estimate.interval[1])]
    return row


def _titled(one: Objective) -> str:
    return f"{one.label} [{one.unit}]" if one.unit else one.label
