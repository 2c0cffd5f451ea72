# SPDX-License-Identifier: Apache-2.0
"""The probability of what hardly ever happens, by multilevel splitting with fixed effort (Garvels 2000; Cérou, Guyader,
2007): the way to a rare event is cut by levels of a score, of which each is likely once the one before was reached.

N missions begin at t = 0. Those that reach the first level are its entrances; from them N missions go on, each with
chance of its own, as equally many from each entrance as N allows (the rest by lot), and so on to the last level. With r_k
missions of N that reached level k, the estimate is the product of r_k/N. Its expectation is the probability itself for
any levels and any N; how far it spreads depends on both. So several estimates are made independently of each other, and
their mean has Student's interval. Nothing is assumed of the missions but that their score comes to a level step by step:
one that jumps over levels counts for each.
"""

from __future__ import annotations

import dataclasses
import math
import pathlib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from mebots.exploration import chance, columns, tables
from mebots.exploration.answers import Moments, student
from mebots.exploration.journal import Journal
from mebots.exploration.missions import Course, Order, Turn
from mebots.exploration.study import Study, Values

if TYPE_CHECKING:
    from mebots.exploration.campaign import Campaign

Way = tuple[int, Course]
"""Of a mission: the number of its draws, and where it turned away from others."""


@dataclasses.dataclass
class Estimate:
    """One of a design's probability: its missions that reached the last level so far, and how many did at each."""

    design: int
    run: int
    ways: list[Way] = dataclasses.field(default_factory=list)
    reached: list[int] = dataclasses.field(default_factory=list)
    flown: int = 0
    failed: int = 0
    simulated_s: list[float] = dataclasses.field(default_factory=list)

    def probability(self, study: Study) -> float:
        assert study.splitting is not None
        if len(self.reached) < len(study.splitting.levels):
            return 0.0  # nobody was left on the way
        return math.prod(count / study.splitting.missions for count in self.reached)


def fly(campaign: Campaign, folder: pathlib.Path, bring: Any) -> tuple[int, int]:
    """Flies level by level, and writes levels.csv and designs.csv. Returns how many missions there were, and how many of
    them failed. ``bring`` takes a list of orders into a journal, which it returns."""
    study = campaign.study
    splitting = study.splitting
    assert splitting is not None
    estimates = [
        Estimate(design, run) for design in range(len(campaign.designs)) for run in range(study.replicates)
    ]
    for number in range(len(splitting.levels)):
        flights = [
            (estimate, way, _order(campaign, estimate, way, number))
            for estimate in estimates
            for way in _ways(study, estimate, number)
        ]
        journal: Journal = bring([order for _, _, order in flights])
        for estimate in {id(one): one for one, _, _ in flights}.values():
            estimate.ways = []
            estimate.reached.append(0)
        for estimate, way, order in flights:
            _count(estimate, way, journal.find(order["mission"]))
        journal.sync()
        most = study.most_failures
        if most is not None and sum(one.failed for one in estimates) >= most:
            _write(campaign, folder, estimates, answered=False)
            break
    else:
        _write(campaign, folder, estimates, answered=True)
    return sum(one.flown for one in estimates), sum(one.failed for one in estimates)


def trial_course(study: Study) -> Course:
    """What a check at t = 0 tries."""
    assert study.splitting is not None
    return (Turn(_place(study, 0), _writes(study, 1, 0)),)


def _place(study: Study, number: int) -> Values:
    splitting = study.splitting
    assert splitting is not None
    return {"score": [splitting.score, splitting.sign], "level": splitting.levels[number]}


def _ways(study: Study, estimate: Estimate, number: int) -> Iterator[Way]:
    """To the next level: from t = 0, or from all missions that reached the one before."""
    splitting = study.splitting
    assert splitting is not None
    count, first = splitting.missions, estimate.run * splitting.missions
    if number == 0:
        yield from ((first + index, ()) for index in range(count))
        return
    parents = estimate.ways
    if not parents:
        return
    each, rest = divmod(count, len(parents))
    lot = f"lot/{estimate.design}/{estimate.run}/{number}"
    order = sorted(range(len(parents)), key=lambda parent: chance.unit(study.draws_seed, lot, parent))
    lucky = set(order[:rest])
    index = first
    for parent, (draw, course) in enumerate(parents):
        for _ in range(each + (parent in lucky)):
            yield draw, (*course, Turn(_place(study, number - 1), _writes(study, number, index)))
            index += 1


def _writes(study: Study, number: int, index: int) -> Values:
    """The draws that are made anew at a level."""
    assert study.splitting is not None
    return {
        name: chance.value(study.draws[name], chance.unit(study.draws_seed, f"{name}/level {number}", index))
        for name in study.splitting.reseed
    }


def _order(campaign: Campaign, estimate: Estimate, way: Way, number: int) -> Order:
    draw, course = way
    return campaign.missions.order_until(_place(campaign.study, number), campaign.values((estimate.design, draw)), course)


def _count(estimate: Estimate, way: Way, record: dict[str, Any] | None) -> None:
    assert record is not None
    estimate.flown += 1
    estimate.failed += bool(record["error"])
    estimate.simulated_s.append(record.get("simulated_time", 0.0))
    if record["outcome"] == "reached":
        estimate.reached[-1] += 1
        estimate.ways.append(way)


def _write(campaign: Campaign, folder: pathlib.Path, estimates: list[Estimate], *, answered: bool) -> None:
    """Without an answer where too many missions had failed on the way to the last level."""
    study = campaign.study
    splitting = study.splitting
    assert splitting is not None
    levels = [["design", "estimate", "level", "missions", "reached"]]
    for one in estimates:
        for level, reached in zip(splitting.levels, one.reached, strict=False):
            levels.append([str(one.design), str(one.run), tables.cell(level), str(splitting.missions), str(reached)])
    tables.write(folder / "levels.csv", levels)
    rows = [
        ["design", *campaign.factors, "estimates", "missions", "failed", "simulated_time [s]"]
        + ["probability", "probability: low", "probability: high", "relative_error"]
    ]
    for design, values in enumerate(campaign.designs):
        own = [one for one in estimates if one.design == design]
        rows.append(
            [str(design), *(tables.cell(values[name]) for name in campaign.factors), str(len(own))]
            + [str(sum(one.flown for one in own)), str(sum(one.failed for one in own))]
            + [tables.cell(math.fsum(time_s for one in own for time_s in one.simulated_s))]
            + (_answer(study, own) if answered else [""] * 4)
        )
    tables.write(folder / "designs.csv", rows)
    columns.write(folder)


def _answer(study: Study, estimates: list[Estimate]) -> list[str]:
    """Mean, its interval, and its standard error as a share of it."""
    moments = Moments()
    for one in estimates:
        moments.add(one.probability(study))
    low, high = student(moments, study.error)
    relative = moments.deviation / math.sqrt(moments.count) / moments.mean if moments.mean > 0 and moments.count > 1 else None
    return [tables.cell(moments.mean), tables.cell(max(low, 0.0)), tables.cell(min(high, 1.0)), tables.cell(relative)]
