# SPDX-License-Identifier: Apache-2.0
"""Reads what a flight left behind."""

import csv
import pathlib

import numpy as np

PHASES = ("on ground", "climb", "cruise", "landing", "landed", "crashed")


class Trace:
    """results.csv as columns by name, without units."""

    def __init__(self, folder):
        with open(pathlib.Path(folder) / "results.csv", newline="") as file:
            rows = csv.reader(file)
            names = [name.rsplit(" [", 1)[0] for name in next(rows)]
            values = np.array([[float(v) for v in row] for row in rows])
        self.columns = dict(zip(names, values.T))
        self.time = self.columns["time"]

    def __getitem__(self, name):
        return self.columns[name]

    def time_at_gate(self):
        """When the gate's plane was crossed [s]; none if it was not."""
        behind = self["world.gate.distance"] <= 0
        return float(self.time[np.argmax(behind)]) if behind.any() else None

    def flown(self):
        """First and last time in the air [s]."""
        air = (self["world.drone.phase"] >= 1) & (self["world.drone.phase"] <= 3)
        return float(self.time[air][0]), float(self.time[air][-1])

    def path_to(self, end_s):
        """Horizontal length flown up to a time [m]."""
        chosen = self.time <= end_s
        x, y = self["world.drone.position.x"][chosen], self["world.drone.position.y"][chosen]
        return float(np.hypot(np.diff(x), np.diff(y)).sum())


ENERGIES = {  # what a joule of the cell became -> recorded energies
    "motors": ["battery.motors.energy"], "avionics": ["battery.avionics.energy"], "chip": ["battery.soc.energy"],
    "camera": ["battery.camera.energy"], "converters": ["battery.energy.converters"],
    "cell": ["battery.energy.ohmic", "battery.energy.polarisation"],
}


def energy_by_phase(trace):
    """{phase: {consumer: J}} for the phases of the flight; the cruise is cut at the gate."""
    gate = trace.time_at_gate()
    phase = trace["world.drone.phase"]
    names = np.array([PHASES[int(p)] for p in phase], dtype=object)
    if gate is not None:
        names[(phase == 2) & (trace.time > gate)] = "behind the gate"
    table = {}
    for consumer, columns in ENERGIES.items():
        spent = np.diff(sum(trace[c] for c in columns), prepend=0.0)
        for name in dict.fromkeys(names):
            table.setdefault(name, {})[consumer] = float(spent[names == name].sum())
    return table
