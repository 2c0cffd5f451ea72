# SPDX-License-Identifier: Apache-2.0
"""``mebots identify``: fits an airframe to recorded flights by least squares.

Thrust and mass cannot both be fitted. In flight, only the ratio F/m has an effect: a drone that is 5 % heavier with
rotors that are 5 % stronger moves in the same way. Therefore either the mass is assumed as known and the thrust
coefficient is fitted, or the reverse.
"""

from __future__ import annotations

import copy
import dataclasses
import hashlib
import json
import os
import pathlib
import tempfile
from collections.abc import Sequence
from typing import Any

import numpy as np

from mebots.errors import InputError
from mebots.exploration.files import write_whole
from mebots.flight import quality
from mebots.flight.airframe import Airframe, read_airframe
from mebots.flight.cell_fit import FACTORS, CellFit, capacity_c, fit_cell, flight_of, scaled_cell
from mebots.flight.compare import MEASURED_SPEEDS, thrusts
from mebots.flight.fitting import Fit, clusters_of, solve
from mebots.flight.log import FlightLog
from mebots.flight.motion import Motion, motion_of
from mebots.flight.reading import read_log
from mebots.flight.traces import Traces, fly

SCALE_KG = 1e-4
"""The assumed uncertainty of a weighed mass."""
WHAT = ("thrust", "mass", "cell")
_BLOCK_WINDOWS = 5


@dataclasses.dataclass(frozen=True)
class Estimate:
    """A fitted value with its 95 % interval, and the base's value. Without a base, value and bounds are assumptions."""

    name: str
    unit: str
    value: float
    low: float
    high: float
    base: float | None
    remark: str = ""


@dataclasses.dataclass(frozen=True)
class Identified:
    """The result of a fit. ``residuals`` are sentences. ``files`` are the written files, with the airframe first."""

    estimates: list[Estimate]
    residuals: list[str]
    notes: list[str]
    files: list[pathlib.Path]


@dataclasses.dataclass(frozen=True)
class _Flown:
    log: FlightLog
    traces: Traces
    motion: Motion | None


def identify(
    logs: Sequence[str | os.PathLike[str]],
    airframe: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    fit: Sequence[str] = ("thrust", "cell"),
    mapping: str | os.PathLike[str] | None = None,
    decks: Sequence[str] | None = None,
    mass: float | None = None,
    hover: bool = False,
    window: float = 1.0,
) -> Identified:
    """Fits an airframe to recorded flights, as ``mebots identify`` does.

    :param logs: flights of one drone.
    :param airframe: the base airframe; properties that are not fitted keep its values.
    :param out: airframe file to write; OUT.rotor.json and OUT.cell.json are written next to it.
    :param fit: "thrust" or "mass", and "cell".
    :param mapping: maps columns of the logs to signals.
    :param decks: decks of the drone, in place of the airframe's.
    :param mass: mass of the whole drone [kg], in place of the airframe's.
    :param hover: the drone hovered in logs without motion.
    :param window: length of the windows of the momentum balance [s].
    """
    _check(logs, fit)
    base = read_airframe(airframe, decks, mass)
    target = pathlib.Path(out)
    if target.suffix != ".json" or not target.parent.is_dir():
        raise InputError(f"{target}: name a file that ends in .json, in a folder that is there", "invalid_argument")
    twice = [str(log) for place, log in enumerate(logs) if _hash(log) in map(_hash, logs[:place])]
    if twice:
        raise InputError(f"{twice[0]}: another log has the same content; each flight counts once, so leave one out", "invalid_value")
    flown = [_fly(log, mapping, base, hover, window) for log in logs]
    source = ", ".join(f"{pathlib.Path(log).name} (SHA-256 {_hash(log)})" for log in logs)
    result = Identified([], [], [], [])
    contents: dict[pathlib.Path, dict[str, Any]] = {}  # written after all fits
    new = copy.deepcopy(base.content)
    new.pop("$schema", None)
    new["name"] = f"{base.name}, fitted"
    if "thrust" in fit:
        _fit_thrust(base, flown, source, new, target, contents, result)
    if "mass" in fit:
        _fit_mass(base, flown, source, new, result)
    if "cell" in fit:
        _fit_cell(base, flown, source, new, target, contents, result)
    for part in ("drone", "rotor", "cell"):  # makes paths relative to the new file
        if os.path.isabs(new[part]):
            new[part] = os.path.relpath(new[part], target.parent.resolve())
    for file, content in (contents | {target: new}).items():
        write_json(file, content)
    result.files.extend([target, *contents])
    return result


