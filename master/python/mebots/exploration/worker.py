# SPDX-License-Identifier: Apache-2.0
"""Flies orders, one after the other: ``python -m mebots.exploration.worker LIFE OUT``.

Orders come on standard input and records go to the file descriptor OUT, a line of JSON each. The process ends when
nobody holds the other end of the descriptor LIFE any more, so none outlives who started it. FMUs are loaded once;
between missions their instances are made anew.
"""

from __future__ import annotations

import collections
import contextlib
import json
import math
import os
import sys
import tempfile
import threading
import time
import traceback
from typing import Any

from mebots import Error, Mission
from mebots.exploration.missions import FILE_MARK, Order, without_paths

_MOST_OPEN = 4  # configs whose FMUs stay loaded

class Worker:
    """Keeps missions open, by their config."""

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._open: collections.OrderedDict[str, tuple[Mission, str]] = collections.OrderedDict()

    def answer(self, order: Order) -> dict[str, Any]:
        """The record of a mission; of an order to ``check``, only what is wrong with it."""
        record: dict[str, Any] = {"mission": order.get("mission", ""), "outcome": "failed", "error": "", "code": ""}
        begun = time.process_time()
        try:
            mission = self._prepared(order)
            if order.get("check"):
                mission.start()
                self._try_wanted(mission, order)
                record["outcome"] = "checked"
            else:
                self._fly(mission, order, record)
        except Error as error:
            record["error"], record["code"] = _without_paths(str(error), order), error.code
        record["processor_time"] = round(time.process_time() - begun, 4)
        return record

    def _prepared(self, order: Order) -> Mission:
        places = {FILE_MARK + digest: path for digest, (path, _) in order["files"].items()}
        mission = self._mission(order["config"], places, bool(order["series"]))
        for name, value in order["settings"].items():
            mission.set(name, places.get(value, value) if isinstance(value, str) else value)
        mission.record([name for name, _ in order["series"]])
        return mission

    def _mission(self, config: str, places: dict[str, str], in_memory: bool) -> Mission:
        for mark, path in places.items():
            config = config.replace(json.dumps(mark), json.dumps(path))
        if config in self._open:
            self._open.move_to_end(config)
            mission, _ = self._open[config]
            mission.reset()
            return mission
        if len(self._open) >= _MOST_OPEN:
            _, (_, unused) = self._open.popitem(last=False)
            os.unlink(unused)
        descriptor, file = tempfile.mkstemp(".json", "mission", self._folder)
        with open(descriptor, "w", encoding="utf-8") as stream:
            stream.write(config)
        mission = Mission(file, in_memory=in_memory)
        self._open[config] = (mission, file)
        return mission

    @staticmethod
    def _try_wanted(mission: Mission, order: Order) -> None:
        for name in order["finals"]:
            mission.value(name)

    @staticmethod
    def _fly(mission: Mission, order: Order, record: dict[str, Any]) -> None:
        try:
            mission.run()
        finally:
            summary = mission.summary
            labels = json.loads(order["config"]).get("summary", {})
            record["outcome"] = mission.outcome or "failed"
            record["simulated_time"] = summary.get("simulated_time", 0.0)
            record["values"] = flat({key: summary[key] for key in labels if key in summary})
        record["finals"] = {name: mission.value(name) for name in order["finals"]}
        record["series"] = {f"{name} {how}": _reduced(mission, name, how) for name, how in order["series"]}


def flat(values: dict[str, Any], before: str = "") -> dict[str, Any]:
    """Nested labels as one, joined by dots."""
    result: dict[str, Any] = {}
    for key, value in values.items():
        result |= flat(value, f"{before}{key}.") if isinstance(value, dict) else {before + key: value}
    return result


def _reduced(mission: Mission, name: str, how: str) -> float:
    values = memoryview(mission._series(name)[1]).cast("d")
    if how == "mean":
        return math.fsum(values) / len(values)
    return {"min": min, "max": max, "first": lambda all: all[0], "last": lambda all: all[-1]}[how](values)


def _without_paths(text: str, order: Order) -> str:
    """A message that is the same on every machine: files by their names."""
    for path, name in order["files"].values():
        text = text.replace(path, name)
    return without_paths(text)


def _end_with(descriptor: int) -> None:
    with contextlib.suppress(OSError):
        os.read(descriptor, 1)
    os._exit(1)


def _answer(worker: Worker, order: Order) -> dict[str, Any]:
    try:
        return worker.answer(order)
    except Exception:  # not the mission's fault: who gave the order shows it
        return {"mission": order["mission"], "bug": traceback.format_exc()}


def main() -> None:
    life, out = int(sys.argv[1]), int(sys.argv[2])
    threading.Thread(target=_end_with, args=(life,), daemon=True).start()
    records = os.fdopen(out, "w", encoding="utf-8")
    with tempfile.TemporaryDirectory(prefix="mebots-worker-") as folder:
        worker = Worker(folder)
        print("{}", file=records, flush=True)  # ready: what comes now is the mission's time
        for line in sys.stdin:
            print(json.dumps(_answer(worker, json.loads(line))), file=records, flush=True)


if __name__ == "__main__":
    main()
