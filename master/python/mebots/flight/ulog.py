# SPDX-License-Identifier: Apache-2.0
"""Reads PX4's ULog files with the package pyulog.

PX4's frames are north-east-down and forward-right-down; those of MEbots are east-north-up and forward-left-up. A mapping for a ULog may add
columns with names ``message.field``, such as ``battery_status.current_a``.
"""

from __future__ import annotations

import contextlib
import io
import pathlib
import struct
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from mebots.errors import InputError
from mebots.extras import extra
from mebots.flight.log import Array, FlightLog, log_of
from mebots.flight.names import Meaning, named

MAGIC = b"ULog\x01\x12\x35"
_SIZE_OF_HEADER = 16
_FIRST_TYPES = {b"B", b"F", b"I", b"M", b"P", b"Q", b"A"}
"""Types of messages that may come first in a file. If the first message has another type, pyulog searches without end.
"""

_ROTORS = (1, 3, 4, 2)
"""PX4's order is front right, rear left, front left, rear right. MEbots' order goes around the drone from the front
right."""

PX4: dict[str, Meaning] = {
    **{f"actuator_motors.control[{place}]": Meaning(f"motor[{rotor}].command", "1") for place, rotor in enumerate(_ROTORS)},
    "battery_status.voltage_v": Meaning("battery.voltage", "V"),
    "battery_status.current_a": Meaning("battery.current", "A"),
    "vehicle_local_position.y": Meaning("position.x", "m"),
    "vehicle_local_position.x": Meaning("position.y", "m"),
    "vehicle_local_position.z": Meaning("position.z", "m", -1),
    "vehicle_local_position.vy": Meaning("velocity.x", "m/s"),
    "vehicle_local_position.vx": Meaning("velocity.y", "m/s"),
    "vehicle_local_position.vz": Meaning("velocity.z", "m/s", -1),
    "sensor_combined.accelerometer_m_s2[0]": Meaning("acceleration.x", "m/s2"),
    "sensor_combined.accelerometer_m_s2[1]": Meaning("acceleration.y", "m/s2", -1),
    "sensor_combined.accelerometer_m_s2[2]": Meaning("acceleration.z", "m/s2", -1),
    "sensor_combined.gyro_rad[0]": Meaning("rate.x", "rad/s"),
    "sensor_combined.gyro_rad[1]": Meaning("rate.y", "rad/s", -1),
    "sensor_combined.gyro_rad[2]": Meaning("rate.z", "rad/s", -1),
    "attitude.qx": Meaning("attitude.qx", "1"),
    "attitude.qy": Meaning("attitude.qy", "1"),
    "attitude.qz": Meaning("attitude.qz", "1"),
    "attitude.qw": Meaning("attitude.qw", "1"),
}


def read_ulog(file: pathlib.Path, meanings: Mapping[str, Meaning] = {}) -> FlightLog:
    """Reads a log. ``meanings`` adds meanings of columns to PX4's, and replaces those of equal names. If several columns have the same
    signal, those in ``meanings`` take precedence. Raises InputError if the log is invalid."""
    data = file.read_bytes()
    if not data.startswith(MAGIC) or len(data) < _SIZE_OF_HEADER:
        raise InputError(f"{file}: byte 0: this is not the start of a ULog file; it is cut off, or of another kind", "syntax_error")
    if len(data) > _SIZE_OF_HEADER and data[_SIZE_OF_HEADER + 2 : _SIZE_OF_HEADER + 3] not in _FIRST_TYPES:
        raise InputError(f"{file}: byte {_SIZE_OF_HEADER}: no message of ULog follows the header. Download it again", "syntax_error")
    pyulog = extra("pyulog", "a ULog file", "pyulog", "flight")
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said):
            parsed = pyulog.ULog(io.BytesIO(data))
    except (IndexError, KeyError, TypeError, UnicodeDecodeError, ValueError, struct.error) as error:
        raise InputError(f"{file}: pyulog cannot read the log: {type(error).__name__}: {error}. Download it again", "syntax_error") from error
    notes = ["the log is damaged: samples may be lost"] if parsed.file_corruption else []
    if parsed.dropouts:
        lost_s = sum(one.duration for one in parsed.dropouts) * 1e-3
        notes.append(f"the autopilot lost {lost_s:.3g} s of the log in {len(parsed.dropouts)} drop-outs")
    return log_of(file, "PX4 ULog", named(_columns(parsed), {**meanings, **PX4, **meanings}), notes)


def _columns(parsed: Any) -> Iterator[tuple[str, Array, Array]]:
    for message in parsed.data_list:
        times = message.data["timestamp"].astype(np.float64) * 1e-6
        prefix = message.name if message.multi_id == 0 else f"{message.name}_{message.multi_id}"
        for field, values in message.data.items():
            if field != "timestamp":
                yield f"{prefix}.{field}", times, values.astype(np.float64)
        if prefix == "vehicle_attitude" and all(f"q[{i}]" in message.data for i in range(4)):
            yield from _attitude(times, [message.data[f"q[{i}]"].astype(np.float64) for i in range(4)])


def _attitude(times: Array, q: list[Array]) -> Iterator[tuple[str, Array, Array]]:
    """Converts attitudes from (body forward-right-down to north-east-down) to (body forward-left-up to east-north-up): a half turn about
    the body's x axis before, and an exchange of the world's axes after the rotation."""
    w, x, y, z = q
    w, x, y, z = -x, w, z, -y  # q * i
    half = np.sqrt(0.5)  # (i + j) / sqrt(2) rotates north-east-down to east-north-up
    yield "attitude.qw", times, half * (-x - y)
    yield "attitude.qx", times, half * (w + z)
    yield "attitude.qy", times, half * (w - z)
    yield "attitude.qz", times, half * (y - x)
