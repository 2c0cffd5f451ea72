# SPDX-License-Identifier: Apache-2.0
"""Reads the results of a flight."""

import csv
import pathlib

import numpy as np

TAKE_OFF, CRUISE, LANDING = 1, 2, 3  # values of world.drone.phase
# The gate's part of a flight starts at this distance before the gate's plane [m], and ends with the landing.
NEAR_GATE_M = 0.5
PASSED = ("passed", "touched_passed")
# The last stretch before the gate starts and ends at these distances before the gate's plane [m].
LAST_STRETCH_M = (1.4, 0.2)


class Trace:
    """The columns of results.csv by name, without units."""

    def __init__(self, folder):
        with open(pathlib.Path(folder) / "results.csv", newline="") as file:
            rows = csv.reader(file)
            names = [name.rsplit(" [", 1)[0] for name in next(rows)]
            values = np.array([[float(v) for v in row] for row in rows])
        self.columns = dict(zip(names, values.T))
        self.time = self.columns["time"]

    def __getitem__(self, name):
        return self.columns[name]

    def first(self, condition):
        """Returns the first time at which a condition was true [s]. If it was never true, returns None."""
        return float(self.time[np.argmax(condition)]) if condition.any() else None

    def time_at_gate(self):
        """Returns the time at which the drone crossed the gate's plane [s]. If it did not cross, returns None."""
        return self.first(self["world.gate.distance"] <= 0)

    def last_stretch_s(self):
        """Returns the duration of the last stretch before the gate [s]. If the drone did not reach its end, returns None."""
        begin, end = (self.first(self["world.gate.distance"] <= left) for left in LAST_STRETCH_M)
        return None if end is None else round(end - begin, 3)

    def flown(self):
        """Returns the first and the last time at which the drone was in the air [s]."""
        air = (self["world.drone.phase"] >= TAKE_OFF) & (self["world.drone.phase"] <= LANDING)
        return float(self.time[air][0]), float(self.time[air][-1])

    def path_to(self, end_s):
        """Returns the horizontal distance that the drone flew until a time [m]."""
        chosen = self.time <= end_s
        x, y = self["world.drone.position.x"][chosen], self["world.drone.position.y"][chosen]
        return float(np.hypot(np.diff(x), np.diff(y)).sum())

    def distance_in_20_s(self):
        """Returns the distance that the drone flew during 20 s in the middle of the cruise [m]."""
        cruise = self["world.drone.phase"] == CRUISE
        middle = (self.time[cruise][0] + (self.time_at_gate() or self.time[cruise][-1])) / 2
        return self.path_to(middle + 10) - self.path_to(middle - 10)

    def thinned(self, points, start_s=0.0):
        """Returns the indices of `points` evenly spaced samples from a time on."""
        first = int(np.searchsorted(self.time, start_s))
        return np.unique(np.linspace(first, len(self.time) - 1, points).astype(int))

    def way(self, points):
        """Returns the drone's positions [m] and speeds [km/h] at `points` evenly spaced samples, rounded for the report."""
        chosen = self.thinned(points)
        way = {axis: np.round(self[f"world.drone.position.{axis}"][chosen], 3).tolist() for axis in "xyz"}
        if "world.drone.speed" in self.columns:
            way["km_h"] = np.round(3.6 * self["world.drone.speed"][chosen], 3).tolist()
        return way

    def course(self, points, start_s=0.0):
        """Returns altitude [m], speed [km/h], voltage [V], power [W] and charge [%] over time [s], rounded for a
        report."""
        chosen = self.thinned(points, start_s)
        power = sum(self[name] for name in ("motors.power", "motors.avionics.power", "soc.power", "soc.camera.power"))
        columns = {"s": self.time, "z_m": self["world.drone.position.z"], "km_h": 3.6 * self["world.drone.speed"],
                   "v": self["battery.cell.voltage"], "w": power, "charge": 100 * self["battery.cell.state_of_charge"]}
        return {name: np.round(values[chosen], 3).tolist() for name, values in columns.items()}


ENERGIES = {  # maps uses of the cell's energy to recorded energies
    "motors": ["battery.motors.energy"], "flight controller": ["battery.avionics.energy"],
    "chip": ["battery.soc.energy"], "camera": ["battery.camera.energy"], "converters": ["battery.energy.converters"],
    "cell": ["battery.energy.ohmic", "battery.energy.polarisation"],
}


def energy_by_phase(trace):
    """Returns {phase: {consumer: J}}: take-off, cruise up to the gate, the gate, landing. Every sample belongs to exactly one
    phase."""
    phase = trace["world.drone.phase"]
    near = np.maximum.accumulate(trace["world.gate.distance"] < NEAR_GATE_M)
    masks = {"take-off": phase <= TAKE_OFF, "cruise": (phase == CRUISE) & ~near, "gate": (phase == CRUISE) & near,
             "landing": phase >= LANDING}
    spent = {consumer: np.diff(sum(trace[c] for c in columns), prepend=0.0) for consumer, columns in ENERGIES.items()}
    return {name: {consumer: float(joules[mask].sum()) for consumer, joules in spent.items()}
            for name, mask in masks.items()}
