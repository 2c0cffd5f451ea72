# SPDX-License-Identifier: Apache-2.0
"""Handles log blocks, which are groups of variables that a client receives periodically (port 5)."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

from mebots.link.crtp import Errno, Packet, Port
from mebots.link.scalars import BY_LOG_NUMBER, Scalar
from mebots.link.toc import CHANNEL as TOC_CHANNEL
from mebots.link.toc import Toc

CONTROL_CHANNEL, DATA_CHANNEL = 1, 2
MOST_BLOCKS, MOST_VARIABLES, MOST_BYTES = 16, 128, 26
_DELETE, _START, _STOP, _RESET, _CREATE, _APPEND, _START_MS = 2, 3, 4, 5, 6, 7, 8
_FIELD_BYTES = 3  # type and number of a variable


@dataclasses.dataclass(frozen=True)
class Variable:
    group: str
    name: str
    scalar: Scalar
    read: Callable[[], float]


@dataclasses.dataclass
class _Block:
    fields: list[tuple[Variable, Scalar]] = dataclasses.field(default_factory=list)
    period_ms: int = 0  # 0: stopped
    next_ms: int = 0

    def size(self) -> int:
        return sum(scalar.size for _, scalar in self.fields)


class Log:
    """The log subsystem of a drone."""

    def __init__(self, variables: Sequence[Variable]) -> None:
        self._variables = variables
        self._toc = Toc([(one.group, one.name, one.scalar.log_number) for one in variables], bytes([MOST_BLOCKS, MOST_VARIABLES]))
        self._blocks: dict[int, _Block] = {}

    def handle(self, packet: Packet, now_ms: int) -> list[Packet]:
        if packet.channel == TOC_CHANNEL:
            return self._toc.handle(packet)
        if packet.channel != CONTROL_CHANNEL or not packet.data:
            return []
        answers: list[Packet] = []
        data = packet.data.ljust(2, b"\0")
        error = self._control(data[0], data[1], data[2:], now_ms, answers)
        return [packet.answer(bytes([data[0], data[1], error])), *answers]

    def due(self, now_ms: int) -> list[Packet]:
        """Returns the packets of the blocks that are due."""
        packets = []
        for number, block in self._blocks.items():
            if block.period_ms == 0 or block.next_ms > now_ms:
                continue
            block.next_ms += block.period_ms * ((now_ms - block.next_ms) // block.period_ms + 1)
            packets.append(_packet(number, block, now_ms))
        return packets

    def _control(self, command: int, number: int, rest: bytes, now_ms: int, answers: list[Packet]) -> Errno:
        if command == _RESET:
            self._blocks.clear()
            return Errno.NONE
        if command == _CREATE:
            if number in self._blocks:
                return Errno.EXISTS
            if len(self._blocks) == MOST_BLOCKS:
                return Errno.NO_MEMORY
            self._blocks[number] = _Block()
            return self._append(number, rest)
        if command not in (_DELETE, _START, _STOP, _APPEND, _START_MS):
            return Errno.NO_COMMAND
        if number not in self._blocks:
            return Errno.NO_ENTRY
        if command == _DELETE:
            del self._blocks[number]
        elif command == _STOP:
            self._blocks[number].period_ms = 0
        elif command == _APPEND:
            return self._append(number, rest)
        else:
            period_ms = 10 * rest[0] if command == _START and rest else int.from_bytes(rest[:2], "little")
            self._start(number, period_ms, now_ms, answers)
        return Errno.NONE

    def _start(self, number: int, period_ms: int, now_ms: int, answers: list[Packet]) -> None:
        block = self._blocks[number]
        if period_ms == 0:  # sends the block once
            answers.append(_packet(number, block, now_ms))
            return
        block.period_ms = period_ms
        block.next_ms = now_ms + period_ms

    def _append(self, number: int, fields: bytes) -> Errno:
        block = self._blocks[number]
        for at in range(0, len(fields) - len(fields) % _FIELD_BYTES, _FIELD_BYTES):
            scalar = BY_LOG_NUMBER.get(fields[at] & 0x0F)
            variable = int.from_bytes(fields[at + 1 : at + 3], "little")
            if scalar is None or variable >= len(self._variables):
                return Errno.NO_ENTRY
            if block.size() + scalar.size > MOST_BYTES:
                return Errno.TOO_BIG
            if sum(len(one.fields) for one in self._blocks.values()) == MOST_VARIABLES:
                return Errno.NO_MEMORY
            block.fields.append((self._variables[variable], scalar))
        return Errno.NONE


def _packet(number: int, block: _Block, now_ms: int) -> Packet:
    values = b"".join(scalar.pack(_stored(variable)) for variable, scalar in block.fields)
    return Packet(Port.LOG, DATA_CHANNEL, bytes([number]) + (now_ms & 0xFFFFFF).to_bytes(3, "little") + values)


def _stored(variable: Variable) -> float:
    """Returns the value as the drone's type stores it: an integer stores 3 for a voltage of 3.7."""
    return variable.scalar.unpack(variable.scalar.pack(variable.read()))
