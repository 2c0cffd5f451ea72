# SPDX-License-Identifier: Apache-2.0
"""``mebots.replay``: runs a recorded flight on the models, and computes the errors of the models."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math
import os
import pathlib
import tempfile
from collections.abc import Sequence
from typing import Any

from mebots.errors import InputError
from mebots.exploration.files import write_csv, write_whole
from mebots.flight import quality
from mebots.flight.airframe import Airframe, read_airframe
from mebots.flight.compare import errors
from mebots.flight.inverse import NOTE, with_commands
from mebots.flight.log import COMMANDS, POSITION, FlightLog
from mebots.flight.motion import Motion, motion_of
from mebots.flight.reading import read_log
from mebots.flight.replay_page import write_replay_page
from mebots.flight.result import Replay, curves, table
from mebots.flight.traces import Traces, fly


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
    """Runs the commands of a recorded flight on the models of motors and battery, as ``mebots replay`` does, and compares
    voltage, rotor speeds, thrust and vertical motion with the measured ones.

    :param log: a Crazyflie's uSD log, PX4's ULog, or CSV.
    :param airframe: airframe file (.json): rotor, cell, mass.
    :param out: folder for errors.csv, replay.json, traces.csv, replay.html and the mission; None = no files.
    :param mapping: file (.json) that maps columns of the log to signals.
    :param decks: decks of the drone, in place of the airframe's.
    :param mass: mass of the whole drone [kg], in place of the airframe's.
    :param initial_charge: state of charge at the start, 0 to 1; by default the value that fits the first voltages.
    :param window: length of the windows of the momentum balance [s].
    :param hover: the drone hovered in a log without motion: the required thrust is its weight.
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
        _make(folder)
    inverted = not any(name in raw for name in COMMANDS) and clean.has(["battery.voltage", POSITION[2]])
    if inverted:
        clean = with_commands(clean, flown)
    with tempfile.TemporaryDirectory(prefix="mebots-replay-") as name:  # if the run fails, OUT stays unchanged
        traces = fly(clean, flown, pathlib.Path(name), step, initial_charge)
        mission = {file.name: file.read_bytes() for file in pathlib.Path(name).iterdir() if file.name in ("mission.json", "inputs.csv")}
    motion = None if inverted else motion_of(clean, flown, traces.times, traces.good, window, hover)
    rows = errors(raw, clean, traces, motion)
    result = Replay(clean, flown, rows, findings, _summary(clean, flown, traces, motion, window), traces, motion)
    if folder is not None:
        _write(folder, result, mission)
    return result


_FILES = ("mission.json", "inputs.csv", "errors.csv", "replay.json", "traces.csv", "replay.html")


def _make(folder: pathlib.Path) -> None:
    """Creates the folder. Raises InputError if this fails, or if a folder has the name of a result file."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"--out {folder}: the folder cannot be created: {error.strerror}; choose another one", "invalid_argument") from None
    for name in _FILES:
        if (folder / name).is_dir():
            raise InputError(f"--out {folder}: {name} in it is a folder, but must be a file; choose another folder", "invalid_argument")


def _summary(log: FlightLog, airframe: Airframe, traces: Traces, motion: Motion | None, window_s: float) -> dict[str, Any]:
    charge = traces["battery.cell.state_of_charge"]
    used_c = float(charge[0] - charge[-1]) * traces.capacity_c
    energy_j = float(traces["motors.energy"][-1] + traces["battery.avionics.energy"][-1])
    duration_s = float(traces.times[-1] - traces.times[0])
    notes = [*log.notes, *traces.notes]
    if motion is None:
        if NOTE not in notes:
            notes.append("the log has neither vertical speed nor height, so there is no momentum balance")
    else:
        notes += motion.notes
        if not len(motion.start):
            notes.append(f"every window of {window_s:g} s has a gap, so there is no momentum balance")
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
        "settle_s": traces.settle_s,
        "notes": notes,
    }


def _write(folder: pathlib.Path, result: Replay, mission: dict[str, bytes]) -> None:
    for name, file in mission.items():
        write_whole(folder / name, [file])
    write_csv(folder / "errors.csv", table(result.errors))
    content = result.summary | {
        "errors": [dataclasses.asdict(one) for one in result.errors],
        "findings": [dataclasses.asdict(one) for one in result.findings],
    }
    write_whole(folder / "replay.json", [(json.dumps(_finite(content), indent=2) + "\n").encode()])
    write_whole(folder / "traces.csv", [_traces(result).encode()])
    write_replay_page(folder / "replay.html", result)


def _finite(value: Any) -> Any:
    """Replaces NaN by None for JSON."""
    if isinstance(value, dict):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_finite(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _traces(result: Replay) -> str:
    columns = curves(result)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([["" if math.isnan(cell) else f"{cell:.8g}" for cell in line] for line in zip(*columns.values(), strict=True)])
    return text.getvalue()
