# SPDX-License-Identifier: Apache-2.0
"""Gives orders to an executor and takes records back. What a worker lacks goes after it; what it lost is given out
again."""

from __future__ import annotations

import concurrent.futures
import pathlib
import queue

from mebots.errors import Error
from mebots.exploration import flying, interrupts
from mebots.exploration.journal import Record
from mebots.exploration.missions import Order

RESUBMISSIONS = 5
"""How often an order is given out again: executors lose workers."""

Future = concurrent.futures.Future[Record]


class Dispatcher:
    """At most ``most`` orders are out at the same time. One thread at a time."""

    def __init__(self, executor: concurrent.futures.Executor, most: int) -> None:
        self._executor = executor
        self._most = most
        self._out: dict[Future, tuple[Order, int]] = {}
        self._done: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self._missions: set[str] = set()

    @property
    def is_full(self) -> bool:
        return len(self._out) >= self._most

    def give(self, order: Order) -> None:
        """Nothing, when the same mission is out."""
        if order["mission"] not in self._missions:
            self._missions.add(order["mission"])
            self._submit(order, 0)

    def take(self) -> list[Record]:
        """Waits for at least one executor's answer; the records of those that are done, perhaps none. Raises Error when
        an order is lost again and again."""
        # Not concurrent.futures.wait: an interrupt may leave it with a lock of a future, for which its worker waits for ever.
        done = [self._done.get()]
        while not self._done.empty():
            done.append(self._done.get())
        records = []
        for future in done:
            order, tries = self._out.pop(future)
            problem = future.exception()
            if problem is None and "build" in future.result():
                raise Error(
                    f"a worker has another build of MEbots ({future.result()['build'][:12]} in place of "
                    f"{order['build'][:12]}): install the same one on all machines",
                    "not_offered",
                )
            if problem is None and "lacks" not in future.result():
                self._missions.discard(order["mission"])
                records.append(future.result())
                continue
            if isinstance(problem, (AssertionError, TypeError, AttributeError, ImportError)):
                raise problem  # not lost on the way: another try would end as this one did
            if tries == RESUBMISSIONS:
                why = str(problem) if problem else f"a worker keeps no files: {future.result()['lacks']}"
                raise Error(f"the executor failed on one mission {tries + 1} times: {why}", "system_failure")
            self._submit(order if problem else _with_contents(order, future.result()["lacks"]), tries + 1)
        return records

    def _submit(self, order: Order, tries: int) -> None:
        with interrupts.held():
            try:
                future = self._executor.submit(flying.fly, order)
            except RuntimeError as error:
                raise Error(f"the executor takes no more missions: {error}", "system_failure") from None
            self._out[future] = ({key: value for key, value in order.items() if key != "contents"}, tries)
            future.add_done_callback(self._done.put)


def _with_contents(order: Order, lacking: list[str]) -> Order:
    return order | {"contents": {digest: pathlib.Path(order["files"][digest][0]).read_bytes() for digest in lacking}}
