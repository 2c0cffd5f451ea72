# SPDX-License-Identifier: Apache-2.0
"""Writes report.html of a study that compares designs. Its numbers are one JSON, which web/src/report draws."""

from __future__ import annotations

import dataclasses
import math
import pathlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from mebots.exploration import report_page, sensitivity
from mebots.exploration.answer import Answer
from mebots.exploration.comparison import Estimate, Evidence
from mebots.exploration.effects import Factor, factors_of, importances, level_means, pair_means, pairs_of
from mebots.exploration.figures import Units, scale_of
from mebots.exploration.report_missions import Replay, missions_of, quantiles_of
from mebots.exploration.study import Objective, Study, Values

MOST_DESIGNS = 5_000
"""The maximum number of designs on the page. If there are more, the page has the best designs, the designs on the
front, and every n-th other design."""
_BEST_DESIGNS = 1_000
_MOST_CURVES = 50
"""The page shows for this number of designs, best first, how their estimates became narrower."""
_POINTS_OF_CURVES = 14


@dataclasses.dataclass(frozen=True)
class Content:
    """The results of a study. ``places`` (whether the design is on the Pareto front, as in front.py), ``status`` and ``failed`` (numbers of
    failed missions) have one entry per design. ``outcomes`` contains the names of all outcomes, and for each design the outcomes of its
    missions; None while the study runs. ``refresh_s`` is the time between reloads of a running study's page."""

    study: Study
    factors: Sequence[str]
    designs: Sequence[Values]
    evidence: Evidence
    answer: Answer
    units: Units
    places: Sequence[str]
    status: Sequence[str]
    failed: Sequence[int]
    provenance: dict[str, str]
    replay: Replay | None = None
    outcomes: tuple[list[str], list[np.ndarray]] | None = None
    refresh_s: float | None = None

    def estimate(self, design: int, objective: Objective) -> Estimate:
        return self.evidence.shown(design, objective) if self.refresh_s is None else self.evidence.so_far(design, objective)


def write(file: pathlib.Path, content: Content) -> None:
    report_page.write(file, content.study, _data(content), content.provenance, str(content.answer))


def _data(content: Content) -> dict[str, Any]:
    study = content.study
    factors = factors_of(content.factors, content.designs, content.units)
    estimates = [[content.estimate(design, one) for design in range(len(content.designs))] for one in study.objectives]
    kept = _kept_designs(content)
    ranks = {row.design: row for row in content.answer.rows}
    values = [np.array([math.nan if one.mean is None else one.mean for one in own]) for own in estimates]
    return {
        "kind": "study",
        "answer": {"headlines": content.answer.headlines, "remarks": content.answer.remarks},
        "refresh_s": content.refresh_s,
        "sequence": study.looks,
        "constraints": [{"objective": content.evidence.index[one.label], "above": one.above, "bound": one.bound} for one in study.constraints],
        "factors": [_factor(one, kept) for one in factors],
        "objectives": [
            _objective(one, content.units.of(one), own, kept) | {"text": [ranks[design].cells[at] for design in kept]}
            for at, (one, own) in enumerate(zip(study.objectives, estimates, strict=True))
        ],
        "designs": {
            "of": len(content.designs),
            "number": kept,
            "name": [ranks[design].name for design in kept],
            "rank": [ranks[design].rank for design in kept],
            "note": [ranks[design].note for design in kept],
            "front": [content.places[design] for design in kept],
            "status": [content.status[design] for design in kept],
            "failed": [content.failed[design] for design in kept],
            "missions": [ranks[design].missions for design in kept],
        },
        "missions_of": sum(row.missions for row in content.answer.rows),
        "failed_of": sum(content.failed),
        "effects": _effects(content, factors, values),
        "indices": _indices(content),
        "quantiles": quantiles_of(content.evidence, kept) if content.refresh_s is None else None,
        "missions": missions_of(content.evidence, kept, content.outcomes) if content.refresh_s is None else None,
        "replay": None if content.replay is None else content.replay.texts(kept, max(content.evidence.counts, default=0)),
        "courses": _courses(content) if content.refresh_s is None else [],
        "best": _best(content),
    }


