# SPDX-License-Identifier: Apache-2.0
"""The report of a study of a rare event: what ``rare_report.js`` draws."""

from __future__ import annotations

import dataclasses
import math
import pathlib
from collections.abc import Sequence
from typing import Any

from mebots.exploration import report_page
from mebots.exploration.study import Study


@dataclasses.dataclass(frozen=True)
class Design:
    """``values`` of its factors. ``answer``: probability, its interval and its relative error; None where there is none.
    ``reached``: for each estimate how many missions came to each of its ``levels``. ``command``: the line that flies one
    again that came to the last."""

    values: list[Any]
    missions: int
    failed: int
    simulated_s: float
    answer: Sequence[float | None]
    levels: list[float]
    reached: list[list[int]]
    command: str


def write(file: pathlib.Path, study: Study, factors: Sequence[str], designs: Sequence[Design], provenance: dict[str, str]) -> None:
    rare = study.rare
    data = {
        "factors": list(factors),
        "score": rare.score,
        "rises": rare.sign > 0,
        "each": rare.missions,
        "found": not rare.levels,
        "estimates": study.replicates,
        "designs": [dataclasses.asdict(one) | {"counting": counting(one)} for one in designs],
    }
    report_page.write(file, study, "rare_report.js", data, provenance)


def counting(design: Design) -> float | None:
    """How many missions would have to be counted, each flown whole, for the same relative error: (1 - p)/(p e^2)."""
    probability, _, _, relative = design.answer
    if not probability or not relative:
        return None
    missions = (1 - probability) / (probability * relative**2)
    return missions if math.isfinite(missions) else None
