# SPDX-License-Identifier: Apache-2.0
"""``mebots new-cell``: writes a cell file from the data on a label.

    capacity   as printed; sellers round up, so 10 % less is within the interval
    mass       as printed, with the uncertainty of its last digit
    current    the C rate times the capacity
    R0         the published cells of 250 mAh have 0.15 Ohm at 15 C and 0.06 Ohm at 25 C: at the stated current a cell
               loses 0.375 to 0.5625 V. C rates are often twice the true value, so twice the resistance is within the
               interval
    all else   open-circuit voltage and time constants of Chen and Rincon-Mora's cell, as in the shipped files

A measured resistance or discharge replaces the estimate.
"""

from __future__ import annotations

import copy
import os
import pathlib
import tempfile
from typing import Any

import numpy as np

from mebots.errors import InputError
from mebots.flight import quality
from mebots.flight.airframe import shipped
from mebots.flight.cell_fit import BLOCK_S, STEP_S, Flight, fit_cell
from mebots.flight.identify import Estimate, Identified, describe_cell, fitted_cell, write_json
from mebots.flight.log import FlightLog
from mebots.flight.reading import read_log

TEMPLATE = "bitcraze_250"
LEAST_LOSS_V, LOSS_V, MOST_LOSS_V = 0.375, 0.46875, 0.5625
OVERSTATED = 2.0
RULE_C_RATES = (10, 40)  # C rates similar to those of the cells from which LOSS_V results
SHORT_OF_CAPACITY = 0.1
_ASSUMED = "assumed by mebots new-cell"


def new_cell(
    out: str | os.PathLike[str],
    *,
    name: str,
    capacity: float,
    mass: float,
    c_rate: float,
    resistance: float | None = None,
    discharge: str | os.PathLike[str] | None = None,
    mapping: str | os.PathLike[str] | None = None,
) -> Identified:
    """Writes a cell file, as ``mebots new-cell`` does.

    :param out: cell file (.json) to write.
    :param name: the cell's name.
    :param capacity: [mAh], as printed.
    :param mass: [g], as printed.
    :param c_rate: continuous discharge current as a multiple of the capacity per hour. Without ``resistance`` and
        ``discharge``, from 10 to 40.
    :param resistance: measured series resistance [Ohm].
    :param discharge: log of a discharge from full charge, with battery.voltage and battery.current, for fitting the cell.
    :param mapping: maps columns of that log to signals.
    """
    file = pathlib.Path(out)
    if file.suffix != ".json" or not file.absolute().parent.is_dir():
        raise InputError(f"{file}: name a file that ends in .json, in an existing folder", "invalid_argument")
    for what, value, most in (("capacity", capacity, 1e6), ("mass", mass, 1e6), ("c-rate", c_rate, 1e3), ("resistance", resistance, 1e2)):
        if value is not None and not 0 < value < most:
            raise InputError(f"--{what} {value:g}: a number above 0, below {most:g}, is expected", "invalid_value")
    if resistance is None and discharge is None and not RULE_C_RATES[0] <= c_rate <= RULE_C_RATES[1]:
        raise InputError(
            f"--c-rate {c_rate:g}: the estimate of R0 comes from cells of 15 and 25 C and holds from {RULE_C_RATES[0]} to {RULE_C_RATES[1]} C. "
            "Set --resistance from a data sheet, or --discharge to a log", "invalid_value")
    cell = _stated(name, capacity, mass, c_rate, resistance)
    result = Identified([], [], [], [file])
    if discharge is not None:
        cell = _fit_discharge(cell, read_log(discharge, mapping), result)
        cell["name"] = name
    else:
        result.estimates.append(_series_resistance(cell, capacity, c_rate, resistance))
    write_json(file, cell)
    return result


def _digits(value: float) -> float:
    """Returns half a unit of the last digit with which ``value`` is printed."""
    text = f"{value:.12f}".rstrip("0")
    places = len(text.partition(".")[2])
    return 0.5 * 10.0**-places


def _resistance(capacity_mah: float, c_rate: float, loss_v: float) -> float:
    return loss_v / (c_rate * capacity_mah * 1e-3)


