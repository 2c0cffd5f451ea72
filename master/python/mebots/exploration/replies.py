# SPDX-License-Identifier: Apache-2.0
"""A worker's result for a batch: lines for the journal and columns of values, so that the study's process need not parse the lines."""

from __future__ import annotations

import dataclasses
import math
import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from mebots.exploration.journal import Record, line_of, record_of
from mebots.exploration.orders import pieces_of

PARTS = ("values", "finals", "series")
"""The parts of a record that contain numbers."""


def number_of(value: Any) -> float:
    """Returns a finite number or a Boolean as a float, and NaN for other values."""
    if isinstance(value, (int, float)):
        try:
            found = float(value)
        except OverflowError:
            return math.nan
        return found if math.isfinite(found) else math.nan
    return math.nan


@dataclasses.dataclass
class Reply:
    """Results of finished missions in the order of the batch."""

    digests: list[bytes]
    lines: bytes
    lengths: np.ndarray
    outcome_names: list[str]
    outcomes: np.ndarray
    """The index of each mission's outcome in the list of names."""
    failed: np.ndarray
    times_s: np.ndarray
    """Simulated time of each mission."""
    numbers: dict[tuple[str, str], np.ndarray]
    """The values by part of the record and by label; NaN if a mission has no number."""
    indices: Sequence[int] = ()
    """The number of each mission in the round; -1 if the round did not request it."""

    def __len__(self) -> int:
        return len(self.digests)

    def records(self) -> list[Record]:
        ends = np.cumsum(self.lengths).tolist()
        return [record_of(self.lines[end - length : end]) for end, length in zip(ends, self.lengths.tolist(), strict=True)]


def reply_of(records: Sequence[Record]) -> dict[str, Any]:
    """Returns the parts of a reply, which an executor can transfer."""
    lines = [line_of(record) for record in records]
    names = {outcome: number for number, outcome in enumerate(dict.fromkeys(record["outcome"] for record in records))}
    keys = dict.fromkeys((part, label) for record in records for part in PARTS for label in record.get(part, ()))
    joined = b"".join(lines)
    return {
        "digests": bytes.fromhex("".join([record["mission"] for record in records])),
        "lines": joined,
        "lines_crc32": zlib.crc32(joined),
        "lengths": np.array([len(line) for line in lines], np.int64),
        "outcome_names": list(names),
        "outcomes": np.array([names[record["outcome"]] for record in records], np.uint16),
        "failed": np.array([bool(record["error"]) for record in records], bool),
        "times_s": np.array([record.get("simulated_time", math.nan) for record in records], float),
        "numbers": {
            (part, label): np.array([number_of(record.get(part, {}).get(label)) for record in records], float) for part, label in keys
        },
    }


def reply_from(parts: dict[str, Any]) -> Reply:
    """Creates a reply from the parts that a worker sent. Raises ValueError if its lines are damaged."""
    if zlib.crc32(parts["lines"]) != parts["lines_crc32"]:
        raise ValueError("the checksum of a worker's answer is wrong")
    chosen = {key: parts[key] for key in ("lines", "lengths", "outcome_names", "outcomes", "failed", "times_s", "numbers")}
    return Reply(pieces_of(parts["digests"]), **chosen)
