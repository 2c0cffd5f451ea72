# SPDX-License-Identifier: Apache-2.0
"""Writes small logs in the formats of the devices, for the tests of recorded flights."""

import struct
import zlib


def usd_header(events, version=2):
    """Returns the header of a uSD log. ``events`` are (id, name, ["group.name(T)", ...])."""
    data = struct.pack("<BHH", 0xBC, version, len(events))
    for number, name, variables in events:
        data += struct.pack("<H", number) + name.encode() + b"\0" + struct.pack("<H", len(variables))
        data += b"".join(variable.encode() + b"\0" for variable in variables)
    return data


def usd_record(number, time, letters, values, version=2):
    return struct.pack("<HQ" if version == 2 else "<HI", number, time) + struct.pack("<" + letters, *values)


def usd_log(events, records, version=2):
    """Returns a uSD log. ``records`` are (id, time [us or ms], values)."""
    letters = {number: "".join(variable[-2] for variable in variables) for number, _, variables in events}
    data = usd_header(events, version)
    data += b"".join(usd_record(number, time, letters[number], values, version) for number, time, values in records)
    return data + struct.pack("<I", zlib.crc32(data))


def ulog(messages, start_us=1000):
    """Returns a ULog file. ``messages`` maps names to (fields as in "float voltage_v;", struct letters, rows of (time in us,
    values))."""

    def message(kind, body):
        return struct.pack("<HB", len(body), ord(kind)) + body

    data = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", start_us)
    data += message("B", bytes(40))
    for name, (fields, _, _) in messages.items():
        data += message("F", f"{name}:uint64_t timestamp;{fields}".encode())
    for number, name in enumerate(messages):
        data += message("A", struct.pack("<BH", 0, number) + name.encode())
    for number, (_, letters, rows) in enumerate(messages.values()):
        for time, values in rows:
            data += message("D", struct.pack("<HQ" + letters, number, time, *values))
    return data
