# SPDX-License-Identifier: Apache-2.0
"""A study from its file to its answer."""

from __future__ import annotations

import array
import collections
import concurrent.futures
import dataclasses
import functools
import gc
import itertools
import json
import math
import pathlib
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from mebots import _mebots
from mebots.errors import Error, InputError
from mebots.exploration import chance, columns, front, report, sensitivity, splitting, tables
from mebots.exploration.comparison import Evidence
from mebots.exploration.dispatch import Dispatcher, Unfinished
from mebots.exploration.files import csv_text, write_csv, write_lines
from mebots.exploration.journal import Journal, Record
from mebots.exploration.missions import Order, build
from mebots.exploration.objectives import Measurer, has_all
from mebots.exploration.rounds import Flight, Flights, Rounds
from mebots.exploration.search import Search
from mebots.exploration.space import MOST_DRAWS_KEPT, Space
from mebots.exploration.study import Study, Values
from mebots.exploration.worker import flat

TABLES = ("missions.csv", "designs.csv", "sensitivity.csv", "levels.csv", *columns.NAMES, "report.html")
_CHUNK = 1000
"""Missions that are looked up in the journal at once."""
_OBJECTS_OF_A_COLLECTION = 100_000
"""New objects after which Python looks for unused cycles. With its default of 700, a fifth of a large study's time goes there."""
_MOST_COMPARED = 300
"""Designs of which it is told on the way who is ahead."""


FLIGHTS = "flights"
"""Folder of the missions' results, each by its hash."""


def is_done(folder: pathlib.Path) -> bool:
    """Whether the table that is written last is there."""
    return (folder / "report.html").exists()

_MOST_VALUES_TRIED = 64
"""Of one factor. Of more, the least and the greatest are tried."""


@dataclasses.dataclass(frozen=True)
class Progress:
    """How far a study is. ``most_left`` counts missions that a decision may still save, ``likely_left`` those that stay if
    decisions go on to save as many as until now; ``answer`` is what is known so far: how missions ended, and after a round
    which designs are ahead. ``of_other_builds``: records of journals that are not used, since another build flew them."""

    flown: int
    taken: int
    failed: int
    most_left: int
    likely_left: float
    designs_flying: int
    rate_per_s: float
    answer: str = ""
    of_other_builds: int = 0


@dataclasses.dataclass(frozen=True)
class Sweep:
    """What came of a study: missions that count, how many of them failed, and the folder with the tables."""

    folder: pathlib.Path
    missions: int
    failed: int
    without_value: list[str] = dataclasses.field(default_factory=list)
    """What to tell of objectives whose expression had no value in any mission."""
    notices: list[str] = dataclasses.field(default_factory=list)
    """What the journals reported: damaged lines, file systems without locks."""

    def designs(self) -> list[dict[str, str]]:
        """The rows of designs.csv."""
        titles, *rows = _mebots.read_csv(self.folder / "designs.csv")
        return [dict(zip(titles, row, strict=True)) for row in rows]


