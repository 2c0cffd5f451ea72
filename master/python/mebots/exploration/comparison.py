# SPDX-License-Identifier: Apache-2.0
"""What is known of designs, and of one against another, from the missions that were flown.

All designs fly the same draws, so a pair is compared replicate by replicate: what chance does to both cancels. For
shares only replicates count in which one succeeded and the other did not; which of the two it was is a coin under "they
are equal".
"""

from __future__ import annotations

import dataclasses
import math

from mebots.exploration.answers import Interval, Moments, mean_sequence, share_sequence, student, wilson
from mebots.exploration.objectives import Measures
from mebots.exploration.study import Constraint, Objective, Study


@dataclasses.dataclass
class Estimate:
    """Of one objective of one design: how many missions count, their mean (for a share: of successes) and its interval."""

    count: int
    mean: float | None
    interval: Interval
    successes: int | None = None


class Evidence:
    """The measures of all missions that count, by design and replicate."""

    def __init__(self, study: Study, designs: int) -> None:
        self.study = study
        self.index = {one.label: number for number, one in enumerate(study.objectives)}
        self.measures: list[list[Measures]] = [[] for _ in range(designs)]
        self._senses = [one for one in study.objectives if one.sense != 0]
        self._estimates: dict[tuple[int, str, float, bool], tuple[int, Estimate]] = {}

    def add(self, design: int, measures: Measures) -> None:
        """The next replicate's."""
        while len(self.measures) <= design:
            self.measures.append([])
        self.measures[design].append(measures)

    @property
    def _pair_error(self) -> float:
        """Of one comparison, so that all together are wrong with a chance of at most half of ``error``."""
        designs = max(len(self.measures), 2)
        return self.study.error / 2 / (designs * (designs - 1) / 2 * max(len(self._senses), 1))

    @property
    def _design_error(self) -> float:
        """Of one statement on one design, so that all together are wrong with the other half."""
        statements = len(self.study.constraints) + (self.study.stop is not None) + len(self._senses)
        return self.study.error / 2 / (max(len(self.measures), 1) * max(statements, 1))

    def estimate(self, design: int, objective: Objective, error: float, *, sequence: bool) -> Estimate:
        """With an interval that holds at all times (``sequence``) or for a number of missions settled beforehand."""
        rows = self.measures[design]
        key = (design, objective.label, error, sequence)
        known = self._estimates.get(key)
        if known is not None and known[0] == len(rows):
            return known[1]
        at = self.index[objective.label]
        values = [row[at] for row in rows if row[at] is not None]
        if objective.is_share:
            successes = int(sum(values))
            interval = (share_sequence if sequence else wilson)(successes, len(values), error)
            found = Estimate(len(values), successes / len(values) if values else None, interval, successes)
        else:
            moments = Moments()
            for value in values:
                moments.add(value)
            interval = (mean_sequence if sequence else student)(moments, error)
            found = Estimate(len(values), moments.mean if values else None, interval)
        self._estimates[key] = (len(rows), found)
        return found

    def shown(self, design: int, objective: Objective) -> Estimate:
        """As the tables show it: at level 1 - ``error`` for each number by itself."""
        return self.estimate(design, objective, self.study.error, sequence=self.study.looks)

    def known_of(self, design: int, objective: Objective) -> Interval:
        """For decisions."""
        return self.estimate(design, objective, self._design_error, sequence=True).interval

    def side(self, design: int, constraint: Constraint) -> bool | None:
        """Whether a design is on the right side of a constraint; None while that is not sure."""
        low, high = self.known_of(design, self.study.objective(constraint.label))
        if constraint.above:
            return True if low > constraint.bound else False if high <= constraint.bound else None
        return True if high < constraint.bound else False if low >= constraint.bound else None

    def feasible(self, design: int) -> bool | None:
        """Whether it keeps all constraints; None while that is not sure."""
        sides = [self.side(design, constraint) for constraint in self.study.constraints]
        if False in sides:
            return False
        return None if None in sides else True

    def advantage(self, better: int, worse: int, objective: Objective) -> float:
        """By how much ``better`` is surely better, in the objective's sense and unit; negative: it may be worse by so
        much. Of shares where only the order is sure: the smallest number above 0."""
        separate = self._advantage_of_intervals(better, worse, objective)
        if separate > 0:
            return separate
        return max(separate, self._advantage_of_pairs(better, worse, objective))

    def _advantage_of_intervals(self, better: int, worse: int, objective: Objective) -> float:
        sense = objective.sense or 1
        first, second = self.known_of(better, objective), self.known_of(worse, objective)
        gap = first[0] - second[1] if sense > 0 else second[0] - first[1]
        return -math.inf if math.isnan(gap) else gap

    def _advantage_of_pairs(self, better: int, worse: int, objective: Objective) -> float:
        sense, at = objective.sense or 1, self.index[objective.label]
        differences = [
            sense * (a[at] - b[at])
            for a, b in zip(self.measures[better], self.measures[worse], strict=False)
            if a[at] is not None and b[at] is not None
        ]
        if objective.is_share:
            wins = sum(1 for one in differences if one > 0)
            decided = sum(1 for one in differences if one != 0)
            return math.ulp(0.0) if share_sequence(wins, decided, self._pair_error)[0] > 0.5 else -math.inf
        moments = Moments()
        for one in differences:
            moments.add(one)
        return mean_sequence(moments, self._pair_error)[0]

    def dominates(self, design: int, other: int) -> bool:
        """Surely better than ``other`` in one objective, and in none worse by more than its tolerance."""
        if not self._senses:
            return False
        some_better = False
        for objective in self._senses:
            advantage = self.advantage(design, other, objective)
            if advantage <= 0 and not advantage > -objective.tolerance:
                return False
            some_better = some_better or advantage > 0
        return some_better

    def not_dominated_by(self, design: int, other: int) -> bool:
        """Surely better than ``other`` in one objective, which then cannot dominate it."""
        return any(self.advantage(design, other, objective) > 0 for objective in self._senses)

    def surely_better(self, design: int, other: int, label: str) -> bool:
        return self.advantage(design, other, self.study.objective(label)) > 0

    def leaders(self, designs: list[int]) -> list[int]:
        """Of these designs, those that no other one dominates by what was measured so far: who is dominated at all is
        dominated by one of them."""
        points = {design: self._point(design) for design in designs}
        whole = {design: point for design, point in points.items() if None not in point}
        return [
            design
            for design, point in whole.items()
            if not any(
                other != point and all(a >= b for a, b in zip(other, point, strict=True)) for other in whole.values()
            )
        ]

    def _point(self, design: int) -> tuple[float | None, ...]:
        means = [self.shown(design, objective).mean for objective in self._senses]
        return tuple(
            None if mean is None else objective.sense * mean for mean, objective in zip(means, self._senses, strict=True)
        )

    @property
    def has_front(self) -> bool:
        return bool(self._senses)
