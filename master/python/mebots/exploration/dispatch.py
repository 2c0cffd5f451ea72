# SPDX-License-Identifier: Apache-2.0
"""Passes batches of orders to an executor and collects results. Sends files that a worker lacks. Repeats missions without a result after a
full disk, too little memory, a killed process or a lost worker."""

from __future__ import annotations

import collections
import concurrent.futures
import dataclasses
import queue
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from mebots.errors import Error
from mebots.exploration import flying, interrupts
from mebots.exploration.inputs import content_of
from mebots.exploration.orders import Order, Orders, packed
from mebots.exploration.replies import Reply, reply_from

ATTEMPTS = 3
"""The number of attempts without a result after which the study stops."""
_BATCH_S = 0.25
"""The time for which a batch should occupy a worker. If the worker is killed, at most this much work is lost."""
_MOST_IN_BATCH = 1000
_GROWTH = 10
_MOST_SENDS = 5
"""The maximum number of times that files are sent to workers for one batch."""

Future = concurrent.futures.Future[dict[str, Any]]


class Unfinished(Error):
    """Raised if a mission has no result after several attempts for a reason outside the mission. The study then stops."""

    def __init__(self, text: str, code: str = "unfinished") -> None:
        super().__init__(text, code)


@dataclasses.dataclass
class _Group:
    """Orders, and the index of each mission in the current round. The index is -1 for other missions."""

    orders: Orders
    indices: Sequence[int]

    def part(self, begin: int, end: int) -> _Group:
        return _Group(self.orders.part(begin, end), self.indices[begin:end])


@dataclasses.dataclass
class _Task:
    groups: list[_Group]
    sends: int = 0

    def __len__(self) -> int:
        return sum(len(group.orders) for group in self.groups)

    def __iter__(self) -> Iterator[tuple[Order, int]]:
        return ((group.orders[number], index) for group in self.groups for number, index in enumerate(group.indices))


