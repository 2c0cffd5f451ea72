# SPDX-License-Identifier: Apache-2.0
"""Writes live.html, the report of a running study. The page reloads itself, and redirects to report.html at the end."""

from __future__ import annotations

import pathlib
import time
from collections.abc import Sequence

from mebots.exploration import report
from mebots.exploration.answer import Answer
from mebots.exploration.comparison import Evidence
from mebots.exploration.figures import Units
from mebots.exploration.files import write_whole
from mebots.exploration.progress import Progress
from mebots.exploration.space import Space

NAME = "live.html"
_EVERY_S = 5.0
_TO_THE_REPORT = b"""<!doctype html><html lang="en"><head><meta charset="utf-8"><meta http-equiv="refresh" content="0; url=report.html">
<title>Study</title></head><body><p>The study is done: <a href="report.html">report.html</a></p></body></html>
"""
_SHARE = 20.0
"""Writing the page takes at most one part in this many of the time."""


class LivePage:
    """Writes the page at most once in five seconds."""

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
        content = report.Content(
            study=self._evidence.study,
            factors=self._space.factors,
            designs=self._space.designs,
            evidence=self._evidence,
            answer=Answer([now.line()], so_far.titles, so_far.rows, []),
            units=self._units,
            places=[""] * len(self._space.designs),
            status=status,
            failed=[0] * len(self._space.designs),
            provenance={"mission": self._evidence.study.mission.name},
            refresh_s=_EVERY_S,
        )
        report.write(self._file, content)
        self._next_s = time.monotonic() + max(_EVERY_S, _SHARE * (time.monotonic() - begun_s))

    def end(self, *, is_done: bool) -> None:
        """If the study is done, makes the page redirect to the report. Otherwise, removes the page."""
        if is_done and self._file.exists():
            write_whole(self._file, [_TO_THE_REPORT])
        else:
            self._file.unlink(missing_ok=True)
