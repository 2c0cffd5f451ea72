# SPDX-License-Identifier: Apache-2.0
"""Stores results of missions on disk, one line of JSON each. A mission is done when its line is in the operating system's cache, which
survives the end of any process. The file is synchronised with the disk several times a second, and before tables are written.

The last member of a line is the CRC-32 of the preceding bytes. A line with a wrong checksum is reported and ignored.
"""

from __future__ import annotations

import collections
import contextlib
import errno
import fcntl
import json
import os
import pathlib
import re
import time
import zlib
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from mebots.errors import Error, InputError
from mebots.exploration import files

NAME = "journal.jsonl"

_SYNC_EVERY_S = 0.25
"""The time between two synchronisations. Each takes milliseconds, during which no mission is started."""
_BLOCK_BYTES = 8 << 20
_WINDOW_BYTES = 1 << 16
_decoded = json.JSONDecoder().decode
_encoded = json.JSONEncoder(separators=(",", ":")).encode
_MOST_NAMED = 10
"""The number of damaged lines that are listed. If there are more, only their number is reported."""

Record = dict[str, Any]

# Parts of a line in the current format of the journal.
_MISSION = b'{"mission":"'
_BUILD = b'","flown_by":"'
_DIGEST = 64
_BUILD_AT = len(_MISSION) + _DIGEST + len(_BUILD)
_SUM = re.compile(rb',"crc32":"([0-9a-f]{8})"}\n$')
_DIGITS = np.array([int(chr(byte), 16) if chr(byte) in "0123456789abcdef" else 0 for byte in range(256)], np.uint64)
_SUM_BYTES = len(b',"crc32":"01234567"}\n')


def line_of(record: Record) -> bytes:
    """Returns the line of a record with its checksum."""
    body = _encoded(record).encode()[:-1]
    return b'%b,"crc32":"%08x"}\n' % (body, zlib.crc32(body))


def record_of(line: bytes) -> Record:
    """Parses a line. Raises ValueError if the checksum is wrong."""
    body = line[:-_SUM_BYTES]
    if line[-11:-3] != b"%08x" % zlib.crc32(body):
        raise ValueError("the checksum of a record is wrong")
    record: Record = _decoded(body.decode() + "}")
    return record


def key_of(mission: str) -> int:
    """Returns the part of a mission's hash that is the journal's search key."""
    return int(mission[:16], 16)


class Places:
    """Stores the positions of lines in the file by the keys of their missions, in 16 bytes per mission. The lists are sorted by key, and a
    later list contains later lines. Merges the last two lists until each list is more than twice as long as the next one. If missions share
    a key, returns all their positions, the latest first."""

    def __init__(self) -> None:
        self._runs: list[tuple[np.ndarray, np.ndarray]] = []
        self.count = 0

    def add_all(self, keys: np.ndarray, places: np.ndarray) -> None:
        if not len(keys):
            return
        self._runs.append(_sorted(keys, places))
        while len(self._runs) > 1 and len(self._runs[-2][0]) <= 2 * len(self._runs[-1][0]):
            last = self._runs.pop()
            before = self._runs.pop()
            self._runs.append(_sorted(*(np.concatenate(pair) for pair in zip(before, last, strict=True))))
        self.count += len(keys)

    def find(self, key: int) -> Iterator[int]:
        for keys, places in reversed(self._runs):
            at = int(np.searchsorted(keys, np.uint64(key), side="right")) - 1
            while at >= 0 and keys[at] == key:
                yield int(places[at])
                at -= 1

    def may_have(self, wanted: np.ndarray) -> np.ndarray:
        """Returns for each key whether a line has this key."""
        found = np.zeros(len(wanted), bool)
        for keys, _ in self._runs:
            at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
            found |= keys[at] == wanted
        return found


