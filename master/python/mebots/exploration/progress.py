# SPDX-License-Identifier: Apache-2.0
"""The progress of a study, for the terminal, the live page and callers of ``mebots.sweep``."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from mebots.exploration.answer import Answer


@dataclasses.dataclass(frozen=True)
class Progress:
    """The progress of a study. ``most_left`` missions are left if no decision saves any; ``likely_left`` assumes that decisions continue to
    save as many as before. ``answer`` is the result so far: how missions ended, and the leading designs after each round.
    ``of_other_builds`` counts unused records of other builds."""

    flown: int
    taken: int
    failed: int
    most_left: int
    likely_left: float
    designs_flying: int
    rate_per_s: float
    answer: str = ""
    of_other_builds: int = 0
    standings: Callable[[], Answer] | None = None
    """Ranks the designs by the missions so far; None for a rare event."""

    def line(self) -> str:
        """Returns a line with missions done and left, remaining time, and outcomes."""
        unused = f" ({self.of_other_builds} of other builds not used)" if self.of_other_builds else ""
        text = (
            f"{self.flown} flown, {self.taken} from a journal{unused}, {self.failed} failed, {self._left()} "
            f"({self.rate_per_s:.2f} a second); {self.designs_flying} designs flying"
        )
        return f"{text}; {self.answer}" if self.answer else text

    def _left(self) -> str:
        """Returns the remaining missions and time as text. Racing and stop conditions may end designs earlier."""
        rate = max(self.rate_per_s, 1e-9)
        most = f"at most {self.most_left} left, {duration_text(self.most_left / rate)}"
        likely = round(self.likely_left)
        return most if likely >= self.most_left else f"about {likely} left, {duration_text(likely / rate)} ({most})"


def duration_text(time_s: float) -> str:
    if time_s < 90:
        return f"{time_s:.0f} s"
    return f"{time_s / 60:.0f} min" if time_s < 5400 else f"{time_s / 3600:.1f} h"