def _kept_designs(content: Content) -> list[int]:
    count = len(content.designs)
    if count <= MOST_DESIGNS:
        return list(range(count))
    best = [row.design for row in content.answer.rows[:_BEST_DESIGNS]]
    every = math.ceil(count / (MOST_DESIGNS - _BEST_DESIGNS))
    front = [design for design, place in enumerate(content.places) if place == "on"]
    return sorted({*best, *front[:_BEST_DESIGNS], *range(0, count, every)})


def _factor(factor: Factor, kept: Sequence[int]) -> dict[str, Any]:
    return {
        "name": factor.name, "label": factor.label, "unit": factor.unit, "scale": factor.scale, "number": factor.is_number,
        "values": [factor.values[design] for design in kept], "levels": factor.levels, "level": factor.level[list(kept)].tolist(),
    }  # fmt: skip


def _objective(objective: Objective, unit: str, estimates: Sequence[Estimate], kept: Sequence[int]) -> dict[str, Any]:
    scale, shown = scale_of(unit, [abs(one.mean) for one in estimates if one.mean is not None])
    if objective.is_share:
        scale, shown = 100.0, "%"
    own = [estimates[design] for design in kept]
    return {
        "label": objective.label, "unit": shown, "scale": scale, "sense": objective.sense, "share": objective.is_share,
        "statistic": objective.statistic, "where": objective.where,
        "mean": [one.mean for one in own],
        "low": [_finite(one.interval[0]) for one in own],
        "high": [_finite(one.interval[1]) for one in own],
        "count": [one.count for one in own],
    }  # fmt: skip


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _effects(content: Content, factors: Sequence[Factor], values: Sequence[np.ndarray]) -> dict[str, Any]:
    pairs = pairs_of(factors)
    found = [importances(content.study, factors, pairs, one) if content.refresh_s is None else None for one in values]
    return {
        "pairs": pairs,
        "means": [[level_means(factor, one) for factor in factors] for one in values],
        "pair_means": [[pair_means((factors[a], factors[b]), one) for a, b in pairs] for one in values],
        "importances": [None if one is None else dataclasses.asdict(one) for one in found],
    }


def _indices(content: Content) -> dict[str, Any] | None:
    """Returns the sensitivity indices if the study requests them."""
    if content.study.design["kind"] != "sensitivity" or content.refresh_s is not None:
        return None
    titles, *rows = sensitivity.rows(content.study, content.evidence)
    return {"method": content.study.design["method"], "titles": titles, "rows": rows}


def _courses(content: Content) -> list[dict[str, Any]]:
    """Returns how the estimates of the best designs change with the number of missions: for each design, the means and intervals after
    increasing numbers."""
    result = []
    for row in content.answer.rows[:_MOST_CURVES]:
        count = content.evidence.counts[row.design]
        counts = _points_up_to(count)
        if len(counts) < 2:
            continue
        curves = [content.evidence.course(row.design, one, counts) for one in content.study.objectives]
        result.append({
            "design": row.design, "counts": counts,
            "mean": [[one.mean for one in curve] for curve in curves],
            "low": [[_finite(one.interval[0]) for one in curve] for curve in curves],
            "high": [[_finite(one.interval[1]) for one in curve] for curve in curves],
        })  # fmt: skip
    return result


def _points_up_to(count: int) -> list[int]:
    """Returns numbers of missions from 2 to ``count`` in a geometric series."""
    return sorted({round(one) for one in np.geomspace(2, count, _POINTS_OF_CURVES)}) if count >= 2 else []


def _best(content: Content) -> list[int]:
    """Returns the designs of a search that rank higher than all designs with smaller numbers."""
    if content.study.design["kind"] != "search":
        return []
    ranks = {row.design: row.rank for row in content.answer.rows if row.rank is not None}
    best: list[int] = []
    for design in sorted(ranks):
        if not best or ranks[design] < ranks[best[-1]]:
            best.append(design)
    return best


