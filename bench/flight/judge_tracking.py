#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the set-points of NanoBench's flights with fmu_world's Crazyflie controller.

Compares the tracking errors with those of the logged flights, and with their spread over repetitions.

    PYTHONPATH=BUILD/python .venv/bin/python bench/flight/judge_tracking.py FOLDER

FOLDER is described in flight_data.py. The logged drone followed positions. Here, the firmware's position loop, with gain and
limit of src/modules/src/controller/position_controller_pid.c, converts them to the velocities that fmu_world follows. Altitudes
are inputs of fmu_world without changes. Nothing is fitted: airframe, cell and mass are those of these flights in docs/replay.md.
The voltage at rest determines the charge at the start.

These flights used the propellers of a 2.1+: at full thrust, a motor has 3.06 V in the logs. The firmware's fit gives 3.08 V for
these propellers, and 2.97 V for the older ones.

A tracking error is the distance between the drone and its set-point at the same time. The judged time starts 3 s after the
set-point leaves the take-off position, and ends with the trajectory.
"""
import argparse
import csv
import json
import re
import tempfile
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import flight_data as data
import mebots

ROOT = Path(__file__).resolve().parents[2]
AIRFRAME = ROOT / "configs/airframes/crazyflie_21plus.json"
MASS_KG = 0.0434          # source: docs/replay.md, NanoBench; mass of a 2.1+ on a stand
POSITION_GAIN = 2.0       # PID_POS_X_KP [1/s]
FASTEST_M_PER_S = 1.1     # PID_POS_VEL_X_MAX plus 10 %
PERIOD_S = 0.01           # period of the position loop and of the logs
OFF, FLY = 0, 2           # values of setpoint.mode
LEFT_M = 0.05             # distance from the take-off position after which the trajectory has started
SETTLED_S = 3.0
FIGURES = ("level, rms", "level, greatest", "vertical, rms", "vertical, greatest")
GAP_M = 0.3               # if Vicon and the drone's own estimate differ by more, the log has a gap


@dataclass
class Tracking:
    """A logged flight in equal steps of PERIOD_S. Arrays have a row for each of x, y, z."""
    name: str
    trajectory: str           # kind and parameters, equal for repetitions
    rest_v: float
    driven: np.ndarray
    setpoint_m: np.ndarray
    position_m: np.ndarray
    judged: slice

    def errors(self, position_m):
        """Returns the horizontal and the vertical error in the judged part of the flight."""
        off = position_m[:, self.judged] - self.setpoint_m[:, self.judged]
        return np.hypot(off[0], off[1]), off[2]


def trajectory_of(metadata):
    """Returns the kind and the parameters of a trajectory, without the number of the repetition."""
    params = re.search(r"^params:\n((?: .*\n|- .*\n)*)", metadata, re.M)[1]
    values = re.findall(r"^  (\w+): (\S+)", params, re.M)
    kind = re.search(r"^trajectory_type: (\S+)", metadata, re.M)[1]
    shown = [f"{key.removesuffix('_m').removesuffix('_mps')} {value}" for key, value in values
             if key not in ("duration_s", "altitude_m", "altitude_start_m", "altitude_end_m", "freq_x", "freq_y", "phase_deg")
             and re.fullmatch(r"[\d.]+", value)]
    return ", ".join([kind.replace("_", " "), *shown])


def read(path):
    """Returns the flight, or the reason why it is omitted."""
    with open(path, newline="") as file:
        names = next(csv.reader(file))
    log = dict(zip(names, np.genfromtxt(path, delimiter=",", skip_header=1).T))
    metadata = path.with_name(f"{path.stem}_metadata.yaml").read_text()
    times = np.arange(log["t"][0], log["t"][-1], PERIOD_S)
    rows = np.searchsorted(log["t"], times, side="right") - 1
    column = lambda name: log[name][rows]
    setpoint, position, estimate = (np.array([column(prefix + axis) for axis in "xyz"])
                                    for prefix in ("sp_ctrltarget_", "p", "est_stateEstimate_"))
    driven = np.mean([column(f"motor_motor_m{i}") for i in range(1, 5)], axis=0) > 0.2 * 65535
    aloft = position[2] > 0.5
    if not aloft.any():
        return "does not leave the ground"
    if not (column("pid_controller_cmd_thrust")[aloft] > 0).any():
        return "is not flown by the PID"
    left = np.flatnonzero(driven & (np.hypot(*(setpoint - setpoint[:, [np.argmax(driven)]])[:2]) > LEFT_M))
    duration = float(re.search(r"duration_s: (\S+)", metadata)[1])
    judged = slice(left[0] + round(SETTLED_S / PERIOD_S), min(left[0] + round(duration / PERIOD_S), len(times)))
    if np.linalg.norm((position - estimate)[:, judged], axis=0).max() > GAP_M:
        return "has a gap"
    rest = np.median(column("pwr_pm_vbat")[:np.argmax(driven)])
    return Tracking(path.stem, trajectory_of(metadata), rest, driven, setpoint, position, judged)


def charge_at(rest_v):
    """Returns the state of charge at which the airframe's cell has this open-circuit voltage."""
    cell = json.loads(AIRFRAME.read_text())["cell"]
    curve = json.loads((ROOT / f"fmu_battery/params/cells/{cell}.json").read_text())["open_circuit_voltage"]
    grid = np.linspace(0, 1, 4001)
    factor, rate = curve["exponential"]
    return float(np.interp(rest_v, factor * np.exp(-rate * grid) + np.polyval(curve["polynomial"][::-1], grid), grid))


