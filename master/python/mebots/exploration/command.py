# SPDX-License-Identifier: Apache-2.0
"""The command line of ``mebots sweep``. The program mebots starts a Python interpreter with this module."""

from __future__ import annotations

import argparse
import collections
import concurrent.futures
import contextlib
import json
import os
import pathlib
import shutil
import signal
import sys
import tempfile
import time
import weakref
from collections.abc import Iterable
from typing import Any

from mebots import notebook
from mebots.errors import Error, InputError
from mebots.exploration import flying, interrupts, live_page
from mebots.exploration.answer import counted, table_lines
from mebots.exploration.campaign import Campaign, is_done
from mebots.exploration.dispatch import Unfinished
from mebots.exploration.figures import percent
from mebots.exploration.journal import Journal
from mebots.exploration.progress import Progress, duration_text
from mebots.exploration.study import NAME, Study, read_study
from mebots.exploration.sweep import Sweep

DONE, NOT_DONE, BAD_INPUT, UNFINISHED = 0, 1, 2, 3


def sweep(
    study: str | os.PathLike[str] | dict[str, Any],
    out: str | os.PathLike[str] | None = None,
    *,
    executor: concurrent.futures.Executor | None = None,
    jobs: int | None = None,
    reuse: Iterable[str | os.PathLike[str]] = (),
    mission: str | os.PathLike[str] | None = None,
    progress: Any = None,
) -> Sweep:
    """Runs the missions of a study, as ``mebots sweep`` does, and writes its tables into ``out``. The same call
    continues an interrupted study. ``to_pandas()``, ``to_polars()`` and ``to_xarray()`` of the result return the
    tables; ``show()`` shows the report in a notebook. Raises InputError for errors that the caller can correct, Error if an executor or a
    disk failed, and ``mebots.exploration.dispatch.Unfinished`` if a mission had no result in three
    attempts.

    :param study: file, or its content as a dict.
    :param out: folder; None = a temporary one, which exists as long as the result.
    :param executor: any ``concurrent.futures.Executor`` whose workers have the package mebots; None = this machine.
    :param jobs: missions at the same time; by default the number of processors. For an executor: the number in progress.
    :param reuse: folders of studies whose missions need not be repeated.
    :param mission: a config in place of the study's.
    :param progress: called with a ``Progress`` after every mission; False = nothing. By default a bar in a notebook.
    """
    read = _asked(study, mission)
    if progress is None and notebook.is_notebook():
        progress = notebook.ProgressBar()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="mebots-sweep-")) if out is None else pathlib.Path(out)
    try:
        with _campaign(read, executor, jobs) as campaign:
            result = campaign.run(folder, [pathlib.Path(one) for one in reuse], progress or (lambda now: None))
    except BaseException:
        if out is None:
            shutil.rmtree(folder, ignore_errors=True)
        raise
    if out is None:
        weakref.finalize(result, shutil.rmtree, folder, ignore_errors=True)
    return result


def _asked(study: str | os.PathLike[str] | dict[str, Any], mission: str | os.PathLike[str] | None) -> Study:
    read = read_study(study)
    return read if mission is None else read.on(pathlib.Path(mission))


@contextlib.contextmanager
def _campaign(study: Study, executor: concurrent.futures.Executor | None, jobs: int | None):
    if executor is not None:
        yield Campaign(study, executor, jobs or 64)
        return
    jobs = jobs or len(os.sched_getaffinity(0))
    flying.ready()
    with interrupts.held():
        threads = concurrent.futures.ThreadPoolExecutor(jobs)  # each thread has its own mission process
        try:
            with interrupts.allowed():
                # Twice the number of workers: no worker waits for a mission, and a decision makes only few missions unnecessary.
                yield Campaign(study, threads, 2 * jobs)
        finally:
            with interrupts.held():  # again, because an interrupt may have ended ``allowed`` early
                ended = flying.end_all()
                threads.shutdown(wait=True, cancel_futures=True)
                flying.close_ended(ended)


