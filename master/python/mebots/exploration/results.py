# SPDX-License-Identifier: Apache-2.0
"""Stores for each mission of a study whether it has a result, and its hash, outcome and simulated time for missions.csv, in 42 bytes.
``comparison.Evidence`` stores the measures."""

from __future__ import annotations

import array
import collections
import dataclasses
import itertools
import math

import numpy as np

from mebots.exploration import tables
from mebots.exploration.comparison import Evidence
from mebots.exploration.files import csv_text
from mebots.exploration.journal import Record
from mebots.exploration.objectives import Measurer
from mebots.exploration.orders import DIGEST_BYTES
from mebots.exploration.replies import Reply
from mebots.exploration.rounds import Flights

_OPEN, _SOUND, _FAILED = 0, 1, 2
_MISSING = 0


@dataclasses.dataclass
class Rows:
    """The cells of consecutive missions of a design, one list per column."""

    missions: list[str | None]
    """Hashes; None for a mission without a result."""
    outcomes: list[str]
    measures: list[list[str]]
    times: list[str]
    messages: list[str]
    failed_places: dict[int, int]
    """Places of failed missions' records in the journal."""


class Results:
    """The missions of all rounds so far, and the state of each mission in the current round."""

    def __init__(self, evidence: Evidence, measurer: Measurer, replicates: int) -> None:
        self.evidence = evidence
        self.failures: collections.Counter[int] = collections.Counter()
        self.failed = 0
        """Failed missions of earlier rounds."""
        self._measurer = measurer
        self._replicates = replicates
        # Per mission: 32 bytes of its hash, the number of its outcome, and its simulated time.
        self._hashes: collections.defaultdict[int, bytearray] = collections.defaultdict(bytearray)
        self._outcomes: collections.defaultdict[int, array.array[int]] = collections.defaultdict(lambda: array.array("H"))
        self._times_s: collections.defaultdict[int, array.array[float]] = collections.defaultdict(lambda: array.array("d"))
        self._names: list[str] = [tables.MISSING]
        self._numbers: dict[str, int] = {tables.MISSING: _MISSING}
        self._failed_places: dict[tuple[int, int], int] = {}
        self.begin(Flights([], 0, 0))

    def begin(self, flights: Flights) -> None:
        """Starts a round. The evidence must contain all missions of the previous round."""
        self.flights = flights
        self._states = bytearray(len(flights))
        self.open = len(flights)
        self._settled = 0
        self.failed_so_far = self.failed
        """The number of failures, including the failures of this round before the first mission without a result."""

    def note(self, index: int, record: Record, place: int) -> None:
        """Stores the result of a mission in the current round."""
        design, replicate = self.flights[index]
        self.evidence.put(design, replicate, self._measurer(record, design * self._replicates + replicate))
        self._store(design, replicate, record)
        if record["error"]:
            self._failed_places[design, replicate] = place
        self.open -= self._states[index] == _OPEN
        self._states[index] = _FAILED if record["error"] else _SOUND

    def note_all(self, reply: Reply, places: np.ndarray) -> None:
        """Stores the results of several missions in the current round."""
        indices = np.array(reply.indices, np.int64)
        measures = self._measurer.columns(reply)
        numbers = np.array([self._number_of(name) for name in reply.outcome_names], np.uint16)[reply.outcomes]
        each = max(1, self.flights.end - self.flights.begin)
        # Each part contains consecutive missions of one design.
        cuts = np.flatnonzero((np.diff(indices) != 1) | (indices[1:] % each == 0)) + 1
        for begin, end in itertools.pairwise([0, *cuts.tolist(), len(indices)]):
            index = int(indices[begin])
            if index < 0:
                continue
            design, replicate = self.flights[index]
            self.evidence.put_rows(design, replicate, measures[begin:end])
            self._store_rows(design, replicate, b"".join(reply.digests[begin:end]), numbers[begin:end], reply.times_s[begin:end])
        known = indices >= 0
        states = np.frombuffer(self._states, np.uint8)
        self.open -= int((states[indices[known]] == _OPEN).sum())
        states[indices[known]] = np.where(reply.failed[known], _FAILED, _SOUND)
        for at in np.flatnonzero(reply.failed & known).tolist():
            self._failed_places[self.flights[int(indices[at])]] = int(places[at])

    def _number_of(self, outcome: str) -> int:
        number = self._numbers.get(outcome)
        if number is None:
            number = self._numbers[outcome] = len(self._names)
            self._names.append(csv_text([outcome]))
        return number

    def _store_rows(self, design: int, replicate: int, digests: bytes, numbers: np.ndarray, times_s: np.ndarray) -> None:
        hashes, outcomes, times = self._hashes[design], self._outcomes[design], self._times_s[design]
        end = replicate + len(numbers)
        self._extend(design, end)
        hashes[DIGEST_BYTES * replicate : DIGEST_BYTES * end] = digests
        outcomes[replicate:end] = array.array("H", numbers.tobytes())
        times[replicate:end] = array.array("d", times_s.tobytes())

    def _extend(self, design: int, replicates: int) -> None:
        """Extends the hashes, outcomes and times of a design to this number of missions."""
        lacking = replicates - len(self._outcomes[design])
        if lacking > 0:
            self._hashes[design].extend(bytes(DIGEST_BYTES * lacking))
            self._outcomes[design].extend([_MISSING] * lacking)
            self._times_s[design].extend([math.nan] * lacking)

    def _store(self, design: int, replicate: int, record: Record) -> None:
        numbers, times_s = np.array([self._number_of(record["outcome"])], np.uint16), np.array([record.get("simulated_time", math.nan)], float)
        self._store_rows(design, replicate, bytes.fromhex(record["mission"]), numbers, times_s)

    def rows(self, design: int, begin: int, end: int) -> Rows:
        """Returns the cells of missions.csv for the replicates from ``begin`` to ``end`` - 1 of a design."""
        self._extend(design, end)
        digests = self._hashes[design][DIGEST_BYTES * begin : DIGEST_BYTES * end].hex()
        numbers = self._outcomes[design][begin:end]
        missions: list[str | None] = [digests[at : at + 2 * DIGEST_BYTES] for at in range(0, len(digests), 2 * DIGEST_BYTES)]
        if _MISSING in numbers:
            missions = [None if number == _MISSING else mission for number, mission in zip(numbers, missions, strict=True)]
        names = self._names
        measures = [tables.number_texts(column) for column in self.evidence.columns(design, begin, end)]
        failed = {at - begin: place for at in range(begin, end) if (place := self._failed_places.get((design, at))) is not None} if self._failed_places else {}
        times = tables.number_texts(self._times_s[design][begin:end])
        return Rows(missions, [names[number] for number in numbers], measures, times, [""] * (end - begin), failed)

    def outcomes(self) -> tuple[list[str], list[np.ndarray]]:
        """Returns the names of all outcomes, and the outcome numbers of each design's missions."""
        for design, count in enumerate(self.evidence.counts):
            self._extend(design, count)
        return self._names, [np.array(self._outcomes[design]) for design in range(len(self.evidence.counts))]

    def settle(self, most_failures: int | None) -> int:
        """Settles further missions of the round in their order. Stops before the first mission without a result, or after the mission with
        which the number of failures reaches ``most_failures``. Returns the number of failures so far."""
        end = self._states.find(_OPEN, self._settled)
        end = len(self._states) if end < 0 else end
        if most_failures is None:
            self.failed_so_far += self._states.count(_FAILED, self._settled, end)
            self._settled = end
            return self.failed_so_far
        while self.failed_so_far < most_failures and self._settled < end:
            at = self._states.find(_FAILED, self._settled, end)
            self.failed_so_far += at >= 0
            self._settled = end if at < 0 else at + 1
        return self.failed_so_far

    def end(self) -> bool:
        """Includes the settled missions in the statistics. Returns True if the round ended before all of its missions were settled."""
        self._count(self._settled)
        self.failed = self.failed_so_far
        return self._settled < len(self._states)

    def end_unfinished(self) -> int:
        """Ends the round although some missions have no result. Records these as missing and returns their number. All missions of the
        round then count in the statistics."""
        missing = 0
        for index, state in enumerate(self._states):
            if state == _OPEN:
                missing += 1
                design, replicate = self.flights[index]
                self.evidence.miss(design, replicate)
        self._count(len(self._states))
        return missing

    def _count(self, settled: int) -> None:
        each = self.flights.end - self.flights.begin
        for at, design in enumerate(self.flights.designs):
            count = min(each, settled - at * each)
            if count <= 0:
                break
            self.failures[design] += self._states.count(_FAILED, at * each, at * each + count)
            self.evidence.count_to(design, self.flights.begin + count)