def mission_file(folder):
    """Writes the hover mission with this airframe and the Crazyflie's controller. Removes the mission's stop conditions."""
    airframe = json.loads(AIRFRAME.read_text())
    cell = json.loads((ROOT / f"fmu_battery/params/cells/{airframe['cell']}.json").read_text())
    config = json.loads((ROOT / "configs/hover.json").read_text())
    world, motors, battery = (config["instances"][name]["parameters"] for name in ("world", "motors", "battery"))
    world |= {"drone.name": airframe["drone"], "drone.dry_mass": MASS_KG - cell["mass"]["value"], "stabiliser.controller": "crazyflie",
              "stabiliser.propellers": "plus", "setpoint.mode": "off"}
    motors |= {"rotor_data": airframe["rotor"], "avionics.base_power": airframe["avionics_power"]["value"]}
    battery["cell.name"] = airframe["cell"]
    config["connections"].append({"from": "battery.bus.voltage", "to": "world.bus.voltage"})
    for key in ("stop_when", "outcomes", "uncertainty", "view", "record", "$schema"):
        del config[key]
    file = folder / "mission.json"
    file.write_text(json.dumps(config))
    return file


def fly(file, flight):
    """Simulates a drone that receives the set-points of a flight. Returns the drone's positions."""
    start = {f"world.start.offset.{axis}": float(value) for axis, value in zip("xy", flight.position_m[:, 0])}
    found = np.full_like(flight.position_m, np.nan)
    settings = {"battery.cell.initial_state_of_charge": charge_at(flight.rest_v)} | start
    with mebots.Mission(file, set=settings, record=["world.drone.position.z"]) as mission:
        for k in range(flight.judged.stop):
            mission.run_until(k * PERIOD_S)
            here = np.array([mission.value(f"world.drone.position.{axis}") for axis in "xyz"])
            yaw = mission.value("world.drone.yaw")
            found[:, k] = here
            away = flight.setpoint_m[:2, k] - here[:2]
            ahead = np.cos(yaw) * away[0] + np.sin(yaw) * away[1], np.cos(yaw) * away[1] - np.sin(yaw) * away[0]
            for axis, distance in zip("xy", ahead):
                mission.write(f"world.setpoint.velocity.{axis}", float(np.clip(POSITION_GAIN * distance, -FASTEST_M_PER_S, FASTEST_M_PER_S)))
            mission.write("world.setpoint.altitude", float(max(flight.setpoint_m[2, k], 0.0)))
            mission.write("world.setpoint.mode", FLY if flight.driven[:k + 1].any() else OFF)
        return found