def _sorted(keys: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(keys, kind="stable")  # among equal keys, the latest stays last
    return keys[order], places[order]


def keys_of(digests: Sequence[bytes]) -> np.ndarray:
    """Returns the search key (``key_of``) of each mission."""
    return np.frombuffer(b"".join(digests), ">u8")[::4].astype(np.uint64)


class Journal:
    """The records of a folder by the hash of their mission. Keeps only their places in memory. Only one process at a time may write.
    Removes an incomplete last line of a killed process. ``notices`` contains texts for the user."""

    def __init__(self, folder: pathlib.Path, *, writable: bool = True) -> None:
        self.file = folder / NAME
        self.notices: list[str] = []
        self._places = Places()
        self._builds: collections.Counter[str] = collections.Counter()
        self._window = (0, b"")
        flags = os.O_RDWR | os.O_CREAT if writable else os.O_RDONLY
        try:
            self._descriptor = os.open(self.file, flags | os.O_CLOEXEC, 0o666)
        except OSError as error:
            raise InputError(f"{self.file}: {error.strerror}", "file_unwritable" if writable else "file_not_found") from None
        try:
            if writable:
                self._lock()
            self._synced_s = time.monotonic()
            self._end = self._read()
            if writable:
                os.ftruncate(self._descriptor, self._end)
        except OSError as error:
            self._abandon()
            raise Error(f"{self.file}: {error.strerror}", "file_unreadable") from None
        except Error:
            self._abandon()
            raise

    def __len__(self) -> int:
        return self._places.count

    def __contains__(self, mission: str) -> bool:
        return self.find(mission) is not None

    def find(self, mission: str) -> Record | None:
        """Returns the last record of a mission, or None."""
        place = self.place_of(mission)
        return None if place is None else self.at(place)

    def place_of(self, mission: str) -> int | None:
        start = _MISSION + mission.encode()
        for place in self._places.find(key_of(mission)):
            line = self._line(place)
            if line.startswith(start) or json.loads(line)["mission"] == mission:
                return place
        return None

    def may_have(self, digests: Sequence[bytes]) -> np.ndarray:
        """Returns an array that is False for missions without a record. For many missions, this is much faster than ``find``."""
        return self._places.may_have(keys_of(digests))

    def at(self, place: int) -> Record:
        """Returns the record whose line starts at ``place``."""
        record: Record = json.loads(self._line(place))
        record.pop("crc32", None)
        return record

    def of_other_builds(self, build: str) -> int:
        """Returns the number of records of other builds when the journal was opened. Old records lack their build."""
        return self._builds.total() - self._builds[build]

    def append(self, records: Iterable[Record]) -> list[int]:
        """Appends the lines of records, as ``append_lines`` does."""
        records = list(records)
        lines = [line_of(record) for record in records]
        digests = [bytes.fromhex(record["mission"]) for record in records]
        return self.append_lines(digests, b"".join(lines), np.array([len(line) for line in lines], np.int64)).tolist()

    def append_lines(self, digests: Sequence[bytes], lines: bytes, lengths: np.ndarray) -> np.ndarray:
        """Appends lines of missions and returns their places. The lines then survive even if this process is killed. If writing fails,
        raises Error and leaves the journal unchanged."""
        try:
            os.lseek(self._descriptor, self._end, os.SEEK_SET)
            files.write_all(self._descriptor, lines)
        except OSError as error:
            with contextlib.suppress(OSError):  # the next call truncates an incomplete line
                os.ftruncate(self._descriptor, self._end)
            raise Error(f"{self.file}: {error.strerror}", "file_unwritable") from None
        ends = self._end + np.cumsum(lengths)
        places = ends - lengths
        self._end += len(lines)
        self._places.add_all(keys_of(digests), places.astype(np.uint64))
        if time.monotonic() - self._synced_s > _SYNC_EVERY_S:
            self.sync()
        return places

    def sync(self) -> None:
        """Waits until all lines are on the disk. Raises Error if this fails."""
        try:
            os.fdatasync(self._descriptor)
        except OSError as error:
            raise Error(f"{self.file}: {error.strerror}", "file_unwritable") from None
        self._synced_s = time.monotonic()

    def close(self) -> None:
        """Closes the file. Raises Error if this fails, because some file systems report a full disk only here. A second call has no
        effect."""
        descriptor, self._descriptor = self._descriptor, -1
        try:
            if descriptor >= 0:
                files.close(descriptor)
        except OSError as error:
            raise Error(f"{self.file}: {error.strerror}", "file_unwritable") from None

    def _abandon(self) -> None:
        with contextlib.suppress(OSError):
            os.close(self._descriptor)

    def _lock(self) -> None:
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(f"{self.file.parent}: another `mebots sweep` uses this folder", "file_unwritable") from None
        except OSError as error:
            if error.errno not in (errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOLCK, errno.EINVAL):
                raise
            self.notices.append(
                f"{self.file.parent}: this file system cannot lock files ({error.strerror}). Make sure that no other `mebots sweep` "
                "works in this folder"
            )

    def _line(self, place: int) -> bytes:
        """Returns the line that starts at ``place``. Reads a larger part of the file at once, because the next line is usually near."""
        begin, window = self._window
        if begin <= place < begin + len(window):
            end = window.find(b"\n", place - begin)
            if end >= 0:
                return window[place - begin : end + 1]
        size = _WINDOW_BYTES
        while True:
            try:
                window = os.pread(self._descriptor, size, place)
            except OSError as error:
                raise Error(f"{self.file}: {error.strerror}", "file_unreadable") from None
            end = window.find(b"\n")
            if end >= 0:
                self._window = (place, window)
                return window[: end + 1]
            if len(window) < size:
                raise Error(f"{self.file}: the file became shorter while it was in use", "file_unreadable")
            size *= 2

    # Opening.

    def _read(self) -> int:
        """Finds the places of all records. Returns the end of the last complete line."""
        scan = _Scan()
        keys, places = [], []
        place, rest, size = 0, b"", 0
        while block := os.pread(self._descriptor, _BLOCK_BYTES, size):
            size += len(block)
            whole, newline, tail = block.rpartition(b"\n")
            if not newline:
                rest += block
                continue
            text = rest + whole + newline
            rest = tail
            found = scan.lines(text, place)
            keys.append(found[0])
            places.append(found[1])
            place += len(text)
        if place and not any(len(one) for one in keys):
            raise InputError(
                f"{self.file}: this is not a journal of `mebots sweep`: no line is a record. Move it away, or choose another folder",
                "syntax_error",
            )
        if keys:
            self._places.add_all(np.concatenate(keys), np.concatenate(places))
        self._builds = scan.builds
        self.notices += [f"{self.file}:{number}: this line is damaged ({why}); its mission runs again" for number, why in scan.damaged]
        if scan.damaged_count > len(scan.damaged):
            self.notices.append(f"{self.file}: {scan.damaged_count} lines are damaged; their missions run again")
        return place


class _Scan:
    """Checks the lines of a journal, and finds the key, the position and the build of each. Reads lines in the current format with NumPy,
    and all others one by one."""

    def __init__(self) -> None:
        self.builds: collections.Counter[str] = collections.Counter()
        self.damaged: list[tuple[int, str]] = []
        self.damaged_count = 0
        self._number = 0
        self._summed = False
        """True after the first line with a checksum. Earlier versions wrote no checksums; this version always does."""

    def lines(self, text: bytes, place: int) -> tuple[np.ndarray, np.ndarray]:
        """Returns the keys of the valid lines in a text, and their positions in the file. ``place`` is the position of the text."""
        data = np.frombuffer(text, np.uint8)
        ends = np.flatnonzero(data == ord("\n")) + 1
        begins = np.concatenate([[0], ends[:-1]])
        usual = self._usual(data, begins, ends)
        sums = [zlib.crc32(text[begin : end - _SUM_BYTES]) for begin, end in zip(begins[usual].tolist(), ends[usual].tolist(), strict=True)]
        stored = _hex(data, ends[usual] - 11, 8)
        right = np.zeros(len(begins), bool)
        right[usual] = np.array(sums, np.uint64) == stored
        keys = np.zeros(len(begins), np.uint64)
        keys[right] = _hex(data, begins[right] + len(_MISSION), 16)
        self._count_builds(data, begins[right])
        first = int(np.argmax(right)) if right.any() else len(begins)
        for at in np.flatnonzero(~right).tolist():
            key = self._key_of(text[begins[at] : ends[at]], self._number + at + 1, self._summed or at > first)
            if key is not None:
                keys[at], right[at] = key, True
        self._summed = self._summed or first < len(begins)
        self._number += len(begins)
        return keys[right], (begins[right] + place).astype(np.uint64)

    @staticmethod
    def _usual(data: np.ndarray, begins: np.ndarray, ends: np.ndarray) -> np.ndarray:
        """Returns the indices of lines in the current format, which have all fixed characters at their positions."""
        usual = np.flatnonzero(ends - begins > _BUILD_AT + _DIGEST + _SUM_BYTES)
        marks = ((begins, 0, _MISSION), (begins, len(_MISSION) + _DIGEST, _BUILD), (ends, -_SUM_BYTES, b',"crc32":"'), (ends, -3, b'"}\n'))
        for start, offset, mark in marks:
            usual = usual[_have(data, start[usual] + offset, np.frombuffer(mark, np.uint8))]
        return usual

    def _count_builds(self, data: np.ndarray, begins: np.ndarray) -> None:
        while len(begins):  # one iteration per build
            first = data[begins[0] + _BUILD_AT :][:_DIGEST]
            same = _have(data, begins + _BUILD_AT, first)
            self.builds[first.tobytes().decode("latin-1")] += int(same.sum())
            begins = begins[~same]

    def _key_of(self, line: bytes, number: int, summed: bool) -> int | None:
        found = _SUM.search(line)
        try:
            if found is None and summed:
                raise ValueError("it has no checksum")
            if found is not None and zlib.crc32(line[: found.start()]) != int(found[1], 16):
                raise ValueError("its checksum is wrong")
            mission, build = _identity(line)
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            self.damaged_count += 1
            if len(self.damaged) < _MOST_NAMED:
                why = str(error) if type(error) is ValueError else "it is not a record"
                self.damaged.append((number, why))
            return None
        self.builds[build] += 1
        return key_of(mission)


def _have(data: np.ndarray, begins: np.ndarray, mark: np.ndarray) -> np.ndarray:
    """Returns for each position in ``begins`` whether the bytes ``mark`` are there."""
    same = np.ones(len(begins), bool)
    for offset, byte in enumerate(mark.tolist()):
        same &= data[begins + offset] == byte
    return same


def _hex(data: np.ndarray, begins: np.ndarray, digits: int) -> np.ndarray:
    """Returns for each position in ``begins`` the number that has ``digits`` hexadecimal digits there."""
    result = np.zeros(len(begins), np.uint64)
    for offset in range(digits):
        result = (result << np.uint64(4)) | _DIGITS[data[begins + offset]]
    return result


def _identity(line: bytes) -> tuple[str, str]:
    """Returns the mission of a line and the build that ran it. Raises an error if the line is not a record."""
    record = json.loads(line)
    texts = (record["mission"], record["outcome"], record["error"])
    parts = (record.get("values", {}), record.get("finals", {}), record.get("series", {}))
    if not all(isinstance(one, str) for one in texts) or not all(isinstance(one, dict) for one in parts):
        raise TypeError
    if len(bytes.fromhex(record["mission"])) * 2 != _DIGEST:
        raise TypeError
    return record["mission"], record.get("flown_by", "")
