# SPDX-License-Identifier: Apache-2.0
"""Tables of contents: clients read the names, types and numbers of log variables and parameters from them."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence

from mebots.link.crtp import Packet

CHANNEL = 0
_ITEM, _INFO = 2, 3
_MOST_LETTERS = 24  # of group and name together


class Toc:
    """A table in protocol version 2. The checksum covers names and types, because clients cache tables by checksum.

    :param entries: group, name and type byte of each variable, in the order of their numbers.
    :param limits: bytes that follow the checksum in the answer to a request for the table's size and checksum.
    """

    def __init__(self, entries: Sequence[tuple[str, str, int]], limits: bytes = b"") -> None:
        self._entries = [(group.encode() + b"\0" + name.encode() + b"\0", kind) for group, name, kind in entries]
        assert all(len(names) - 2 <= _MOST_LETTERS for names, _ in self._entries)
        check_sum = zlib.crc32(b"".join(bytes([kind]) + names for names, kind in self._entries))
        self._info = bytes([_INFO]) + struct.pack("<HI", len(self._entries), check_sum) + limits

    def handle(self, packet: Packet) -> list[Packet]:
        command = packet.data[:1]
        if command == bytes([_INFO]):
            return [packet.answer(self._info)]
        if command != bytes([_ITEM]) or len(packet.data) < 3:
            return []
        number = int.from_bytes(packet.data[1:3], "little")
        if number >= len(self._entries):
            return [packet.answer(command)]
        names, kind = self._entries[number]
        return [packet.answer(packet.data[:3] + bytes([kind]) + names)]
