# SPDX-License-Identifier: Apache-2.0
"""Reads data of public flights and motor stands of the Crazyflie. States the place of each file and its permitted use.

A folder contains checkouts with the names of their repositories: crazyflie-data-collection (IMRCLab), Crazyflie-2.0-battery-data
(RaresCraciun), nanobench-iros2026 (syediu). Most have no licence, so this repository contains none of their files. Needs the
package mebots in PYTHONPATH.
"""
import csv
import hashlib
import re
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np

from mebots.flight.usd import read_events

GRAVITY = 9.80665
CRACIUN = "Crazyflie-2.0-battery-data/Real_path"
NANOBENCH = "nanobench-iros2026/datasets/dataset"
IMRC = "crazyflie-data-collection"
FLIGHTS = f"{IMRC}/brushed_flights/data"
STANDS = f"{IMRC}/system-id/data"

# Fits may use only these flights and stands.
CALIBRATION_FLIGHTS = ("jana04", "jana05", "jana06")
CALIBRATION_STANDS = ("cf21_eckart1/data.csv", "cf21_bitcraze2021/cf21_stock2.csv")

JUDGED_FLIGHTS = ("jana00", "jana01", "jana02", "jana03", "jana10", "jana11")
CLIMBING_FLIGHTS = ("jana20", "jana23", "jana24", "jana25", "jana27", "jana28", "jana29", "jana30", "jana32", "jana33")
SECOND_DRONE_FLIGHTS = tuple(f"rl{n}" for n in range(20, 31))
JUDGED_STAND = "cf21_bitcraze2021/cf2.1-stock-prop.csv"

JANA_MASS_KG = 0.0347  # source: README of the flights; with cell, RPM deck and uSD deck
RL_MASS_KG = 0.0365    # source: system-id/estimate_kw.py


def digest(path):
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def distinct(paths):
    """Returns the paths in the order of their names. Omits a file if an earlier file has the same content."""
    found = {}
    for path in sorted(paths):
        found.setdefault(digest(path), path)
    return list(found.values())


def read_usd(path):
    """Returns the columns of the event fixedFrequency in a log of Bitcraze's uSD deck. `time` is in seconds from the first
    row."""
    columns = read_events(Path(path))["fixedFrequency"]
    return columns | {"time": columns["time"] - columns["time"][0]}


@dataclass
class Flight:
    """The rotor data of a flight, as arrays over time. Arrays of rotors have four rows."""
    name: str
    mass_kg: float
    time_s: np.ndarray
    speed_rad_per_s: np.ndarray
    duty: np.ndarray
    voltage_v: np.ndarray
    upright: np.ndarray       # cosine of the tilt
    climb_m_per_s: np.ndarray

    def blocks(self, length_s=1.0):
        """Returns slices of the flight in which every rotor turns. Each slice is about `length_s` long."""
        edges = np.searchsorted(self.time_s, np.arange(self.time_s[0], self.time_s[-1], length_s))
        whole = [slice(a, b) for a, b in zip(edges, edges[1:])]
        return [s for s in whole if (self.speed_rad_per_s[:, s] > 500).all()]


def flight_of(log, name, mass_kg, duty="pwm.m{}_pwm"):
    """Converts the columns of a log to a flight. If the log has no state estimate, the tilt and the climb rate are zero."""
    length = len(log["time"])
    has_state = "stateEstimate.qx" in log
    upright = 1 - 2 * (log["stateEstimate.qx"]**2 + log["stateEstimate.qy"]**2) if has_state else np.ones(length)
    return Flight(name, mass_kg, log["time"], np.array([log[f"rpm.m{i}"] for i in range(1, 5)]) * np.pi / 30,
                  np.array([log[duty.format(i)] for i in range(1, 5)]) / 65535, 1e-3 * log["pm.vbatMV"],
                  upright, log["stateEstimate.vz"] if has_state else np.zeros(length))


def flight(folder, name):
    """Reads a flight named jana* or rl*. The logs of rl* have no state estimate."""
    if name.startswith("rl"):
        return flight_of(read_usd(Path(folder) / STANDS / "cf21_imrc2025" / name), name, RL_MASS_KG, "motor.m{}")
    return flight_of(read_usd(Path(folder) / FLIGHTS / name), name, JANA_MASS_KG)


@dataclass
class Stand:
    """Steady points of a motor stand, converted to one of four equal rotors."""
    duty: np.ndarray
    voltage_v: np.ndarray
    speed_rad_per_s: np.ndarray
    square_speed: np.ndarray   # mean of the squares of the four speeds
    thrust_n: np.ndarray
    current_a: np.ndarray      # current of the supply minus the current at rest; nan if not measured

    def where(self, mask):
        return Stand(*(getattr(self, name)[mask] for name in self.__dataclass_fields__))

    @property
    def grams(self):
        """Returns the thrust of all four rotors [g]."""
        return 4e3 * self.thrust_n / GRAVITY

    @property
    def power_w(self):
        return self.voltage_v * self.current_a


