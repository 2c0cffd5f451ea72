# SPDX-License-Identifier: Apache-2.0
"""The Pareto front with what is sure of it.

Two designs are compared first by the intervals of their means, for all designs at once, and pair by pair only where the
intervals leave it open.
"""

from __future__ import annotations

import numpy as np

from mebots.exploration.comparison import Evidence

ON, OFF, UNDECIDED, EXCLUDED, NONE = "on", "off", "undecided", "excluded", ""


def places(evidence: Evidence) -> list[str]:
    """For each design: ``excluded`` (it surely breaks a constraint), ``off`` the front (another one that keeps all
    constraints surely dominates it), ``on`` it (surely feasible, and surely better than every other one in some
    objective), or ``undecided``. Noise is never ranked: two designs whose difference is not sure are both undecided."""
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
    """What is sure of each design compared with those that lead among ``feasible`` and with all ``rivals``."""

    def __init__(self, evidence: Evidence, feasible: list[int], rivals: list[int]) -> None:
        self._evidence = evidence
        self._low, self._high, self._mean = evidence.bounds()
        self._leaders = np.array(evidence.leaders(feasible), int)
        self._rivals = np.array(rivals, int)
        # Where two designs have the same missions, the mean of differences is the difference of means.
        self._counts = np.array(evidence.counts)
        self._counts[~evidence.complete] = -1
        # Sums in another order differ in their last bits.
        self._slack = 1e-9 * np.nanmax(np.abs(self._mean), axis=0, initial=0.0)

    def is_dominated(self, design: int) -> bool:
        """True if a leader surely dominates the design."""
        leaders = self._leaders
        lead = self._low[leaders] - self._high[design]
        tolerances = self._evidence.tolerances
        by_intervals = ((lead > 0) | (lead > -tolerances)).all(axis=1) & (lead > 0).any(axis=1)
        if (by_intervals & (leaders != design)).any():
            return True
        # A lower bound of a mean difference is below the difference.
        may_lead = (self._mean[leaders] - self._mean[design] > -tolerances - self._slack).all(axis=1)
        same_missions = (self._counts[leaders] == self._counts[design]) & (self._counts[design] >= 0)
        open_ones = (leaders != design) & (may_lead | ~same_missions)
        margin = (self._mean[leaders[open_ones]] - self._mean[design]).min(axis=1, initial=np.inf)
        nearest_last = leaders[open_ones][np.argsort(-margin, kind="stable")]
        return any(self._evidence.dominates(leader, design) for leader in nearest_last.tolist())

    def is_best_somewhere(self, design: int) -> bool:
        """True if the design is surely better than each rival in some objective, so that none dominates it."""
        rivals = self._rivals
        open_ones = ~(self._low[design] > self._high[rivals]).any(axis=1) & (rivals != design)
        margin = (self._mean[design] - self._mean[rivals[open_ones]]).max(axis=1, initial=-np.inf)
        nearest_first = rivals[open_ones][np.argsort(margin, kind="stable")]
        return all(self._evidence.not_dominated_by(design, rival) for rival in nearest_first.tolist())
