# SPDX-License-Identifier: Apache-2.0
"""Controls mission processes. Executors call ``fly_all``, which executes orders in a process of the calling thread. A crash of an FMU ends
only this process, not the executor's worker."""

from __future__ import annotations

import contextlib
import json
import os
import pathlib
import re
import select
import signal
import subprocess
import sys
import tempfile
import threading
import time
from typing import Any

from mebots.exploration import outcomes
from mebots.exploration.inputs import digest_of_input, stamp_of, write_content
from mebots.exploration.missions import build, without_paths
from mebots.exploration.orders import Batch, Order, unpacked
from mebots.exploration.replies import reply_of

ATTEMPTS = 3
"""The number of attempts for a mission whose process crashes, because a crash may be random."""
_LOOK_EVERY_S = 0.25
_STALLED_AFTER_S = 60.0
_STALLED_AFTER_LEAST_S = 5.0
_MOST_WORDS = 2000
_ADDRESS = re.compile(r"0x[0-9a-fA-F]+")
_TICKS = os.sysconf("SC_CLK_TCK")


class Lost(Exception):
    """Raised if the process ended during a mission. The text describes the end. ``is_outcome`` is False if the cause was outside the
    mission."""

    def __init__(self, text: str, *, is_outcome: bool = True) -> None:
        super().__init__(text)
        self.is_outcome = is_outcome


class MissionProcess:
    """Runs missions in a separate process. Not thread-safe."""

    def __init__(self) -> None:
        life, self._life = os.pipe()
        self._records, out = os.pipe()
        self._last_words = tempfile.TemporaryFile("a+b")
        environment = dict(os.environ)
        package = str(pathlib.Path(__file__).resolve().parents[2])
        environment["PYTHONPATH"] = os.pathsep.join([package, *filter(None, [environment.get("PYTHONPATH")])])
        environment["TMPDIR"] = folder = _folder()  # deleted after the process is killed, with its unpacked FMUs
        self._process = subprocess.Popen(
            [sys.executable, "-m", "mebots.exploration.worker", str(life), str(out), folder],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,  # an FMU may print
            stderr=self._last_words,  # such as the message of an assertion
            pass_fds=(life, out),
            start_new_session=True,  # the parent decides how to handle Ctrl-C
            env=environment,
        )
        os.close(life)
        os.close(out)
        self._rest = b""
        self._closed = False
        try:
            self._line(None)
        except Lost:
            self.close()
            raise

    def fly(self, order: Order) -> dict[str, Any]:
        """Runs a mission and returns its record. Raises Lost if the process ends without a result; afterwards, this object is unusable."""
        assert self._process.stdin is not None
        self._last_words.truncate(0)
        try:
            self._process.stdin.write(json.dumps(order).encode() + b"\n")
            self._process.stdin.flush()
        except OSError:
            raise self._lost() from None
        limit_s = order.get("processor_time")
        record = self._line(limit_s)
        if "bug" in record:
            raise AssertionError(record["bug"])
        if "unfinished" not in record and limit_s is not None and record["processor_time"] > limit_s:
            return failed(order, *_over(limit_s))
        return record

    def end(self) -> None:
        """Ends the process. Thread-safe. A thread that waits for a record raises Lost."""
        with contextlib.suppress(OSError):
            os.killpg(self._process.pid, signal.SIGKILL)

    def close(self) -> None:
        if self._closed:
            return
        self._closed = True
        self.end()
        self._process.wait()
        self._last_words.close()
        for descriptor in (self._life, self._records):
            with contextlib.suppress(OSError):
                os.close(descriptor)
        if self._process.stdin is not None:
            with contextlib.suppress(OSError):
                self._process.stdin.close()

    def _line(self, limit_s: float | None) -> dict[str, Any]:
        # Reads processor times only after the first wait. Most missions are then finished, and their records contain the time.
        begun_s = last_s = None
        moved_at = time.monotonic()
        # Only this limit uses the wall clock, because a call that never returns may use no processor time.
        patience_s = _STALLED_AFTER_S if limit_s is None else max(_STALLED_AFTER_LEAST_S, limit_s)
        while b"\n" not in self._rest:
            if select.select([self._records], [], [], _LOOK_EVERY_S)[0]:
                block = os.read(self._records, 1 << 16)
                if not block:
                    raise self._lost()
                self._rest = (self._rest + block).lstrip(b"\n")  # an empty line reports that the process waits for another process
                moved_at = time.monotonic()
                continue
            now_s = self._processor_time_s()
            if begun_s is None or last_s is None:
                begun_s = last_s = now_s
            if limit_s is not None and now_s - begun_s > limit_s:
                raise TooLong(limit_s)
            if now_s != last_s:
                last_s, moved_at = now_s, time.monotonic()
            elif time.monotonic() - moved_at > patience_s:
                raise Lost(f"it made no progress for {patience_s:g} s")
        line, _, self._rest = self._rest.partition(b"\n")
        return json.loads(line)

    def _processor_time_s(self) -> float:
        """Returns the processor time of the process and its descendants. Forks run the missions and start processes of isolated
        instances."""
        return _ticks_of_all(self._process.pid) / _TICKS

    def _lost(self) -> Lost:
        try:
            code = self._process.wait(5)
        except subprocess.TimeoutExpired:
            return Lost("it closed its output")
        text = f"it ended with exit code {code}" if code >= 0 else f"it ended by {_name_of(-code)}"
        size = self._last_words.seek(0, os.SEEK_END)
        self._last_words.seek(max(0, size - _MOST_WORDS))
        words = self._last_words.read().decode(errors="replace").strip().splitlines()
        if words:  # without paths and addresses, the text is the same on every machine
            text = f"{text}: {_ADDRESS.sub('0x...', without_paths(words[-1]))}"
        return Lost(text, is_outcome=not outcomes.is_outside_signal(-code) and not outcomes.describes_system_error("\n".join(words)))