def figures(flight, position_m):
    """Returns the errors in the order of FIGURES [m]."""
    level, vertical = flight.errors(position_m)
    return np.array([np.sqrt(np.mean(level**2)), level.max(), np.sqrt(np.mean(vertical**2)), np.abs(vertical).max()])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    folder = parser.parse_args().folder
    groups, left_out = defaultdict(list), defaultdict(list)
    with tempfile.TemporaryDirectory() as scratch:
        file = mission_file(Path(scratch))
        for path in data.distinct((Path(folder) / data.NANOBENCH).glob("*.csv")):
            flight = read(path)
            if isinstance(flight, str):
                left_out[flight].append(path.stem)
                continue
            own = fly(file, flight)
            apart = np.linalg.norm((own - flight.position_m)[:, flight.judged], axis=0)
            groups[flight.trajectory].append((figures(flight, flight.position_m), figures(flight, own), np.sqrt(np.mean(apart**2))))
    report(groups, left_out)


def shares(what, flights, i):
    ratio = np.array([own[i] / measured[i] for measured, own, _ in flights])
    return f"{what} {np.median(ratio):.2f} ({np.percentile(ratio, 5):.2f} to {np.percentile(ratio, 95):.2f})"


def report(groups, left_out):
    print("\nErrors [mm]: mean of the repetitions (least to greatest), and of our flights\n"
          "| trajectory | flights | level, rms: measured | ours | level, greatest: measured | ours | vertical, rms: measured | ours |\n"
          + "|---" * 8 + "|")
    for name, flights in sorted(groups.items()):
        measured, own = (1e3 * np.array([f[i] for f in flights]) for i in (0, 1))
        cells = []
        for i in range(3):
            spread = f" ({measured[:, i].min():.0f} to {measured[:, i].max():.0f})" if len(flights) > 1 else ""
            cells += [f"{measured[:, i].mean():.0f}{spread}", f"{own[:, i].mean():.0f}"]
        print(f"| {name} | {len(flights)} | " + " | ".join(cells) + " |")
    repeated = [flights for flights in groups.values() if len(flights) > 1]
    expected = sum((len(flights) - 1) / (len(flights) + 1) for flights in repeated)
    fast, slow = ([f for name, flights in groups.items() if ("speed 1.0" in name) == is_fast for f in flights] for is_fast in (True, False))
    print(f"\n{len(slow)} flights below 1 m/s, {len(fast)} at 1 m/s, {len(repeated)} trajectories with repetitions. One more repetition by the same "
          f"drone would be within the others for {expected:.1f} of them on average")
    for i, what in enumerate(FIGURES):
        inside = sum(min(f[0][i] for f in flights) <= np.mean([f[1][i] for f in flights]) <= max(f[0][i] for f in flights) for flights in repeated)
        around = np.concatenate([[f[0][i] / np.mean([other[0][i] for other in flights]) for f in flights] for flights in repeated])
        print(f"{what}: ours / measured, median (5 to 95 %): {shares('below 1 m/s', slow, i)}, {shares('at 1 m/s', fast, i)}; "
              f"a repetition / the mean of its trajectory {np.percentile(around, 5):.2f} to {np.percentile(around, 95):.2f}; "
              f"within the repetitions: {inside} of {len(repeated)}")
    apart = np.array([f[2] for f in slow + fast])
    print(f"distance between both drones, rms of a flight: median {1e3 * np.median(apart):.0f}, 90 % {1e3 * np.percentile(apart, 90):.0f} mm")
    for reason, names in left_out.items():
        print(f"left out, {reason}: {len(names)}: {', '.join(names)}")


if __name__ == "__main__":
    main()
