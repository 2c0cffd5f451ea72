# SPDX-License-Identifier: Apache-2.0
"""Reads logs in CSV. A mapping assigns columns to signals.

    {"time": {"column": "t", "unit": "s"}, "columns": {"vbat": {"signal": "battery.voltage", "unit": "mV"}}}

A table without times has "time": {"period": 0.01, "unit": "s"}. With a second clock, "reference": {"column": ..., "unit": ...}, the reader
removes the drift of the first clock.
"""

from __future__ import annotations

import pathlib
from typing import Any

import numpy as np

from mebots import _mebots
from mebots.errors import InputError
from mebots.flight.log import Array, FlightLog, log_of
from mebots.flight.names import Meaning, named

_MOST_DRIFT = 0.05
"""The maximum difference between two clocks that measure the same time in a flight."""


def read_table(file: pathlib.Path, mapping: dict[str, Any], meanings: dict[str, Meaning]) -> FlightLog:
    """Reads a log with a mapping that ``reading`` checked. Raises InputError with line and column if the log is invalid."""
    try:
        header, *rows = _mebots.read_csv(file)
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: the table has the byte 0x{error.object[error.start]:02x}, which is not UTF-8; save it as text in UTF-8", "syntax_error") from None
    if not rows:
        raise InputError(f"{file}: the table has a header and no rows", "invalid_value")
    absent = [column for column in meanings if column not in header]
    if absent:
        raise InputError(
            f"{file}: the mapping names the column '{absent[0]}', which the table does not have. It has: {', '.join(header)}",
            "unknown_name",
        )
    columns = {title: _numbers(file, rows, place, title in meanings) for place, title in enumerate(header)}
    times, notes = _times(file, mapping["time"], columns, len(rows))
    known = ((title, times, values) for title, values in columns.items() if values is not None)
    return log_of(file, "CSV table", named(known, meanings), notes)


def _numbers(file: pathlib.Path, rows: list[list[str]], place: int, needed: bool) -> Array | None:
    """Returns the values of a column. Empty cells become NaN. Returns None for a column of texts that no signal needs."""
    cells = [row[place].strip() or "nan" for row in rows]
    try:
        return np.array(cells, dtype=np.float64)
    except ValueError:
        if not needed:
            return None
    for number, cell in enumerate(cells):
        try:
            float(cell)
        except ValueError:
            raise InputError(
                f"{file}: row {number + 1} after the header, column {place + 1}: '{cell}' is not a number; "
                "leave a cell empty if nothing was measured",
                "syntax_error",
            ) from None
    raise AssertionError("one cell was refused above")


def _times(file: pathlib.Path, time: dict[str, Any], columns: dict[str, Array | None], count: int) -> tuple[Array, list[str]]:
    scale = _mebots.log_unit_factor(time.get("unit", "s"), "s")
    if "period" in time:
        return np.arange(count) * (time["period"] * scale), [f"the table has no times: one row every {time['period'] * scale:g} s"]
    times = _clock(file, time["column"], columns) * scale
    if "reference" not in time:
        return times, []
    reference = time["reference"]
    other = _clock(file, reference["column"], columns) * _mebots.log_unit_factor(reference.get("unit", "s"), "s")
    return _without_drift(file, times, other)


def _clock(file: pathlib.Path, column: str, columns: dict[str, Array | None]) -> Array:
    values = columns.get(column)
    if values is None:
        raise InputError(f"{file}: the mapping's column of times '{column}' is not in the table, or holds text", "unknown_name")
    return values


def _without_drift(file: pathlib.Path, times: Array, other: Array) -> tuple[Array, list[str]]:
    """Converts times to the rate of the reference clock by a line through pairs of times."""
    good = np.isfinite(times) & np.isfinite(other)
    if good.sum() < 2 or np.ptp(times[good]) <= 0:
        raise InputError(f"{file}: the reference clock has fewer than two times", "invalid_value")
    start = times[good][0]
    rate = float(np.polyfit(times[good] - start, other[good] - other[good][0], 1)[0])
    if not abs(rate - 1) <= _MOST_DRIFT:
        raise InputError(
            f"{file}: the reference clock runs {rate:.4g} times as fast as the clock of the table; check the units in the mapping",
            "invalid_value",
        )
    return start + (times - start) * rate, [f"the clock drifts by {(1 - rate) * 1e6:.0f} ppm against its reference; the drift is removed"]