class Dispatcher:
    """Passes batches to the executor, at most ``most`` at a time. Not thread-safe."""

    def __init__(self, executor: concurrent.futures.Executor, most: int) -> None:
        self._executor = executor
        self._most = most
        self._size = 1
        self._waiting: collections.deque[_Group] = collections.deque()
        self._left = 0
        self._out: dict[Future, _Task] = {}
        self._done: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self._missions: set[bytes] = set()
        self._attempts: collections.Counter[str] = collections.Counter()
        self._unfinished: Unfinished | None = None

    @property
    def is_full(self) -> bool:
        return len(self._out) >= self._most

    def has_none_of(self, digests: Iterable[bytes]) -> bool:
        """True if none of these missions is in progress."""
        return self._missions.isdisjoint(digests)

    def give(self, orders: Orders, indices: Sequence[int] | None = None, left: int = _MOST_IN_BATCH) -> None:
        """Queues orders, except those of missions in progress. ``indices`` are the numbers of the missions in the round. ``left`` is the
        maximum number of later orders. Near the end of a round, batches become small, so that all workers receive one."""
        if indices is None:
            indices = [-1] * len(orders)
        if not self.has_none_of(orders.digests):
            fresh = [at for at, digest in enumerate(orders.digests) if digest not in self._missions]
            orders, indices = orders.only(fresh), [indices[at] for at in fresh]
        if orders.digests:
            self._missions.update(orders.digests)
            self._waiting.append(_Group(orders, indices))
        self._left = left
        self._send(whole=True)

    def flush(self) -> None:
        """Sends orders that wait for a full batch."""
        self._send(whole=False)

    def _send(self, *, whole: bool) -> None:
        """Sends batches while there is capacity. If ``whole`` is true, sends only full batches."""
        waiting = sum(len(group.orders) for group in self._waiting)
        while waiting and len(self._out) < self._most:
            size = max(1, min(self._size, (waiting + self._left) // self._most))
            if whole and waiting < size:
                return
            groups = []
            while size and self._waiting:
                group = self._waiting.popleft()
                count = len(group.orders)
                if count > size:
                    self._waiting.appendleft(group.part(size, count))
                    group = group.part(0, size)
                groups.append(group)
                size -= len(group.orders)
                waiting -= len(group.orders)
            self._submit(_Task(groups))

    def take(self) -> list[Reply]:
        """Waits for the executor. Returns results of finished missions, possibly none. If a mission failed permanently, returns the last
        results first and raises Unfinished in the next call. Raises Error if the executor failed."""
        if self._unfinished is not None:
            raise self._unfinished
        if not self._out:
            self.flush()
        # Does not use concurrent.futures.wait(): an interrupt could leave a future locked, and its worker would wait without end.
        done = [self._done.get()]
        while not self._done.empty():
            done.append(self._done.get())
        replies = [reply for future in done if (reply := self._reply(self._out.pop(future), future)) is not None]
        if self._unfinished is not None and not replies:
            raise self._unfinished
        self._send(whole=True)
        return replies

    def _reply(self, task: _Task, future: Future) -> Reply | None:
        problem = _problem_of(future)
        if isinstance(problem, (AssertionError, TypeError, AttributeError, ImportError)):
            raise problem  # a bug, which another attempt would repeat
        if problem is not None:
            for order, index in task:
                self._repeat(order, index, f"the executor lost the mission: {str(problem) or type(problem).__name__}")
            return None
        answer = future.result()
        if "build" in answer:
            own = next(iter(task))[0]["build"]
            raise Error(
                f"a worker has another build of MEbots ({answer['build'][:12]} in place of {own[:12]}): install the same one on all machines",
                "not_offered",
            )
        if "lacks" in answer:
            if task.sends == _MOST_SENDS:
                raise Error(f"a worker does not keep the files that are sent to it: {answer['lacks']}", "system_failure")
            self._submit(_Task(task.groups, task.sends + 1), answer["lacks"])
            return None
        self._adapt(len(task), answer["duration_s"])
        try:
            reply = reply_from(answer)
        except ValueError as damage:
            for order, index in task:
                self._repeat(order, index, str(damage))
            return None
        reply.indices = [index for group in task.groups for index in group.indices]
        if unfinished := answer["unfinished"]:
            ended = []
            for order, index in task:
                if order["mission"] in unfinished:
                    self._repeat(order, index, unfinished[order["mission"]])
                else:
                    ended.append(index)
            reply.indices = ended
        self._missions.difference_update(reply.digests)
        return reply if reply.digests else None

    def _repeat(self, order: Order, index: int, why: str) -> None:
        """Repeats a mission in a separate batch, so that no other mission is lost if its worker ends again."""
        mission = order["mission"]
        self._attempts[mission] += 1
        if self._attempts[mission] < ATTEMPTS:
            self._submit(_Task([_Group(Orders.of([order]), [index])]))
        elif self._unfinished is None:
            self._unfinished = Unfinished(
                f"the mission {mission} had no result in {ATTEMPTS} attempts: {why}. The mission is not the cause: remove the cause, then "
                f"continue with the same command. The mission has {_told(order)}"
            )

    def _adapt(self, count: int, duration_s: float) -> None:
        ideal = _MOST_IN_BATCH if duration_s <= 0 else int(count * _BATCH_S / duration_s)
        self._size = max(1, min(ideal, self._size * _GROWTH, _MOST_IN_BATCH))

    def _submit(self, task: _Task, lacking: list[str] | None = None) -> None:
        batch = packed([group.orders for group in task.groups])
        if lacking:
            batch["contents"] = {digest: content_of(batch["files"][digest][0]) for digest in lacking}
        with interrupts.held():
            try:
                future = self._executor.submit(flying.fly_all, batch)
            except Exception as error:  # noqa: BLE001 - each kind of executor has its own exceptions
                why = (str(error) or type(error).__name__).rstrip(".")
                raise Error(f"the executor accepts no more missions: {why}. The same command continues with another executor", "system_failure") from None
            self._out[future] = task
            future.add_done_callback(self._done.put)


def _problem_of(future: Future) -> BaseException | None:
    try:
        return future.exception()
    except concurrent.futures.CancelledError as error:  # Dask raises this error after the end of its scheduler
        return error


def _told(order: Order) -> str:
    return ", ".join(f"{name} = {value}" for name, value in order["settings"].items()) or "no settings"
