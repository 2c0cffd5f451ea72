# SPDX-License-Identifier: Apache-2.0
"""Creates orders of missions. An order contains everything that a worker needs, and the hash of all inputs.

Orders name files (FMUs, firmware, networks, cells) by their hashes, so they are valid on every machine. Paths on this machine are stored
separately.
"""

from __future__ import annotations

import copy
import dataclasses
import functools
import hashlib
import json
import math
import os
import pathlib
import re
import shlex
from collections.abc import Iterable, Sequence
from typing import Any

from mebots import _mebots
from mebots.errors import InputError
from mebots.exploration.inputs import digest_of_file, digest_of_input, is_input
from mebots.exploration.orders import DIGEST_BYTES, Order, Orders
from mebots.exploration.study import Study, Values

FILE_MARK = "mebots-file:"
"""Prefix of a text that names a file by the hash that follows."""

Course = tuple["Turn", ...]
"""The points at which a mission starts to differ from other missions with the same earlier part."""


@dataclasses.dataclass(frozen=True)
class Turn:
    """Values of inputs and tunable parameters to write at a ``place``. This is the first communication point at or after a time
    (``{"at": s}``), or the first at which a variable reaches a level (``{"score": [name, sign], "level": value}``)."""

    place: Values
    writes: Values

_NOT_OF_A_MISSION = ("text", "record", "pictures", "view", "log", "threads", "uncertainty")  # without effect on results
_OF_RESULTS = ("record", "pictures", "view", "log")

_PATH = re.compile(r"(?<![\w.~/])/(?:[^\s/:;,'\"]+/)+([^\s/:;,'\"]*)")


canonical = json.JSONEncoder(sort_keys=True, separators=(",", ":")).encode
"""Returns the JSON text of a value for hashes."""


def digest_of(value: Any) -> str:
    return hashlib.sha256(canonical(value).encode()).hexdigest()


@functools.cache
def build() -> str:
    """Returns a hash of the program that runs missions. During development, builds differ without a new version number."""
    return digest_of_file(_mebots.__file__)


def without_paths(text: str) -> str:
    """Replaces paths in a message by file names."""
    return _PATH.sub(r"\1", text)


@dataclasses.dataclass
class _Variant:
    """The config of a mission after factors have set its keys."""

    config: str
    digest: str
    files: dict[str, list[str]]
    last_point_s: float
    """The last communication point before the stop time."""
    stop_time_s: float
    kept: Any  # keeps an SSP's unpacked folder


