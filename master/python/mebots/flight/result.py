# SPDX-License-Identifier: Apache-2.0
"""The result of a replay: errors, findings and curves. Formats its table for a terminal."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from mebots.flight import quality
from mebots.flight.airframe import Airframe
from mebots.flight.compare import ErrorRow
from mebots.flight.log import FlightLog
from mebots.flight.motion import Motion
from mebots.flight.quality import Finding
from mebots.flight.traces import Traces

FIELDS = ("quantity", "unit", "model", "n", "excluded", "measured", "mean", "rms", "p5", "p50", "p95")


@dataclasses.dataclass(frozen=True)
class Replay:
    """A replayed flight. ``errors`` has a row for each measured quantity and method. ``findings`` are the bad samples of the log.
    ``summary`` contains the model's energy and charge, and notes on missing data."""

    log: FlightLog
    airframe: Airframe
    errors: list[ErrorRow]
    findings: list[Finding]
    summary: dict[str, Any]
    traces: Traces
    motion: Motion | None

    def error(self, quantity: str, model: str) -> ErrorRow:
        """Returns the row of a quantity and a model. Raises KeyError without such a row."""
        for one in self.errors:
            if (one.quantity, one.model) == (quantity, model):
                return one
        raise KeyError(f"'{quantity}' by '{model}' was not compared; compared: {sorted({one.quantity for one in self.errors})}")


def table(rows: Sequence[ErrorRow]) -> list[list[str]]:
    """Returns the titles and the rows as texts."""
    return [list(FIELDS), *([_text(getattr(one, field)) for field in FIELDS] for one in rows)]


def _text(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def shown(result: Replay) -> str:
    """Returns table and notes as text for a terminal."""
    lines = table(result.errors)
    widths = [max(len(line[i]) for line in lines) for i in range(len(FIELDS))]
    text = ["  ".join(cell.ljust(width) if i < 3 else cell.rjust(width) for i, (cell, width) in enumerate(zip(line, widths, strict=True))).rstrip() for line in lines]
    summary = result.summary
    text += ["", "errors are model minus measurement; p5, p50 and p95 are percentiles of the error"]
    text.append(
        f"{summary['airframe']}, {summary['mass']['source']}; charge {100 * summary['initial_charge']:.1f} to "
        f"{100 * summary['final_charge']:.1f} %, {summary['charge_used_c'] / 3.6:.1f} mAh, {summary['energy_j']:.0f} J, "
        f"{summary['mean_power_w']:.2f} W over {summary['duration_s']:.1f} s by the model"
    )
    text += [f"note: {note}" for note in summary["notes"]]
    text += [f"log: {finding}" for finding in result.findings]
    return "\n".join(text)


TRACE_INTERVAL_S = 0.02


def curves(result: Replay) -> dict[str, np.ndarray]:
    """Returns the curves of model and measurement at intervals of ``TRACE_INTERVAL_S``. NaN marks missing values."""
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