def main(words: list[str] | None = None) -> int:
    options = _options(words)
    signal.signal(signal.SIGTERM, interrupts.interrupt)
    signal.signal(signal.SIGHUP, interrupts.interrupt)
    try:
        if options.status:
            return _status(pathlib.Path(options.status))
        if not options.study:
            raise InputError("a study is missing. `mebots sweep --help` lists the arguments", "missing_key")
        study = _asked(options.study, options.mission)
        if options.dry_run:
            return _dry_run(study, options)
        if not options.out:
            raise InputError("--out is missing: the folder for the results", "missing_key")
        return _sweep(study, options)
    except InputError as error:
        _complain(error)
        return BAD_INPUT
    except Unfinished as error:
        _complain(error)
        return UNFINISHED
    except Error as error:
        _complain(error)
        return NOT_DONE
    except KeyboardInterrupt:
        print("interrupted; the same command continues from here", file=sys.stderr)
        return NOT_DONE


def _options(words: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser("mebots sweep")
    parser.add_argument("study", nargs="?")
    parser.add_argument("--mission")
    parser.add_argument("--out")
    parser.add_argument("--jobs", type=int)
    parser.add_argument("--dry-run", action="store_true")
    parser.add_argument("--status")
    parser.add_argument("--reuse", action="append", default=[])
    return parser.parse_args(words)


def _complain(error: Error) -> None:
    for line in str(error).splitlines():
        print(f"mebots: error: {line}", file=sys.stderr)


def _sweep(study: Study, options: argparse.Namespace) -> int:
    out = pathlib.Path(options.out)
    with _campaign(study, None, options.jobs) as campaign:
        progress_line = _ProgressLine()
        print(_size(campaign), file=sys.stderr)
        if study.splitting is None and sys.stderr.isatty():
            print(f"{out / live_page.NAME} shows the designs while it runs", file=sys.stderr)
        if study.is_another_in(out):
            print(f"{out} has the tables of another study; this study replaces them, and reuses the missions that both have", file=sys.stderr)
        result = campaign.run(out, [pathlib.Path(one) for one in options.reuse], progress_line)
        progress_line.end()
    for text in result.notices:
        print(f"mebots: warning: {text}", file=sys.stderr)
    written = ("missions.csv" if study.splitting is None else "levels.csv", "designs.csv", "report.html")
    known = f", {campaign.taken} of them known before" if campaign.taken else ""
    if campaign.flown and campaign.of_other_builds:
        known += f", {counted(campaign.of_other_builds, 'record')} of other builds not used"
    if result.answer is not None:
        width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
        print("\n".join(result.answer.lines(width)) + "\n")
    else:
        print("\n".join(_probabilities(result)) + "\n")
    print(f"{counted(result.missions, 'mission')}{known}, {result.failed} failed: {', '.join(str(out / name) for name in written)}")
    for text in result.without_value:
        print(f"mebots: error: {text}", file=sys.stderr)
    if result.failed:
        return NOT_DONE
    return BAD_INPUT if result.without_value else DONE


def _probabilities(result: Sweep) -> list[str]:
    """Returns the answer of a study of a rare event as lines."""
    lines = []
    for row in result.designs():
        found, low, high = (row[name] for name in ("probability", "probability: low", "probability: high"))
        interval = f" ({percent(float(low))} to {percent(float(high))})" if low and high else ""
        lines.append(f"Design #{row['design']}: probability {percent(float(found))}{interval}" if found else f"Design #{row['design']}: no probability yet")
    return lines


def _size(campaign: Campaign) -> str:
    designs = f"{counted(len(campaign.space.designs), 'design')}, " if campaign.space.designs else ""
    return f"{designs}at most {counted(campaign.most_missions, 'mission')}"


_MOST_SHOWN = 12
"""Maximum number of designs in the live table."""
_EVERY_S, _TABLE_SHARE = 0.5, 20.0
"""The live table uses at most a twentieth of the time."""


class _ProgressLine:
    """Shows the progress of a study. On a terminal, redraws a line and the current ranking. Otherwise, prints lines from time to time."""

    def __init__(self) -> None:
        self._terminal = sys.stderr.isatty()
        self._next_s = time.monotonic() + (_EVERY_S if self._terminal else 10)
        self._drawn = 0  # number of lines

    def __call__(self, now: Progress) -> None:
        begun_s = time.monotonic()
        if begun_s < self._next_s:
            return
        if not self._terminal:
            print(now.line(), file=sys.stderr, flush=True)
            self._next_s = begun_s + 10
            return
        self._draw([now.line(), *_live_table(now)])
        self._next_s = time.monotonic() + max(_EVERY_S, _TABLE_SHARE * (time.monotonic() - begun_s))

    def _draw(self, lines: list[str]) -> None:
        """Replaces the lines drawn before. Truncates long lines, because wrapped lines cannot be replaced."""
        size = shutil.get_terminal_size()
        shown = [line[: size.columns - 1] for line in lines[: max(1, size.lines - 1)]]
        back = f"\r\033[{self._drawn - 1}A" if self._drawn > 1 else "\r"
        self._drawn = len(shown)
        print(f"{back}\033[J" + "\n".join(shown), end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        if self._terminal:
            self._draw([""])


def _live_table(now: Progress) -> list[str]:
    """Returns lines with the best designs so far and their intervals. Further lines say how many designs get no more missions, and why."""
    if now.standings is None:
        return []
    so_far = now.standings()
    ended = collections.Counter(row.note for row in so_far.rows if row.note)
    reasons = [f"no more missions for {counted(count, 'design')}: {reason}" for reason, count in ended.most_common()]
    return [*table_lines(so_far.titles, so_far.rows[:_MOST_SHOWN], shutil.get_terminal_size().columns - 1), *reasons]


def _status(folder: pathlib.Path) -> int:
    try:
        study = read_study(folder / NAME)
    except InputError as error:
        if (folder / NAME).exists():
            raise
        raise InputError(f"{folder}: there is no study in this folder", "file_not_found") from error
    with _campaign(study, None, 1) as campaign:
        journal = Journal(folder, writable=False)
        flown, outcomes = 0, collections.Counter[str]()
        for flight in campaign.all_flights() if study.splitting is None else ():
            record = journal.find(campaign.space.order(flight)["mission"])
            if record is not None:
                flown += 1
                outcomes[record["outcome"]] += 1
        journal.close()
        done = is_done(folder)
        known = f"{flown} of at most {campaign.most_missions} missions are flown; " if flown else ""
        print(f"{known}the journal has {len(journal)}")
        if outcomes:
            print(", ".join(f"{outcome} {count}" for outcome, count in outcomes.most_common()))
        print(f"the study is done: {folder / 'report.html'}" if done else "the study is not done")
    return DONE


def _dry_run(study: Study, options: argparse.Namespace) -> int:
    """Checks the study, and runs one mission to estimate the time of all missions."""
    with _campaign(study, None, options.jobs) as campaign:
        campaign.check()
        jobs = options.jobs or len(os.sched_getaffinity(0))
        with tempfile.TemporaryDirectory(prefix="mebots-dry-run-") as folder:
            if study.results:
                campaign.space.missions.folder = pathlib.Path(folder)
            record = flying.fly(campaign.space.missions.order(campaign.example()))
            if "unfinished" in record:
                raise Unfinished(record["unfinished"])
            files = sum(file.stat().st_size for file in pathlib.Path(folder).rglob("*") if file.is_file())
        count = campaign.most_missions
        line_bytes = len(json.dumps(record)) + 1 + files
        time_s = count * record["processor_time"] / jobs
        print(_size(campaign))
        print(f"about {duration_text(time_s)} with {jobs} jobs ({record['processor_time']:.2f} s per mission, measured on one mission)")
        print(f"about {count * (line_bytes + 200) / 1e6:.1f} MB of disk")
    return DONE
