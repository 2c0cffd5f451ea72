# SPDX-License-Identifier: Apache-2.0
"""Reads study files. C++ code (master/src/io/study) checks them; this module adds defaults."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
from typing import Any

from mebots import _mebots
from mebots.errors import InputError
from mebots.exploration.files import write_whole
from mebots.exploration.inputs import is_input

NAME = "study.json"
"""Name of the study's copy in its results folder."""

Values = dict[str, Any]
"""A map from each factor or variable to its value, in the notation of the study."""


@dataclasses.dataclass(frozen=True)
class Objective:
    """A quantity that is computed for every mission, identified by ``label``.

    ``source`` is the origin of its value ("outcome", "end_reason", "summary", "final", "series", "expression"), and
    ``what`` selects one. ``sense`` is -1 to minimise, +1 to maximise, 0 for neither. A design's value is the mean of its
    missions, or their ``percentile``.
    """

    label: str
    source: str
    what: Any
    reduction: str | None = None
    where: str | None = None
    sense: int = 0
    tolerance: float = 0.0
    unit: str = ""
    percentile: float | None = None

    @property
    def is_share(self) -> bool:
        """True if the objective is 0 or 1 for each mission, so that its mean is a share."""
        return self.source in ("outcome", "end_reason")

    @property
    def statistic(self) -> str:
        """Returns the name of the statistic of a design's missions."""
        return "mean" if self.percentile is None else f"percentile {self.percentile:g}"


@dataclasses.dataclass(frozen=True)
class Constraint:
    """A design is feasible only if its share or mean of ``label`` is above ``bound``, or below it if ``above`` is false."""

    label: str
    above: bool
    bound: float


@dataclasses.dataclass(frozen=True)
class Stop:
    """A design needs no more missions if its objective ``label`` has this precision."""

    label: str
    width: float | None = None
    constraint: Constraint | None = None
    best: bool = False


@dataclasses.dataclass(frozen=True)
class Fork:
    """Factors and draws that apply from a certain time. Missions that are equal before this time share that part."""

    at_s: float
    variables: tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class Splitting:
    """Settings for estimating the probability that ``score`` reaches ``goal``, upwards (``sign`` +1) or downwards (-1). ``levels`` end with
    the goal; if empty, pilot missions determine them. ``missions`` is the number of missions per level in one estimate. The draws in
    ``reseed`` are drawn again at each level."""

    score: str
    levels: tuple[float, ...]
    goal: float
    sign: int
    missions: int
    reseed: tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class Study:
    """A valid study. ``place`` names it in messages. ``folders`` are searched for files of factors and draws. ``text`` is its JSON with
    absolute paths."""

    place: str
    folders: tuple[pathlib.Path, ...]
    text: str
    mission: pathlib.Path
    design: dict[str, Any]
    replicates: int
    draws_seed: int
    draws: dict[str, dict[str, Any]]
    objectives: tuple[Objective, ...]
    constraints: tuple[Constraint, ...]
    processor_time_s: float | None
    most_failures: int | None
    round_size: int | None
    error: float
    racing: bool
    stop: Stop | None
    fork: Fork | None
    splitting: Splitting | None
    results: bool

    def write(self, folder: pathlib.Path) -> None:
        """Writes the study into the folder. `--status` and later calls read it."""
        write_whole(folder / NAME, [(self.text + "\n").encode()])

    def is_another_in(self, folder: pathlib.Path) -> bool:
        """True if the folder contains results of another study."""
        try:
            return (folder / NAME).read_text(encoding="utf-8") != self.text + "\n"
        except (OSError, ValueError):
            return False

    def on(self, mission: pathlib.Path) -> Study:
        """Returns a copy of the study with another mission."""
        path = mission.absolute()
        content = {**json.loads(self.text), "mission": str(path)}
        return dataclasses.replace(self, mission=path, text=_written(content), draws=_draws_of(content))

    def objective(self, label: str) -> Objective:
        return next(one for one in self.objectives if one.label == label)

    @property
    def rare(self) -> Splitting:
        """Returns the splitting settings of a study of a rare event."""
        assert self.splitting is not None
        return self.splitting

    @property
    def looks(self) -> bool:
        """True if the number of missions depends on their results. Then only confidence sequences have their stated level."""
        return self.racing or self.stop is not None


def read_study(source: str | os.PathLike[str] | dict[str, Any]) -> Study:
    """Reads a study from a file or a dict. Paths in a dict are relative to the working folder. Raises InputError with all errors."""
    if isinstance(source, dict):
        return _from_dict(source)
    try:
        content = _mebots.read_study(source)
    except InputError:
        _refuse_config(source)
        raise
    return _study(os.fspath(source), pathlib.Path(source).absolute().parent, json.loads(content))


