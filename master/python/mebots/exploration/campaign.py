# SPDX-License-Identifier: Apache-2.0
"""Runs a study from its file to its answer."""

from __future__ import annotations

import collections
import concurrent.futures
import functools
import gc
import json
import pathlib
import re
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from mebots.errors import Error, InputError
from mebots.exploration import chance, columns, front, live_page, report, sensitivity, splitting, tables
from mebots.exploration.answer import Answer, Judge
from mebots.exploration.live_page import LivePage
from mebots.exploration.progress import Progress
from mebots.exploration.comparison import Evidence
from mebots.exploration.dispatch import Dispatcher, Unfinished
from mebots.exploration.figures import Units, design_names
from mebots.exploration.files import csv_text, write_csv, write_lines
from mebots.exploration.journal import Journal, Record
from mebots.exploration.missions import build
from mebots.exploration.objectives import Measurer, has_all
from mebots.exploration.orders import Order, Orders
from mebots.exploration.replies import Reply
from mebots.exploration.report_missions import Replay
from mebots.exploration.results import Results
from mebots.exploration.rounds import Flights, Rounds
from mebots.exploration.search import Search
from mebots.exploration.space import MOST_DRAWS_KEPT, Space
from mebots.exploration.study import Study, Values
from mebots.exploration.sweep import Sweep
from mebots.exploration.worker import FACTS, flat

TABLES = ("missions.csv", "designs.csv", "sensitivity.csv", "levels.csv", *columns.NAMES, "report.html")
_CHUNK = 1000
"""The number of missions that are looked up in the journal at once."""
_SETTING = re.compile(r'set\("(.+?)"\): ')
"""The beginning of an error of Mission.set()."""
_OBJECTS_OF_A_COLLECTION = 100_000
"""The number of new objects after which Python's garbage collector searches for cycles. With the default of 700, the
search takes a fifth of a large study's time."""
_MOST_COMPARED = 300
"""If there are more designs than this, the progress does not name the leaders."""


FLIGHTS = "flights"
"""The folder of the missions' results. Each is named by its hash."""
REPLAYS = "replays"
"""The folder for missions that the commands of the report repeat."""


def is_done(folder: pathlib.Path) -> bool:
    """True if the folder contains the file that a study writes last."""
    return (folder / "report.html").exists()

GROUP_STATISTICS = ("least", "mean", "most", "count", "of")
"""Numbers of a group in the summary: the first three of numbers, the last two of Booleans."""

_MOST_VALUES_TRIED = 64
"""The check tries all values of a factor if there are at most this many; otherwise only the least and the greatest."""


