# SPDX-License-Identifier: Apache-2.0
"""CRTP packets: a header byte and up to 30 bytes in one datagram."""

from __future__ import annotations

import enum
from typing import NamedTuple

MAX_DATA = 30


class Port(enum.IntEnum):
    CONSOLE = 0
    PARAMETERS = 2
    SETPOINT = 3
    MEMORY = 4
    LOG = 5
    GENERIC_SETPOINT = 7
    HIGH_LEVEL = 8
    SUPERVISOR = 9
    PLATFORM = 13
    LINK = 15


class Errno(enum.IntEnum):
    """Error numbers in answers, which are those of the firmware's C library."""

    NONE = 0
    NOT_PERMITTED = 1
    NO_ENTRY = 2
    IO = 5
    TOO_BIG = 7
    NO_COMMAND = 8
    NO_MEMORY = 12
    ACCESS = 13
    BUSY = 16
    EXISTS = 17
    INVALID = 22


class Packet(NamedTuple):
    """A CRTP packet. Bits 7 to 4 of the header are the port, bits 1 and 0 the channel. Bits 3 and 2 are ignored."""

    port: int
    channel: int
    data: bytes

    @staticmethod
    def parse(datagram: bytes) -> Packet | None:
        """Returns the packet in a datagram, or None if the datagram is empty or too long."""
        if not 1 <= len(datagram) <= 1 + MAX_DATA:
            return None
        return Packet(datagram[0] >> 4, datagram[0] & 0x03, datagram[1:])

    def encode(self) -> bytes:
        assert len(self.data) <= MAX_DATA
        return bytes([self.port << 4 | self.channel]) + self.data

    def answer(self, data: bytes) -> Packet:
        """Returns a packet with ``data`` and the same port and channel."""
        return Packet(self.port, self.channel, data)
