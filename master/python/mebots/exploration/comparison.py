# SPDX-License-Identifier: Apache-2.0
"""Computes statistics of designs and comparisons from the missions so far.

All designs use the same draws, so designs are compared replicate by replicate, and common effects of chance cancel out. For shares, a
replicate counts only if exactly one of the two designs succeeds. If the designs are equal, each of them has this success with probability
one half.
"""

from __future__ import annotations

import array
import collections
import dataclasses
import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from mebots.exploration import pareto
from mebots.exploration.answers import (
    Interval,
    Moments,
    exact_share,
    mean_sequence,
    percentile_interval,
    percentile_of,
    percentile_sequence,
    share_sequence,
    student,
    wilson,
)
from mebots.exploration.objectives import Measures
from mebots.exploration.study import Constraint, Objective, Study


@dataclasses.dataclass
class Estimate:
    """The estimate of an objective for a design: counted missions, mean, interval, and successes of a share. For a percentile, ``mean`` is
    the percentile."""

    count: int
    mean: float | None
    interval: Interval
    successes: int | None = None


@dataclasses.dataclass(frozen=True)
class Methods:
    """The functions that compute the interval of a share, a mean and a percentile."""

    share: Callable[[int, int, float], Interval]
    mean: Callable[[Moments, float], Interval]
    percentile: Callable[[Sequence[float], float, float], Interval]


SEQUENCES = Methods(share_sequence, mean_sequence, percentile_sequence)
"""Intervals that are valid at all numbers of missions at once, for a study whose decisions end the missions of designs."""
SHOWN = Methods(wilson, student, percentile_interval)
"""Intervals for a number of missions that was chosen beforehand."""
DECIDED = Methods(exact_share, student, percentile_interval)
"""Intervals for decisions with such a number. A decision makes many comparisons, each with a small permitted error, for
which Wilson's interval is too narrow."""