class Missions:
    """Creates orders from designs and draws. Computes each file's hash only once."""

    def __init__(self, study: Study) -> None:
        self._study = study
        self._digests: dict[str, str] = {}
        self._found: dict[tuple[str, str], str] = {}  # paths of files named in texts
        self._plain: dict[tuple[str, ...], bool] = {}
        self._names: dict[tuple[str, ...], list[tuple[str, str]]] = {}
        self._drawn: dict[str, tuple[list[Any], list[bytes]]] = {}
        self._hash_begin = f'{{"build":{canonical(build())},"config":"'
        self._hash_end = f',"version":{canonical(_mebots.__version__)}}}'
        self._variants: dict[str, _Variant] = {}
        self._ground = _mebots.BaseConfig(study.mission)
        self.config: dict[str, Any] = json.loads(self._ground.config)
        finals = {one.what for one in study.objectives if one.source == "final"}
        series = {(one.what, one.reduction) for one in study.objectives if one.source == "series"}
        self._finals = sorted(finals)
        self._series = [list(pair) for pair in sorted(series)]
        factors = study.design.get("factors", {})
        self._options = {name: one["options"] for name, one in factors.items() if isinstance(one, dict) and "options" in one}
        self.folder: pathlib.Path | None = None
        """Folder of the results, with 256 folders for the first two digits of the mission's hash."""

    def order(self, values: Values) -> Order:
        """Returns the order of the mission with these values of factors and draws. Raises InputError if a JSON pointer finds no value in
        the config, or if no communication point before the stop time is at or after the fork."""
        fork = self._study.fork
        if fork is None:
            return self._order(values, ())
        variant = self._variant(self._divide(values)[0])
        if fork.at_s > variant.last_point_s:
            raise InputError(
                f"'fork': at {fork.at_s:g} s or later there is no communication point before the mission's stop time, "
                f"{variant.stop_time_s:g} s: its values would have no effect",
                "invalid_value",
            )
        later = {name: value for name, value in values.items() if name in fork.variables}
        before = {name: value for name, value in values.items() if name not in later}
        return self._order(before, (Turn({"at": fork.at_s}, later),))

    def order_until(self, place: Values, values: Values, course: Course) -> Order:
        """Returns the order of a mission that follows ``course`` up to ``place`` and saves its state there. Missions whose courses begin in
        the same way can start from this state."""
        order = self._order(values, course)
        order["until"] = place
        order["keeps"] = self._past(order["mission"], place)
        order["mission"] = digest_of({"mission": order["mission"], "until": place})
        return order

    def _past(self, mission: str, place: Values) -> str:
        """Returns the hash under which the state of a mission at ``place`` is saved. It depends on the recorded variables."""
        return digest_of([mission, place, self._series])

    def _order(self, values: Values, course: Course) -> Order:
        pointers, settings = self._divide(values)
        variant = self._variant(pointers)
        files = dict(variant.files)
        for name, value in settings.items():
            if isinstance(value, str):
                settings[name] = self._portable(name, value, files)
        # Equals digest_of() of a dict with these four members.
        text = f'{self._hash_begin}{variant.digest}","settings":{self._canonical(settings)}{self._hash_end}'
        digest = hashlib.sha256(text.encode()).hexdigest()
        turns = []
        for turn in course:
            turns.append({"place": turn.place, "writes": turn.writes, "past": self._past(digest, turn.place)})
            digest = digest_of([digest, turn.place, turn.writes])
        order = {
            "mission": digest,
            "build": build(),
            "course": turns,
            "config": variant.config,
            "digest": variant.digest,
            "settings": settings,
            "files": files,
            "finals": self._finals,
            "series": self._series,
            "processor_time": self._study.processor_time_s,
        }
        if self.folder is not None:
            order["out"] = str(self.folder / digest[:2] / digest)
        return order

    def orders(self, fixed: Values, drawn: Sequence[Values]) -> Orders:
        """Returns the orders of missions with the same factors and different draws."""
        if not drawn or not self._are_columns(fixed, drawn[0]):
            return Orders.of([self.order(fixed | draws) for draws in drawn])
        common = self._order(fixed | drawn[0], ())
        columns = {name: [draws[name] for draws in drawn] for name in drawn[0]}
        pieces, texts = self._pieces(common, columns)
        begin, end = f"{self._hash_begin}{common['digest']}\",\"settings\":{{".encode(), f"}}{self._hash_end}".encode()
        form = begin + b",".join(pieces) + end
        rows = zip(*texts, strict=True)
        sha256 = hashlib.sha256
        digests = [sha256(form % row).digest() for row in rows]
        assert len(digests[0]) == DIGEST_BYTES and digests[0].hex() == common["mission"]
        return Orders(digests, common, columns)

    def _are_columns(self, fixed: Values, draws: Values) -> bool:
        """True if missions with these draws differ only in numbers, so that they need only columns: they have the same config, files and
        course."""
        numbers = all(isinstance(value, (int, float)) for value in draws.values())
        return bool(draws) and numbers and not _has_pattern((*fixed, *draws)) and self._study.fork is None and self.folder is None and self._is_plain((*fixed, *draws))

    def _pieces(self, common: Order, columns: dict[str, list[Any]]) -> tuple[list[bytes], list[list[bytes]]]:
        """Returns two lists for the hash of a mission: pieces of the JSON text of ``settings``, with ``%b`` in place of values that differ
        between missions; and the texts of these values for each mission."""
        pieces, texts = [], []
        for name in sorted(common["settings"]):
            title = f"{canonical(name)}:".replace("%", "%%").encode()
            if name in columns:
                pieces.append(title + b"%b")
                texts.append(self._texts(name, columns[name]))
            else:
                pieces.append(title + canonical(common["settings"][name]).replace("%", "%%").encode())
        return pieces, texts

    def _texts(self, name: str, values: list[Any]) -> list[bytes]:
        """Returns the ``canonical`` texts of values. Caches the last texts of each name, because all designs have the same draws."""
        known = self._drawn.get(name)
        if known is None or known[0] != values:
            known = self._drawn[name] = values, [_canonical_of(value).encode() for value in values]
        return known[1]

    def shell_line(self, values: Values, out: str) -> str:
        """Returns the command that repeats a mission with all results and pictures. Returns "" if options cannot set all values, because
        some change the config."""
        settings = self.settings_words(values)
        if settings is None:
            return ""
        return " ".join(filter(None, (shlex.join(["mebots", "run", str(self._study.mission), "--out", out]), settings)))

    def settings_words(self, values: Values) -> str | None:
        """Returns the options of `mebots run` that set these values, or None if options cannot set all of them."""
        pointers, settings = self._divide(values)
        stop_time = pointers.pop("/stop_time", None)
        if pointers or self._study.fork is not None:
            return None
        words = ["--set", *(f"{name}={_as_typed(value)}" for name, value in settings.items())] if settings else []
        if stop_time is not None:
            words += ["--stop-time", _as_typed(stop_time)]
        return shlex.join(words)

    def replay(self, values: Values, folder: pathlib.Path, name: str, text: str, scenario: list[Values]) -> str:
        """Writes a scenario that repeats the changes during a mission. Returns the command that repeats the mission with this scenario, or
        "" if options cannot set all values."""
        command = self.shell_line(values, str(folder / name))
        if command:
            folder.mkdir(exist_ok=True)
            file = folder / f"{name}.json"
            file.write_text(json.dumps({"text": text, "scenario": scenario}, indent=1) + "\n", encoding="utf-8")
            command += f" --scenario {shlex.quote(str(file))}"
        return command

    def settings(self, name: str, value: Any) -> Values:
        """Returns the settings of a factor or draw with this value: the value itself, or the settings of its option."""
        options = self._options.get(name)
        return {name: value} if options is None else options[value]

    def _divide(self, values: Values) -> tuple[Values, Values]:
        """Returns two dicts: the values of JSON pointers, which change the config, and the values of parameters. Replaces each option by
        its settings."""
        if self._is_plain(tuple(values)):
            return {}, {name: self._located(name, value) if isinstance(value, str) else value for name, value in values.items()}
        pointers: Values = {}
        settings: Values = {}
        for name, value in values.items():
            for key, setting in self.settings(name, value).items():
                place = pointers if key.startswith("/") else settings
                place[key] = self._located(key, setting) if isinstance(setting, str) else setting
        return pointers, settings

    def _is_plain(self, names: tuple[str, ...]) -> bool:
        """True if all names are parameters, not JSON pointers or names with options."""
        if names not in self._plain:
            self._plain[names] = not any(name.startswith("/") or name in self._options for name in names)
        return self._plain[names]

    def _located(self, name: str, value: str) -> str:
        """If ``value`` is a relative path of an input in one of the study's folders, returns the absolute path. Otherwise, returns
        ``value``."""
        if (name, value) not in self._found:
            paths = (str(folder / value) for folder in self._study.folders)
            relative = value and not os.path.isabs(value)
            self._found[name, value] = next((path for path in paths if is_input(name, path)), value) if relative else value
        return self._found[name, value]

    def _portable(self, name: str, value: Any, files: dict[str, list[str]]) -> Any:
        if not isinstance(value, str) or not is_input(name, value):
            return value
        path = os.path.abspath(value)
        digest = self._digests.get(path)
        if digest is None:
            digest = self._digests[path] = digest_of_input(path)
        files[digest] = [path, os.path.basename(path)]
        return FILE_MARK + digest

    def _canonical(self, settings: Values) -> str:
        """Returns ``canonical(settings)``, faster for numbers."""
        names = tuple(settings)
        if names not in self._names:
            ordered = names if _has_pattern(names) else sorted(names)  # with patterns, the order of settings matters
            self._names[names] = [(name, f"{canonical(name)}:") for name in ordered]
        return "{" + ",".join([title + _canonical_of(settings[name]) for name, title in self._names[names]]) + "}"

    def _variant(self, pointers: Values) -> _Variant:
        key = canonical(pointers) if pointers else "{}"
        if key not in self._variants:
            self._variants[key] = self._make_variant(pointers)
        return self._variants[key]

    def _make_variant(self, pointers: Values) -> _Variant:
        config = copy.deepcopy(self.config)
        for pointer, value in pointers.items():
            _put(config, pointer, value)
        ground = _mebots.BaseConfig(self._study.mission, json.dumps(config)) if pointers else self._ground
        config = json.loads(ground.config)
        shown = {section: config.pop(section) for section in _NOT_OF_A_MISSION if section in config}
        files: dict[str, list[str]] = {}
        for instance, path in json.loads(ground.fmus).items():
            config["instances"][instance]["fmu"] = self._portable("fmu", path, files)
        for instance in config["instances"].values():
            parameters = instance.get("parameters", {})
            for name, value in parameters.items():
                parameters[name] = self._portable(name, value, files)
        for entry in _signals(config):
            entry["file"] = self._portable("file", entry["file"], files)
        digest = digest_of(config)
        if self._study.results:
            config |= {section: shown[section] for section in _OF_RESULTS if section in shown}
        return _Variant(json.dumps(config), digest, files, ground.last_point_s, ground.stop_time_s, ground)


