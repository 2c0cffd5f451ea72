# SPDX-License-Identifier: Apache-2.0
"""Reads airframe files and the data files to which they refer."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
import zipfile
from collections.abc import Sequence
from typing import Any

from mebots import _mebots
from mebots.errors import InputError

_SHIPPED = {"rotor": ("fmu_motors", "rotors"), "cell": ("fmu_battery", "cells"), "drone": ("fmu_world", "drones")}


@dataclasses.dataclass(frozen=True)
class Airframe:
    """The configuration of a drone. ``rotor``, ``cell`` and ``drone`` are names of shipped files, or paths."""

    file: pathlib.Path
    content: dict[str, Any]
    decks: tuple[str, ...]
    weighed_kg: float | None
    """The weighed mass of the whole drone; None if it is not known."""

    @property
    def name(self) -> str:
        return self.content["name"]

    def part(self, kind: str) -> str:
        return self.content[kind]

    def path(self, kind: str) -> str:
        """Returns the value of the FMU's parameter that selects the rotor, cell or drone: the name of a shipped file, or an absolute
        path."""
        name = self.part(kind)
        return str(pathlib.Path(name).resolve()) if name.endswith(".json") else name

    def data(self, kind: str) -> dict[str, Any]:
        """Returns the content of the data file ``rotor``, ``cell`` or ``drone``."""
        name = self.part(kind)
        if name.endswith(".json"):
            return _read_part(kind, pathlib.Path(name))
        return shipped(kind, name)

    @property
    def avionics_power_w(self) -> float:
        return self.content["avionics_power"]["value"]

    @property
    def mass_kg(self) -> float:
        """Returns the mass of the drone with its cell and decks."""
        if self.weighed_kg is not None:
            return self.weighed_kg
        decks = sum(self.content["decks"][deck]["value"] for deck in self.decks)
        return self.content["mass_without_cell"]["value"] + decks + self.data("cell")["mass"]["value"]

    @property
    def mass_text(self) -> str:
        if self.weighed_kg is not None:
            return f"{1e3 * self.mass_kg:.1f} g, weighed"
        return f"{1e3 * self.mass_kg:.1f} g: {' + '.join(['drone', 'cell', *self.decks])} of {self.file.name}"

    @property
    def vertical_drag_ns_per_m(self) -> float:
        return self.data("drone")["drag"]["values"][2]


_MASS_FACTOR = 5.0
"""A weighed mass that differs by a larger factor belongs to another drone, or is in grams."""
_NEEDED = {"rotor": ("thrust_coefficient", "value"), "cell": ("mass", "value"), "drone": ("drag", "values")}
"""The values that are read here. The FMUs check the rest of rotor and cell."""


def _read_part(kind: str, file: pathlib.Path) -> dict[str, Any]:
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except ValueError as error:
        raise InputError(f"{file}: the {kind} file is not JSON: {error}", "syntax_error") from None
    outer, inner = _NEEDED[kind]
    part = content.get(outer) if isinstance(content, dict) else None
    if not isinstance(part, dict) or inner not in part:
        raise InputError(f"{file}: there is no /{outer}/{inner}, so this is not a {kind} file; `mebots schema {kind}` prints its keys", "missing_key")
    return content


def read_airframe(file: str | os.PathLike[str], decks: Sequence[str] | None = None, mass_kg: float | None = None) -> Airframe:
    """Reads an airframe file. Raises InputError with all errors of the file.

    :param decks: decks of the drone, in place of the file's ``fitted_decks``.
    :param mass_kg: mass of the whole drone, in place of the sum of its parts.
    """
    path = pathlib.Path(file)
    content = json.loads(_mebots.read_airframe(path))
    known = content.get("decks", {})
    fitted = tuple(content.get("fitted_decks", ()) if decks is None else decks)
    for deck in fitted:
        if deck not in known:
            raise InputError(f"{path}: there is no deck '{deck}'. The file has: {', '.join(known) or 'none'}", "unknown_name")
    if mass_kg is not None and not 0 < mass_kg < 1e3:
        raise InputError(f"--mass {mass_kg}: the mass of the whole drone is expected, in kg", "invalid_value")
    airframe = Airframe(path, content, fitted, mass_kg)
    for kind in _SHIPPED:
        airframe.data(kind)
    summed_kg = dataclasses.replace(airframe, weighed_kg=None).mass_kg
    if mass_kg is not None and not summed_kg / _MASS_FACTOR < mass_kg < summed_kg * _MASS_FACTOR:
        raise InputError(
            f"--mass {mass_kg:g}: the parts of {path} have {summed_kg:.4g} kg together, and the given mass differs from this by more than a factor of {_MASS_FACTOR:g}; "
            "give it in kg, or name the airframe that flew",
            "invalid_value",
        )
    return airframe


def shipped(kind: str, name: str) -> dict[str, Any]:
    """Returns a data file inside an FMU. If it does not exist, raises InputError with the available names."""
    fmu, folder = _SHIPPED[kind]
    with zipfile.ZipFile(_mebots.find_fmu(fmu)) as archive:
        prefix = f"resources/{folder}/"
        names = [entry.removeprefix(prefix).removesuffix(".json") for entry in archive.namelist() if entry.startswith(prefix)]
        if name not in names:
            raise InputError(f"there is no {kind} '{name}' in {fmu}. It has: {', '.join(sorted(filter(None, names)))}", "unknown_name")
        return json.loads(archive.read(f"{prefix}{name}.json"))
