# SPDX-License-Identifier: Apache-2.0
"""Stores states from which other missions start, by hash. The latest states are in memory. The others are on disk, for all mission
processes of the same parent. If a state was deleted, one process computes it again, and all other processes that need this state wait.
"""

from __future__ import annotations

import collections
import contextlib
import fcntl
import os
import pathlib
import time
from collections.abc import Callable, Iterator

_MOST_IN_MEMORY = 4
MOST_BYTES = 4 << 30
"""Maximum size on disk. The least recently used states are deleted first."""
_LOOK_EVERY_BYTES = MOST_BYTES // 64
"""A process checks the size of the folder each time it has written this many bytes. The check reads the size of every
state."""
_ASK_EVERY_S = 0.02
_SAY_EVERY_S = 1.0


class Pasts:
    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self._folder = pathlib.Path(folder)
        self._recent: collections.OrderedDict[str, bytes] = collections.OrderedDict()
        self._unseen_bytes = 0

    def find(self, name: str) -> bytes | None:
        if name in self._recent:
            self._recent.move_to_end(name)
            return self._recent[name]
        with contextlib.suppress(OSError):
            state = (self._folder / name).read_bytes()
            os.utime(self._folder / name)
            self._remember(name, state)
            return state
        return None

    def keep(self, name: str, state: bytes) -> None:
        self._remember(name, state)
        unfinished = self._folder / f"{name}.{os.getpid()}"
        with contextlib.suppress(OSError):  # without this file, the state is computed again
            try:
                unfinished.write_bytes(state)
                unfinished.replace(self._folder / name)
            except OSError:
                unfinished.unlink(missing_ok=True)
                raise
            self._unseen_bytes += len(state)
            if self._unseen_bytes > _LOOK_EVERY_BYTES:
                self._unseen_bytes = 0
                self._make_room()

    @contextlib.contextmanager
    def flown_by_me(self, name: str, waiting: Callable[[], None]) -> Iterator[None]:
        """Lets only one process compute a state. Other processes wait, call ``waiting`` repeatedly, and then find the saved state. If the
        process is killed, the next one computes the state."""
        file = self._folder / f"{name}.flying"
        try:
            lock = os.open(file, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        except OSError:  # then several processes may compute the state
            yield
            return
        try:
            said_s = -_SAY_EVERY_S
            while not _locked(lock):
                if time.monotonic() - said_s >= _SAY_EVERY_S:
                    said_s = time.monotonic()
                    waiting()
                time.sleep(_ASK_EVERY_S)
            yield
        finally:
            file.unlink(missing_ok=True)  # later processes find the state
            os.close(lock)

    def _remember(self, name: str, state: bytes) -> None:
        self._recent[name] = state
        self._recent.move_to_end(name)
        if len(self._recent) > _MOST_IN_MEMORY:
            self._recent.popitem(last=False)

    def _make_room(self) -> None:
        kept = []
        for file in os.scandir(self._folder):
            with contextlib.suppress(FileNotFoundError):  # another process also deletes the file
                stat = file.stat()
                kept.append((stat.st_mtime_ns, stat.st_size, file.path))
        total = sum(size for _, size, _ in kept)
        for _, size, path in sorted(kept):
            if total <= MOST_BYTES:
                return
            with contextlib.suppress(FileNotFoundError):
                os.unlink(path)
            total -= size


def _locked(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # the file system has no locks
        pass
    return True