class Evidence:
    """Stores the measures of all missions by design and replicate, 8 bytes each. NaN marks a missing measure. A mission without a result
    has no measures."""

    def __init__(self, study: Study, designs: int) -> None:
        self.study = study
        self.index = {one.label: number for number, one in enumerate(study.objectives)}
        self.counts: list[int] = [0] * designs
        """The number of counted replicates of each design."""
        self._measures = [array.array("d") for _ in range(designs)]
        self._missing: collections.Counter[int] = collections.Counter()
        self._senses = [one for one in study.objectives if one.sense != 0]
        self._estimates: dict[tuple[int, str, float, bool], tuple[int, Estimate]] = {}

    def add_designs(self, designs: int) -> None:
        """Extends the tables to this number of designs."""
        while len(self.counts) < designs:
            self.counts.append(0)
            self._measures.append(array.array("d"))

    def put(self, design: int, replicate: int, measures: Measures) -> None:
        """Stores the measures of a mission. The measures count only after ``count_to`` includes this replicate."""
        width, own = len(self.index), self._measures[design]
        values = [math.nan if one is None else one for one in measures]
        if len(own) == replicate * width:
            own.extend(values)
            return
        if len(own) < (replicate + 1) * width:
            own.extend([math.nan] * ((replicate + 1) * width - len(own)))
        own[replicate * width : (replicate + 1) * width] = array.array("d", values)

    def put_rows(self, design: int, replicate: int, rows: np.ndarray) -> None:
        """Stores the measures of consecutive replicates, one row each. NaN marks a missing measure."""
        width, own = len(self.index), self._measures[design]
        begin, end = replicate * width, (replicate + len(rows)) * width
        if len(own) < begin:
            own.extend([math.nan] * (begin - len(own)))
        values = array.array("d", rows.tobytes())
        if len(own) == begin:
            own.extend(values)
            return
        if len(own) < end:
            own.extend([math.nan] * (end - len(own)))
        own[begin:end] = values

    def count_to(self, design: int, replicates: int) -> None:
        """Includes the first ``replicates`` results of a design in its statistics."""
        self.counts[design] = replicates

    def miss(self, design: int, replicate: int) -> None:
        """Records that a mission has no result."""
        self.put(design, replicate, (None,) * len(self.index))
        self._missing[design] += 1

    def missing_of(self, design: int) -> int:
        return self._missing[design]

    def missions_of(self, design: int) -> int:
        """Returns the number of the design's missions that count in its statistics and have a result."""
        return self.counts[design] - self._missing[design]

    def row(self, design: int, replicate: int) -> list[float | None]:
        width = len(self.index)
        return [_known(one) for one in self._measures[design][replicate * width : (replicate + 1) * width]]

    def columns(self, design: int, begin: int, end: int) -> list[array.array[float]]:
        """Returns the measures of the replicates from ``begin`` to ``end``. NaN marks a missing measure."""
        width = len(self.index)
        return [self._measures[design][begin * width + at : end * width : width] for at in range(width)]

    def column(self, design: int, at: int) -> array.array[float]:
        """Returns one measure for all missions of a design that count in its statistics (see count_to()). NaN marks a missing measure."""
        width = len(self.index)
        return self._measures[design][at : self.counts[design] * width : width]

    @property
    def design_error(self) -> float:
        """Returns the permitted error of one statement about one design. All statements about single designs together use half of
        ``error``; comparisons of designs use the other half.
        """
        statements = len(self.study.constraints) + (self.study.stop is not None) + len(self._senses)
        return self.study.error / 2 / (max(len(self.counts), 1) * max(statements, 1))

    def estimate(self, design: int, objective: Objective, error: float, methods: Methods) -> Estimate:
        count = self.counts[design]
        key = (design, objective.label, error, methods is DECIDED)
        known = self._estimates.get(key)
        if known is not None and known[0] == count:
            return known[1]
        found = _estimated(objective, self.column(design, self.index[objective.label]), error, methods)
        self._estimates[key] = (count, found)
        return found

    def so_far(self, design: int, objective: Objective) -> Estimate:
        """Returns the estimate from all results so far, including those that do not yet count in the statistics (see count_to())."""
        values = self._measures[design][self.index[objective.label] :: len(self.index)]
        return _estimated(objective, values, self.study.error, SEQUENCES if self.study.looks else SHOWN)

    def course(self, design: int, objective: Objective, counts: Sequence[int]) -> list[Estimate]:
        """Returns the estimates that shown() would return after each of these numbers of missions."""
        values = self.column(design, self.index[objective.label])
        methods = SEQUENCES if self.study.looks else SHOWN
        return [_estimated(objective, values[:count], self.study.error, methods) for count in counts]

    def shown(self, design: int, objective: Objective) -> Estimate:
        """Returns the estimate for tables. Its interval contains the true value with the probability 1 - ``error``."""
        return self.estimate(design, objective, self.study.error, SEQUENCES if self.study.looks else SHOWN)

    def known_of(self, design: int, objective: Objective) -> Interval:
        """Returns the interval with which the study compares the design with bounds and other designs. Without draws, all missions of a
        design are equal, so the value is exact."""
        found = self.estimate(design, objective, self.design_error, SEQUENCES if self.study.looks else DECIDED)
        return (found.mean, found.mean) if not self.study.draws and found.mean is not None else found.interval

    def side(self, design: int, constraint: Constraint) -> bool | None:
        """Returns True if a design certainly satisfies a constraint, False if it certainly violates it, and None otherwise."""
        low, high = self.known_of(design, self.study.objective(constraint.label))
        if constraint.above:
            return True if low > constraint.bound else False if high <= constraint.bound else None
        return True if high < constraint.bound else False if low >= constraint.bound else None

    def feasible(self, design: int) -> bool | None:
        """Returns True if a design certainly satisfies all constraints, False if it certainly violates one, and None otherwise."""
        sides = [self.side(design, constraint) for constraint in self.study.constraints]
        if False in sides:
            return False
        return None if None in sides else True

    def advantage(self, better: int, worse: int, objective: Objective) -> float:
        """Returns the amount by which ``better`` is certainly better, in the unit of the objective, whether it is minimised or maximised. A
        negative result is the amount by which ``better`` may be worse. If the order of two shares is certain, but not the amount, returns
        the smallest positive number."""
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
        if objective.percentile is not None:  # the percentile of differences is not the difference of percentiles
            return -math.inf
        differences = self.differences(better, worse, objective)
        if objective.is_share:
            wins = sum(1 for one in differences if one > 0)
            decided = sum(1 for one in differences if one != 0)
            return math.ulp(0.0) if self.share_bound(wins, decided) > 0.5 else -math.inf
        return self.mean_bound(Moments().add(differences))

    def share_bound(self, wins: int, decided: int) -> float:
        """Returns the lower bound of the share ``wins`` / ``decided``. ``decided`` is the number of replicates in which exactly one of two
        designs succeeds, and ``wins`` is the number of those in which it is the first design."""
        return (SEQUENCES if self.study.looks else DECIDED).share(wins, decided, self.pair_error)[0]

    def mean_bound(self, differences: Moments) -> float:
        """Returns the lower bound of the mean of differences between two designs."""
        return (SEQUENCES if self.study.looks else DECIDED).mean(differences, self.pair_error)[0]

    def differences(self, better: int, worse: int, objective: Objective) -> list[float]:
        """Returns for each common replicate the amount by which ``better`` was better, whether the objective is minimised or maximised."""
        sense, at = objective.sense or 1, self.index[objective.label]
        return [
            sense * (a - b)
            for a, b in zip(self.column(better, at), self.column(worse, at), strict=False)
            if a == a and b == b  # not NaN
        ]

    @property
    def pair_error(self) -> float:
        """Returns the permitted error of one comparison. All comparisons together are wrong with a probability of at most half of
        ``error``."""
        designs = max(len(self.counts), 2)
        return self.study.error / 2 / (designs * (designs - 1) / 2 * max(len(self._senses), 1))

    def dominates(self, design: int, other: int) -> bool:
        """True if the design is certainly better than ``other`` in one objective, and certainly not worse by more than the tolerance in any
        other objective."""
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
        """True if the design is certainly better than ``other`` in one objective, so that ``other`` cannot dominate it."""
        return any(self.advantage(design, other, objective) > 0 for objective in self._senses)

    def surely_better(self, design: int, other: int, label: str) -> bool:
        return self.advantage(design, other, self.study.objective(label)) > 0

    def leaders(self, designs: Sequence[int]) -> list[int]:
        """Returns the designs on the Pareto front of the means so far. No design dominates them, and one of them dominates each other
        design. Ignores designs without a mean of each objective that is minimised or maximised."""
        points = [(design, self._point(design)) for design in designs]
        complete = [(design, point) for design, point in points if None not in point]
        if not complete:
            return []
        return [complete[at][0] for at in pareto.front(np.array([point for _, point in complete], float))]

    def bounds(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Returns the lower and upper ends of the intervals for decisions, and the means, which are NaN if missing. Each array has a row
        per design and a column per objective. Values of minimised objectives are negated, so greater is always better."""
        shape = (len(self.counts), len(self._senses))
        low, high, mean = np.empty(shape), np.empty(shape), np.full(shape, np.nan)
        for design in range(len(self.counts)):
            for at, objective in enumerate(self._senses):
                first, second = self.known_of(design, objective)
                low[design, at], high[design, at] = (first, second) if objective.sense > 0 else (-second, -first)
                found = self.shown(design, objective).mean
                if found is not None:
                    mean[design, at] = objective.sense * found
        return low, high, mean

    @property
    def tolerances(self) -> np.ndarray:
        return np.array([objective.tolerance for objective in self._senses])

    @property
    def complete(self) -> np.ndarray:
        """Returns for each design whether all of its missions have values for each objective that is minimised or maximised."""
        places = [self.index[objective.label] for objective in self._senses]
        return np.array([not any(np.isnan(self.column(design, at)).any() for at in places) for design in range(len(self.counts))], bool)

    def _point(self, design: int) -> tuple[float | None, ...]:
        means = [self.shown(design, objective).mean for objective in self._senses]
        return tuple(
            None if mean is None else objective.sense * mean for mean, objective in zip(means, self._senses, strict=True)
        )

    @property
    def has_front(self) -> bool:
        return bool(self._senses)


def _estimated(objective: Objective, column: Iterable[float], error: float, methods: Methods) -> Estimate:
    values = [one for one in column if one == one]  # not NaN
    if objective.is_share:
        successes = int(sum(values))
        interval = methods.share(successes, len(values), error)
        return Estimate(len(values), successes / len(values) if values else None, interval, successes)
    if objective.percentile is not None:
        values.sort()
        interval = methods.percentile(values, objective.percentile, error)
        return Estimate(len(values), percentile_of(values, objective.percentile) if values else None, interval)
    moments = Moments().add(values)
    interval = methods.mean(moments, error)
    return Estimate(len(values), moments.mean if values else None, interval)


def _known(value: float) -> float | None:
    return value if value == value else None  # not NaN
