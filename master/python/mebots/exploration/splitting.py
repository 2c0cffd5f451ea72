# SPDX-License-Identifier: Apache-2.0
"""Estimates the probability of rare events by multilevel splitting with fixed effort (Garvels 2000; Cérou, Guyader 2007). The score of a
mission rises towards the event. Levels divide the range of the score, so that missions often reach a level from the previous one.

N missions start at t = 0. The states in which missions reach the first level are its entrances. N missions continue from them with new
draws: the same number from each entrance, with the remainder assigned at random. This is repeated up to the last level. If r_k of N
missions reached level k, the estimate is the product of r_k/N. The expectation of the estimate is the exact probability for any levels
and any N. Its spread depends on the levels and on N. Therefore several estimates are made independently, and their mean has Student's
interval. If the score of a mission jumps over levels, the mission counts for each of these levels.

If a study defines no levels, pilot missions determine them.
"""

from __future__ import annotations

import dataclasses
import math
import pathlib
from collections.abc import Callable, Iterator, Sequence
from mebots.exploration import chance, columns, rare_report, tables
from mebots.exploration.answers import Moments, student
from mebots.exploration.figures import Units
from mebots.exploration.files import write_csv
from mebots.exploration.journal import Journal, Record
from mebots.exploration.missions import Course, Turn
from mebots.exploration.orders import Order
from mebots.exploration.space import Space
from mebots.exploration.study import Splitting, Study, Values

Bring = Callable[[list[Order], int], Journal]
"""Adds orders to a journal and returns it. The number is the maximum number of orders that follow."""


@dataclasses.dataclass(frozen=True)
class Way:
    """The origin of a mission: the number of its draw, and the earlier missions from whose states it started, with the times of these
    states [s]."""

    draw: int
    course: Course = ()
    times_s: tuple[float, ...] = ()


@dataclasses.dataclass
class Estimate:
    """An estimate of a design's probability. ``ways`` are the missions that reached the latest level. ``reached`` contains the number of
    missions that reached each level."""

    design: int
    run: int
    levels: tuple[float, ...]
    ways: list[Way] = dataclasses.field(default_factory=list)
    reached: list[int] = dataclasses.field(default_factory=list)
    flown: int = 0
    failed: int = 0
    simulated_s: list[float] = dataclasses.field(default_factory=list)

    def probability(self, study: Study) -> float:
        if len(self.reached) < len(self.levels):
            return 0.0  # no mission reached this level
        return math.prod(count / study.rare.missions for count in self.reached)

    def count(self, record: Record) -> None:
        self.flown += 1
        self.failed += bool(record["error"])
        self.simulated_s.append(record.get("simulated_time", 0.0))


def fly(space: Space, folder: pathlib.Path, bring: Bring, units: Units) -> tuple[int, int]:
    """Runs missions level by level, and writes levels.csv, designs.csv and report.html. Returns the numbers of missions and of failed
    missions."""
    study = space.study
    pilots = [Estimate(design, study.replicates, ()) for design in range(len(space.designs))]
    answered = True
    if not study.rare.levels:
        answered = _find_levels(space, pilots, bring)
    estimates = [
        Estimate(pilot.design, run, study.rare.levels or pilot.levels)
        for pilot in pilots
        for run in range(study.replicates)
    ]
    everybody = estimates if study.rare.levels else [*pilots, *estimates]
    for number in range(max(len(one.levels) for one in estimates) if answered else 0):
        _fly_level(space, [one for one in estimates if number < len(one.levels)], number, bring)
        if _too_many(study, everybody):
            answered = False
            break
    _write(space, folder, everybody, units, answered=answered)
    return sum(one.flown for one in everybody), sum(one.failed for one in everybody)


def most_missions(study: Study) -> int:
    """Returns the maximum number of missions of one design."""
    if study.rare.levels:
        return study.replicates * len(study.rare.levels) * study.rare.missions
    return (study.replicates + 1) * MOST_LEVELS * study.rare.missions


def trial_course(study: Study) -> Course:
    """Returns the changes in the mission with which a study of a rare event is checked at its start."""
    return (Turn(_place(study.rare, study.rare.goal), _writes(study, 1, 0)),)


def _too_many(study: Study, estimates: Sequence[Estimate]) -> bool:
    return study.most_failures is not None and sum(one.failed for one in estimates) >= study.most_failures


def _fly_level(space: Space, estimates: Sequence[Estimate], number: int, bring: Bring) -> None:
    for estimate, flown in _flown_to(space, estimates, lambda one: one.levels[number], number, bring):
        estimate.ways = []
        for way, record in flown:
            if record["outcome"] == "reached":
                estimate.ways.append(dataclasses.replace(way, times_s=(*way.times_s, record["time"])))
        estimate.reached.append(len(estimate.ways))