class Campaign:
    """Flies a study's missions through an executor. The executor's workers need nothing but the package mebots."""

    def __init__(self, study: Study, executor: concurrent.futures.Executor, in_flight: int) -> None:
        self.study = study
        self._dispatcher = Dispatcher(executor, in_flight)
        self.space = Space(study)
        self._check_names()
        labels = flat(self.space.missions.config.get("summary", {}))
        self._measurer = Measurer(study, _labels(labels))
        self.notices: list[str] = []
        self.flown = self.taken = self.failed = self.of_other_builds = 0
        self._begun_s = time.monotonic()
        self._outcomes: collections.Counter[str] = collections.Counter()
        self._ahead = ""
        self._flown_ahead: set[str] = set()  # of rounds to come

    # What the missions are.

    @property
    def most_missions(self) -> int:
        design = self.study.design
        designs = design["points"] * design["rounds"] if design["kind"] == "search" else len(self.space.designs)
        if self.study.splitting is not None:
            return designs * splitting.most_missions(self.study)
        return designs * self.study.replicates

    def all_flights(self) -> Flights:
        """All that a study without decisions flies."""
        return Flights(range(len(self.space.designs)), 0, self.study.replicates)

    def example(self) -> Values:
        """The values of a mission that stands for all."""
        return next(self._trials())[1]

    def _check_names(self) -> None:
        for name in self.study.fork.variables if self.study.fork else ():
            if name not in self.space.factors and name not in self.study.draws:
                raise InputError(f"{self.study.place}: 'fork': there is no factor or draw '{name}'", "unknown_name")
            spread = self.study.design.get("factors", {}).get(name)
            if name.startswith("/") or (isinstance(spread, dict) and "options" in spread):
                raise InputError(f"{self.study.place}: 'fork': '{name}' is not a variable that could change in a mission", "invalid_value")
        for one in self.study.objectives if self.study.results else ():
            if one.source == "series":
                raise InputError(f"{self.study.place}: the objective '{one.label}': a series cannot be used with 'results', which has the whole of it", "invalid_value")
        for name in self.study.draws:
            if name in self.space.factors:
                raise InputError(f"{self.study.place}: '{name}' is a factor and a draw; it can only be one of them", "duplicate_name")
        known = [one["outcome"] for one in self.space.missions.config.get("outcomes", [])] + ["completed"]
        for one in self.study.objectives:
            for outcome in one.what if one.is_share else ():
                if outcome not in known:
                    raise InputError(
                        f"{self.study.place}: the objective '{one.label}': the mission has no outcome '{outcome}'. It has: {', '.join(dict.fromkeys(known))}",
                        "unknown_name",
                    )

    # Before the first mission.

    def check(self, journal: Journal | None = None) -> None:
        """Brings missions to t = 0 in which every value of every factor occurs, and those at the ends of each draw.
        Raises InputError with everything that is refused."""
        tried: dict[str, tuple[str, Values]] = {}
        found: dict[str, Record] = {}
        problems: dict[str, str] = {}

        def take() -> None:
            found.update((record["mission"], record) for record, _ in self._dispatcher.take())

        for what, values in self._trials():
            try:
                order = self._trial(values)
            except InputError as error:  # of the config that the values make
                problems.setdefault(str(error), self._blamed("", str(error), values))
                continue
            if order["mission"] in tried or (journal is not None and order["mission"] in journal):
                continue
            tried[order["mission"]] = what, values
            while self._dispatcher.is_full:
                take()
            self._dispatcher.give(order | {"check": True})
        while len(found) < len(tried):
            self._dispatcher.flush()
            take()
        for mission, (what, values) in tried.items():
            error, about = found[mission]["error"], found[mission].get("about", "")
            if error:
                # Nobody called set(): the study says it.
                problems.setdefault(error.removeprefix(f'set("{about}"): '), self._blamed(about, error, values) or what)
        if problems:
            told = (": ".join(filter(None, (self.study.place, what, error))) for error, what in problems.items())
            raise InputError("\n".join(told), "invalid_value")

    def _blamed(self, about: str, error: str, values: Values) -> str:
        """Who asks for the variable that an error is about: a factor, a draw or an objective; "" for none of them."""
        for name, value in values.items():
            settings = self.space.missions.settings(name, value)
            if about in settings or any(key.startswith("/") and f" {key}: " in error for key in settings):
                return f"{'draw' if name in self.study.draws else 'factor'} '{name}' = {json.dumps(value)}"
        for one in self.study.objectives:
            if one.source in ("final", "series") and (one.what == about or f"'{one.what}'" in error):
                return f"the objective '{one.label}'"
        return ""

    def _trial(self, values: Values) -> Order:
        if self.study.splitting is None:
            return self.space.missions.order(values)
        return self.space.missions.order_until({}, values, splitting.trial_course(self.study))

    def _trials(self) -> Iterator[tuple[str, Values]]:
        if not self.space.designs:
            yield from self._trials_of_search()
            return
        for factor in self.space.factors:
            seen: dict[str, int] = {}
            for number, design in enumerate(self.space.designs):
                seen.setdefault(repr(design[factor]), number)
            chosen = list(seen.values())
            if len(chosen) > _MOST_VALUES_TRIED and all(_is_number(self.space.designs[one][factor]) for one in chosen):
                chosen.sort(key=lambda one: self.space.designs[one][factor])
                chosen = [chosen[0], chosen[-1]]
            for number in chosen:
                yield f"factor '{factor}' = {json.dumps(self.space.designs[number][factor])}", self.space.values((number, 0))
        for name, spread in self.study.draws.items():
            for value in chance.extremes(spread):
                yield f"draw '{name}' = {json.dumps(value)}", self.space.values((0, 0)) | {name: value}

    def _trials_of_search(self) -> Iterator[tuple[str, Values]]:
        factors = self.study.design["factors"]
        first = {name: chance.extremes(spread)[0] for name, spread in factors.items()}
        for name, spread in factors.items():
            for value in chance.extremes(spread):
                yield f"factor '{name}' = {json.dumps(value)}", first | {name: value} | self.space.draw(0)

    # Flying.

    def run(self, folder: pathlib.Path, reuse: Iterable[pathlib.Path], tell: Callable[[Progress], None]) -> Sweep:
        """Flies what the folder's journal does not have, and writes the tables. Raises InputError and Error."""
        thresholds = gc.get_threshold()
        gc.set_threshold(_OBJECTS_OF_A_COLLECTION, *thresholds[1:])
        try:
            return self._run(folder, reuse, tell)
        except (ConnectionError, TimeoutError):  # of an executor
            raise
        except OSError as error:
            if error.errno is None:  # not of the system: dask's closed connections are OSErrors, too
                raise
            raise Error(f"{error.filename or folder}: {error.strerror}", "file_unwritable") from error
        finally:
            gc.set_threshold(*thresholds)

    def _run(self, folder: pathlib.Path, reuse: Iterable[pathlib.Path], tell: Callable[[Progress], None]) -> Sweep:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{folder}: {error.strerror}. Choose another folder with --out", "file_unwritable") from None
        if self.study.results:
            self.space.missions.folder = folder.resolve() / FLIGHTS
            self.space.missions.folder.mkdir(exist_ok=True)
        journal = Journal(folder)
        others = [Journal(pathlib.Path(one), writable=False) for one in reuse]
        self.of_other_builds = sum(one.of_other_builds(build()) for one in (journal, *others))
        self.notices = [notice for one in (journal, *others) for notice in one.notices]
        try:
            self.check(journal)
            for name in TABLES:  # where they are, the study is done
                (folder / name).unlink(missing_ok=True)
            self.study.write(folder)
            if self.study.splitting is not None:
                bring = functools.partial(self._bring, journal, others, tell)
                return Sweep(folder, *splitting.fly(self.space, folder, bring), notices=self.notices)
            return self._fly_rounds(folder, journal, others, tell)
        finally:
            for one in (journal, *others):
                one.close()

    def _fly_rounds(self, folder: pathlib.Path, journal: Journal, others: list[Journal], tell: Callable[[Progress], None]) -> Sweep:
        evidence = Evidence(self.study, len(self.space.designs))
        rounds = self._rounds(evidence)
        results = _Results(evidence, self._measurer, self.study.replicates)
        try:
            while flights := rounds.next():
                results.begin(flights)
                self._fly(results, rounds, journal, others, tell)
                if results.end() or self._too_many(results.failed):
                    rounds.end(f"ended: {results.failed} missions had failed")
                    break
                rounds.decide()
                self._ahead = self._who_is_ahead(evidence)
        except Unfinished as error:
            missing = results.end_unfinished()
            rounds.end(f"not evaluated: {missing} missions are missing")
            try:
                journal.sync()
                self._write_tables(folder, journal, results, rounds)
            except (OSError, Error) as other:  # the disk that ended the missions may be this one
                raise Unfinished(f"{error}\n{missing} missions are missing, and no table could be written: {other}") from None
            raise Unfinished(f"{error}\n{missing} missions are missing: see {folder / 'designs.csv'}") from None
        journal.sync()
        self._write_tables(folder, journal, results, rounds)
        self._write_report(folder, results, rounds)
        missions = sum(evidence.counts)
        return Sweep(folder, missions, results.failed, self._measurer.without_value(), self.notices)

    def _rounds(self, evidence: Evidence) -> Rounds | Search:
        if self.study.design["kind"] == "search":
            return Search(self.study, evidence, self.space.designs)
        return Rounds(self.study, evidence)

    def _too_many(self, failures: int) -> bool:
        return self.study.most_failures is not None and failures >= self.study.most_failures

    def _fly(
        self,
        results: _Results,
        rounds: Rounds | Search,
        journal: Journal,
        others: list[Journal],
        tell: Callable[[Progress], None],
    ) -> None:
        """Brings the missions of a round into the journal and the results, up to the one with which too many had failed."""
        flights = results.flights
        left = rounds.most_left() - len(flights)
        likely_left = rounds.likely_left() - len(flights)
        flying = len(rounds.flying())
        waiting: dict[str, list[int]] = {}
        queue = self._unknown(flights, journal, others, results)
        ahead = self._unknown(rounds.ahead(), journal, others, None)
        while results.open > 0 and not self._too_many(results.settle(self.study.most_failures)):
            self._fill(queue, ahead, waiting, len(flights))
            if results.open == 0:
                break
            records = self._take(journal)
            for record, place in records:
                indices = waiting.pop(record["mission"], ())
                for index in indices:
                    results.note(index, record, place)
                if not indices:
                    self._flown_ahead.add(record["mission"])
            self._note([record for record, _ in records])
            self.failed = results.failed_so_far
            tell(self._progress(left + results.open, likely_left + results.open, flying))
        self.failed = results.settle(self.study.most_failures)

    def _unknown(
        self, flights: Iterable[Flight], journal: Journal, others: list[Journal], results: _Results | None
    ) -> Iterator[tuple[int, Order]]:
        """Yields the missions that no journal has, with their numbers. Notes the others as results."""
        numbered = enumerate(flights)
        while chunk := [(index, self.space.order(flight)) for index, flight in itertools.islice(numbered, _CHUNK)]:
            may_be_known = journal.may_have([order["mission"] for _, order in chunk])
            if others:
                may_be_known[:] = True
            seen: set[str] = set()
            for (index, order), known in zip(chunk, may_be_known.tolist(), strict=True):
                mission = order["mission"]
                # One that is out, or that comes twice, may have come home since the chunk was looked up.
                known = known or mission in seen or self._dispatcher.has(mission)
                seen.add(mission)
                found = self._known(order, journal, others) if known else None
                if found is None:
                    yield index, order
                elif results is not None:
                    results.note(index, *found)
                    self._count_taken(*found)

    def _fill(
        self, queue: Iterator[tuple[int, Order]], ahead: Iterator[tuple[int, Order]], waiting: dict[str, list[int]], most: int
    ) -> None:
        """Gives orders out, of the round first, until all workers have enough."""
        while not self._dispatcher.is_full:
            found = next(queue, None)
            if found is not None:
                index, order = found
                waiting.setdefault(order["mission"], []).append(index)
                self._dispatcher.give(order, most - index - 1)
                continue
            found = next(ahead, None)
            if found is None:
                break
            self._dispatcher.give(found[1])
        self._dispatcher.flush()

    def _bring(
        self, journal: Journal, others: list[Journal], tell: Callable[[Progress], None], orders: list[Order], later: int
    ) -> Journal:
        """Brings these missions into the journal. ``later``: how many follow at most."""
        missing = {order["mission"]: order for order in orders if not self._is_known(order, journal, others)}
        queue = iter(missing.values())
        left = len(missing)
        while left > 0:
            while not self._dispatcher.is_full and (order := next(queue, None)) is not None:
                self._dispatcher.give(order, left)
            self._dispatcher.flush()
            records = [record for record, _ in self._take(journal)]
            left -= len(records)
            self._note(records)
            self.failed += sum(bool(record["error"]) for record in records)
            tell(self._progress(left + later, left + later, len(self.space.designs)))
        return journal

    def _take(self, journal: Journal) -> list[tuple[Record, int]]:
        """Waits for results and appends them to the journal. Returns records with their places there."""
        found = self._dispatcher.take()
        places = journal.append_lines([(record["mission"], line) for record, line in found])
        return [(record, place) for (record, _), place in zip(found, places, strict=True)]

    def _note(self, records: list[Record]) -> None:
        self.flown += len(records)
        self._outcomes.update(record["outcome"] for record in records)

    def _progress(self, most_left: int, likely_left: float, flying: int) -> Progress:
        return Progress(self.flown, self.taken, self.failed, most_left, likely_left, flying, self._rate(), self._answer(), self.of_other_builds)

    def _answer(self) -> str:
        ended = ", ".join(f"{outcome} {count}" for outcome, count in self._outcomes.most_common(4))
        return "; ".join(filter(None, (ended, self._ahead)))

    def _who_is_ahead(self, evidence: Evidence) -> str:
        """The designs that no other one dominates by what was measured so far; noise may have put them there."""
        if not evidence.has_front or len(self.space.designs) > _MOST_COMPARED:
            return ""
        ahead = evidence.leaders([design for design in range(len(self.space.designs)) if evidence.feasible(design) is not False])
        shown = ", ".join(str(design) for design in ahead[:4])
        more = f" and {len(ahead) - 4} more" if len(ahead) > 4 else ""
        return f"ahead so far: designs {shown}{more}" if ahead else ""

    def _is_known(self, order: Order, journal: Journal, others: list[Journal]) -> bool:
        """Counts it as taken, unless this call flew it."""
        found = self._known(order, journal, others)
        if found is not None:
            self._count_taken(*found)
        return found is not None

    def _count_taken(self, record: Record, place: int) -> None:
        if record["mission"] in self._flown_ahead:
            self._flown_ahead.remove(record["mission"])
        else:
            self.taken += 1
            self._outcomes[record["outcome"]] += 1

    def _known(self, order: Order, journal: Journal, others: list[Journal]) -> tuple[Record, int] | None:
        """Returns the record of a mission and its place in the journal."""
        place = journal.place_of(order["mission"])
        if place is not None:
            record = journal.at(place)
            if has_all(record, order):
                return record, place
        for other in others:
            record = other.find(order["mission"])
            if record is not None and has_all(record, order):
                return record, journal.append([record])[0]
        return None

    def _rate(self) -> float:
        return self.flown / max(time.monotonic() - self._begun_s, 1e-9)

    # What came of it.

    def _write_tables(self, folder: pathlib.Path, journal: Journal, results: _Results, rounds: Rounds | Search) -> None:
        write_lines(folder / "missions.csv", self._mission_lines(journal, results))
        self._places = front.places(results.evidence)
        write_csv(folder / "designs.csv", self._design_rows(results, rounds))
        columns.write(folder)
        if self.study.design["kind"] == "sensitivity":
            sensitivity.write(folder / "sensitivity.csv", self.study, results.evidence)

    def _write_report(self, folder: pathlib.Path, results: _Results, rounds: Rounds | Search) -> None:
        space = self.space
        told = [
            {"failed": results.failures[number], "status": rounds.status[number], "front": self._places[number]}
            for number in range(len(space.designs))
        ]
        commands = [
            space.missions.shell_line(space.values((number, 0)), str(report.replay_folder(folder, number))) for number in range(len(space.designs))
        ]
        report.write(
            folder / "report.html", self.study, space.factors, space.designs, results.evidence, told, commands, space.provenance(self.example())
        )

    def _design_rows(self, results: _Results, rounds: Rounds | Search) -> Iterator[list[str]]:
        yield tables.design_head(self.space.factors, self.study)
        for number, values in enumerate(self.space.designs):
            yield tables.design_row(
                number, values, self.space.factors, results.evidence, results.failures[number], rounds.status[number], self._places[number]
            )

    def _mission_lines(self, journal: Journal, results: _Results) -> Iterator[str]:
        """Yields the lines of missions.csv, from what ``results`` keep: reading the journal again would take longer."""
        space, evidence = self.space, results.evidence
        yield csv_text(tables.mission_head(space.factors, self.study)) + "\n"
        drawn: dict[int, str] = {}
        for design, values in enumerate(space.designs):
            factors = tables.values_text({name: values[name] for name in space.factors})
            for replicate in range(evidence.counts[design]):
                draws = drawn.get(replicate)
                if draws is None:
                    draws = tables.values_text(space.draw(replicate))
                    if len(drawn) < MOST_DRAWS_KEPT:
                        drawn[replicate] = draws
                found = results.found(design, replicate)
                if found is None:
                    mission, outcome, time_s = space.order((design, replicate))["mission"], tables.MISSING, math.nan
                    message = tables.MISSING_MESSAGE
                else:
                    mission, outcome, time_s, place = found
                    message = csv_text([journal.at(place)["error"]]) if place is not None else ""
                measures = "".join([tables.number_text(one) + "," for one in evidence.numbers(design, replicate)])
                yield f"{design},{replicate},{factors}{draws}{outcome},{measures}{tables.number_text(time_s)},{message},{mission}\n"


