# SPDX-License-Identifier: Apache-2.0
"""Executes orders one after the other: ``python -m mebots.exploration.worker LIFE OUT FOLDER``.

Orders arrive on standard input. Records are written to the file descriptor OUT, a line of JSON each; an empty line
means that the process waits for another order. The process ends when no process holds the other end of the descriptor
LIFE, so that it does not outlive its parent. FOLDER, for temporary files and for shared saved states, belongs to the
parent, which deletes it.

Each mission starts as in a new process. The first process loads FMUs and never creates an instance. It forks a second
process, which runs missions while their FMUs are clean (``docs/master/clean-fmus.md``). A mission of clean FMUs leaves
nothing in the process. After a mission with an FMU that is not clean, the next order goes to a new fork.
"""

from __future__ import annotations

import collections
import contextlib
import gc
import itertools
import json
import math
import os
import resource
import select
import shutil
import signal
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from typing import Any, NoReturn

from mebots import Error, Mission
from mebots.exploration import answers, outcomes
from mebots.exploration.missions import FILE_MARK, without_paths
from mebots.exploration.orders import Order
from mebots.exploration.pasts import Pasts

_MOST_OPEN = 4  # maximum number of configs whose FMUs stay loaded
_NO_WHOLE_STATE = (
    "the saved state of an FMU is incomplete, so no other mission can start from it: {}. Run the study without "
    "'fork' and 'splitting'"
)
_TRIES_TO_REMOVE = 20
FACTS = ("simulated_time", "steps")
"""Numbers that every mission's summary contains under its own labels."""
_ENDED_BY_FMU = -1  # with exit code 0 before the record was written