def _flown_to(
    space: Space, estimates: Sequence[Estimate], level: Callable[[Estimate], float], number: int, bring: Bring
) -> list[tuple[Estimate, list[tuple[Way, Record]]]]:
    """Runs the missions of each estimate that start at its level ``number`` - 1 (at t = 0 if ``number`` is 0). They run to
    ``level(estimate)``, or to their end if they do not reach it. Returns the missions of each estimate with their records."""
    study = space.study
    flights = [(one, [(way, _order(space, one, way, level(one))) for way in _ways(study, one, number)]) for one in estimates]
    journal = bring([order for _, own in flights for _, order in own], _most_later(space, estimates, number))
    result = []
    for estimate, own in flights:
        flown = []
        for way, order in own:
            record = journal.find(order["mission"])
            assert record is not None
            estimate.count(record)
            flown.append((way, record))
        result.append((estimate, flown))
    journal.sync()
    return result


def _most_later(space: Space, estimates: Sequence[Estimate], number: int) -> int:
    """Returns the maximum number of missions that the study needs after those to the level with the index ``number``."""
    study, designs = space.study, len(space.designs)
    if estimates[0].run == study.replicates:  # pilot missions, which precede all estimates
        return ((MOST_LEVELS - number - 1) + study.replicates * MOST_LEVELS) * designs * study.rare.missions
    return sum(len(one.levels) - number - 1 for one in estimates) * study.rare.missions


def _place(splitting: Splitting, level: float) -> Values:
    return {"score": [splitting.score, splitting.sign], "level": level}


def _ways(study: Study, estimate: Estimate, number: int) -> Iterator[Way]:
    """Yields the missions that start from states of missions that reached level ``number`` - 1. If ``number`` is 0, they start at t = 0."""
    count, first = study.rare.missions, estimate.run * study.rare.missions
    if number == 0:
        yield from (Way(first + index) for index in range(count))
        return
    parents = estimate.ways
    if not parents:
        return
    each, rest = divmod(count, len(parents))
    lot = f"lot/{estimate.design}/{estimate.run}/{number}"
    order = sorted(range(len(parents)), key=lambda parent: chance.unit(study.draws_seed, lot, parent))
    lucky = set(order[:rest])
    place = _place(study.rare, estimate.levels[number - 1])
    index = first
    for parent, way in enumerate(parents):
        for _ in range(each + (parent in lucky)):
            yield dataclasses.replace(way, course=(*way.course, Turn(place, _writes(study, number, index))))
            index += 1


def _writes(study: Study, number: int, index: int) -> Values:
    """Returns new draws of the variables in ``reseed``. They depend on the level's index ``number`` and on the mission's ``index``."""
    return {
        name: chance.value(study.draws[name], chance.unit(study.draws_seed, f"{name}/level {number}", index))
        for name in study.rare.reseed
    }


def _order(space: Space, estimate: Estimate, way: Way, level: float) -> Order:
    values = space.values((estimate.design, way.draw))
    return space.missions.order_until(_place(space.study.rare, level), values, way.course)


# Levels that the study does not state.

SHARE = 0.2
"""The share of missions that should reach the next level. With fixed effort, the work for a given error has
its minimum at a fifth (Lagnoux 2006, Probability in the Engineering and Informational Sciences 20, 45)."""
MOST_LEVELS = 20
"""The maximum number of levels. A fifth of a fifth and so on is then 1e-14."""


def _find_levels(space: Space, pilots: list[Estimate], bring: Bring) -> bool:
    """Runs pilot missions of each design to their end or to the goal. The next level is the score that the best fifth reached (adaptive
    multilevel splitting: Cérou, Guyader 2007); these missions are its entrances. Estimates use their own draws, so the choice of levels
    causes no bias. Returns False if too many missions failed."""
    goal = space.study.rare.goal
    flying = pilots
    while flying:
        number = len(flying[0].levels)
        for pilot, flown in _flown_to(space, flying, lambda one: goal, number, bring):
            _set_level(space.study.rare, pilot, flown)
        if _too_many(space.study, pilots):
            return False
        flying = [pilot for pilot in flying if pilot.levels[-1] != goal]
    return True