def _has_pattern(names: Iterable[str]) -> bool:
    """True if the name of a setting can match several variables."""
    return any("*" in name or "?" in name for name in names)


def _canonical_of(value: Any) -> str:
    if type(value) is float and math.isfinite(value):
        return repr(value)
    return str(value) if type(value) is int else canonical(value)


def _signals(config: dict[str, Any]) -> list[dict[str, Any]]:
    """Returns the parts of a config that name a signal file."""
    inputs = config.get("inputs", [])
    entries = [inputs] if isinstance(inputs, dict) else inputs
    return entries + [entry for entry in config.get("scenario", []) if "file" in entry]


def _put(config: dict[str, Any], pointer: str, value: Any) -> None:
    """Sets the value at a JSON pointer (RFC 6901). Only the last member may be new."""
    steps = [step.replace("~1", "/").replace("~0", "~") for step in pointer.split("/")[1:]]
    place: Any = config
    for number, step in enumerate(steps):
        last = number == len(steps) - 1
        if isinstance(place, list) and step.isdigit() and int(step) < len(place):
            key: Any = int(step)
        elif isinstance(place, dict) and (last or step in place):
            key = step
        else:
            raise InputError(f"the factor '{pointer}' does not exist in the mission's config: there is no '{step}'", "unknown_key")
        if last:
            place[key] = value
        else:
            place = place[key]


def _as_typed(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)
