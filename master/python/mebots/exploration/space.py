# SPDX-License-Identifier: Apache-2.0
"""The missions of a study: designs, draws, and orders."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from mebots.exploration import chance, designs
from mebots.exploration.missions import Missions
from mebots.exploration.orders import Order, Orders
from mebots.exploration.rounds import Flight, Flights
from mebots.exploration.study import Study, Values

MOST_DRAWS_KEPT = 100_000
"""The number of replicates whose draws are cached; the others are computed each time."""


class Space:
    """The designs and draws of a study. In a search, every round extends ``designs``."""

    def __init__(self, study: Study) -> None:
        self.study = study
        self.missions = Missions(study)
        self.designs = designs.designs_of(study)
        self.factors = list(self.designs[0] if self.designs else study.design["factors"])
        self._draws: dict[int, Values] = {}

    def values(self, flight: Flight) -> Values:
        """Returns a mission's values of factors and draws."""
        design, replicate = flight
        return self.designs[design] | self.draw(replicate)

    def draw(self, replicate: int) -> Values:
        """Returns a replicate's draws, which all designs share."""
        drawn = self._draws.get(replicate)
        if drawn is None:
            drawn = {
                name: chance.value(spread, chance.unit(self.study.draws_seed, name, replicate))
                for name, spread in self.study.draws.items()
            }
            if len(self._draws) < MOST_DRAWS_KEPT:
                self._draws[replicate] = drawn
        return drawn

    def order(self, flight: Flight) -> Order:
        return self.missions.order(self.values(flight))

    def orders(self, flights: Flights, most: int) -> Iterator[tuple[int, Orders]]:
        """Yields orders and the number of their first mission. Each object contains up to ``most`` missions of one design."""
        for at, design in enumerate(flights.designs):
            for begin in range(flights.begin, flights.end, most):
                drawn = [self.draw(replicate) for replicate in range(begin, min(begin + most, flights.end))]
                yield at * (flights.end - flights.begin) + begin - flights.begin, self.missions.orders(self.designs[design], drawn)

    def provenance(self, example: Values) -> dict[str, str]:
        """Returns the mission, the draws and the hashes of the input files as texts for the report. ``example`` contains the values of any
        mission of the study."""
        draws = json.dumps(self.study.draws) if self.study.draws else "none"
        files: dict[str, Any] = self.missions.order(example)["files"]
        return {
            "mission": self.study.mission.name,
            "draws": f"{draws}, seed {self.study.draws_seed}",
        } | {name: digest for digest, (_, name) in sorted(files.items(), key=lambda one: one[1][1])}
