# SPDX-License-Identifier: Apache-2.0
"""Writes report.html of a study of a rare event. web/src/report/rare.ts draws the page."""

from __future__ import annotations

import dataclasses
import itertools
import math
import pathlib
from collections.abc import Sequence
from typing import Any

from mebots.exploration import report_page
from mebots.exploration.figures import Units, design_names
from mebots.exploration.study import Study


@dataclasses.dataclass(frozen=True)
class Design:
    """A design with its factors' ``values``. ``answer`` is the probability, its interval and relative error, or None. ``reached`` contains
    for each estimate how many missions reached each of its ``levels``. ``command`` repeats a mission that reached the last level."""

    values: list[Any]
    missions: int
    failed: int
    simulated_s: float
    answer: Sequence[float | None]
    levels: list[float]
    reached: list[list[int]]
    command: str


def write(file: pathlib.Path, study: Study, factors: Sequence[str], designs: Sequence[Design], provenance: dict[str, str], units: Units) -> None:
    """Writes the page."""
    rare = study.rare
    names = design_names(factors, [dict(zip(factors, one.values, strict=True)) for one in designs], units)
    data = {
        "kind": "rare",
        "factors": list(factors),
        "factor_units": [units.of_factor(name) for name in factors],
        "unit": units.of_factor(rare.score),
        "score": rare.score,
        "rises": rare.sign > 0,
        "each": rare.missions,
        "found": not rare.levels,
        "estimates": study.replicates,
        "designs": [_content(one, name, rare.missions) for one, name in zip(designs, names, strict=True)],
    }
    answer = "\n".join(f"{name}: {one.answer[0]}" for one, name in zip(designs, names, strict=True))
    report_page.write(file, study, data, provenance, answer)


def _content(design: Design, name: str, missions: int) -> dict[str, Any]:
    shares = [_shares(counts, missions) for counts in design.reached]
    means = [
        sum(own[level] if level < len(own) else 0.0 for own in shares) / len(shares) if shares else 0.0
        for level in range(len(design.levels))
    ]
    return dataclasses.asdict(design) | {"name": name, "counting": counting(design), "shares": shares, "mean_shares": means}


def _shares(reached: Sequence[int], missions: int) -> list[float]:
    """Returns the estimated probability of reaching each level: the product of the shares up to this level."""
    return list(itertools.accumulate((count / missions for count in reached), lambda share, one: share * one))


def counting(design: Design) -> float | None:
    """Returns the number of complete missions for the same relative error e of the probability p by plain counting: (1 - p)/(p e^2)."""
    probability, _, _, relative = design.answer
    if not probability or not relative:
        return None
    missions = (1 - probability) / (probability * relative**2)
    return missions if math.isfinite(missions) else None
