# SPDX-License-Identifier: Apache-2.0
"""A study from its file to its answer."""

from __future__ import annotations

import collections
import concurrent.futures
import dataclasses
import functools
import itertools
import json
import pathlib
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from mebots import _mebots
from mebots.errors import Error, InputError
from mebots.exploration import chance, columns, designs, front, report, sensitivity, splitting, tables
from mebots.exploration.comparison import Evidence
from mebots.exploration.dispatch import Dispatcher
from mebots.exploration.journal import Journal, Record
from mebots.exploration.missions import Missions, Order, build
from mebots.exploration.objectives import Measurer, has_all
from mebots.exploration.rounds import Flight, Rounds
from mebots.exploration.search import Search
from mebots.exploration.study import Study, Values
from mebots.exploration.worker import flat

TABLES = ("missions.csv", "designs.csv", "sensitivity.csv", "levels.csv", *columns.NAMES, "report.html")
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

    def designs(self) -> list[dict[str, str]]:
        """The rows of designs.csv."""
        titles, *rows = _mebots.read_csv(self.folder / "designs.csv")
        return [dict(zip(titles, row, strict=True)) for row in rows]


class Campaign:
    """Flies a study's missions through an executor. The executor's workers need nothing but the package mebots."""

    def __init__(self, study: Study, executor: concurrent.futures.Executor, in_flight: int) -> None:
        self.study = study
        self._dispatcher = Dispatcher(executor, in_flight)
        self.missions = Missions(study)
        self.designs = designs.designs_of(study)
        self.factors = list(self.designs[0] if self.designs else study.design["factors"])
        self._check_names()
        labels = flat(self.missions.config.get("summary", {}))
        self._measurer = Measurer(study, _labels(labels))
        self._draws: dict[int, Values] = {}
        self.flown = self.taken = self.failed = self.of_other_builds = 0
        self._begun_s = time.monotonic()
        self._outcomes: collections.Counter[str] = collections.Counter()
        self._ahead = ""
        self._flown_ahead: set[str] = set()  # of rounds to come

    # What the missions are.

    def values(self, flight: Flight) -> Values:
        """The values of factors and draws of a mission."""
        design, replicate = flight
        return self.designs[design] | self._draw(replicate)

    def _draw(self, replicate: int) -> Values:
        if replicate not in self._draws:
            self._draws[replicate] = {
                name: chance.value(spread, chance.unit(self.study.draws_seed, name, replicate))
                for name, spread in self.study.draws.items()
            }
        return self._draws[replicate]

    def order(self, flight: Flight) -> Order:
        return self.missions.order(self.values(flight))

    @property
    def most_missions(self) -> int:
        design = self.study.design
        designs = design["points"] * design["rounds"] if design["kind"] == "search" else len(self.designs)
        if self.study.splitting is not None:
            return designs * splitting.most_missions(self.study)
        return designs * self.study.replicates

    def all_flights(self) -> Iterator[Flight]:
        """All that a study without decisions flies."""
        return itertools.product(range(len(self.designs)), range(self.study.replicates))

    def example(self) -> Values:
        """The values of a mission that stands for all."""
        return next(self._trials())[1]

    def _check_names(self) -> None:
        for name in self.study.fork.variables if self.study.fork else ():
            if name not in self.factors and name not in self.study.draws:
                raise InputError(f"{self.study.place}: 'fork': there is no factor or draw '{name}'", "unknown_name")
            spread = self.study.design.get("factors", {}).get(name)
            if name.startswith("/") or (isinstance(spread, dict) and "options" in spread):
                raise InputError(f"{self.study.place}: 'fork': '{name}' is not a variable that could change in a mission", "invalid_value")
        for one in self.study.objectives if self.study.results else ():
            if one.source == "series":
                raise InputError(f"{self.study.place}: the objective '{one.label}': a series cannot be used with 'results', which has the whole of it", "invalid_value")
        for name in self.study.draws:
            if name in self.factors:
                raise InputError(f"{self.study.place}: '{name}' is a factor and a draw; it can only be one of them", "duplicate_name")
        known = [one["outcome"] for one in self.missions.config.get("outcomes", [])] + ["completed"]
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
            found.update((record["mission"], record) for record in self._dispatcher.take())

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
            settings = self.missions.settings(name, value)
            if about in settings or any(key.startswith("/") and f" {key}: " in error for key in settings):
                return f"{'draw' if name in self.study.draws else 'factor'} '{name}' = {json.dumps(value)}"
        for one in self.study.objectives:
            if one.source in ("final", "series") and (one.what == about or f"'{one.what}'" in error):
                return f"the objective '{one.label}'"
        return ""

    def _trial(self, values: Values) -> Order:
        if self.study.splitting is None:
            return self.missions.order(values)
        return self.missions.order_until({}, values, splitting.trial_course(self.study))

    def _trials(self) -> Iterator[tuple[str, Values]]:
        if not self.designs:
            yield from self._trials_of_search()
            return
        for factor in self.factors:
            seen: dict[str, int] = {}
            for number, design in enumerate(self.designs):
                seen.setdefault(repr(design[factor]), number)
            chosen = list(seen.values())
            if len(chosen) > _MOST_VALUES_TRIED and all(_is_number(self.designs[one][factor]) for one in chosen):
                chosen.sort(key=lambda one: self.designs[one][factor])
                chosen = [chosen[0], chosen[-1]]
            for number in chosen:
                yield f"factor '{factor}' = {json.dumps(self.designs[number][factor])}", self.values((number, 0))
        for name, spread in self.study.draws.items():
            for value in chance.extremes(spread):
                yield f"draw '{name}' = {json.dumps(value)}", self.values((0, 0)) | {name: value}

    def _trials_of_search(self) -> Iterator[tuple[str, Values]]:
        factors = self.study.design["factors"]
        first = {name: chance.extremes(spread)[0] for name, spread in factors.items()}
        for name, spread in factors.items():
            for value in chance.extremes(spread):
                yield f"factor '{name}' = {json.dumps(value)}", first | {name: value} | self._draw(0)

    # Flying.

    def run(self, folder: pathlib.Path, reuse: Iterable[pathlib.Path], tell: Callable[[Progress], None]) -> Sweep:
        """Flies what the folder's journal does not have, and writes the tables. Raises InputError and Error."""
        try:
            return self._run(folder, reuse, tell)
        except (ConnectionError, TimeoutError):  # of an executor
            raise
        except OSError as error:
            if error.errno is None:  # not of the system: dask's closed connections are OSErrors, too
                raise
            raise Error(f"{error.filename or folder}: {error.strerror}", "file_unwritable") from error

    def _run(self, folder: pathlib.Path, reuse: Iterable[pathlib.Path], tell: Callable[[Progress], None]) -> Sweep:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{folder}: {error.strerror}. Choose another folder with --out", "file_unwritable") from None
        if self.study.results:
            self.missions.folder = folder.resolve() / FLIGHTS
            self.missions.folder.mkdir(exist_ok=True)
        journal = Journal(folder)
        others = [Journal(pathlib.Path(one), writable=False) for one in reuse]
        self.of_other_builds = sum(one.of_other_builds(build()) for one in (journal, *others))
        try:
            self.check(journal)
            for name in TABLES:  # where they are, the study is done
                (folder / name).unlink(missing_ok=True)
            self.study.write(folder)
            if self.study.splitting is not None:
                bring = functools.partial(self._bring, journal, others, tell)
                return Sweep(folder, *splitting.fly(self, folder, bring))
            evidence = Evidence(self.study, len(self.designs))
            rounds = self._rounds(evidence)
            hashes: dict[int, list[str]] = collections.defaultdict(list)
            failures: collections.Counter[int] = collections.Counter()
            while flights := rounds.next():
                done = self._fly(flights, rounds, journal, others, tell)
                for (design, _), mission in done:
                    record = journal.find(mission)
                    assert record is not None
                    failures[design] += bool(record["error"])
                    hashes[design].append(mission)
                    evidence.add(design, self._measurer(record))
                if len(done) < len(flights) or self._too_many(failures.total()):
                    rounds.end(f"ended: {failures.total()} missions had failed")
                    break
                rounds.decide()
                self._ahead = self._who_is_ahead(evidence)
            journal.sync()
            self._write(folder, journal, evidence, rounds, hashes, failures)
            return Sweep(folder, sum(len(one) for one in hashes.values()), failures.total(), self._measurer.without_value())
        finally:
            for one in (journal, *others):
                one.close()

    def _rounds(self, evidence: Evidence) -> Rounds | Search:
        if self.study.design["kind"] == "search":
            return Search(self.study, evidence, self.designs)
        return Rounds(self.study, evidence)

    def _too_many(self, failures: int) -> bool:
        return self.study.most_failures is not None and failures >= self.study.most_failures

    def _fly(
        self,
        flights: list[Flight],
        rounds: Rounds | Search,
        journal: Journal,
        others: list[Journal],
        tell: Callable[[Progress], None],
    ) -> list[tuple[Flight, str]]:
        """Brings the missions of a round into the journal. Returns them in the study's order, up to the one with which
        too many had failed."""
        names: list[str] = []
        missing: set[str] = set()
        waiting: list[Flight] = []
        for flight in flights:
            order = self.order(flight)
            names.append(order["mission"])
            if order["mission"] not in missing and not self._is_known(order, journal, others):
                missing.add(order["mission"])
                waiting.append(flight)
        left = rounds.most_left() - len(flights)
        likely_left = rounds.likely_left() - len(flights)
        ahead = rounds.ahead()
        queue = map(self.order, waiting)
        settled = 0
        while True:
            while settled < len(names) and names[settled] not in missing:
                record = journal.find(names[settled])
                assert record is not None
                self.failed += bool(record["error"])
                settled += 1
                if self._too_many(self.failed):
                    break
            if settled == len(names) or self._too_many(self.failed):
                break
            self._fill(queue, ahead, journal, others)
            records = self._dispatcher.take()
            journal.append(records)
            self._flown_ahead.update(record["mission"] for record in records if record["mission"] not in missing)
            missing.difference_update(record["mission"] for record in records)
            self._note(records)
            tell(self._progress(left + len(missing), likely_left + len(missing), len(rounds.flying())))
        return list(zip(flights[:settled], names[:settled], strict=True))

    def _bring(
        self, journal: Journal, others: list[Journal], tell: Callable[[Progress], None], orders: list[Order], later: int
    ) -> Journal:
        """Brings these missions into the journal. ``later``: how many follow at most."""
        missing = {order["mission"]: order for order in orders if not self._is_known(order, journal, others)}
        queue = iter(missing.values())
        left = len(missing)
        while left > 0:
            while not self._dispatcher.is_full and (order := next(queue, None)) is not None:
                self._dispatcher.give(order)
            records = self._dispatcher.take()
            journal.append(records)
            left -= len(records)
            self._note(records)
            self.failed += sum(bool(record["error"]) for record in records)
            tell(self._progress(left + later, left + later, len(self.designs)))
        return journal

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
        if not evidence.has_front or len(self.designs) > _MOST_COMPARED:
            return ""
        ahead = evidence.leaders([design for design in range(len(self.designs)) if evidence.feasible(design) is not False])
        shown = ", ".join(str(design) for design in ahead[:4])
        more = f" and {len(ahead) - 4} more" if len(ahead) > 4 else ""
        return f"ahead so far: designs {shown}{more}" if ahead else ""

    def _is_known(self, order: Order, journal: Journal, others: list[Journal]) -> bool:
        """Counts it as taken, unless this call flew it."""
        record = self._known(order, journal, others)
        if record is None:
            return False
        if order["mission"] in self._flown_ahead:
            self._flown_ahead.remove(order["mission"])
        else:
            self.taken += 1
            self._outcomes[record["outcome"]] += 1
        return True

    def _known(self, order: Order, journal: Journal, others: list[Journal]) -> Record | None:
        record = journal.find(order["mission"])
        if record is not None and has_all(record, order):
            return record
        for other in others:
            record = other.find(order["mission"])
            if record is not None and has_all(record, order):
                journal.append([record])
                return record
        return None

    def _fill(self, queue: Iterator[Order], ahead: Iterator[Flight], journal: Journal, others: list[Journal]) -> None:
        while not self._dispatcher.is_full:
            order = next(queue, None)
            if order is None:
                flight = next(ahead, None)
                if flight is None:
                    return
                order = self.order(flight)
                if self._known(order, journal, others) is not None:
                    continue
            self._dispatcher.give(order)

    def _rate(self) -> float:
        return self.flown / max(time.monotonic() - self._begun_s, 1e-9)

    # What came of it.

    def _write(
        self,
        folder: pathlib.Path,
        journal: Journal,
        evidence: Evidence,
        rounds: Rounds | Search,
        hashes: dict[int, list[str]],
        failures: collections.Counter[int],
    ) -> None:
        tables.write(folder / "missions.csv", self._mission_rows(journal, evidence, hashes))
        found = front.places(evidence)
        head = [tables.design_head(self.factors, self.study)]
        rows = [
            tables.design_row(number, values, self.factors, evidence, failures[number], rounds.status[number], found[number])
            for number, values in enumerate(self.designs)
        ]
        tables.write(folder / "designs.csv", head + rows)
        columns.write(folder)
        if self.study.design["kind"] == "sensitivity":
            sensitivity.write(folder / "sensitivity.csv", self.study, evidence)
        told = [
            {"failed": failures[number], "status": rounds.status[number], "front": found[number]}
            for number in range(len(self.designs))
        ]
        commands = [
            self.missions.shell_line(self.values((number, 0)), str(report.replay_folder(folder, number))) for number in range(len(self.designs))
        ]
        report.write(
            folder / "report.html", self.study, self.factors, self.designs, evidence, told, commands, self.provenance()
        )

    def provenance(self) -> dict[str, str]:
        """What was flown and with what, for people."""
        draws = json.dumps(self.study.draws) if self.study.draws else "none"
        files = self.missions.order(self.example())["files"]
        return {
            "mission": self.study.mission.name,
            "draws": f"{draws}, seed {self.study.draws_seed}",
        } | {name: digest for digest, (_, name) in sorted(files.items(), key=lambda one: one[1][1])}

    def _mission_rows(self, journal: Journal, evidence: Evidence, hashes: dict[int, list[str]]) -> Iterator[list[str]]:
        names = [*self.factors, *self.study.draws]
        yield tables.mission_head(self.factors, self.study)
        for design in range(len(self.designs)):
            for replicate, mission in enumerate(hashes[design]):
                record = journal.find(mission)
                assert record is not None
                values = self.values((design, replicate))
                yield tables.mission_row(
                    design, replicate, values, names, record, evidence.measures[design][replicate]
                )


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
