# SPDX-License-Identifier: Apache-2.0
"""Determines the Pareto front and its certainty.

Compares designs first by the intervals of their means. If two intervals overlap, compares the two designs replicate by replicate.
"""

from __future__ import annotations

import numpy as np

from mebots.exploration.comparison import Evidence

ON, OFF, UNDECIDED, EXCLUDED, NONE = "on", "off", "undecided", "excluded", ""


def places(evidence: Evidence) -> list[str]:
    """Returns a word per design. ``excluded``: certainly violates a constraint. ``off``: certainly dominated by another design that
    satisfies all constraints. ``on``: certainly satisfies all constraints, and is certainly better than each other design in some
    objective. ``undecided``: all others, because differences within the uncertainty do not count. Without a front, all words are empty."""
    designs = range(len(evidence.counts))
    if not evidence.has_front:
        return [NONE] * len(designs)
    feasible = [evidence.feasible(design) for design in designs]
    sure = Dominance(evidence, [design for design in designs if feasible[design]], [design for design in designs if feasible[design] is not False])
    result = []
    for design in designs:
        if feasible[design] is False:
            result.append(EXCLUDED)
        elif sure.is_dominated(design):
            result.append(OFF)
        elif feasible[design] and sure.is_best_somewhere(design):
            result.append(ON)
        else:
            result.append(UNDECIDED)
    return result


class Dominance:
    """Determines whether a design is certainly dominated, or certainly not. is_dominated() compares it with the leaders, which are the
    Pareto front of the means of ``feasible``. is_best_somewhere() compares it with all ``rivals``."""

    def __init__(self, evidence: Evidence, feasible: list[int], rivals: list[int]) -> None:
        self._evidence = evidence
        low, high, mean = evidence.bounds()
        self._low, self._high, self._mean = low, high, mean
        self._leaders = np.array(evidence.leaders(feasible), int)
        self._rivals = np.array(rivals, int)
        # One row for each objective, because NumPy is fast along rows.
        self._leaders_low, self._leaders_mean = low[self._leaders].T.copy(), mean[self._leaders].T.copy()
        self._rivals_high = high[self._rivals].T.copy()
        # If two designs have the same missions, the mean of differences is the difference of means.
        self._counts = np.array(evidence.counts)
        self._counts[~evidence.complete] = -1
        self._leaders_counts = self._counts[self._leaders]
        # Tolerates the rounding of sums, which depends on their order.
        self._slack = 1e-9 * np.nanmax(np.abs(mean), axis=0, initial=0.0)

    def is_dominated(self, design: int) -> bool:
        """True if a leader certainly dominates the design."""
        leaders, tolerances = self._leaders, self._evidence.tolerances
        never_worse, some_better, may_lead = (np.full(len(leaders), one) for one in (True, False, True))
        for at, tolerance in enumerate(tolerances):
            lead = self._leaders_low[at] - self._high[design, at]
            never_worse &= (lead > 0) | (lead > -tolerance)
            some_better |= lead > 0
            # A cheap test for leaders with the same missions: if the mean difference is too small, the leader cannot dominate, because the
            # lower bound of a difference is below its mean.
            may_lead &= self._leaders_mean[at] > self._mean[design, at] - tolerance - self._slack[at]
        others = leaders != design
        if (never_worse & some_better & others).any():
            return True
        same_missions = (self._leaders_counts == self._counts[design]) & (self._counts[design] >= 0)
        open_ones = leaders[others & (may_lead | ~same_missions)]
        margin = (self._mean[open_ones] - self._mean[design]).min(axis=1, initial=np.inf)
        largest_first = open_ones[np.argsort(-margin, kind="stable")]
        return any(self._evidence.dominates(leader, design) for leader in largest_first.tolist())

    def is_best_somewhere(self, design: int) -> bool:
        """True if the design is certainly better than each rival in some objective, so that no rival dominates it."""
        open_ones = self._rivals != design
        for at in range(len(self._rivals_high)):
            open_ones &= self._low[design, at] <= self._rivals_high[at]
        rivals = self._rivals[open_ones]
        margin = (self._mean[design] - self._mean[rivals]).max(axis=1, initial=-np.inf)
        nearest_first = rivals[np.argsort(margin, kind="stable")]
        return all(self._evidence.not_dominated_by(design, rival) for rival in nearest_first.tolist())
