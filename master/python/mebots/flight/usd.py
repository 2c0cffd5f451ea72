# SPDX-License-Identifier: Apache-2.0
"""Reads the binary logs on a Crazyflie's micro-SD card (crazyflie-firmware, usddeck.c).

    byte       0xBC
    uint16     version: 1 = times in milliseconds (uint32), 2 = times in microseconds (uint64)
    uint16     number of kinds of events
    per kind   uint16 id; name, ended by a zero byte; uint16 number of variables; per variable "group.name(T)" and a
               zero byte, T = type in the letters of Python's struct module
    records    uint16 id of the event; time; the values of its variables, without padding
    uint32     CRC-32 of all bytes before it

All numbers are little-endian. A truncated log, such as that of a flight until the cell was empty, has no CRC.
"""

from __future__ import annotations

import dataclasses
import pathlib
import struct
import zlib
from collections.abc import Iterator, Mapping

import numpy as np

from mebots.errors import InputError
from mebots.flight.log import Array, FlightLog, log_of
from mebots.flight.names import CRAZYFLIE, Meaning, named

MAGIC = 0xBC
_TYPES = frozenset("BbHhIiQqfd?")
_TIMES = {1: ("<u4", 1e-3), 2: ("<u8", 1e-6)}
_REMEDY = "copy the log from the card again; the firmware's tools/usdlog writes this format"


@dataclasses.dataclass
class _Kind:
    name: str
    record: np.dtype
    offsets: list[int]


class _Reader:
    """Reads numbers and names of the log one after the other. ``at`` is the position of the next byte."""

    def __init__(self, file: pathlib.Path, data: bytes) -> None:
        self.file, self.data, self.at = file, data, 0

    def fail(self, text: str, at: int | None = None) -> InputError:
        return InputError(f"{self.file}: byte {self.at if at is None else at}: {text}; {_REMEDY}", "syntax_error")

    def uint16(self, what: str) -> int:
        if self.at + 2 > len(self.data):
            raise self.fail(f"the header ends where {what} is expected")
        (value,) = struct.unpack_from("<H", self.data, self.at)
        self.at += 2
        return value

    def name(self, what: str) -> str:
        end = self.data.find(b"\0", self.at)
        if end < 0:
            raise self.fail(f"{what} has no end")
        raw = self.data[self.at : end]
        try:
            text = raw.decode("ascii")
        except UnicodeDecodeError:
            raise self.fail(f"{what} {raw[:40]!r} is not text") from None
        self.at = end + 1
        return text


def read_usd(file: pathlib.Path, meanings: Mapping[str, Meaning] = {}) -> FlightLog:
    """Reads a log. ``meanings`` adds meanings of columns to the firmware's, and replaces those of equal names. If several columns have the same
    signal, those in ``meanings`` take precedence. Raises InputError if the log is invalid."""
    log = _parse(file)
    columns = ((name, times, values) for _, times, kind in _tables(log) for name, values in kind.items())
    return log_of(file, "Crazyflie uSD log", named(columns, {**meanings, **CRAZYFLIE, **meanings}), log.notes)


def read_events(file: pathlib.Path) -> dict[str, dict[str, Array]]:
    """Returns the unchanged columns of each kind of event by name. ``time`` is in seconds. Raises InputError if the log is invalid."""
    return {event: {"time": times, **columns} for event, times, columns in _tables(_parse(file))}


@dataclasses.dataclass
class _Log:
    data: bytes
    kinds: dict[int, _Kind]
    version: int
    notes: list[str]


def _parse(file: pathlib.Path) -> _Log:
    data = file.read_bytes()
    if not data:
        raise InputError(f"{file}: the file is empty; {_REMEDY}", "syntax_error")
    reader = _Reader(file, data)
    kinds, version = _header(reader)
    whole = len(data) - reader.at >= 4 and zlib.crc32(data[:-4]) == struct.unpack("<I", data[-4:])[0]
    end = len(data) - 4 if whole else len(data)
    stop = _walk(reader, kinds, end, whole)
    notes = []
    if not whole:
        rest = f", and {end - stop} bytes from byte {stop} on are left out" if stop < end else ""
        notes.append(f"the checksum at the end does not match: the log was cut off or changed{rest}")
    return _Log(data, kinds, version, notes)


def _header(reader: _Reader) -> tuple[dict[int, _Kind], int]:
    if reader.data[0] != MAGIC:
        raise reader.fail(f"a Crazyflie log starts with byte 0xBC, this file with 0x{reader.data[0]:02X}")
    reader.at = 1
    version = reader.uint16("the version")
    if version not in _TIMES:
        raise reader.fail(f"version {version} of the format is not known, only 1 and 2", 1)
    kinds: dict[int, _Kind] = {}
    for _ in range(reader.uint16("the number of events")):
        at = reader.at
        number = reader.uint16("the id of an event")
        if number in kinds:
            raise reader.fail(f"two kinds of events have the id {number}", at)
        name = reader.name("the name of an event")
        fields = [_field(reader) for _ in range(reader.uint16("the number of variables"))]
        if len({field for field, _ in fields}) < len(fields):
            raise reader.fail(f"the event {name} has a variable twice", at)
        kinds[number] = _Kind(name, np.dtype([(" id", "<u2"), (" time", _TIMES[version][0]), *fields]), [])
    return kinds, version


def _field(reader: _Reader) -> tuple[str, str]:
    at = reader.at
    text = reader.name("the name of a variable")
    name, letter = text[:-3], text[-2:-1]
    if len(text) < 4 or text[-3] != "(" or text[-1] != ")" or letter not in _TYPES:
        raise reader.fail(f"the variable {text!r} must end in its type, such as '(f)'", at)
    return name, "<" + letter


def _walk(reader: _Reader, kinds: dict[int, _Kind], end: int, whole: bool) -> int:
    """Stores the positions of records. Returns the end of the last complete record."""
    data, at = reader.data, reader.at
    while at + 2 <= end:
        (number,) = struct.unpack_from("<H", data, at)
        kind = kinds.get(number)
        if kind is None:
            if whole:
                raise reader.fail(f"a record has the id {number}, which is not in the header", at)
            return at
        if at + kind.record.itemsize > end:
            if whole:
                raise reader.fail(f"the last record, of the event {kind.name}, is incomplete", at)
            return at
        kind.offsets.append(at)
        at += kind.record.itemsize
    return at


def _tables(log: _Log) -> Iterator[tuple[str, Array, dict[str, Array]]]:
    """Yields name, times and columns of each kind of event with records."""
    raw = np.frombuffer(log.data, np.uint8)
    for kind in log.kinds.values():
        if not kind.offsets:
            continue
        size = kind.record.itemsize
        places = np.array(kind.offsets)[:, None] + np.arange(size)
        records = np.ascontiguousarray(raw[places]).view(kind.record)[:, 0]
        times = records[" time"].astype(np.float64) * _TIMES[log.version][1]
        yield kind.name, times, {name: records[name].astype(np.float64) for name in kind.record.names[2:]}
