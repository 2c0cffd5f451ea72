# SPDX-License-Identifier: Apache-2.0
"""``mebots.replay``: a recorded flight on our models, and the errors of the models."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math
import os
import pathlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from mebots.errors import InputError
from mebots.exploration.files import write_csv, write_whole
from mebots.flight import quality
from mebots.flight.airframe import Airframe, read_airframe
from mebots.flight.compare import ErrorRow, errors
from mebots.flight.log import FlightLog
from mebots.flight.motion import Motion, motion_of
from mebots.flight.quality import Finding
from mebots.flight.reading import read_log
from mebots.flight.traces import SETTLE_S, Traces, fly

FIELDS = ("quantity", "unit", "model", "n", "excluded", "measured", "mean", "rms", "p5", "p50", "p95")


@dataclasses.dataclass(frozen=True)
class Replay:
    """A replayed flight. ``errors``: one row for each measured quantity and way to compute it. ``findings``: bad samples
    of the log. ``summary``: what the model says of energy and charge, and notes on what the log lacks."""

    log: FlightLog
    airframe: Airframe
    errors: list[ErrorRow]
    findings: list[Finding]
    summary: dict[str, Any]
    traces: Traces
    motion: Motion | None

    def error(self, quantity: str, model: str) -> ErrorRow:
        """The row of a quantity. Raises KeyError."""
        for one in self.errors:
            if (one.quantity, one.model) == (quantity, model):
                return one
        raise KeyError(f"'{quantity}' by '{model}' was not compared; compared: {sorted({one.quantity for one in self.errors})}")


def replay(
    log: str | os.PathLike[str],
    airframe: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str] | None = None,
    mapping: str | os.PathLike[str] | None = None,
    decks: Sequence[str] | None = None,
    mass: float | None = None,
    initial_charge: float | None = None,
    window: float = 1.0,
    hover: bool = False,
    step: float = 0.002,
) -> Replay:
    """Flies the commands of a recorded flight on the models of motors and battery, as ``mebots replay`` does, and compares
    voltage, rotor speeds, thrust and vertical motion with what was measured.

    :param log: a Crazyflie's uSD log, PX4's ULog, or CSV.
    :param airframe: airframe file (.json): rotor, cell, mass.
    :param out: folder for errors.csv, replay.json, traces.csv, replay.html and the mission; None = no files.
    :param mapping: file (.json) that says which column of the log is which signal.
    :param decks: decks that the drone carried, in place of the airframe's.
    :param mass: mass of the whole drone [kg], in place of the airframe's.
    :param initial_charge: state of charge at the start, 0 to 1; by default the one with which the first voltages agree.
    :param window: length of the windows of the momentum balance [s].
    :param hover: a log without motion is of a drone that hovered: the needed thrust is its weight.
    :param step: communication step [s].
    """
    if not 0.1 <= window <= 60:
        raise InputError(f"--window {window:g}: a time from 0.1 to 60 s is expected", "invalid_value")
    if not 1e-4 <= step <= 0.02:
        raise InputError(f"--step {step:g}: a time from 0.0001 to 0.02 s is expected", "invalid_value")
    if initial_charge is not None and not 0 < initial_charge <= 1:
        raise InputError(f"--charge {initial_charge:g}: a number above 0, up to 1, is expected", "invalid_value")
    flown = read_airframe(airframe, decks, mass)
    raw = read_log(log, mapping)
    clean, findings = quality.clean(raw, cells=1)
    folder = None if out is None else pathlib.Path(out)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    traces = fly(clean, flown, folder, step, initial_charge)
    motion = motion_of(clean, flown, traces.times, traces.good, window, hover)
    rows = errors(raw, clean, traces, motion)
    result = Replay(clean, flown, rows, findings, _summary(clean, flown, traces, motion, window), traces, motion)
    if folder is not None:
        _write(folder, result)
    return result


def _summary(log: FlightLog, airframe: Airframe, traces: Traces, motion: Motion | None, window_s: float) -> dict[str, Any]:
    charge = traces["battery.cell.state_of_charge"]
    used_c = float(charge[0] - charge[-1]) * traces.capacity_c
    energy_j = float(traces["motors.energy"][-1] + traces["battery.avionics.energy"][-1])
    duration_s = float(traces.times[-1] - traces.times[0])
    notes = [*log.notes, *traces.notes]
    if motion is None:
        notes.append("the log has neither vertical speed nor height: no momentum balance")
    else:
        notes += motion.notes
        if not len(motion.start):
            notes.append(f"no window of {window_s:g} s is without a gap: no momentum balance")
    return {
        "log": str(log.file),
        "kind": log.kind,
        "airframe": airframe.name,
        "mass": {"value": airframe.mass_kg, "unit": "kg", "source": airframe.mass_text},
        "rotor": airframe.part("rotor"),
        "cell": airframe.part("cell"),
        "duration_s": duration_s,
        "compared_s": float(traces.good.mean()) * duration_s,
        "initial_charge": traces.initial_charge,
        "final_charge": float(charge[-1]),
        "charge_used_c": used_c,
        "energy_j": energy_j,
        "mean_power_w": energy_j / duration_s,
        "window_s": window_s,
        "windows": 0 if motion is None else len(motion.start),
        "settle_s": SETTLE_S,
        "notes": notes,
    }


def table(rows: Sequence[ErrorRow]) -> list[list[str]]:
    """The rows as texts, below their titles."""
    return [list(FIELDS), *([_text(getattr(one, field)) for field in FIELDS] for one in rows)]


def _text(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def shown(result: Replay) -> str:
    """The table and the notes for a terminal."""
    lines = table(result.errors)
    widths = [max(len(line[i]) for line in lines) for i in range(len(FIELDS))]
    text = ["  ".join(cell.ljust(width) if i < 3 else cell.rjust(width) for i, (cell, width) in enumerate(zip(line, widths, strict=True))).rstrip() for line in lines]
    summary = result.summary
    text += ["", "errors are model less measurement; p5, p50 and p95 are percentiles of the error"]
    text.append(
        f"{summary['airframe']}, {summary['mass']['source']}; charge {100 * summary['initial_charge']:.1f} to "
        f"{100 * summary['final_charge']:.1f} %, {summary['charge_used_c'] / 3.6:.1f} mAh, {summary['energy_j']:.0f} J, "
        f"{summary['mean_power_w']:.2f} W over {summary['duration_s']:.1f} s by the model"
    )
    text += [f"note: {note}" for note in summary["notes"]]
    text += [f"log: {finding}" for finding in result.findings]
    return "\n".join(text)


def _write(folder: pathlib.Path, result: Replay) -> None:
    write_csv(folder / "errors.csv", table(result.errors))
    content = result.summary | {
        "errors": [dataclasses.asdict(one) for one in result.errors],
        "findings": [dataclasses.asdict(one) for one in result.findings],
    }
    write_whole(folder / "replay.json", [(json.dumps(_finite(content), indent=2) + "\n").encode()])
    write_whole(folder / "traces.csv", [_traces(result).encode()])
    from mebots.flight.replay_page import write_replay_page

    write_replay_page(folder / "replay.html", result)


def _finite(value: Any) -> Any:
    """JSON has no NaN."""
    if isinstance(value, dict):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_finite(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


TRACE_INTERVAL_S = 0.02


def curves(result: Replay) -> dict[str, np.ndarray]:
    """Model and measurement side by side, every ``TRACE_INTERVAL_S``; NaN where nothing was measured."""
    traces = result.traces
    stride = max(1, round(TRACE_INTERVAL_S / float(traces.times[1] - traces.times[0])))
    times = traces.times[::stride]
    pairs = {"battery.voltage": "battery.bus.voltage", "battery.current": "battery.cell.current"}
    pairs |= {f"rotor[{i}].speed": f"motors.rotor[{i}].speed" for i in range(1, 5)}
    columns = {"time [s]": times}
    for name, variable in pairs.items():
        unit = {"battery.voltage": "V", "battery.current": "A"}.get(name, "rad/s")
        columns[f"{name} model [{unit}]"] = traces[variable][::stride]
        if result.log.has([name]):
            signal = result.log[name]
            measured = np.interp(times, signal.times, signal.values)
            columns[f"{name} measured [{unit}]"] = np.where(quality.covered(signal, times), measured, np.nan)
    columns["power model [W]"] = (traces["motors.power"] + traces["motors.avionics.power"])[::stride]
    columns["charge model [1]"] = traces["battery.cell.state_of_charge"][::stride]
    return columns


def _traces(result: Replay) -> str:
    columns = curves(result)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([["" if math.isnan(cell) else f"{cell:.8g}" for cell in line] for line in zip(*columns.values(), strict=True)])
    return text.getvalue()
