# SPDX-License-Identifier: Apache-2.0
"""Chooses the next missions. Decisions are made between rounds and depend only on earlier rounds, so they are the same for any number of
workers and after interruptions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mebots.exploration.comparison import Evidence
from mebots.exploration.front import Dominance
from mebots.exploration.study import Study

Flight = tuple[int, int]
"""Design, replicate."""

FLYING = "flying"


class Flights(Sequence[Flight]):
    """A sequence of missions: the replicates from ``begin`` to ``end`` - 1 of the first design, then those of the next design, and so on.
    Computes its items, so it needs no memory for them."""

    def __init__(self, designs: Sequence[int], begin: int, end: int) -> None:
        self.designs = designs
        self.begin = begin
        self.end = max(begin, end)

    def __len__(self) -> int:
        return len(self.designs) * (self.end - self.begin)

    def __getitem__(self, index):  # no slices
        at, replicate = divmod(index, self.end - self.begin)
        return self.designs[at], self.begin + replicate

    def __iter__(self) -> Iterator[Flight]:
        return ((design, replicate) for design in self.designs for replicate in range(self.begin, self.end))


class Rounds:
    """Runs as many replicates of each design as necessary.

    Every round adds the same replicates to each active design. After a round, a design ends if the condition of ``stop`` is met, or if
    racing drops it.
    """

    def __init__(self, study: Study, evidence: Evidence) -> None:
        self._study = study
        self._evidence = evidence
        self._size = study.round_size or study.replicates
        self._flown = 0
        self._decided = 0
        self.status = [FLYING] * len(evidence.counts)

    def flying(self) -> list[int]:
        return [design for design, status in enumerate(self.status) if status == FLYING]

    def next(self) -> Flights:
        """Returns the missions of the next round. Empty if the study is done."""
        return self._missions(self._flown)

    def ahead(self) -> Flights:
        """Returns the missions of the round after the current one, assuming that no design ends in the current one. Idle workers run them
        early."""
        return self._missions(self._flown + self._size)

    def most_left(self) -> int:
        """Returns the number of missions left if no design ends early."""
        return len(self.flying()) * (self._study.replicates - self._flown)

    def likely_left(self) -> float:
        """Estimates the number of missions left. Assumes that each round ends the same share of the remaining designs as the rounds so
        far."""
        if self._decided == 0:
            return self.most_left()
        going_on = (len(self.flying()) / len(self.status)) ** (1 / self._decided)
        left, designs = 0.0, float(len(self.flying()))
        for begin in range(self._flown, self._study.replicates, self._size):
            left += designs * min(self._size, self._study.replicates - begin)
            designs *= going_on
        return left

    def decide(self) -> None:
        """Ends the round. The evidence must contain all of its missions."""
        self._flown = min(self._flown + self._size, self._study.replicates)
        self._decided += 1
        last = self._flown == self._study.replicates
        if self._study.stop is not None:
            self._answer()
        if self._study.racing and not last:
            self._race()
        if last:
            for design in self.flying():
                self.status[design] = "all flown"

    def end(self, reason: str) -> None:
        for design in self.flying():
            self.status[design] = reason

    def _missions(self, begin: int) -> Flights:
        return Flights(self.flying(), begin, min(begin + self._size, self._study.replicates))

    def _answer(self) -> None:
        stop = self._study.stop
        assert stop is not None
        objective = self._study.objective(stop.label)
        flying = self.flying()
        for design in flying:
            low, high = self._evidence.known_of(design, objective)
            if stop.width is not None and high - low <= stop.width:
                self.status[design] = f"interval of {stop.label} is at most {stop.width:g}"
            if stop.constraint is not None:
                side = self._evidence.side(design, stop.constraint)
                word = "above" if stop.constraint.above else "below"
                if side is not None:
                    self.status[design] = f"{stop.label} {'' if side else 'not '}{word} {stop.constraint.bound:g}"
        if stop.best:
            worse = [
                design
                for design in flying
                if any(self._evidence.surely_better(other, design, stop.label) for other in flying if other != design)
            ]
            for design in worse:
                self.status[design] = f"not the best by {stop.label}"
            if len(flying) - len(worse) == 1:
                (best,) = set(flying) - set(worse)
                self.status[best] = f"the best by {stop.label}"

    def _race(self) -> None:
        designs = range(len(self.status))
        feasible = [self._evidence.feasible(design) for design in designs]
        sure = Dominance(self._evidence, [design for design in designs if feasible[design]], [])
        for design in self.flying():
            if feasible[design] is False:
                self.status[design] = "dropped: breaks a constraint"
            elif sure.is_dominated(design):
                self.status[design] = "dropped: dominated"