def _check(logs: Sequence[str | os.PathLike[str]], fit: Sequence[str]) -> None:
    if not logs:
        raise InputError("name at least one log", "missing_key")
    for what in fit:
        if what not in WHAT:
            raise InputError(f"--fit {what}: one or more of {', '.join(WHAT)} are expected", "unknown_name")
    if "thrust" in fit and "mass" in fit:
        raise InputError(
            "--fit thrust,mass: flights determine the ratio of thrust to mass alone, so one of the two must be known. "
            "Weigh the drone, give its mass by --mass, and fit the thrust",
            "invalid_value",
        )


def _fly(log: str | os.PathLike[str], mapping: str | os.PathLike[str] | None, base: Airframe, hover: bool, window_s: float) -> _Flown:
    clean, _ = quality.clean(read_log(log, mapping), cells=1)
    traces = fly(clean, base, None, 0.002, None)
    # The comparison with the model's cell ends when that cell is empty. The thrust at the measured voltage does not depend on the cell.
    good = traces.good if not traces.has_measured_voltage else traces.logged
    return _Flown(clean, traces, motion_of(clean, base, traces.times, good, window_s, hover))


def _hash(file: str | os.PathLike[str]) -> str:
    try:
        return hashlib.sha256(pathlib.Path(file).read_bytes()).hexdigest()[:12]
    except OSError as error:
        raise InputError(f"{file}: the log cannot be read: {error.strerror}", "file_not_found") from None


@dataclasses.dataclass(frozen=True)
class _Balance:
    """Vertical forces in the windows of all flights: the thrust of the base airframe's rotors, the thrust that the measured motion requires
    for the base airframe's mass, and the drag."""

    model_n: np.ndarray
    needed_n: np.ndarray
    drag_n: np.ndarray
    clusters: np.ndarray
    given: set[str]


