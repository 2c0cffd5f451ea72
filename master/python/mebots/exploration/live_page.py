# SPDX-License-Identifier: Apache-2.0
"""live.html: the report of a study that is under way. It loads itself again, and goes when the study ends."""

from __future__ import annotations

import pathlib
import time
from collections.abc import Sequence

from mebots.exploration import report
from mebots.exploration.answer import Answer
from mebots.exploration.comparison import Evidence
from mebots.exploration.figures import Units
from mebots.exploration.progress import Progress
from mebots.exploration.space import Space

NAME = "live.html"
_EVERY_S = 5.0
_SHARE = 20.0
"""Writing the page takes at most this part of the time."""


class LivePage:
    """Writes the page at most every five seconds."""

    def __init__(self, folder: pathlib.Path, space: Space, evidence: Evidence, units: Units) -> None:
        self._file = folder / NAME
        self._space = space
        self._evidence = evidence
        self._units = units
        self._next_s = time.monotonic() + _EVERY_S

    def show(self, now: Progress, status: Sequence[str]) -> None:
        begun_s = time.monotonic()
        if begun_s < self._next_s or now.standings is None:
            return
        so_far = now.standings()
        rows = {row.design: row for row in so_far.rows}
        told = [
            {"failed": 0, "status": status[number], "front": "", "rank": rows[number].rank, "name": rows[number].name, "note": rows[number].note}
            for number in range(len(self._space.designs))
        ]
        report.write(
            self._file,
            self._evidence.study,
            self._space.factors,
            self._space.designs,
            self._evidence,
            told,
            [""] * len(told),
            {"mission": self._evidence.study.mission.name},
            Answer([now.line()], so_far.titles, so_far.rows, []),
            self._units,
            refresh_s=_EVERY_S,
        )
        self._next_s = time.monotonic() + max(_EVERY_S, _SHARE * (time.monotonic() - begun_s))

    def remove(self) -> None:
        self._file.unlink(missing_ok=True)