def _set_level(splitting: Splitting, pilot: Estimate, flown: list[tuple[Way, Record]]) -> None:
    sound = [(way, record) for way, record in flown if not record["error"]]
    bests = [splitting.sign * record["best"] for _, record in sound]
    floor = splitting.sign * pilot.levels[-1] if pilot.levels else None
    level = splitting.sign * next_level(bests, floor, splitting.sign * splitting.goal, len(pilot.levels))
    entrances = [(way, record) for way, record in sound if splitting.sign * record["best"] >= splitting.sign * level]
    pilot.levels += (level,)
    pilot.ways = [way for way, _ in entrances]
    pilot.reached.append(len(entrances))
    if level != splitting.goal:
        # The entrances saved no state at the level, because it was not known before. Each must run to the level again, which counts as
        # simulated time.
        pilot.simulated_s += [record["simulated_time"] for _, record in entrances]


def next_level(bests: Sequence[float], floor: float | None, goal: float, found: int) -> float:
    """Chooses the next level after missions from the level ``floor`` (None: from the start): the score that the best fifth of them reached.
    Returns the goal if this score reaches it, if no mission got beyond ``floor``, or if ``found`` levels are enough."""
    if not bests or found + 1 >= MOST_LEVELS:
        return goal
    beyond = min(bests) if floor is None else floor
    ranked = sorted(bests, reverse=True)
    level = ranked[max(1, round(SHARE * len(ranked))) - 1]
    if level <= beyond:  # most missions made no progress
        level = min((best for best in bests if best > beyond), default=goal)
    return min(level, goal)


# Results.


def _write(space: Space, folder: pathlib.Path, estimates: list[Estimate], units: Units, *, answered: bool) -> None:
    """Writes the tables and the page. If too many missions failed before the last level, there is no answer."""
    study = space.study
    levels = [["design", "estimate", "level", "missions", "reached"]]
    for one in estimates:
        name = "pilot" if one.run == study.replicates else str(one.run)
        for level, reached in zip(one.levels, one.reached, strict=False):
            levels.append([str(one.design), name, tables.cell(level), str(study.rare.missions), str(reached)])
    write_csv(folder / "levels.csv", levels)
    rows = [
        ["design", *space.factors, "estimates", "missions", "failed", "simulated_time [s]"]
        + ["probability", "probability: low", "probability: high", "relative_error"]
    ]
    told = []
    for design, values in enumerate(space.designs):
        own = [one for one in estimates if one.design == design]
        counted = [one for one in own if one.run < study.replicates]
        answer = _answer(study, counted) if answered else [None] * 4
        missions = sum(one.flown for one in own)
        simulated_s = math.fsum(time_s for one in own for time_s in one.simulated_s)
        rows.append(
            [str(design), *(tables.cell(values[name]) for name in space.factors), str(study.replicates), str(missions)]
            + [str(sum(one.failed for one in own)), tables.cell(simulated_s), *map(tables.cell, answer)]
        )
        told.append(rare_report.Design(
            values=[values[name] for name in space.factors], missions=missions, failed=sum(one.failed for one in own),
            simulated_s=simulated_s, answer=answer, levels=list(counted[0].levels), reached=[one.reached for one in counted],
            command=_write_replay(space, folder, design, counted)))
    write_csv(folder / "designs.csv", rows)
    columns.write(folder)
    rare_report.write(folder / "report.html", study, space.factors, told, space.provenance(space.values((0, 0))), units)


def _answer(study: Study, estimates: list[Estimate]) -> list[float | None]:
    """Returns the mean probability of the estimates, both ends of its interval, and its relative standard error."""
    moments = Moments().add(one.probability(study) for one in estimates)
    low, high = student(moments, study.error)
    relative = moments.deviation / math.sqrt(moments.count) / moments.mean if moments.mean > 0 and moments.count > 1 else None
    return [moments.mean, max(low, 0.0), min(high, 1.0), relative]


def _write_replay(space: Space, folder: pathlib.Path, design: int, estimates: list[Estimate]) -> str:
    """Writes a scenario that repeats the first mission that reached the last level. Returns the command, or "" if no mission reached it."""
    way = next((way for one in estimates if len(one.reached) == len(one.levels) for way in one.ways), None)
    if way is None:
        return ""
    scenario = []
    for turn, begin_s, end_s in zip(way.course, way.times_s, way.times_s[1:], strict=False):
        for name, value in turn.writes.items():
            entry = {"variable": name, "set": value, "from": begin_s}
            scenario.append(entry | {"until": end_s} if turn is not way.course[-1] else entry)
    text = f"A mission of design {design} that reached the last level, with the values that were drawn again at the levels"
    return space.missions.replay(space.values((design, way.draw)), folder / "rare", f"design_{design}", text, scenario)