def _balance(flown: Sequence[_Flown]) -> _Balance:
    rows, logs, blocks, given = [], [], [], set()
    for number, one in enumerate(flown):
        if one.motion is None or not len(one.motion.start):
            continue
        *_, (how, thrust_n, known) = thrusts(one.traces, one.log)  # the last method is closest to the measurement
        whole = one.motion.mean(np.where(known, 0.0, 1.0)) == 0
        drag_n = one.motion.drag_ns_per_m * one.motion.mean(one.motion.speed_m_per_s)
        rows.append(np.array([one.motion.vertical_thrust_n(thrust_n), one.motion.needed_thrust_n, drag_n])[:, whole])
        logs.append(np.full(int(whole.sum()), number))
        blocks.append(np.arange(int(whole.sum())) // _BLOCK_WINDOWS)
        given.add(how)
    if not rows or sum(one.shape[1] for one in rows) < 3:
        raise InputError(
            f"{flown[0].log.file}: thrust and mass need three windows of motion at least: log the vertical speed or the height "
            "(stateEstimate.vz), or name --hover for a drone that hovered",
            "missing_key",
        )
    model_n, needed_n, drag_n = np.concatenate(rows, axis=1)
    return _Balance(model_n, needed_n, drag_n, clusters_of(np.concatenate(logs), np.concatenate(blocks)), given)


def _ratio(x: np.ndarray, y: np.ndarray, clusters: np.ndarray) -> Fit:
    """Returns the factor k in y = k x by least squares."""
    return solve(
        lambda values: values[0] * x - y, lambda values: x[:, None], np.array([1.0]), np.array([0.2]), np.array([5.0]), clusters
    )


def _describe(balance: _Balance, fit: Fit, result: Identified) -> None:
    ratio = fit.residuals / balance.needed_n
    result.residuals.append(
        f"vertical thrust: {len(ratio)} windows, rms {100 * np.sqrt(np.mean(ratio**2)):.2f} %, "
        f"5th to 95th percentile {100 * np.percentile(ratio, 5):+.2f} to {100 * np.percentile(ratio, 95):+.2f} %"
    )
    if balance.given != {MEASURED_SPEEDS}:
        result.notes.append(
            "not all logs have rotor speeds: the thrust is computed from commands and voltage, so errors of the modelled speed are part of it"
        )


def _widened(low: float, high: float, value: float, quantity: dict[str, Any]) -> tuple[float, float]:
    """Widens the interval by the relative uncertainty of a known quantity that all flights share."""
    if "interval" not in quantity:
        return low, high
    below = (quantity["value"] - quantity["interval"][0]) / quantity["value"]
    above = (quantity["interval"][1] - quantity["value"]) / quantity["value"]
    return value - np.hypot(value - low, below * value), value + np.hypot(high - value, above * value)


def _mass_of(base: Airframe) -> dict[str, Any]:
    """Returns the mass of the whole drone with its interval: that of the scale if the drone was weighed, otherwise that in the airframe
    file."""
    if base.weighed_kg is not None:
        below = above = SCALE_KG
    else:
        empty = base.content["mass_without_cell"]
        low, high = empty.get("interval", [empty["value"]] * 2)
        below, above = empty["value"] - low, high - empty["value"]
    return {"value": base.mass_kg, "interval": [base.mass_kg - below, base.mass_kg + above]}


def _fit_thrust(
    base: Airframe,
    flown: Sequence[_Flown],
    source: str,
    new: dict[str, Any],
    target: pathlib.Path,
    contents: dict[pathlib.Path, dict[str, Any]],
    result: Identified,
) -> None:
    balance = _balance(flown)
    fit = _ratio(balance.model_n, balance.needed_n, balance.clusters)
    rotor = base.data("rotor")
    old = rotor["thrust_coefficient"]["value"]
    factor = float(fit.values[0])
    low, high = _widened(*fit.interval(0), factor, _mass_of(base))
    # Multiplies the thrust by the factor. Divides torque and power per thrust by it, so that drag torque and power at a given speed stay
    # the same.
    rotor["thrust_coefficient"] = {
        "value": factor * old,
        "unit": "N.s2/rad2",
        "source": f"mebots identify, least squares of the vertical momentum balance with {base.mass_text}; interval: 95 %",
        "interval": [low * old, high * old],
        "fitted_on": source,
    }
    rotor["torque_per_thrust"]["value"] /= factor
    rotor["torque_per_thrust"].pop("interval", None)
    rotor["torque_per_thrust"]["source"] += "; divided by the factor of the fitted thrust coefficient, which leaves the drag torque"
    if "power_per_thrust" in rotor:
        rotor["power_per_thrust"]["value"] /= factor
        rotor["power_per_thrust"].pop("interval", None)
        rotor["power_per_thrust"]["source"] += "; divided by the factor of the fitted thrust coefficient, which leaves the power"
    rotor["name"] = f"{rotor['name']}, fitted"
    rotor.pop("$schema", None)
    file = target.with_suffix(".rotor.json")
    contents[file] = rotor
    new["rotor"] = file.name
    remark = "with 0.1 g for the scale" if base.weighed_kg else "with the interval of the airframe's mass"
    result.estimates.append(Estimate("thrust_coefficient", "N.s2/rad2", factor * old, low * old, high * old, old, remark))
    _describe(balance, fit, result)


def _fit_mass(base: Airframe, flown: Sequence[_Flown], source: str, new: dict[str, Any], result: Identified) -> None:
    balance = _balance(flown)
    # In the momentum balance F - c v = m (g + a), F is `model_n` and c v is `drag_n`. `needed_n` - `drag_n` is m (g + a) for the base
    # airframe's mass.
    fit = _ratio(balance.needed_n - balance.drag_n, balance.model_n - balance.drag_n, balance.clusters)
    factor = float(fit.values[0])
    low, high = _widened(*fit.interval(0), factor, base.data("rotor")["thrust_coefficient"])
    others = base.mass_kg - base.content["mass_without_cell"]["value"] if base.weighed_kg is None else _parts_kg(base)
    value, below, above = (one * base.mass_kg - others for one in (factor, low, high))
    if below <= 0:
        raise InputError(f"the fitted mass of the drone, {1e3 * factor * base.mass_kg:.1f} g, is less than that of cell and decks", "invalid_value")
    new["mass_without_cell"] = {
        "value": value,
        "unit": "kg",
        "interval": [below, above],
        "source": f"mebots identify, least squares of the vertical momentum balance with the rotor {base.part('rotor')}; interval: 95 %",
        "known": "fitted",
        "fitted_on": source,
    }
    result.estimates.append(Estimate("mass", "kg", factor * base.mass_kg, low * base.mass_kg, high * base.mass_kg, base.mass_kg, "drone with cell and decks"))
    _describe(balance, fit, result)


def _parts_kg(base: Airframe) -> float:
    return base.data("cell")["mass"]["value"] + sum(base.content["decks"][deck]["value"] for deck in base.decks)


def _fit_cell(
    base: Airframe,
    flown: Sequence[_Flown],
    source: str,
    new: dict[str, Any],
    target: pathlib.Path,
    contents: dict[pathlib.Path, dict[str, Any]],
    result: Identified,
) -> None:
    flights = [flight for one in flown if (flight := flight_of(one.log, one.traces)) is not None]
    if not flights:
        raise InputError(f"{flown[0].log.file}: a fit of the cell needs battery.voltage; --fit thrust leaves the cell as it is", "missing_key")
    cell = base.data("cell")
    with tempfile.TemporaryDirectory(prefix="mebots-identify-") as folder:
        found = fit_cell(cell, flights, pathlib.Path(folder))
    fitted = fitted_cell(cell, found, source)
    file = target.with_suffix(".cell.json")
    contents[file] = fitted
    new["cell"] = file.name
    describe_cell(cell, found, len(flights), result.estimates, result.residuals, result.notes)


def fitted_cell(base: dict[str, Any], found: CellFit, source: str) -> dict[str, Any]:
    """Returns a cell file with the fitted factors."""
    cell = scaled_cell(base, {name: value for name, (value, _, _) in found.factors.items()})
    cell.pop("$schema", None)
    cell["name"] = f"{base['name']}, fitted"
    curves = {"series_resistance": ["series_resistance"], "polarisation": ["pair1_resistance", "pair1_capacitance", "pair2_resistance", "pair2_capacitance"]}
    for name, (value, low, high) in found.factors.items():
        text = f"; times {value:.4g} (capacitances: divided), with 95 % from {low:.4g} to {high:.4g}, by mebots identify"
        for curve in curves.get(name, []):
            cell[curve]["source"] = cell[curve].get("source", base["name"]) + text
            cell[curve]["fitted_on"] = source
        if name == "series_resistance":
            factor = cell["resistance_factor"]["value"]
            cell["resistance_factor"] |= {"interval": [factor * low / value, factor * high / value], "fitted_on": source}
            cell["resistance_factor"]["source"] += "; interval: 95 % of the series resistance, by mebots identify"
        if name == "capacity":
            charge = base["capacity"]["value"]  # capacity_factor stays the same and also multiplies the interval
            cell.get("capacity_factor", {}).pop("interval", None)
            cell["capacity"] |= {"interval": [low * charge, high * charge], "fitted_on": source, "source": "mebots identify, least squares of voltages; interval: 95 %"}
    return cell


def describe_cell(
    base: dict[str, Any], found: CellFit, flights: int, estimates: list[Estimate], residuals: list[str], notes: list[str]
) -> None:
    for name in FACTORS:
        if name in found.factors:
            value, low, high = found.factors[name]
            if name == "capacity":
                charge = capacity_c(base)
                estimates.append(Estimate("capacity", "C", value * charge, low * charge, high * charge, charge))
            else:
                estimates.append(Estimate(name, "1", value, low, high, 1.0, f"factor on the base cell's {name.replace('_', ' ')}"))
        else:
            notes.append(f"{name.replace('_', ' ')} stays at the base's value: {found.kept[name]}")
    residuals.append(
        f"voltage: {found.count} means over 0.5 s of {flights} flights, rms {1e3 * found.rms_v:.1f} mV; with the base cell {1e3 * found.before_v:.1f} mV"
    )


def write_json(file: pathlib.Path, content: dict[str, Any]) -> None:
    write_whole(file, [(json.dumps(content, indent=2) + "\n").encode()])


def shown(result: Identified) -> str:
    """Returns the result as text for a terminal."""
    lines = []
    for one in result.estimates:
        remark = f" ({one.remark})" if one.remark else ""
        share, base = ("", "") if one.base is None else ("95 % ", f"; base {one.base:.5g}, {100 * (one.value / one.base - 1):+.1f} %")
        lines.append(f"{one.name}: {one.value:.5g} {one.unit}, {share}from {one.low:.5g} to {one.high:.5g}{base}{remark}")
    lines += [f"residuals of {text}" for text in result.residuals]
    lines += [f"note: {note}" for note in result.notes]
    lines.append("written: " + ", ".join(map(str, result.files)))
    return "\n".join(lines)
