# SPDX-License-Identifier: Apache-2.0
"""Handles memories that a client reads and writes (port 4). A drone has one memory for uploaded trajectories."""

from __future__ import annotations

from mebots.link.crtp import MAX_DATA, Errno, Packet

TRAJECTORY_BYTES = 4096
_TRAJECTORY_TYPE = 0x12
_INFO_CHANNEL, _READ_CHANNEL, _WRITE_CHANNEL = 0, 1, 2
_COUNT, _DETAILS = 1, 2
_SERIAL_NUMBER = bytes(8)
_ADDRESS_BYTES = 5  # number of the memory and address


class Memories:
    def __init__(self) -> None:
        self.trajectories = bytearray(TRAJECTORY_BYTES)

    def handle(self, packet: Packet) -> list[Packet]:
        data = packet.data
        if packet.channel == _INFO_CHANNEL:
            return self._about(packet)
        if len(data) < _ADDRESS_BYTES or packet.channel not in (_READ_CHANNEL, _WRITE_CHANNEL):
            return []
        head, begin = data[:_ADDRESS_BYTES], int.from_bytes(data[1:_ADDRESS_BYTES], "little")
        written = data[_ADDRESS_BYTES:]
        reads = packet.channel == _READ_CHANNEL
        if reads and not written:
            return []
        end = begin + (written[0] if reads else len(written))
        if data[0] != 0 or end > TRAJECTORY_BYTES or (reads and end - begin > MAX_DATA - _ADDRESS_BYTES - 1):
            return [packet.answer(head + bytes([Errno.IO]))]
        if reads:
            return [packet.answer(head + bytes([Errno.NONE]) + self.trajectories[begin:end])]
        self.trajectories[begin:end] = written
        return [packet.answer(head + bytes([Errno.NONE]))]

    def _about(self, packet: Packet) -> list[Packet]:
        command = packet.data[0] if packet.data else -1
        if command == _COUNT:
            return [packet.answer(bytes([_COUNT, 1]))]
        if command == _DETAILS and packet.data[1:2] == b"\0":
            size = TRAJECTORY_BYTES.to_bytes(4, "little")
            return [packet.answer(bytes([_DETAILS, 0, _TRAJECTORY_TYPE]) + size + _SERIAL_NUMBER)]
        return []
