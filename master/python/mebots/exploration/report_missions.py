# SPDX-License-Identifier: Apache-2.0
"""Prepares missions for a study's report: values, quantiles of each design, and commands that repeat missions."""

from __future__ import annotations

import dataclasses
import math
import pathlib
import shlex
from collections.abc import Sequence
from typing import Any

import numpy as np

from mebots.exploration.comparison import Evidence
from mebots.exploration.space import Space

MOST_MISSIONS = 50_000
"""The maximum number of missions on the page. If there are more, the page has the values of every n-th mission of each
design. Quantiles include all missions."""
MOST_COMMANDS = 10_000
"""The number of replicates whose commands are in the page; equal for all designs."""
QUANTILES = (0, 0.05, 0.25, 0.5, 0.75, 0.95, 1)
_DIGITS = 6


def quantiles_of(evidence: Evidence, designs: Sequence[int]) -> list[list[list[float] | None]]:
    """Returns ``QUANTILES`` of each design's missions by objective, or None for a design without values."""
    return [[_quantiles(np.array(evidence.column(design, at))) for design in designs] for at in range(len(evidence.index))]


def _quantiles(values: np.ndarray) -> list[float] | None:
    known = values[~np.isnan(values)]
    return [_rounded(one) for one in np.quantile(known, QUANTILES)] if len(known) else None


def missions_of(evidence: Evidence, designs: Sequence[int], outcomes: tuple[list[str], list[np.ndarray]] | None) -> dict[str, Any]:
    """Returns the values of missions for the page. If there are too many missions, takes only every n-th of each design; ``every`` contains
    n, and ``counts`` the number per design. ``outcome_counts`` includes all missions."""
    every = max(1, math.ceil(sum(evidence.counts[design] for design in designs) / MOST_MISSIONS))
    counts = [len(range(0, evidence.counts[design], every)) for design in designs]
    values = [
        [_known(one) for design in designs for one in evidence.column(design, at)[::every]]
        for at in range(len(evidence.index))
    ]
    names, numbers = outcomes or ([], [])
    return {
        "every": every,
        "counts": counts,
        "values": values,
        "outcome": [int(one) for design in designs for one in numbers[design][: evidence.counts[design] : every]] if names else [],
        "outcomes": names,
        "outcome_counts": [np.bincount(numbers[design][: evidence.counts[design]], minlength=len(names)).tolist() for design in designs] if names else [],
    }


def _known(value: float) -> float | None:
    return _rounded(value) if value == value else None  # not NaN


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


@dataclasses.dataclass(frozen=True)
class Replay:
    """Creates commands that repeat missions. They write results below ``folder``."""

    space: Space
    folder: pathlib.Path

    def texts(self, designs: Sequence[int], replicates: int) -> dict[str, Any] | None:
        """Returns the parts from which the page builds the commands that repeat missions: the start of each command, the settings of each
        design (None if options cannot set them), and those of each replicate's draws. Returns None if no command can repeat a mission."""
        missions = self.space.missions
        own = [missions.settings_words(self.space.designs[design]) for design in designs]
        draws = [missions.settings_words(self.space.draw(one)) for one in range(min(replicates, MOST_COMMANDS))]
        if None in draws or all(one is None for one in own):
            return None
        return {
            "run": f"mebots run {shlex.quote(str(self.space.study.mission))}",
            "folder": shlex.quote(str(self.folder)),
            "designs": own,
            "draws": draws,
            "pages": sorted(page.relative_to(self.folder.parent).as_posix() for page in self.folder.glob("*/flight.html")),
            "name": self.folder.name,
        }