class Worker:
    """Keeps missions open, by their config."""

    def __init__(self, folder: str, pasts: Pasts, waiting: Callable[[], None] = lambda: None) -> None:
        """``waiting`` is called repeatedly while another process computes a required state."""
        self._folder = folder
        self._pasts = pasts
        self._waiting = waiting
        self._open: collections.OrderedDict[str, tuple[Mission, str]] = collections.OrderedDict()
        self._about = ""  # the variable being read
        self._own_files: set[str] = set()
        self._flown: Mission | None = None
        self._was_clean = True

    def prepare(self, order: Order) -> None:
        """Opens the order's mission and loads its FMUs without instances."""
        config = _config_of(order)
        if ("out" in order and not order.get("check")) or config in self._open:
            return
        with contextlib.suppress(Error, OSError, MemoryError):  # answer() reports the same error
            self._mission(config, bool(order["series"]), None).load()

    def is_clean(self) -> bool:
        """True if the next mission would start as in a new process. Frees the instances of the last mission."""
        self.free_instances()
        return self._was_clean

    def use_folder(self, folder: str) -> None:
        """Sets the folder for temporary files. A fork calls this function, and must not delete the files of the process from which it was
        forked."""
        self._folder = folder
        self._own_files.clear()

    def answer(self, order: Order) -> dict[str, Any]:
        """Runs a mission and returns its record. For an order with ``check``, only checks the mission at its start; the record then
        contains the error, and in ``about`` the variable that caused it."""
        self.free_instances()
        self._about = ""
        record: dict[str, Any] = {"mission": order.get("mission", ""), "flown_by": order.get("build", ""), "outcome": "failed", "error": "", "code": ""}
        begun = time.process_time()
        try:
            if order.get("check"):
                self._check(self._prepared(order), order)
                record["outcome"] = "checked"
            elif "until" in order:
                self._fly_until(order, record)
            else:
                self._fly(order, record)
        except (Error, OSError, MemoryError) as error:
            if outcomes.is_outside(error):
                self._forget(order)
                return {"mission": record["mission"], "unfinished": outcomes.text_of(error)}
            assert isinstance(error, Error)
            record["error"], record["code"] = _without_paths(str(error), order), error.code
            if order.get("check"):
                record["about"] = self._about
        leftovers = self.free_instances() if order["course"] else []
        if leftovers and not record["error"]:
            record["error"] = _without_paths(_NO_WHOLE_STATE.format(leftovers[0][0]), order)
            record |= {"outcome": "failed", "code": "not_offered"}
        record["processor_time"] = round(time.process_time() - begun, 4)
        return record

    def _forget(self, order: Order) -> None:
        """Drops a mission after a system error, which may have left it in any state. The next attempt opens it again."""
        self.free_instances()
        self._open.pop(_config_of(order), None)

    def free_instances(self) -> list[tuple[str, bool]]:
        """Frees the instances of the last mission. Returns the FMUs that are not clean because they may have left data that affect later
        missions, and whether they ran in this process."""
        flown, self._flown = self._flown, None
        leftovers = [] if flown is None else flown.free_instances()
        self._was_clean = self._was_clean and not any(in_process for _, in_process in leftovers)
        return leftovers

    def _prepared(self, order: Order) -> Mission:
        places = _places(order)
        out = None if order.get("check") or "out" not in order else _unfinished(order["out"])
        if out is not None:
            os.makedirs(os.path.dirname(out), exist_ok=True)
        mission = self._flown = self._mission(_config_of(order), bool(order["series"]), out)
        for name, value in order["settings"].items():
            mission.set(name, places.get(value, value) if isinstance(value, str) else value)
        if out is None:
            mission.record([name for name, _ in order["series"]])
        return mission

    def _mission(self, config: str, in_memory: bool, out: str | None) -> Mission:
        if out is None and config in self._open:
            self._open.move_to_end(config)
            mission, _ = self._open[config]
            mission.reset()
            return mission
        descriptor, file = tempfile.mkstemp(".json", "mission", self._folder)
        self._own_files.add(file)
        with open(descriptor, "w", encoding="utf-8") as stream:
            stream.write(config)
        if out is not None:  # a mission has only one results folder
            return Mission(file, in_memory=in_memory, out=out, statistics=True)
        if len(self._open) >= _MOST_OPEN:
            _, (_, unused) = self._open.popitem(last=False)
            if unused in self._own_files:
                os.unlink(unused)
        mission = Mission(file, in_memory=in_memory)
        self._open[config] = (mission, file)
        return mission

    def _check(self, mission: Mission, order: Order) -> None:
        """Starts the mission, and tries what the order does later: reads its variables, writes its values and saves the state."""
        mission.start()
        scores = [turn["place"]["score"][0] for turn in order["course"] if "score" in turn["place"]]
        for name in (*order["finals"], *scores):
            self._about = name
            mission.value(name)
        self._about = ""
        for turn in order["course"]:
            _write(mission, turn["writes"])
        if order["course"]:
            mission.save_state()
            with contextlib.suppress(Error):  # the mission itself reports errors of the step
                mission.step()
            if mission.state == "running" and not mission.ended:
                mission.save_state()  # raises InputError if an FMU keeps data outside its instances

    def _follow(self, mission: Mission, order: Order) -> None:
        """Continues from the state that was saved at the latest possible turn of the order's course. Then writes the values of this turn,
        and of each later turn that the mission reaches."""
        course = order["course"]
        if not course:
            return
        begin, state = self._last_state(course)
        if state is None or begin < len(course) - 1:
            with self._pasts.flown_by_me(course[-1]["past"], self._waiting):
                self._go_on(mission, course, *self._last_state(course))
        else:
            self._go_on(mission, course, begin, state)

    def _last_state(self, course: list[dict[str, Any]]) -> tuple[int, bytes | None]:
        """Returns the index of the last turn of ``course`` with a saved state, and this state. Without a saved state, returns 0 and None. A
        turn is a place at which inputs change (missions.Turn)."""
        for number in range(len(course) - 1, -1, -1):
            state = self._pasts.find(course[number]["past"])
            if state is not None:
                return number, state
        return 0, None

    def _go_on(self, mission: Mission, course: list[dict[str, Any]], begin: int, state: bytes | None) -> None:
        if state is not None:
            mission.start_from(state)
        for number in range(begin, len(course)):
            turn = course[number]
            if state is None or number > begin:
                _go_to(mission, turn["place"])
                if mission.ended:
                    return
                self._pasts.keep(turn["past"], mission.save_state())
            _write(mission, turn["writes"])

    def _fly_until(self, order: Order, record: dict[str, Any]) -> None:
        mission = self._prepared(order)
        self._follow(mission, order)
        mission.start()
        begun_s = mission.time
        (score, sign), level = order["until"]["score"], order["until"]["level"]
        best = _best_on_the_way(mission, score, sign, level)
        reached = sign * best >= sign * level
        if reached and not mission.ended:
            self._pasts.keep(order["keeps"], mission.save_state())
        record |= {"outcome": "reached" if reached else mission.outcome or "failed", "best": best,
                   "simulated_time": mission.time - begun_s, "time": mission.time}

    def _fly(self, order: Order, record: dict[str, Any]) -> None:
        mission = self._prepared(order)
        try:
            self._follow(mission, order)
            mission.run()
        finally:
            summary = mission.summary
            labels = json.loads(order["config"]).get("summary", {})
            record["outcome"] = mission.outcome or "failed"
            record["simulated_time"] = summary.get("simulated_time", 0.0)
            record["end_reason"] = summary.get("end_reason", "failed")
            record["values"] = flat({key: summary[key] for key in (*labels, *FACTS) if key in summary})
        if "out" in order:
            mission.close()
            shutil.rmtree(order["out"], ignore_errors=True)  # results of a deleted journal
            os.replace(_unfinished(order["out"]), order["out"])
            record["memory_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000
        record["finals"] = {name: mission.value(name) for name in order["finals"]}
        record["series"] = {f"{name} {how}": _reduced(mission, name, how) for name, how in order["series"]}


def _places(order: Order) -> dict[str, str]:
    return {FILE_MARK + digest: path for digest, (path, _) in order["files"].items()}


def _config_of(order: Order) -> str:
    config: str = order["config"]
    for mark, path in _places(order).items():
        config = config.replace(json.dumps(mark), json.dumps(path))
    return config


def _unfinished(folder: str) -> str:
    return folder + ".part"


def _write(mission: Mission, values: dict[str, Any]) -> None:
    for name, value in values.items():
        mission.write(name, value)


def _go_to(mission: Mission, place: dict[str, Any]) -> bool:
    """Runs to the time or the level that ``place`` defines (missions.Turn). Returns False if the mission ended before."""
    if "at" in place:
        mission.run_until(place["at"])
        return not mission.ended
    (score, sign), level = place["score"], place["level"]
    return sign * _best_on_the_way(mission, score, sign, level) >= sign * level


def _best_on_the_way(mission: Mission, score: str, sign: int, level: float) -> float:
    """Runs until the score reaches the level, or to the end. Returns the greatest score if `sign` is positive, otherwise the least."""
    best = mission.value(score)
    while sign * best < sign * level and mission.step():
        best = sign * max(sign * best, sign * mission.value(score))
    return best


def flat(values: dict[str, Any], before: str = "") -> dict[str, Any]:
    """Flattens nested labels and joins them by dots."""
    result: dict[str, Any] = {}
    for key, value in values.items():
        result |= flat(value, f"{before}{key}.") if isinstance(value, dict) else {before + key: value}
    return result


_PERCENTILES = {"p5": 5.0, "median": 50.0, "p95": 95.0}


def _reduced(mission: Mission, name: str, how: str) -> float | None:
    values = memoryview(mission._series(name)[1]).cast("d")
    if how == "mean":
        return math.fsum(values) / len(values)
    if how in _PERCENTILES:
        return answers.percentile_of(sorted(values), _PERCENTILES[how])
    if how == "first_true":
        times_s = memoryview(mission._run.times).cast("d")
        return next((time_s for time_s, value in zip(times_s, values, strict=True) if value != 0), None)
    functions: dict[str, Callable[[Any], float]] = {"min": min, "max": max, "first": lambda all: all[0], "last": lambda all: all[-1]}
    return functions[how](values)


def _without_paths(text: str, order: Order) -> str:
    """Replaces paths by file names, so that a message is the same on every machine."""
    for path, name in order["files"].values():
        text = text.replace(path, name)
    return without_paths(text)


class _Pipes:
    """The pipes of a worker, which its forks share: orders arrive on standard input, and records are written to ``records``. The pipe
    ``life`` is closed when the parent needs no more records."""

    def __init__(self, life: int, out: int, folder: str) -> None:
        self.life = life
        self.folder = folder
        self.records = os.fdopen(out, "w", encoding="utf-8")
        # Replaces standard input, on which orders arrive, by an empty file, so that FMUs cannot read orders.
        self._orders = os.dup(0)
        nothing = os.open(os.devnull, os.O_RDONLY)
        os.dup2(nothing, 0)
        os.close(nothing)

    def orders(self) -> Iterator[Order]:
        """Yields orders. The processes of a worker read the same pipe, one process at a time. The parent sends an order only after the
        record of the previous order, so that a process never reads an order for the next process."""
        text = b""
        while block := os.read(self._orders, 1 << 16):
            text += block
            if text.endswith(b"\n"):
                yield json.loads(text)
                text = b""

    def write(self, record: dict[str, Any]) -> None:
        print(json.dumps(record), file=self.records, flush=True)

    def wait(self) -> None:
        print(file=self.records, flush=True)

    def is_over(self) -> bool:
        return bool(select.select([self.life], [], [], 0)[0])


def _end_with(life: int, parent: int, folder: str) -> None:
    """Waits until the pipe ``life`` or ``parent`` is closed. Then ends this process. If ``life`` is closed, no more records are needed, so
    also deletes all temporary files."""
    if life in select.select([life, parent], [], [])[0]:
        for _ in range(_TRIES_TO_REMOVE):  # a mission may still write its state
            shutil.rmtree(folder, ignore_errors=True)
            if not os.path.exists(folder):
                break
            time.sleep(0.1)
    os._exit(1)


def _answer(worker: Worker, order: Order) -> dict[str, Any]:
    try:
        return worker.answer(order)
    except Exception:  # a bug of MEbots, which the parent reports
        return {"mission": order["mission"], "bug": traceback.format_exc()}


def _fly_while_clean(worker: Worker, order: Order, pipes: _Pipes) -> None:
    """Executes this order and further orders from the pipe until a mission leaves data in the process, or until an error in MEbots
    occurs."""
    process = os.getpid()
    for each in itertools.chain([order], pipes.orders()):
        record = _answer(worker, each)
        if os.getpid() != process:  # this is the child of a fork by an FMU
            os._exit(1)
        with contextlib.suppress(BrokenPipeError):  # the reader has ended
            pipes.write(record)
        if "bug" in record or not worker.is_clean():
            return


def _fly_in_fork(worker: Worker, order: Order, pipes: _Pipes) -> int:
    """Executes the order in a fork of this process. While its missions leave no data, the fork also executes further orders. Returns its
    exit status; 0 after a normal end."""
    folder = tempfile.mkdtemp(prefix="flights-", dir=pipes.folder)
    well, told = os.pipe()
    parent, ours = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(well)
        os.close(ours)
        threading.Thread(target=_end_with, args=(pipes.life, parent, pipes.folder), daemon=True).start()
        os.environ["TMPDIR"] = folder
        worker.use_folder(folder)
        _fly_while_clean(worker, order, pipes)
        os.write(told, b"!")
        os._exit(0)
    os.close(told)
    os.close(parent)
    try:
        _, status = os.waitpid(child, 0)
        os.set_blocking(well, False)
        with contextlib.suppress(BlockingIOError):  # a process of an FMU may hold the other end
            if os.read(well, 1):
                return 0
        return status or _ENDED_BY_FMU
    finally:
        os.close(well)
        os.close(ours)
        shutil.rmtree(folder, ignore_errors=True)


def _end_as(status: int) -> NoReturn:
    """Ends this process with the exit code or signal of its fork, so that the reader of the records sees it."""
    if os.WIFSIGNALED(status):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        signal.signal(os.WTERMSIG(status), signal.SIG_DFL)
        os.kill(os.getpid(), os.WTERMSIG(status))
    os._exit(0 if status == _ENDED_BY_FMU else os.waitstatus_to_exitcode(status))


def main() -> None:
    pipes = _Pipes(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3])
    pasts = os.path.join(pipes.folder, "pasts")
    os.makedirs(pasts, exist_ok=True)
    worker = Worker(tempfile.mkdtemp(prefix="worker-", dir=pipes.folder), Pasts(pasts), pipes.wait)
    pipes.write({})  # reports that the process is ready; only now does the mission's time start
    for order in pipes.orders():
        worker.prepare(order)
        gc.freeze()  # keeps unwritten pages shared with the fork
        status = _fly_in_fork(worker, order, pipes)
        if status != 0 and not pipes.is_over():
            _end_as(status)
    while not pipes.is_over():  # waits for the parent, which has ended or ends this process
        select.select([pipes.life], [], [])
    shutil.rmtree(pipes.folder, ignore_errors=True)
    os._exit(1)


if __name__ == "__main__":
    main()