class Campaign:
    """Runs a study's missions on an executor, whose workers need only the package mebots."""

    def __init__(self, study: Study, executor: concurrent.futures.Executor, in_flight: int) -> None:
        self.study = study
        self._dispatcher = Dispatcher(executor, in_flight)
        self.space = Space(study)
        self._check_names()
        labels = flat(self.space.missions.config.get("summary", {}))
        self.units = Units(study, self.space.missions.config.get("summary", {}))
        self._measurer = Measurer(study, [*_labels(labels), *FACTS])
        self.notices: list[str] = []
        self.flown = self.taken = self.failed = self.of_other_builds = 0
        self._begun_s = time.monotonic()
        self._outcomes: collections.Counter[str] = collections.Counter()
        self._ahead = ""
        self._standings: Callable[[], Answer] | None = None
        self._live_page: LivePage | None = None
        self._flown_ahead: set[str] = set()  # missions of future rounds

    # All missions of the study, and examples of them.

    @property
    def most_missions(self) -> int:
        design = self.study.design
        designs = design["points"] * design["rounds"] if design["kind"] == "search" else len(self.space.designs)
        if self.study.splitting is not None:
            return designs * splitting.most_missions(self.study)
        return designs * self.study.replicates

    def all_flights(self) -> Flights:
        """Returns all missions of a study whose number of missions is fixed beforehand."""
        return Flights(range(len(self.space.designs)), 0, self.study.replicates)

    def example(self) -> Values:
        """Returns the factors and draws of one mission of the study, as an example."""
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
                raise InputError(f"{self.study.place}: the objective '{one.label}': a series cannot be used with 'results', which already records whole missions", "invalid_value")
        for name in self.study.draws:
            if name in self.space.factors:
                raise InputError(f"{self.study.place}: '{name}' is both a factor and a draw; remove one of them", "duplicate_name")
        known = [one["outcome"] for one in self.space.missions.config.get("outcomes", [])] + ["completed"]
        for one in self.study.objectives:
            for outcome in one.what if one.source == "outcome" else ():
                if outcome not in known:
                    raise InputError(
                        f"{self.study.place}: the objective '{one.label}': the mission has no outcome '{outcome}'. It has: {', '.join(dict.fromkeys(known))}",
                        "unknown_name",
                    )

    # Checks before the first mission.

    def check(self, journal: Journal | None = None) -> None:
        """Initialises missions to the start time, so that every factor value and both extremes of each draw occur. Raises InputError with
        all errors."""
        tried: dict[str, tuple[str, Values]] = {}
        found: dict[str, Record] = {}
        problems: dict[str, str] = {}

        def take() -> None:
            found.update((record["mission"], record) for reply in self._dispatcher.take() for record in reply.records())

        for what, values in self._trials():
            try:
                order = self._trial(values)
            except InputError as error:  # the config is invalid with these values
                problems.setdefault(str(error), self._blamed("", str(error), values))
                continue
            if order["mission"] in tried or (journal is not None and order["mission"] in journal):
                continue
            tried[order["mission"]] = what, values
            while self._dispatcher.is_full:
                take()
            self._dispatcher.give(Orders.of([order | {"check": True}]))
        while len(found) < len(tried):
            self._dispatcher.flush()
            take()
        for mission, (what, values) in tried.items():
            text, about = found[mission]["error"], found[mission].get("about", "")
            if setting := _SETTING.match(text):  # removes "set()" from the text, because the value is in the study
                about, text = setting[1], text[setting.end():]
            if text:
                problems.setdefault(text, self._blamed(about, text, values) or what)
        if problems:
            told = (": ".join(filter(None, (self.study.place, what, error))) for error, what in problems.items())
            raise InputError("\n".join(told), "invalid_value")

    def _blamed(self, about: str, error: str, values: Values) -> str:
        """Returns the cause of an error as text: the factor, draw or objective that contains the variable ``about``, or a key or variable
        that the error names. If no cause is found, returns ""."""
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

    def run(self, folder: pathlib.Path, reuse: Iterable[pathlib.Path], on_progress: Callable[[Progress], None]) -> Sweep:
        """Runs the missions that the folder's journal lacks, and writes the tables. Raises InputError or Error if this fails."""
        thresholds = gc.get_threshold()
        gc.set_threshold(_OBJECTS_OF_A_COLLECTION, *thresholds[1:])
        try:
            return self._run(folder, reuse, on_progress)
        except (ConnectionError, TimeoutError):  # raised by an executor
            raise
        except OSError as error:
            if error.errno is None:  # not from the system: Dask's closed connections are also OSErrors
                raise
            raise Error(f"{error.filename or folder}: {error.strerror}", "file_unwritable") from error
        finally:
            gc.set_threshold(*thresholds)

    def _run(self, folder: pathlib.Path, reuse: Iterable[pathlib.Path], on_progress: Callable[[Progress], None]) -> Sweep:
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
            for name in (*TABLES, live_page.NAME):  # deleted first, because their existence means that the study is done
                (folder / name).unlink(missing_ok=True)
            self.study.write(folder)
            if self.study.splitting is not None:
                bring = functools.partial(self._bring, journal, others, on_progress)
                return Sweep(folder, *splitting.fly(self.space, folder, bring, self.units), notices=self.notices)
            return self._fly_rounds(folder, journal, others, on_progress)
        finally:
            if self._live_page is not None:
                self._live_page.end(is_done=is_done(folder))
            for one in (journal, *others):
                one.close()

    def _fly_rounds(self, folder: pathlib.Path, journal: Journal, others: list[Journal], on_progress: Callable[[Progress], None]) -> Sweep:
        evidence = Evidence(self.study, len(self.space.designs))
        rounds = self._rounds(evidence)
        results = Results(evidence, self._measurer, self.study.replicates)
        self._standings = lambda: self._judge(evidence, rounds).standings()
        self._live_page = LivePage(folder, self.space, evidence, self.units)
        try:
            while flights := rounds.next():
                results.begin(flights)
                self._fly(results, rounds, journal, others, on_progress)
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
            except (OSError, Error) as other:  # the disk error that ended the missions may have occurred again
                raise Unfinished(f"{error}\n{missing} missions are missing, and no table could be written: {other}") from None
            raise Unfinished(f"{error}\n{missing} missions are missing: see {folder / 'designs.csv'}") from None
        journal.sync()
        self._write_tables(folder, journal, results, rounds)
        answer = self._judge(evidence, rounds).answer(self._places)
        self._write_report(folder, results, rounds, answer)
        missions = sum(evidence.counts)
        return Sweep(
            folder, missions, results.failed, self._measurer.without_value(), self.notices, answer, list(self.space.factors), list(self.study.draws)
        )

    def _judge(self, evidence: Evidence, rounds: Rounds | Search) -> Judge:
        names = design_names(self.space.factors, self.space.designs, self.units)
        return Judge(evidence, self.units, names, rounds.status)

    def _rounds(self, evidence: Evidence) -> Rounds | Search:
        if self.study.design["kind"] == "search":
            return Search(self.study, evidence, self.space.designs)
        return Rounds(self.study, evidence)

    def _too_many(self, failures: int) -> bool:
        return self.study.most_failures is not None and failures >= self.study.most_failures

    def _fly(
        self,
        results: Results,
        rounds: Rounds | Search,
        journal: Journal,
        others: list[Journal],
        on_progress: Callable[[Progress], None],
    ) -> None:
        """Adds the missions of a round to journal and results, up to the mission that exceeds the permitted number of failures."""
        flights = results.flights
        left = rounds.most_left() - len(flights)
        likely_left = rounds.likely_left() - len(flights)
        flying = len(rounds.flying())
        repeated: dict[bytes, list[int]] = {}
        queue = self._unknown(flights, journal, others, results, repeated)
        ahead = self._unknown(rounds.ahead(), journal, others, None, {})
        while results.open > 0 and not self._too_many(results.settle(self.study.most_failures)):
            self._fill(queue, ahead, len(flights))
            if results.open == 0:
                break
            for reply, places in self._take(journal):
                results.note_all(reply, places)
                self._note_others(results, reply, places, repeated)
            self.failed = results.failed_so_far
            progress = self._progress(left + results.open, likely_left + results.open, flying)
            on_progress(progress)
            if self._live_page is not None:
                self._live_page.show(progress, rounds.status)
        self.failed = results.settle(self.study.most_failures)

    def _note_others(self, results: Results, reply: Reply, places: np.ndarray, repeated: dict[bytes, list[int]]) -> None:
        """Records what Results.note_all() does not record: the result of a mission for its further indices in this round (``repeated``),
        and which missions of later rounds have results."""
        if not repeated and -1 not in reply.indices:
            return
        records: list[Record] = []
        for at, (digest, index) in enumerate(zip(reply.digests, reply.indices, strict=True)):
            again = repeated.pop(digest, ())
            if again:
                records = records or reply.records()
            for one in again:
                results.note(one, records[at], int(places[at]))
            if index < 0 and not again:
                self._flown_ahead.add(digest.hex())

    def _unknown(
        self, flights: Flights, journal: Journal, others: list[Journal], results: Results | None, repeated: dict[bytes, list[int]]
    ) -> Iterator[tuple[Sequence[int], Orders]]:
        """Yields the missions that are in no journal and not in progress, with their indices in the round. Stores results from journals in
        ``results`` unless it is None. If a mission is in progress or occurs more than once, stores its further indices in ``repeated``."""
        for first, orders in self.space.orders(flights, _CHUNK):
            digests = orders.digests
            may_be_known = journal.may_have(digests)
            if others:
                may_be_known[:] = True
            if not may_be_known.any() and self._dispatcher.has_none_of(digests) and len(set(digests)) == len(digests):
                yield range(first, first + len(orders)) if results is not None else [-1] * len(orders), orders
                continue
            fresh: list[int] = []
            seen: set[bytes] = set()
            for at, digest in enumerate(digests):
                if digest in seen or not self._dispatcher.has_none_of((digest,)):
                    repeated.setdefault(digest, []).append(first + at)
                    continue
                found = self._known(orders[at], journal, others) if may_be_known[at] else None
                if found is None:
                    seen.add(digest)
                    fresh.append(at)
                elif results is not None:
                    results.note(first + at, *found)
                    self._count_taken(*found)
            if fresh:
                yield [first + at for at in fresh] if results is not None else [-1] * len(fresh), orders.only(fresh)

    def _fill(self, queue: Iterator[tuple[Sequence[int], Orders]], ahead: Iterator[tuple[Sequence[int], Orders]], most: int) -> None:
        """Passes orders to the executor until it has enough for all workers. Passes orders of later rounds only after all orders of this
        round."""
        while not self._dispatcher.is_full:
            found = next(queue, None)
            if found is not None:
                indices, orders = found
                self._dispatcher.give(orders, indices, most - indices[-1] - 1)
                continue
            found = next(ahead, None)
            if found is None:
                break
            self._dispatcher.give(found[1], found[0])
        self._dispatcher.flush()

    def _bring(
        self, journal: Journal, others: list[Journal], on_progress: Callable[[Progress], None], orders: list[Order], later: int
    ) -> Journal:
        """Adds the missions to the journal, and runs those that no journal contains. ``later`` is the maximum number of missions that
        follow these."""
        missing = {order["mission"]: order for order in orders if not self._is_known(order, journal, others)}
        queue = iter(missing.values())
        left = len(missing)
        while left > 0:
            while not self._dispatcher.is_full and (order := next(queue, None)) is not None:
                self._dispatcher.give(Orders.of([order]), left=left)
            self._dispatcher.flush()
            for reply, _ in self._take(journal):
                left -= len(reply)
                self.failed += int(reply.failed.sum())
            on_progress(self._progress(left + later, left + later, len(self.space.designs)))
        return journal

    def _take(self, journal: Journal) -> list[tuple[Reply, np.ndarray]]:
        """Waits for results, appends them to the journal and counts them. Returns them with their places in the journal."""
        found = []
        for reply in self._dispatcher.take():
            found.append((reply, journal.append_lines(reply.digests, reply.lines, reply.lengths)))
            self.flown += len(reply)
            counts = np.bincount(reply.outcomes, minlength=len(reply.outcome_names)).tolist()
            self._outcomes.update(dict(zip(reply.outcome_names, counts, strict=True)))
        return found

    def _progress(self, most_left: int, likely_left: float, flying: int) -> Progress:
        return Progress(self.flown, self.taken, self.failed, most_left, likely_left, flying, self._rate(), self._answer(), self.of_other_builds, self._standings)

    def _answer(self) -> str:
        ended = ", ".join(f"{outcome} {count}" for outcome, count in self._outcomes.most_common(4))
        return "; ".join(filter(None, (ended, self._ahead)))

    def _who_is_ahead(self, evidence: Evidence) -> str:
        """Returns the designs that no other design dominates by their means so far, as text. The differences may be due to chance."""
        if not evidence.has_front or len(self.space.designs) > _MOST_COMPARED:
            return ""
        ahead = evidence.leaders([design for design in range(len(self.space.designs)) if evidence.feasible(design) is not False])
        shown = ", ".join(str(design) for design in ahead[:4])
        more = f" and {len(ahead) - 4} more" if len(ahead) > 4 else ""
        return f"ahead so far: designs {shown}{more}" if ahead else ""

    def _is_known(self, order: Order, journal: Journal, others: list[Journal]) -> bool:
        """True if a journal contains the mission. Counts the mission as reused unless this run of the study has executed it."""
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
        """Returns the record of a mission and its place in the journal, or None."""
        place = journal.place_of(order["mission"])
        if place is not None:
            record = journal.at(place)
            if has_all(record, order):
                return record, place
        for other in others:
            found = other.find(order["mission"])
            if found is not None and has_all(found, order):
                return found, journal.append([found])[0]
        return None

    def _rate(self) -> float:
        return self.flown / max(time.monotonic() - self._begun_s, 1e-9)

    # Results.

    def _write_tables(self, folder: pathlib.Path, journal: Journal, results: Results, rounds: Rounds | Search) -> None:
        write_lines(folder / "missions.csv", self._mission_lines(journal, results))
        self._places = front.places(results.evidence)
        write_csv(folder / "designs.csv", self._design_rows(results, rounds))
        columns.write(folder)
        if self.study.design["kind"] == "sensitivity":
            sensitivity.write(folder / "sensitivity.csv", self.study, results.evidence)

    def _write_report(self, folder: pathlib.Path, results: Results, rounds: Rounds | Search, answer: Answer) -> None:
        space = self.space
        content = report.Content(
            study=self.study,
            factors=space.factors,
            designs=space.designs,
            evidence=results.evidence,
            answer=answer,
            units=self.units,
            places=self._places,
            status=rounds.status,
            failed=[results.failures[number] for number in range(len(space.designs))],
            provenance=space.provenance(self.example()),
            replay=Replay(space, folder / REPLAYS),
            outcomes=results.outcomes(),
        )
        report.write(folder / "report.html", content)

    def _design_rows(self, results: Results, rounds: Rounds | Search) -> Iterator[list[str]]:
        yield tables.design_head(self.space.factors, self.study)
        for number, values in enumerate(self.space.designs):
            yield tables.design_row(
                number, values, self.space.factors, results.evidence, results.failures[number], rounds.status[number], self._places[number]
            )

    def _mission_lines(self, journal: Journal, results: Results) -> Iterator[str]:
        """Yields the lines of missions.csv in blocks. Uses ``results``, because reading the journal again would take longer."""
        space, evidence = self.space, results.evidence
        yield csv_text(tables.mission_head(space.factors, self.study)) + "\n"
        drawn: dict[int, list[str]] = {}
        for design, values in enumerate(space.designs):
            factors = tables.values_text({name: values[name] for name in space.factors})
            for begin in range(0, evidence.counts[design], _CHUNK):
                end = min(begin + _CHUNK, evidence.counts[design])
                draws = drawn.get(begin)
                if draws is None or len(draws) < end - begin:
                    draws = [tables.values_text(space.draw(replicate)) for replicate in range(begin, end)]
                    if begin < MOST_DRAWS_KEPT:
                        drawn[begin] = draws
                rows = results.rows(design, begin, end)
                missing = [at for at, mission in enumerate(rows.missions) if mission is None]
                for at in missing:
                    rows.missions[at] = space.order((design, begin + at))["mission"]
                    rows.messages[at] = tables.MISSING_MESSAGE
                for at, place in rows.failed_places.items():
                    rows.messages[at] = csv_text([journal.at(place)["error"]])
                cells = zip(draws, rows.outcomes, *rows.measures, rows.times, rows.messages, rows.missions)  # noqa: B905 - draws may be longer
                head = f"{design},%d,{factors.replace('%', '%%')}%s%s{',%s' * (len(rows.measures) + 3)}\n"
                yield "".join([head % (begin + at, *row) for at, row in enumerate(cells)])


def _labels(flat_summary: dict[str, Any]) -> list[str]:
    """Returns the labels of a flattened summary. The object {"variable": ..., "when": ...} is the value of one label. The members of a list
    form a group with the labels of its statistics and of each member."""
    result = []
    for label, value in flat_summary.items():
        before, _, last = label.rpartition(".")
        if last in ("variable", "when") and f"{before}.when" in flat_summary and f"{before}.variable" in flat_summary:
            result.append(before)
        elif isinstance(value, list):
            members = [one.get("name", str(position)) for position, one in enumerate(value, 1)]
            result += [f"{label}.{part}" for part in (*GROUP_STATISTICS, *(f"each.{name}" for name in members))]
        else:
            result.append(label)
    return list(dict.fromkeys(result))


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
