# SPDX-License-Identifier: Apache-2.0
"""Gives batches of orders to an executor and takes records back. Sends the files that a worker lacks. Counts the attempts
of missions that ended without a result: a full disk, too little memory, a killed process, a lost worker."""

from __future__ import annotations

import collections
import concurrent.futures
import dataclasses
import pathlib
import queue
from typing import Any

from mebots.errors import Error
from mebots.exploration import flying, interrupts
from mebots.exploration.journal import Record, record_of
from mebots.exploration.missions import Order, packed

ATTEMPTS = 3
"""How often a mission may end without a result before the study stops."""
_BATCH_S = 0.25
"""Time for which a batch should keep a worker busy: a kill loses no more of it."""
_MOST_IN_BATCH = 1000
_GROWTH = 10
_MOST_SENDS = 5
"""How often files are sent to workers for one batch."""

Future = concurrent.futures.Future[dict[str, Any]]


class Unfinished(Error):
    """A mission had no result in several attempts, for a reason outside of the mission. The study stops."""

    def __init__(self, text: str, code: str = "unfinished") -> None:
        super().__init__(text, code)


@dataclasses.dataclass
class _Task:
    orders: list[Order]
    sends: int = 0


class Dispatcher:
    """At most ``most`` batches are out at the same time. One thread at a time."""

    def __init__(self, executor: concurrent.futures.Executor, most: int) -> None:
        self._executor = executor
        self._most = most
        self._size = 1
        self._next: list[Order] = []
        self._out: dict[Future, _Task] = {}
        self._done: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self._missions: set[str] = set()
        self._attempts: collections.Counter[str] = collections.Counter()
        self._unfinished: Unfinished | None = None

    @property
    def is_full(self) -> bool:
        return len(self._out) >= self._most

    def has(self, mission: str) -> bool:
        """True for a mission that was given out and has no result yet."""
        return mission in self._missions

    def give(self, order: Order, left: int = _MOST_IN_BATCH) -> None:
        """Adds an order to the next batch, unless its mission is out. ``left``: how many orders follow at most; near the end
        batches are small, so that all workers have one."""
        if order["mission"] in self._missions:
            return
        self._missions.add(order["mission"])
        self._next.append(order)
        if len(self._next) >= min(self._size, 1 + left // self._most):
            self.flush()

    def flush(self) -> None:
        """Sends the orders that are waiting for a full batch."""
        if self._next:
            orders, self._next = self._next, []
            self._submit(_Task(orders))

    def take(self) -> list[tuple[Record, bytes]]:
        """Waits for at least one answer of the executor. Returns records of finished missions with their lines, perhaps none. Raises
        Unfinished at the call after the one that returned the last records, Error for an executor that failed."""
        if self._unfinished is not None:
            raise self._unfinished
        if not self._out:
            self.flush()
        # Not concurrent.futures.wait: an interrupt may leave it with a lock of a future, for which its worker waits for ever.
        done = [self._done.get()]
        while not self._done.empty():
            done.append(self._done.get())
        records: list[tuple[Record, bytes]] = []
        for future in done:
            records += self._records(self._out.pop(future), future)
        if self._unfinished is not None and not records:
            raise self._unfinished
        return records

    def _records(self, task: _Task, future: Future) -> list[tuple[Record, bytes]]:
        problem = _problem_of(future)
        if isinstance(problem, (AssertionError, TypeError, AttributeError, ImportError)):
            raise problem  # a mistake of the program: another attempt would end in the same way
        if problem is not None:
            for order in task.orders:
                self._repeat(order, f"the executor lost it: {str(problem) or type(problem).__name__}")
            return []
        answer = future.result()
        if "build" in answer:
            raise Error(
                f"a worker has another build of MEbots ({answer['build'][:12]} in place of "
                f"{task.orders[0]['build'][:12]}): install the same one on all machines",
                "not_offered",
            )
        if "lacks" in answer:
            if task.sends == _MOST_SENDS:
                raise Error(f"a worker does not keep the files that are sent to it: {answer['lacks']}", "system_failure")
            self._submit(_Task(task.orders, task.sends + 1), answer["lacks"])
            return []
        self._adapt(len(task.orders), answer["duration_s"])
        unfinished = answer["unfinished"]
        for order in task.orders if unfinished else ():
            if order["mission"] in unfinished:
                self._repeat(order, unfinished[order["mission"]])
        records = [(record_of(line), line) for line in answer["lines"]]
        self._missions.difference_update([record["mission"] for record, _ in records])
        return records

    def _repeat(self, order: Order, why: str) -> None:
        """Gives a mission without a result out again, alone: no other one suffers if it ends its worker."""
        mission = order["mission"]
        self._attempts[mission] += 1
        if self._attempts[mission] < ATTEMPTS:
            self._submit(_Task([order]))
        elif self._unfinished is None:
            self._unfinished = Unfinished(
                f"the mission {mission} had no result in {ATTEMPTS} attempts: {why}. This is no property of the mission: mend the cause, "
                f"and the same command continues. The mission has {_told(order)}"
            )

    def _adapt(self, count: int, duration_s: float) -> None:
        ideal = _MOST_IN_BATCH if duration_s <= 0 else int(count * _BATCH_S / duration_s)
        self._size = max(1, min(ideal, self._size * _GROWTH, _MOST_IN_BATCH))

    def _submit(self, task: _Task, lacking: list[str] | None = None) -> None:
        batch = packed(task.orders)
        if lacking:
            batch["contents"] = {digest: pathlib.Path(batch["files"][digest][0]).read_bytes() for digest in lacking}
        with interrupts.held():
            try:
                future = self._executor.submit(flying.fly_all, batch)
            except Exception as error:  # noqa: BLE001 - each kind of executor has its own
                why = (str(error) or type(error).__name__).rstrip(".")
                raise Error(f"the executor takes no more missions: {why}. The same command continues with another one", "system_failure") from None
            self._out[future] = task
            future.add_done_callback(self._done.put)


def _problem_of(future: Future) -> BaseException | None:
    try:
        return future.exception()
    except concurrent.futures.CancelledError as error:  # as Dask does when its scheduler is gone
        return error


def _told(order: Order) -> str:
    return ", ".join(f"{name} = {value}" for name, value in order["settings"].items()) or "no settings"
