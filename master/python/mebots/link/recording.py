# SPDX-License-Identifier: Apache-2.0
"""Reads and writes recordings: the packets that drones received and their simulated times. A recording can repeat the run.

A recording has one line of JSON for the settings, one per packet, and one for the end:

    {"mebots": "0.2.0", "drones": 1, "spacing": 1.0, "decks": ["bcFlow2"], "set": {}, "stop_time": null}
    {"ms": 1230, "drone": 1, "packet": "ff"}
    {"end_ms": 62000, "bits": "41f9c6d14ff0d9e8"}
"""

from __future__ import annotations

import dataclasses
import json
import pathlib
from typing import IO, Any, NamedTuple

from mebots._mebots import __version__
from mebots.errors import InputError
from mebots.link.control import PERIOD_MS
from mebots.link.crtp import Packet
from mebots.link.session import Settings

FILE = "link.jsonl"
MOST_BYTES = 1 << 30


class Event(NamedTuple):
    time_ms: int
    drone: int  # index, starting at 0
    packet: Packet


@dataclasses.dataclass(frozen=True)
class Recording:
    settings: Settings
    events: list[Event]
    end_ms: int | None  # None if the run was killed
    bits: str | None


class Recorder:
    """Writes a recording. ``write`` buffers lines, ``flush`` writes them to the file.

    :param most_bytes: size from which ``is_full`` is True. The end of the recording still fits.
    """

    def __init__(self, file: pathlib.Path, settings: Settings, most_bytes: int = MOST_BYTES) -> None:
        self._file: IO[str] = open(file, "w", encoding="ascii")  # noqa: SIM115: it is open as long as the server runs
        self._most_bytes = most_bytes
        self._bytes = 0
        self._line({"mebots": __version__, **dataclasses.asdict(settings)})

    @property
    def is_full(self) -> bool:
        return self._bytes >= self._most_bytes

    def write(self, event: Event) -> None:
        self._line({"ms": event.time_ms, "drone": event.drone + 1, "packet": event.packet.encode().hex()})

    def flush(self) -> None:
        self._file.flush()

    def close(self, end_ms: int, bits: str) -> None:
        self._line({"end_ms": end_ms, "bits": bits})
        self._file.close()

    def _line(self, content: dict[str, Any]) -> None:
        self._bytes += self._file.write(json.dumps(content) + "\n")


def read_recording(file: pathlib.Path) -> Recording:
    """Reads a recording. Raises InputError with the line if the recording is invalid."""
    try:
        lines = file.read_text(encoding="ascii").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{file}: cannot be read: {error}", "file_unreadable") from None
    reader = _Reader(file)
    for number, line in enumerate(lines, start=1):
        reader.take(number, line, number == len(lines))
    if reader.settings is None:
        raise InputError(f"{file}: the recording is empty; name the {FILE} of a run", "invalid_value")
    return Recording(reader.settings, reader.events, reader.end_ms, reader.bits)


class _Reader:
    def __init__(self, file: pathlib.Path) -> None:
        self._file = file
        self.settings: Settings | None = None
        self.events: list[Event] = []
        self.end_ms: int | None = None
        self.bits: str | None = None

    def take(self, number: int, line: str, is_last: bool) -> None:
        try:
            content = json.loads(line)
            if self.settings is None:
                self.settings = _settings(content)
            elif self.end_ms is not None:
                raise ValueError("a line after the end")
            elif "end_ms" in content:
                self.end_ms, self.bits = self._time(content["end_ms"]), str(content["bits"])
            else:
                self.events.append(self._event(content))
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            if is_last and isinstance(error, json.JSONDecodeError) and self.settings is not None:
                return  # the killed run did not complete this line
            reason = f"key {error} is missing" if isinstance(error, KeyError) else error
            raise InputError(f"{self._file}:{number}: this is no line of a recording by `mebots link`: {reason}", "invalid_value") from None

    def _time(self, time_ms: Any) -> int:
        before = self.events[-1].time_ms if self.events else 0
        if not isinstance(time_ms, int) or time_ms < before or time_ms % PERIOD_MS != 0:
            raise ValueError(f"time {time_ms!r}: a multiple of {PERIOD_MS} ms from {before} is expected")
        return time_ms

    def _event(self, content: dict[str, Any]) -> Event:
        packet = Packet.parse(bytes.fromhex(content["packet"]))
        if packet is None:
            raise ValueError("the packet has no byte, or more than 31")
        if not isinstance(content["drone"], int) or content["drone"] < 1:
            raise ValueError(f"drone {content['drone']!r}: a number from 1 is expected")
        return Event(self._time(content["ms"]), content["drone"] - 1, packet)


def _settings(content: dict[str, Any]) -> Settings:
    names = [field.name for field in dataclasses.fields(Settings)]
    given = {name: content[name] for name in names}
    return Settings(**{**given, "decks": tuple(given["decks"])})
