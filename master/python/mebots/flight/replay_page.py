# SPDX-License-Identifier: Apache-2.0
"""Writes replay.html with the curves and tables of a replay. web/src/report/replay.ts draws the page."""

from __future__ import annotations

import dataclasses
import math
import pathlib
from typing import Any

import numpy as np

from mebots.flight.compare import ErrorRow, thrusts
from mebots.flight.result import Replay, curves
from mebots.page import write_page

_MOST_POINTS = 1500
_DIGITS = 5


def write_replay_page(file: pathlib.Path, result: Replay) -> None:
    summary = result.summary
    data = {
        "kind": "replay",
        "fields": [field.name for field in dataclasses.fields(ErrorRow)],
        "errors": [[_number(cell) for cell in dataclasses.astuple(one)] for one in result.errors],
        "findings": [str(one) for one in result.findings],
        "notes": summary["notes"],
        "answer": answer(result),
        "charts": [*_charts(result), *_balance(result)],
        "window": summary["window_s"],
        "settle": summary["settle_s"],
    }
    provenance = {
        "log": f"{summary['log']} ({summary['kind']})",
        "airframe": f"{result.airframe.file} ({summary['airframe']})",
        "mass": summary["mass"]["source"],
        "rotor": summary["rotor"],
        "cell": summary["cell"],
    }
    title = f"{result.log.file.name} on {summary['airframe']}"
    write_page(file, title, data, provenance, data["answer"])


def answer(result: Replay) -> str:
    """Returns a sentence with the most important errors."""
    parts = []
    for quantity, what in (("battery.voltage", "voltage"), ("thrust.vertical", "vertical thrust")):
        found = [one for one in result.errors if one.quantity == quantity]
        if found:
            one = found[0]
            parts.append(f"{what}: {one.mean:+.3g} {one.unit} on average ({100 * one.relative:+.1f} %), rms {one.rms:.3g} {one.unit}, n = {one.n}")
    return "; ".join(parts) or "The log contains nothing to compare with."


def _number(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _thin(values: np.ndarray, stride: int) -> list[float | None]:
    """Returns every ``stride``-th value, rounded to ``_DIGITS``; None for missing values."""
    return [None if math.isnan(one) else float(f"{one:.{_DIGITS}g}") for one in values[::stride].tolist()]


def _charts(result: Replay) -> list[dict[str, Any]]:
    columns = curves(result)
    times = columns["time [s]"]
    first_s = times[0] + result.summary["settle_s"]
    stride = max(1, math.ceil(len(times) / _MOST_POINTS))
    groups: dict[str, list[tuple[str, np.ndarray]]] = {}
    for title, values in columns.items():
        if title == "time [s]":
            continue
        name, who, unit = title.split(" ")
        if who == "model":  # the acceleration from rest would dominate the scale
            values = np.where(times >= first_s, values, np.nan)
        groups.setdefault(f"{name} {unit}", []).append((who, values))
    x = _thin(times, stride)
    return [
        {"title": title, "x": x, "curves": [{"name": who, "y": _thin(values, stride)} for who, values in group]}
        for title, group in groups.items()
    ]


def _balance(result: Replay) -> list[dict[str, Any]]:
    motion = result.motion
    if motion is None or not len(motion.start):
        return []
    measured = {"name": "needed by the motion", "y": _thin(motion.needed_thrust_n, 1)}
    models = [{"name": given, "y": _thin(motion.vertical_thrust_n(thrust_n), 1)} for given, thrust_n, _ in thrusts(result.traces, result.log)]
    return [{"title": f"vertical thrust over {result.summary['window_s']:g} s [N]", "x": _thin(motion.middles_s, 1), "curves": [measured, *models]}]
