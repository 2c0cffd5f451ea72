# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of a log on the FMUs of motors and battery.

The run has three instances. ``motors`` and ``battery`` are coupled as in a mission; only the commands, and the motion that affects the
rotors' power, come from the log. ``motors_at_measured`` gets the measured voltage, so that errors of the cell do not affect it.
"""

from __future__ import annotations

import dataclasses
import json
import pathlib
import tempfile
from typing import Any

import numpy as np

from mebots.errors import InputError
from mebots.flight.airframe import Airframe
from mebots.flight.log import COMMANDS, ROTORS, VELOCITY, Array, FlightLog
from mebots.flight.quality import DRIVEN, Mask, covered
from mebots.mission import Mission

SETTLE_S = 1.0
"""The duration after the start, and after a gap in the commands, that is not compared. The reason is that the rotors of
the model start at rest, but a log may begin in flight. Rotors of a Crazyflie take 0.14 s for 63 % of a change."""
RAMP_S = 0.6
"""If a log begins in flight, the commands rise from 0 over this time. Motors at rest under full command would draw
so much current that the cell's protection opens."""
CHARGE_S = 0.5
"""The initial charge is fitted to the voltage over this duration. If the log begins at rest, this is before the motors
are driven; otherwise it is after ``SETTLE_S``."""
_SHORTEST_REST_S = 0.1
_LONGEST_S = 7200.0
"""The maximum duration of a log. In a longer log, the clock jumps or the times have another unit, because no cell
supplies a multirotor for two hours."""
_DIGITS = 12


@dataclasses.dataclass(frozen=True)
class Traces:
    """The values that the models computed at ``times`` (seconds since the start of the log). ``good`` is True for times that can be
    compared with the log."""

    times: Array
    good: Mask
    logged: Mask
    """The times with logged commands. ``good`` also excludes times after the protection of the model's cell opened."""
    values: dict[str, Array]
    initial_charge: float
    settle_s: float
    """The duration after the start that is not compared."""
    notes: list[str]
    capacity_c: float
    cut_off_s: float | None
    """The time at which the protection of the model's cell opened."""

    def __getitem__(self, name: str) -> Array:
        return self.values[name]

    @property
    def has_measured_voltage(self) -> bool:
        return "motors_at_measured.power" in self.values

    def thrust_n(self, instance: str = "motors") -> Array:
        return sum((self.values[f"{instance}.rotor[{i}].thrust"] for i in ROTORS), start=np.zeros(len(self.times)))


def fly(log: FlightLog, airframe: Airframe, folder: pathlib.Path | None, step_s: float, initial_charge: float | None) -> Traces:
    """Runs the commands of the log. Writes the mission into ``folder``, so that ``mebots run`` can repeat it. If ``folder`` is None, keeps
    no files."""
    log.require(COMMANDS, "a replay without voltage and height")
    if folder is not None:
        return _Flight(log, airframe, folder, step_s).fly(initial_charge)
    with tempfile.TemporaryDirectory(prefix="mebots-replay-") as temporary:
        return _Flight(log, airframe, pathlib.Path(temporary), step_s).fly(initial_charge)