def _refuse_config(source: str | os.PathLike[str]) -> None:
    """Raises InputError with one sentence if the file is the config of a run, instead of one error per key."""
    try:
        content = json.loads(pathlib.Path(source).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return
    if isinstance(content, dict) and "instances" in content and "mission" not in content:
        name = os.fspath(source)
        raise InputError(f'{name}: this is the config of a run, not a study. `mebots run {name}` runs it; a study names it under the key "mission"') from None


def _from_dict(source: dict[str, Any]) -> Study:
    folder = pathlib.Path.cwd()
    return _study("the study", folder, json.loads(_mebots.check_study(json.dumps(source), str(folder / "study.json"))))


def _study(place: str, folder: pathlib.Path, content: dict[str, Any]) -> Study:
    draws = content.get("draws", {})
    design = content["design"]
    file = design.get("file")
    limits = content.get("limits", {})
    rounds = content.get("rounds", {})
    return Study(
        place=place,
        folders=(folder, pathlib.Path(file).parent) if file else (folder,),
        text=_written(_with_absolute_files(content, folder)),
        mission=pathlib.Path(content["mission"]),
        design=design,
        replicates=draws.get("replicates", 1),
        draws_seed=draws.get("seed", 0),
        draws=_draws_of(content),
        objectives=tuple(_objective(label, one) for label, one in content.get("objectives", {}).items()),
        constraints=tuple(_constraint(label, one) for label, one in content.get("constraints", {}).items()),
        processor_time_s=limits.get("processor_time"),
        most_failures=limits.get("failures"),
        round_size=rounds.get("size"),
        error=rounds.get("error", 0.05),
        racing=rounds.get("racing", False),
        stop=_stop(rounds["stop"]) if "stop" in rounds else None,
        fork=_fork(content["fork"]) if "fork" in content else None,
        splitting=_splitting(content["splitting"]) if "splitting" in content else None,
        results=content.get("results", False),
    )


def _draws_of(content: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Returns the drawn variables. If the study has "uncertainty", adds the mission's calibration parameters."""
    drawn = dict(content.get("draws", {}).get("variables", {}))
    if "uncertainty" in content:
        given = {*drawn, *content["design"].get("factors", {})}
        names = _mebots.calibration_parameters(content["mission"])
        if not names:
            raise InputError(
                f"'uncertainty': no FMU of {content['mission']} has a parameter calibration.* that can be drawn",
                "unknown_name",
            )
        drawn |= {name: {"uniform": [-1.0, 1.0]} for name in names if name not in given}
    return drawn


def _written(content: dict[str, Any]) -> str:
    return json.dumps(content, indent=1)


def _with_absolute_files(content: dict[str, Any], folder: pathlib.Path) -> dict[str, Any]:
    """Makes paths of factors' and draws' files absolute, so that the study can be read in any folder."""

    def absolute(value: Any, name: str = "") -> Any:
        if isinstance(value, dict):
            return {key: absolute(one, key) for key, one in value.items()}
        if isinstance(value, list):
            return [absolute(one, name) for one in value]
        if isinstance(value, str) and value and is_input(name, folder / value):
            return str(folder / value)
        return value

    found = dict(content)
    for section, keys in (("design", ("factors", "conditions")), ("draws", ("variables",))):
        if section in content:
            found[section] = {key: absolute(one) if key in keys else one for key, one in content[section].items()}
    return found


def _fork(content: dict[str, Any]) -> Fork:
    return Fork(float(content["at"]), tuple(content["variables"]))


def _bound(content: dict[str, Any]) -> float:
    return content["above"] if "above" in content else content["below"]


def _splitting(content: dict[str, Any]) -> Splitting:
    levels = tuple(float(level) for level in content.get("levels", ()))
    goal = levels[-1] if levels else float(_bound(content))
    rises = levels[-1] >= levels[0] if levels else "above" in content
    return Splitting(content["score"], levels, goal, 1 if rises else -1, content["missions"], tuple(content["reseed"]))


def _objective(label: str, content: dict[str, Any]) -> Objective:
    source = next(key for key in ("outcome", "end_reason", "summary", "final", "series", "expression") if key in content)
    what = content[source]
    if source in ("outcome", "end_reason"):
        what = (what,) if isinstance(what, str) else tuple(what)
    return Objective(
        label=label,
        source=source,
        what=what,
        reduction=content.get("of"),
        where=content.get("where"),
        sense=-1 if "minimize" in content else 1 if "maximize" in content else 0,
        tolerance=content.get("tolerance", 0.0),
        unit=content.get("unit", ""),
        percentile=content.get("percentile"),
    )


def _constraint(label: str, content: dict[str, Any]) -> Constraint:
    return Constraint(label, "above" in content, _bound(content))


def _stop(content: dict[str, Any]) -> Stop:
    label = content["objective"]
    side = _constraint(label, content) if "above" in content or "below" in content else None
    return Stop(label, content.get("width"), side, content.get("best", False))
