# SPDX-License-Identifier: Apache-2.0
"""Chooses designs round by round with a sampler of Optuna. The sampler receives results in the order of the study, so its proposals are the
same for any number of workers and after interruptions."""

from __future__ import annotations

from typing import Any

from mebots.errors import InputError
from mebots.exploration.comparison import Evidence
from mebots.exploration.rounds import FLYING, Flights
from mebots.exploration.study import Study, Values
from mebots.extras import extra


class Search:
    """Requests the designs of each round from Optuna's sampler, and appends them to ``designs``. Has the same methods as
    ``rounds.Rounds``."""

    def __init__(self, study: Study, evidence: Evidence, designs: list[Values]) -> None:
        self._study = study
        self._evidence = evidence
        self._designs = designs
        self._optuna = extra("optuna", "a design 'search'", "optuna")
        self._optuna.logging.set_verbosity(self._optuna.logging.ERROR)
        self._senses = [one for one in study.objectives if one.sense != 0]
        if not self._senses:
            raise InputError("a search needs an objective to minimize or maximize", "missing_key")
        self._search = self._optuna.create_study(
            sampler=self._sampler(),
            directions=["minimize" if one.sense < 0 else "maximize" for one in self._senses],
        )
        self._trials: list[Any] = []
        self._round = 0
        self.status: list[str] = []

    def flying(self) -> list[int]:
        return [design for design, status in enumerate(self.status) if status == FLYING]

    def next(self) -> Flights:
        """Returns all replicates of the next round's designs."""
        if self._round == self._study.design["rounds"]:
            return Flights([], 0, 0)
        first = len(self._designs)
        spaces = {name: self._space(spread) for name, spread in self._study.design["factors"].items()}
        for _ in range(self._study.design["points"]):
            trial = self._search.ask(spaces)
            self._trials.append(trial)
            self._designs.append({name: trial.params[name] for name in spaces})
            self.status.append(FLYING)
        self._evidence.add_designs(len(self._designs))
        return Flights(range(first, len(self._designs)), 0, self._study.replicates)

    def ahead(self) -> Flights:
        """Returns an empty list, because the next designs depend on this round's results."""
        return Flights([], 0, 0)

    def most_left(self) -> int:
        return (self._study.design["rounds"] - self._round) * self._study.design["points"] * self._study.replicates

    def likely_left(self) -> float:
        return self.most_left()

    def decide(self) -> None:
        self._round += 1
        for design in self.flying():
            self.status[design] = f"round {self._round}"
            trial = self._trials[design]
            means = [self._evidence.shown(design, one).mean for one in self._senses]
            if None in means:
                self._search.tell(trial, state=self._optuna.trial.TrialState.FAIL)
                continue
            trial.set_user_attr("broken", self._broken(design))
            self._search.tell(trial, means)

    def end(self, reason: str) -> None:
        for design in self.flying():
            self.status[design] = reason

    def _broken(self, design: int) -> list[float]:
        """Returns the violation of each constraint. A value of at most 0 satisfies the constraint."""
        found = []
        for one in self._study.constraints:
            mean = self._evidence.shown(design, self._study.objective(one.label)).mean
            missed = float("inf") if mean is None else (one.bound - mean if one.above else mean - one.bound)
            found.append(min(missed, 1e300))
        return found

    def _sampler(self) -> Any:
        samplers, seed = self._optuna.samplers, self._study.design.get("seed", 0)
        constraints = (lambda trial: trial.user_attrs["broken"]) if self._study.constraints else None
        if self._study.design.get("method", "nsga2") == "nsga2":
            points = max(2, self._study.design["points"])
            return samplers.NSGAIISampler(population_size=points, seed=seed, constraints_func=constraints)
        return samplers.TPESampler(seed=seed, constraints_func=constraints)

    def _space(self, spread: Any) -> Any:
        spaces = self._optuna.distributions
        if isinstance(spread, list):
            return spaces.CategoricalDistribution(spread)
        ((kind, arguments),) = spread.items()
        if kind == "options":
            return spaces.CategoricalDistribution(list(arguments))
        if kind == "integer":
            return spaces.IntDistribution(int(arguments[0]), int(arguments[1]))
        return spaces.FloatDistribution(arguments[0], arguments[1], log=kind == "log_uniform")