class _Flight:
    def __init__(self, log: FlightLog, airframe: Airframe, folder: pathlib.Path, step_s: float) -> None:
        self.log, self.airframe, self.step_s = log, airframe, step_s
        self.notes: list[str] = []
        self.start_s = max(float(log[name].times[0]) for name in COMMANDS)
        end_s = min(float(log[name].times[-1]) for name in COMMANDS)
        if end_s - self.start_s > _LONGEST_S:
            times = log[COMMANDS[0]].times
            jump = int(np.argmax(np.diff(times)))
            raise InputError(
                f"{log.file}: the commands last {end_s - self.start_s:.6g} s; at most {_LONGEST_S:g} s are replayed. The longest step of the clock "
                f"is from {times[jump]:.6g} to {times[jump + 1]:.6g} s; check the unit of the times in the mapping, or cut the log there",
                "invalid_value",
            )
        self.steps = int((end_s - self.start_s) / step_s)
        self.duration_s = self.steps * step_s
        if self.duration_s < SETTLE_S + CHARGE_S:
            raise InputError(
                f"{log.file}: the four commands overlap for {max(self.duration_s, 0):.2f} s; "
                f"a replay needs at least {SETTLE_S + CHARGE_S:g} s, since the model's rotors start at rest",
                "invalid_value",
            )
        self.grid = self.start_s + np.arange(self.steps + 1) * step_s
        self.settle_s, self.charge_end_s = self._begin()
        self.has_voltage = log.has(["battery.voltage"])
        self.mission = folder / "mission.json"
        self._write_inputs(folder / "inputs.csv")

    def fly(self, initial_charge: float | None) -> Traces:
        charge = self._initial_charge() if initial_charge is None else initial_charge
        self._write_mission(charge)
        recorded = ["motors.*", "battery.*", *(["motors_at_measured.*"] if self.has_voltage else [])]
        with Mission(self.mission, record=recorded) as mission:
            mission.run()
            values = {name: mission[name] for name in mission.variables}
            times = mission.times + self.start_s
        connected = values["battery.cell.connected"]
        cut_off_s = None if connected.all() else float(times[int(np.argmin(connected))])
        if cut_off_s is not None:
            self.notes.append(f"the protection of the model's cell opens at {cut_off_s:.1f} s: nothing after it is compared")
        logged = self._logged(times)
        good = logged & (True if cut_off_s is None else times < cut_off_s)
        return Traces(times, good, logged, values, charge, self.settle_s, self.notes, float(values["battery.cell.capacity"][0]), cut_off_s)

    def _begin(self) -> tuple[float, float]:
        """Returns two times: the end of the log's first part, which is not compared with the model, and the end of the part that determines
        the initial charge."""
        driven = np.max([np.interp(self.grid, self.log[name].times, self.log[name].values) for name in COMMANDS], axis=0) > DRIVEN
        if not driven.any():
            self.notes.append(f"no command is above {DRIVEN:g}: the motors never start; check the unit of the commands in the mapping if they did")
        rest_s = (int(np.argmax(driven)) if driven.any() else len(driven) - 1) * self.step_s
        if rest_s < _SHORTEST_REST_S:
            return SETTLE_S, SETTLE_S + CHARGE_S
        return 0.0, min(rest_s, CHARGE_S)

    def _logged(self, times: Array) -> Mask:
        """True at times for which the log has all commands without a gap during the ``SETTLE_S`` before."""
        logged = np.logical_and.reduce([covered(self.log[name], times) for name in COMMANDS])
        since = np.maximum.accumulate(np.where(logged, -np.inf, times))
        return (times >= self.start_s + self.settle_s) & (times - since > SETTLE_S)

    def _write_inputs(self, file: pathlib.Path) -> None:
        """Writes one row per communication point. A command keeps its value until the next, as in the motors' driver."""
        columns = {"time": np.arange(self.steps + 1) * self.step_s}
        for name in COMMANDS:
            signal = self.log[name]
            held = signal.values[np.clip(np.searchsorted(signal.times, self.grid, side="right") - 1, 0, None)]
            columns[name] = held if self.settle_s == 0 else held * np.minimum(columns["time"] / RAMP_S, 1)
        if self.has_voltage:
            columns["voltage"] = self._interpolated("battery.voltage")
        if self.log.has(VELOCITY):
            columns["speed"] = np.hypot(self._interpolated("velocity.x"), self._interpolated("velocity.y"))
            columns["climb"] = self._interpolated("velocity.z")
        self.columns = [name for name in columns if name != "time"]
        rows = np.column_stack(list(columns.values()))
        np.savetxt(file, rows, fmt=f"%.{_DIGITS}g", delimiter=",", header=",".join(columns), comments="")

    def _interpolated(self, name: str) -> Array:
        signal = self.log[name]
        return np.interp(self.grid, signal.times, signal.values)

    def _write_mission(self, charge: float) -> None:
        parameters = {
            "rotor_data": self.airframe.path("rotor"),
            "avionics.base_power": self.airframe.avionics_power_w,
            "body.mass": self.airframe.mass_kg,
        }
        motors = ["motors", *(["motors_at_measured"] if self.has_voltage else [])]
        instances: dict[str, Any] = {name: {"fmu": "fmu_motors", "parameters": parameters} for name in motors}
        cell = {"cell.name": self.airframe.path("cell"), "cell.initial_state_of_charge": charge}
        instances["battery"] = {"fmu": "fmu_battery", "parameters": cell}
        targets = {f"motor[{i}].command": [f"{name}.rotor[{i}].command" for name in motors] for i in ROTORS}
        targets |= {"voltage": ["motors_at_measured.bus.voltage"]}
        targets |= {column: [f"{name}.body.{column}" for name in motors] for column in ("speed", "climb")}
        config = {
            "text": f"Replay of {self.log.file.name} on {self.airframe.name}",
            "step": self.step_s,
            "stop_time": self.duration_s,
            "instances": instances,
            "connections": [
                {"from": "battery.bus.voltage", "to": "motors.bus.voltage"},
                {"from": "motors.power", "to": "battery.motors.power"},
                {"from": "motors.avionics.power", "to": "battery.avionics.power"},
            ],
            "inputs": {"file": "inputs.csv", "to": {column: targets[column] for column in self.columns}},
            "summary": {"bus_voltage": "battery.bus.voltage", "state_of_charge": "battery.cell.state_of_charge"},
        }
        self.mission.write_text(json.dumps(config, indent=2) + "\n", encoding="utf-8")

    def _initial_charge(self) -> float:
        """Returns the state of charge for which the model's mean voltage soon after the start equals the measured one. The model starts
        without polarisation, because that of the real cell is unknown."""
        if not self.has_voltage:
            self.notes.append("the log has no voltage that can be used: the model starts with a full cell")
            return 1.0
        voltage = self.log["battery.voltage"]
        first_s, last_s = max(self.charge_end_s - CHARGE_S, 0.0), self.charge_end_s
        window = (voltage.times >= self.start_s + first_s) & (voltage.times <= self.start_s + last_s)
        if not window.any():
            self.notes.append("the log has no voltage soon after its start: the model starts with a full cell")
            return 1.0
        measured_v = float(voltage.values[window].mean())
        low, high = 0.0, 1.0
        highest_v = self._voltage_with(high)
        if measured_v >= highest_v:
            if measured_v > highest_v:
                self.notes.append(f"the cell has {measured_v - highest_v:.3f} V above the voltage of the model's full cell: the model starts with a full cell")
            return 1.0
        for _ in range(20):
            middle = (low + high) / 2
            low, high = (middle, high) if self._voltage_with(middle) < measured_v else (low, middle)
        return high

    def _voltage_with(self, charge: float) -> float:
        self._write_mission(charge)
        with Mission(self.mission, record=["battery.bus.voltage"], stop_time=self.charge_end_s) as mission:
            mission.run()
            return float(mission["battery.bus.voltage"][mission.times >= self.charge_end_s - CHARGE_S].mean())