def _rows(path):
    with open(path, newline="") as file:
        reader = csv.reader(file)
        names = [name.strip() for name in next(reader)]
        table = np.array([[float(cell) for cell in row] for row in reader])
    return dict(zip(names, table.T))


def stand(folder, name):
    """Returns the points of a stand: means over the second half of each interval of constant PWM, or the rows if they are already
    steady. The current at rest is that of the electronics; its power counts as constant."""
    log = _rows(Path(folder) / STANDS / name)
    pwm = log["pwm"]
    weight = log["weight" if "weight" in log else "weight[g]"]
    current = log.get("i[A]", np.full(len(pwm), np.nan))
    edges = np.flatnonzero(np.diff(pwm)) + 1
    pieces = [p[len(p) // 2:] for p in np.split(np.arange(len(pwm)), edges) if "i[A]" not in log or len(p) >= 5]
    mean = lambda column: np.array([np.mean(column[p]) for p in pieces])
    speeds = np.array([log[f"rpm{i}"] for i in range(1, 5)]) * np.pi / 30
    duty, voltage = mean(pwm) / 65535, mean(log["vbat[V]"])
    supply = mean(current)
    rest = duty == 0
    rest_w = np.mean(supply[rest] * voltage[rest]) if rest.any() else np.nan
    points = Stand(duty, voltage, mean(speeds.mean(axis=0)), mean((speeds**2).mean(axis=0)),
                   mean(weight) * GRAVITY * 1e-3 / 4, (supply - rest_w / voltage) / 4)
    return points.where(~rest)


@dataclass
class Discharge:
    """The voltage of a cell during a flight, in equal intervals from the start of the motors."""
    name: str
    fitted: bool              # true if fits may use the flight
    rest_v: float             # voltage before the motors start
    voltage_v: np.ndarray     # mean voltages over intervals of STEP_S
    duty: np.ndarray | None   # duty cycles of the four rotors; None if not logged
    start_s: float            # start time on the common clock of the set, or the number of the flight
    end_rest_v: float         # voltage after the motors stop; nan if the log ends in flight


STEP_S = 0.5
LEAST_DURATION_S = 15.0
DROP_V = 0.15  # voltage drop that indicates running motors


def _means(values, rows):
    whole = values.shape[-1] // rows * rows
    return values[..., :whole].reshape(*values.shape[:-1], -1, rows).mean(axis=-1)


def craciun(folder):
    """Reads flights that contain only the voltage, 100 rows per second. Fits may use the flights with an even SHA-256."""
    found = []
    for path in distinct((Path(folder) / CRACIUN).glob("*.csv")):
        voltage = np.genfromtxt(path, delimiter=",", skip_header=1)[:, 3]
        rest = np.median(voltage[:50])
        below = np.flatnonzero(voltage < rest - DROP_V)
        if not below.size or len(voltage) - below[0] < 100 * LEAST_DURATION_S:
            continue
        found.append(Discharge(path.stem, int(digest(path), 16) % 2 == 0, rest,
                               _means(voltage[below[0]:], round(100 * STEP_S)), None,
                               float(path.stem.rsplit("_", 1)[1]), np.nan))
    return found


def nanobench(folder):
    """Reads flights with duty cycles, 100 rows per second, in the order of time. Fits must not use these flights."""
    found = []
    for path in distinct((Path(folder) / NANOBENCH).glob("*.csv")):
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        column = lambda name: np.array([float(row[name] or "nan") for row in rows])
        voltage = column("pwr_pm_vbat")
        duty = np.clip(np.nan_to_num(np.array([column(f"motor_motor_m{i}") for i in range(1, 5)]) / 65535), 0, 1)
        on = np.flatnonzero(duty.mean(axis=0) > 0.2)  # some logs overshoot 0 and 1 by interpolation
        if on.size < 100 * LEAST_DURATION_S or on[0] < 50:
            continue
        flown = slice(on[0], on[-1])
        text = path.with_name(f"{path.stem}_metadata.yaml").read_text()
        start = datetime.strptime(re.search(r"recording_start_utc: (\S+)", text)[1], "%Y%m%dT%H%M%SZ")
        interval = round(100 * STEP_S)
        found.append(Discharge(path.stem, False, np.median(voltage[:on[0] - 20]), _means(voltage[flown], interval),
                               _means(duty[:, flown], interval), start.timestamp(), np.median(voltage[-50:])))
    return sorted(found, key=lambda f: f.start_s)
