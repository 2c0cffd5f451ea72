# SPDX-License-Identifier: Apache-2.0
"""What was flown, on disk: a line of JSON a mission. A line is with the system, which outlives any process, before anybody
counts on it; several times a second, and before tables are written, the system puts it on the disk."""

from __future__ import annotations

import collections
import contextlib
import fcntl
import json
import os
import pathlib
import time
from collections.abc import Iterable
from typing import Any

from mebots.errors import Error, InputError

NAME = "journal.jsonl"

_SYNC_EVERY_S = 0.25
"""A synchronisation takes milliseconds, in which nobody gives out missions."""

Record = dict[str, Any]


class Journal:
    """The records of a folder by their mission's hash. Keeps where they stand, not what they say: memory grows with the
    number of missions alone. One process at a time writes; a line that a kill tore is cut off."""

    def __init__(self, folder: pathlib.Path, *, writable: bool = True) -> None:
        self.file = folder / NAME
        self._places: dict[bytes, int] = {}
        self._builds: collections.Counter[str] = collections.Counter()
        flags = os.O_RDWR | os.O_CREAT if writable else os.O_RDONLY
        try:
            self._stream = os.fdopen(os.open(self.file, flags | os.O_CLOEXEC, 0o666), "r+b" if writable else "rb")
        except OSError as error:
            raise InputError(f"{self.file}: {error.strerror}", "file_unwritable" if writable else "file_not_found") from None
        if writable:
            self._lock()
        self._synced_s = time.monotonic()
        end = self._read()
        if writable:
            self._stream.truncate(end)
        self._end = end

    def __len__(self) -> int:
        return len(self._places)

    def __contains__(self, mission: str) -> bool:
        return bytes.fromhex(mission) in self._places

    def find(self, mission: str) -> Record | None:
        """The last record of a mission."""
        place = self._places.get(bytes.fromhex(mission))
        if place is None:
            return None
        self._stream.seek(place)
        return json.loads(self._stream.readline())

    def of_other_builds(self, build: str) -> int:
        """How many of the records that were there at first are not this build's; older ones do not say whose they are."""
        return self._builds.total() - self._builds[build]

    def append(self, records: Iterable[Record]) -> None:
        """Returns when a kill of this process cannot undo it. Raises Error when they cannot be written."""
        lines = []
        places = {}
        end = self._end
        for record in records:
            line = json.dumps(record, separators=(",", ":")).encode() + b"\n"
            places[bytes.fromhex(record["mission"])] = end
            end += len(line)
            lines.append(line)
        try:
            self._stream.seek(self._end)
            self._stream.write(b"".join(lines))
            self._stream.flush()
        except OSError as error:
            raise Error(f"{self.file}: {error.strerror}", "file_unwritable") from None
        self._places |= places
        self._end = end
        if time.monotonic() - self._synced_s > _SYNC_EVERY_S:
            self.sync()

    def sync(self) -> None:
        """Returns when all is on the disk. Raises Error."""
        try:
            os.fdatasync(self._stream.fileno())
        except OSError as error:
            raise Error(f"{self.file}: {error.strerror}", "file_unwritable") from None
        self._synced_s = time.monotonic()

    def close(self) -> None:
        with contextlib.suppress(OSError):  # append() told of what could not be written
            self._stream.close()

    def _lock(self) -> None:
        try:
            fcntl.flock(self._stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise InputError(f"{self.file.parent}: another `mebots sweep` is at work in this folder", "file_unwritable") from None

    def _read(self) -> int:
        """Notes where the records stand. Returns where the last whole line ends."""
        end = 0
        for number, line in enumerate(self._stream, 1):
            if not line.endswith(b"\n"):
                break
            try:
                mission, build = _identity(line)
            except (ValueError, KeyError, TypeError):
                raise InputError(f"{self.file}:{number}: this is not a line of a journal; remove it", "syntax_error") from None
            self._places[mission] = end
            self._builds[build] += 1
            end += len(line)
        return end


def _identity(line: bytes) -> tuple[bytes, str]:
    """The mission, and the build that flew it. Raises ValueError, KeyError or TypeError for what is not a record."""
    record = json.loads(line)
    texts = (record["mission"], record["outcome"], record["error"])
    parts = (record.get("values", {}), record.get("finals", {}), record.get("series", {}))
    if not all(isinstance(one, str) for one in texts) or not all(isinstance(one, dict) for one in parts):
        raise ValueError
    return bytes.fromhex(record["mission"]), record.get("flown_by", "")