class _Results:
    """What is known of the missions of all rounds so far, and of each mission of this round whether it has a result."""

    def __init__(self, evidence: Evidence, measurer: Measurer, replicates: int) -> None:
        self.evidence = evidence
        self.failures: collections.Counter[int] = collections.Counter()
        self.failed = 0
        """Failed missions of earlier rounds."""
        self._measurer = measurer
        self._replicates = replicates
        # Of each mission, by design: 32 bytes of its hash, the number of its outcome, its simulated time.
        self._hashes: collections.defaultdict[int, bytearray] = collections.defaultdict(bytearray)
        self._outcomes: collections.defaultdict[int, array.array[int]] = collections.defaultdict(lambda: array.array("H"))
        self._times_s: collections.defaultdict[int, array.array[float]] = collections.defaultdict(lambda: array.array("d"))
        self._names: list[str] = [tables.MISSING]
        self._numbers: dict[str, int] = {tables.MISSING: _MISSING}
        self._failed_places: dict[tuple[int, int], int] = {}
        self.begin(Flights([], 0, 0))

    def begin(self, flights: Flights) -> None:
        """Begins a round. All missions of the one before are in the evidence."""
        self.flights = flights
        self._states = bytearray(len(flights))
        self.open = len(flights)
        self._settled = 0
        self.failed_so_far = self.failed
        """With those of this round before the first mission without a result."""

    def note(self, index: int, record: Record, place: int) -> None:
        """Stores the result of a mission of this round."""
        design, replicate = self.flights[index]
        self.evidence.put(design, replicate, self._measurer(record, design * self._replicates + replicate))
        self._store(design, replicate, record)
        if record["error"]:
            self._failed_places[design, replicate] = place
        self.open -= self._states[index] == _OPEN
        self._states[index] = _FAILED if record["error"] else _SOUND

    def _store(self, design: int, replicate: int, record: Record) -> None:
        hashes, outcomes, times_s = self._hashes[design], self._outcomes[design], self._times_s[design]
        lacking = replicate + 1 - len(outcomes)
        if lacking > 0:
            hashes.extend(bytes(32 * lacking))
            outcomes.extend([_MISSING] * lacking)
            times_s.extend([math.nan] * lacking)
        number = self._numbers.get(record["outcome"])
        if number is None:
            number = self._numbers[record["outcome"]] = len(self._names)
            self._names.append(csv_text([record["outcome"]]))
        hashes[32 * replicate : 32 * replicate + 32] = bytes.fromhex(record["mission"])
        outcomes[replicate] = number
        times_s[replicate] = record.get("simulated_time", math.nan)

    def found(self, design: int, replicate: int) -> tuple[str, str, float, int | None] | None:
        """Returns hash, outcome, simulated time [s] and, for a failed mission, the place of its record in the journal; None for
        a mission without a result."""
        outcomes = self._outcomes[design]
        if replicate >= len(outcomes) or outcomes[replicate] == _MISSING:
            return None
        mission = self._hashes[design][32 * replicate : 32 * replicate + 32].hex()
        place = self._failed_places.get((design, replicate)) if self._failed_places else None
        return mission, self._names[outcomes[replicate]], self._times_s[design][replicate], place

    def settle(self, most_failures: int | None) -> int:
        """Moves the end of the missions that count up to the first one without a result, or with which there are too many
        failures. Returns the failures up to there."""
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
        """Lets the missions count that are settled. Returns whether the round was cut short."""
        self._count(self._settled)
        self.failed = self.failed_so_far
        return self._settled < len(self._states)

    def end_unfinished(self) -> int:
        """Lets the missions of this round count that have a result, and notes the others as missing. Returns their number."""
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


_OPEN, _SOUND, _FAILED = 0, 1, 2
_MISSING = 0


def _labels(flat_summary: dict[str, Any]) -> list[str]:
    """The summary's labels; of one with conditions the parts "variable" and "when" are not labels."""
    result = []
    for label in flat_summary:
        before, _, last = label.rpartition(".")
        if last in ("variable", "when") and f"{before}.when" in flat_summary and f"{before}.variable" in flat_summary:
            label = before
        result.append(label)
    return list(dict.fromkeys(result))


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