def _name_of(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


class TooLong(Lost):
    def __init__(self, limit_s: float) -> None:
        super().__init__(_over(limit_s)[0])
        self.limit_s = limit_s


def _over(limit_s: float) -> tuple[str, str]:
    return f"it needed more than its limit of {limit_s:g} s of processor time", "fmu_timeout"


def _ticks_of_all(process: int) -> int:
    """Returns the processor time of a process and all its descendants, including ended ones."""
    total = _ticks_of(process)
    with contextlib.suppress(OSError):
        for task in os.listdir(f"/proc/{process}/task"):
            with contextlib.suppress(OSError), open(f"/proc/{process}/task/{task}/children", encoding="ascii") as children:
                total += sum(_ticks_of_all(int(child)) for child in children.read().split())
    return total


def _ticks_of(process: int) -> int:
    """Returns user and system time of a process and its ended children. Returns 0 if the process has ended."""
    with contextlib.suppress(OSError, IndexError), open(f"/proc/{process}/stat", encoding="utf-8") as stat:
        return sum(int(word) for word in stat.read().rpartition(")")[2].split()[11:15])
    return 0


def failed(order: Order, error: str, code: str) -> dict[str, Any]:
    """Returns a record for a mission whose process wrote none."""
    return {"mission": order["mission"], "flown_by": order["build"], "outcome": "failed", "error": error, "code": code}


_mine = threading.local()
_all: set[MissionProcess] = set()
_closing = threading.Event()
_lock = threading.Lock()
_place: tempfile.TemporaryDirectory[str] | None = None


_PREFIX = "mebots-sweep-"
_LEFT_BEHIND_S = 600.0


def _remove_empty_folders() -> None:
    """Removes the empty folders of killed runs. Running missions fill their folders within a second."""
    with contextlib.suppress(OSError), os.scandir(tempfile.gettempdir()) as entries:
        for entry in entries:
            if entry.name.startswith(_PREFIX):
                with contextlib.suppress(OSError):  # in use, or of another user
                    if time.time() - entry.stat(follow_symlinks=False).st_mtime > _LEFT_BEHIND_S:
                        os.rmdir(entry.path)


def _folder() -> str:
    """Returns the folder for temporary files and shared states of mission processes. This process deletes it, because mission processes may
    be killed."""
    global _place
    with _lock:
        if _place is None:
            _remove_empty_folders()
            _place = tempfile.TemporaryDirectory(prefix=_PREFIX, ignore_cleanup_errors=True)
        return _place.name


def fly_all(batch: Batch) -> dict[str, Any]:
    """Executes a batch in the mission process of the calling thread. Returns the results (``replies.py``), the ``unfinished`` missions with
    reasons, and ``duration_s``. If this machine lacks files, returns ``{"lacks": [hashes]}``; the next batch may contain them under
    ``contents``. If the batch is from another build of MEbots, returns this machine's ``build``, because its results could differ."""
    if batch["shared"]["build"] != build():
        return {"build": build()}
    lacking = _find_files(batch)
    if lacking:
        return {"lacks": lacking}
    begun_s = time.monotonic()
    records = [fly(order) for order in unpacked(batch)]
    unfinished = {record["mission"]: record["unfinished"] for record in records if "unfinished" in record}
    reply = reply_of([record for record in records if "unfinished" not in record])
    return reply | {"unfinished": unfinished, "duration_s": time.monotonic() - begun_s}


def fly(order: Order) -> dict[str, Any]:
    """Executes an order whose files are on this machine. Returns the record, or ``{"mission", "unfinished": why}`` if a cause outside the
    mission ended it."""
    for attempt in range(1, ATTEMPTS + 1):
        if _closing.is_set():
            raise RuntimeError("the study is over")
        try:
            return _my_process().fly(order)
        except TooLong as error:
            _drop_my_process()
            return failed(order, *_over(error.limit_s))
        except Lost as error:
            _drop_my_process()
            if not error.is_outcome:
                return {"mission": order["mission"], "unfinished": f"the mission's process was lost: {error}"}
            if attempt == ATTEMPTS:
                return failed(order, f"the mission's process was lost: {error}", "fmu_lost")
        except OSError as error:  # the process could not start
            return {"mission": order["mission"], "unfinished": outcomes.text_of(error)}
    raise AssertionError("unreachable")


def _my_process() -> MissionProcess:
    if getattr(_mine, "process", None) is None:
        process = MissionProcess()
        with _lock:
            is_late = _closing.is_set()
            if not is_late:
                _all.add(process)
        if is_late:  # end_all did not include this process
            process.close()
            raise RuntimeError("the study is over")
        _mine.process = process
    return _mine.process


def _drop_my_process() -> None:
    process, _mine.process = getattr(_mine, "process", None), None
    if process is None:  # the process could not start
        return
    with _lock:
        _all.discard(process)
    process.close()


def ready() -> None:
    """Permits mission processes again after ``end_all``."""
    _closing.clear()


def end_all() -> list[MissionProcess]:
    """Ends all mission processes of this process and returns them. The caller must pass them to ``close_ended`` after all threads have
    stopped waiting for them."""
    _closing.set()
    with _lock:
        processes = list(_all)
        _all.clear()
    for process in processes:
        process.end()
    return processes


def close_ended(processes: list[MissionProcess]) -> None:
    """Waits for the exit of ended mission processes and deletes their files."""
    global _place
    for process in processes:
        process.close()
    with _lock:
        place, _place = _place, None
    if place is not None:
        place.cleanup()


def close_all() -> None:
    """Ends all mission processes of this process and deletes their files. No other thread may use them."""
    close_ended(end_all())


# Files by hash.

_known: dict[tuple[str, Any], str] = {}


def cache_folder() -> pathlib.Path:
    """Returns the folder for files that arrived with orders."""
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return pathlib.Path(base) / "mebots" / "inputs"


def _find_files(batch: Batch) -> list[str]:
    """Finds the files of a batch on this machine, and stores their paths in the batch. Returns the hashes of missing files."""
    contents = batch.pop("contents", {})
    lacking = []
    for digest, place in batch["files"].items():
        if _is(place[0], digest):
            continue
        cached = cache_folder() / digest / place[1]
        if digest in contents and not _is(str(cached), digest):
            write_content(cached, contents[digest])
        if _is(str(cached), digest):
            place[0] = str(cached)
        else:
            lacking.append(digest)
    return lacking


def _is(path: str, digest: str) -> bool:
    """True if the file or folder has this hash. Caches the result while times and sizes stay the same."""
    try:
        key = path, stamp_of(path)
    except OSError:
        return False
    if key not in _known:
        _known[key] = digest_of_input(path)
    return _known[key] == digest