def _stated(name: str, capacity_mah: float, mass_g: float, c_rate: float, resistance_ohm: float | None) -> dict[str, Any]:
    """Returns the cell that a label describes."""
    cell = copy.deepcopy(shipped("cell", TEMPLATE))
    cell.pop("$schema", None)
    r0 = resistance_ohm or _resistance(capacity_mah, c_rate, LOSS_V)
    at_rest = cell["series_resistance"]["polynomial"][0]
    low, high = _resistance(capacity_mah, c_rate, LEAST_LOSS_V), OVERSTATED * _resistance(capacity_mah, c_rate, MOST_LOSS_V)
    how = f"R0 = {r0:.4g} Ohm above s = 0.2, measured by the user" if resistance_ohm else f"{_ASSUMED}: R0 = {r0:.4g} Ohm, a loss of {LOSS_V:.3g} V at {c_rate:g} C"
    interval = {} if resistance_ohm else {"interval": [low / at_rest, high / at_rest]}
    charge_c = capacity_mah * 3.6
    half_g = _digits(mass_g)
    return cell | {
        "name": name,
        "notes": "Written by mebots new-cell. Intervals show the uncertainty of the seller's figures; open-circuit voltage and time constants are those of another cell.",
        "mass": {"value": mass_g * 1e-3, "unit": "kg", "source": f"the seller: {mass_g:g} g", "interval": [(mass_g - half_g) * 1e-3, (mass_g + half_g) * 1e-3]},
        "capacity": {
            "value": charge_c,
            "unit": "C",
            "source": f"the seller: {capacity_mah:g} mAh; interval: {_ASSUMED}, up to {100 * SHORT_OF_CAPACITY:g} % less",
            "interval": [charge_c * (1 - SHORT_OF_CAPACITY), charge_c],
        },
        "continuous_current": {"value": c_rate * capacity_mah * 1e-3, "unit": "A", "source": f"the seller: {c_rate:g} C"},
        "self_discharge_current": {
            "value": 0.05 * charge_c / (30 * 86400) + 7e-7,
            "unit": "A",
            "source": f"{_ASSUMED}: 5 % of the charge in 30 days, plus 0.7 uA of a protection circuit",
        },
        "resistance_factor": {"value": r0 / at_rest, "unit": "1", "source": how, **interval},
        "capacitance_factor": {"value": at_rest / r0, "unit": "1", "source": f"{_ASSUMED}: inverse of resistance_factor, which keeps the time constants"},
    }


def _series_resistance(cell: dict[str, Any], capacity_mah: float, c_rate: float, resistance_ohm: float | None) -> Estimate:
    factor = cell["resistance_factor"]
    at_rest = cell["series_resistance"]["polynomial"][0]
    low, high = factor.get("interval", [factor["value"]] * 2)
    remark = "measured by the user" if resistance_ohm else f"from {c_rate:g} C of {capacity_mah:g} mAh"
    return Estimate("series_resistance", "Ohm", factor["value"] * at_rest, low * at_rest, high * at_rest, None, remark)


def _fit_discharge(cell: dict[str, Any], raw: FlightLog, result: Identified) -> dict[str, Any]:
    """Fits the cell's resistance, polarisation and capacity to a discharge from full charge."""
    log, findings = quality.clean(raw, cells=1)
    log.require(("battery.voltage", "battery.current"), "a discharge")
    voltage, current = log["battery.voltage"], log["battery.current"]
    start_s, end_s = max(voltage.times[0], current.times[0]), min(voltage.times[-1], current.times[-1])
    times = np.arange(start_s, end_s, STEP_S)
    if len(times) * STEP_S < 30:
        raise InputError(f"{raw.file}: the discharge has {len(times) * STEP_S:.1f} s; 30 s are needed", "invalid_value")
    volts = np.interp(times, voltage.times, voltage.values)
    power_w = np.maximum(volts * np.interp(times, current.times, current.values), 0)
    per_block = round(BLOCK_S / STEP_S)
    count = len(times) // per_block
    flight = Flight(raw.file.name, power_w, volts[: count * per_block].reshape(count, per_block).mean(axis=1), 1.0, False)
    with tempfile.TemporaryDirectory(prefix="mebots-new-cell-") as folder:
        found = fit_cell(cell, [flight], pathlib.Path(folder))
    describe_cell(cell, found, 1, result.estimates, result.residuals, result.notes)
    result.notes.extend(map(str, findings))
    return fitted_cell(cell, found, raw.file.name)
