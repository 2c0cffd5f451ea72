# SPDX-License-Identifier: Apache-2.0
"""The report of a study that compares designs: what ``report.js`` draws."""

from __future__ import annotations

import math
import pathlib
import shlex
from collections.abc import Sequence
from typing import Any

from mebots.exploration import report_page
from mebots.exploration.answer import Answer
from mebots.exploration.comparison import Estimate, Evidence
from mebots.exploration.figures import Units
from mebots.exploration.study import Study, Values

MOST_MISSIONS = 50_000
"""Of more missions the report shows the designs alone."""
BESIDE = "replays/beside.html"
"""The page of a mission of each of several designs."""


def write(
    file: pathlib.Path,
    study: Study,
    factors: Sequence[str],
    designs: Sequence[Values],
    evidence: Evidence,
    rows: Sequence[dict[str, Any]],
    commands: Sequence[str],
    provenance: dict[str, str],
    answer: Answer,
    units: Units,
    *,
    refresh_s: float | None = None,
) -> None:
    """``rows``: status, place on the front, rank and failed missions of each design; ``commands``: the line that flies its
    first mission again, into ``replay_folder``; ``provenance``: what was flown. ``refresh_s``: the study is under way, and the
    page of what is known so far loads itself again."""
    estimate = evidence.shown if refresh_s is None else evidence.so_far
    data = {
        "factors": list(factors),
        "objectives": [
            {"label": one.label, "unit": _shown_unit(units.of(one)), "sense": one.sense, "share": one.is_share} for one in study.objectives
        ],
        "factor_units": [_shown_unit(units.of_factor(name)) for name in factors],
        "answer": {"headlines": answer.headlines, "remarks": answer.remarks},
        "constraints": [{"label": one.label, "above": one.above, "bound": one.bound} for one in study.constraints],
        "sequence": study.looks,
        "beside": {"out": shlex.quote(str(file.parent / BESIDE)), "page": BESIDE},
        "designs": [
            {
                "values": [values[name] for name in factors],
                "missions": max([evidence.missions_of(number), *(estimate(number, one).count for one in study.objectives)]),
                "estimates": [_numbers(estimate(number, one)) for one in study.objectives],
                "command": commands[number],
                "replay": _replay(file.parent, number),
                "folder": shlex.quote(str(replay_folder(file.parent, number))),
                "flights": _flights(evidence, number),
            }
            | rows[number]
            for number, values in enumerate(designs)
        ],
    }
    report_page.write(file, study, "report.js", data, provenance, refresh_s)


def _shown_unit(unit: str) -> str:
    return "" if unit == "1" else unit


def replay_folder(study: pathlib.Path, design: int) -> pathlib.Path:
    """Where the first mission of a design goes when somebody flies it again to see it."""
    return study / "replays" / f"design_{design}"


def _replay(study: pathlib.Path, design: int) -> str | None:
    """The page of that mission, once it is there: an address relative to the report."""
    page = replay_folder(study, design) / "flight.html"
    return page.relative_to(study).as_posix() if page.exists() else None


def _numbers(estimate: Estimate) -> list[float | None]:
    low, high = (None if math.isinf(one) else one for one in estimate.interval)
    return [estimate.mean, low, high, estimate.count]


def _flights(evidence: Evidence, design: int) -> list[list[float | None]]:
    """For each objective the values of all missions."""
    if sum(evidence.counts) > MOST_MISSIONS:
        return []
    return list(map(list, zip(*(evidence.row(design, one) for one in range(evidence.counts[design])), strict=True)))
