# SPDX-License-Identifier: Apache-2.0
"""Handles parameters that a client reads and writes (port 2)."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

from mebots.link.crtp import Errno, Packet, Port
from mebots.link.scalars import Scalar
from mebots.link.toc import CHANNEL as TOC_CHANNEL
from mebots.link.toc import Toc

_READ_CHANNEL, _WRITE_CHANNEL, _OTHER_CHANNEL = 1, 2, 3
_SET_BY_NAME, _UPDATED, _EXTENDED, _STORE, _STORED, _CLEAR, _DEFAULT, _EXTENDED_2, _DEFAULT_2 = range(9)
_READ_ONLY, _HAS_EXTENDED = 0x40, 0x10
_PERSISTENT = 1


@dataclasses.dataclass(frozen=True)
class Parameter:
    group: str
    name: str
    scalar: Scalar
    default: float = 0
    read_only: bool = False
    persistent: bool = False

    @property
    def full_name(self) -> str:
        return f"{self.group}.{self.name}"

    @property
    def kind(self) -> int:
        """Returns the type byte in the table of contents."""
        return self.scalar.parameter_number | (_READ_ONLY if self.read_only else 0) | (_HAS_EXTENDED if self.persistent else 0)


class Parameters:
    """The parameters of a drone.

    :param changed: called with the full name after a client has written a value.
    """

    def __init__(self, parameters: Sequence[Parameter], changed: Callable[[str], None]) -> None:
        self._parameters = parameters
        self._numbers = {one.full_name: number for number, one in enumerate(parameters)}
        self._toc = Toc([(one.group, one.name, one.kind) for one in parameters])
        self._bytes = [one.scalar.pack(one.default) for one in parameters]
        self._stored: dict[int, bytes] = {}
        self._changed = changed
        self._updates: list[Packet] = []

    def __getitem__(self, full_name: str) -> float:
        number = self._numbers[full_name]
        return self._parameters[number].scalar.unpack(self._bytes[number])

    def set(self, full_name: str, value: float) -> None:
        """Changes a value without a request. ``updates`` then notifies the client."""
        number = self._numbers[full_name]
        self._bytes[number] = self._parameters[number].scalar.pack(value)
        self._updates.append(Packet(Port.PARAMETERS, _OTHER_CHANNEL, bytes([_UPDATED]) + number.to_bytes(2, "little") + self._bytes[number]))

    def updates(self) -> list[Packet]:
        """Returns and deletes the notifications since the last call."""
        packets, self._updates = self._updates, []
        return packets

    def handle(self, packet: Packet) -> list[Packet]:
        if packet.channel == TOC_CHANNEL:
            return self._toc.handle(packet)
        if packet.channel == _OTHER_CHANNEL:
            return self._other(packet)
        if len(packet.data) < 2:
            return []
        head, number = packet.data[:2], int.from_bytes(packet.data[:2], "little")
        if number >= len(self._parameters):
            return [packet.answer(head + bytes([Errno.NO_ENTRY]))]
        if packet.channel == _READ_CHANNEL:
            return [packet.answer(head + b"\0" + self._bytes[number])]
        if self._parameters[number].read_only or not self._write(number, packet.data[2:]):
            return []
        return [packet.answer(head + self._bytes[number]), *self._notify(number)]

    def _write(self, number: int, value: bytes) -> bool:
        """Writes a value. Returns False if the client sent too few bytes."""
        size = self._parameters[number].scalar.size
        if len(value) < size:
            return False
        self._bytes[number] = value[:size]
        return True

    def _notify(self, number: int) -> list[Packet]:
        self._changed(self._parameters[number].full_name)
        return self.updates()

    def _other(self, packet: Packet) -> list[Packet]:
        command = packet.data[0] if packet.data else -1
        if command == _SET_BY_NAME:
            return self._set_by_name(packet)
        if command not in (_EXTENDED, _STORE, _STORED, _CLEAR, _DEFAULT, _EXTENDED_2, _DEFAULT_2) or len(packet.data) < 3:
            return []
        head, number = packet.data[:3], int.from_bytes(packet.data[1:3], "little")
        if number >= len(self._parameters):
            return [packet.answer(head + bytes([Errno.NO_ENTRY]))]
        return [packet.answer(head + self._about(command, number))]

    def _about(self, command: int, number: int) -> bytes:
        parameter = self._parameters[number]
        default = parameter.scalar.pack(parameter.default)
        refused = bytes([Errno.NO_ENTRY])
        if command in (_EXTENDED, _EXTENDED_2):
            status = b"" if command == _EXTENDED else b"\0"
            return status + bytes([_PERSISTENT]) if parameter.persistent else refused
        if command in (_DEFAULT, _DEFAULT_2):
            status = b"" if command == _DEFAULT else b"\0"
            return refused if parameter.read_only else status + default
        if command == _STORED:
            stored = self._stored.get(number)
            return b"\0" + default if stored is None else b"\1" + default + stored
        if command == _CLEAR:
            return refused if self._stored.pop(number, None) is None else b"\0"
        if not parameter.persistent:
            return refused
        self._stored[number] = self._bytes[number]
        return b"\0"

    def _set_by_name(self, packet: Packet) -> list[Packet]:
        group, first, rest = packet.data[1:].partition(b"\0")
        name, second, rest = rest.partition(b"\0")
        if not first or not second or not rest:
            return []
        number = self._numbers.get(f"{group.decode('latin-1')}.{name.decode('latin-1')}")
        error = Errno.NONE
        if number is None:
            error = Errno.NO_ENTRY
        elif rest[0] != self._parameters[number].scalar.parameter_number:
            error = Errno.INVALID
        elif self._parameters[number].read_only:
            error = Errno.ACCESS
        elif not self._write(number, rest[1:]):
            error = Errno.INVALID
        answer = packet.answer(packet.data[: 3 + len(group) + len(name)] + bytes([error]))
        return [answer, *(self._notify(number) if number is not None and error == Errno.NONE else [])]
