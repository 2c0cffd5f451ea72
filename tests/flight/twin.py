# SPDX-License-Identifier: Apache-2.0
"""Generates a flight with the models and writes it as a Crazyflie's log. A replay must find only rounding errors."""

import json
import math
import pathlib

import numpy as np
from logs import usd_log

import mebots
from mebots.flight.motion import GRAVITY_M_PER_S2

SOURCE = pathlib.Path(__file__).resolve().parents[2]
STATE = (
    0xFFFF,
    "fixedFrequency",
    [f"pwm.m{i}_pwm(H)" for i in (1, 2, 3, 4)] + [f"rpm.m{i}(H)" for i in (1, 2, 3, 4)] + ["pm.vbatMV(H)", "stateEstimate.vz(f)"],
)
MASS_KG = 0.03
STEP_S = 0.002
DRAG = json.loads((SOURCE / "fmu_world/params/drones/crazyflie.json").read_text())["drag"]["values"][2]


def commands(times, rotor):
    """Returns duty cycles around hover that differ between rotors, in whole motor values."""
    duty = 0.62 + 0.03 * np.sin(2 * math.pi * 0.4 * times + rotor) + 0.02 * np.sin(2 * math.pi * 1.1 * times)
    return np.round(duty * 65535) / 65535


def fly(folder, duration_s=12.0, charge=0.8, rotor="crazyflie_l250", cell="bitcraze_250"):
    """Runs the models. Returns the rows of the log and their times [s]."""
    times = np.arange(0, duration_s + STEP_S / 2, STEP_S)
    duty = [commands(times, i) for i in range(4)]
    header = "time," + ",".join(f"motors.rotor[{i}].command" for i in (1, 2, 3, 4))
    np.savetxt(folder / "duty.csv", np.column_stack([times, *duty]), fmt="%.12g", delimiter=",", header=header, comments="")
    (folder / "truth.json").write_text(json.dumps({
        "step": STEP_S, "stop_time": duration_s,
        "instances": {
            "motors": {"fmu": "fmu_motors", "parameters": {"rotor_data": rotor, "avionics.base_power": 0.96}},
            "battery": {"fmu": "fmu_battery", "parameters": {"cell.name": cell, "cell.initial_state_of_charge": charge}},
        },
        "connections": [
            {"from": "battery.bus.voltage", "to": "motors.bus.voltage"},
            {"from": "motors.power", "to": "battery.motors.power"},
            {"from": "motors.avionics.power", "to": "battery.avionics.power"},
        ],
        "inputs": {"file": "duty.csv"},
    }))
    with mebots.Mission(folder / "truth.json") as mission:
        mission.run()
        thrust_n = sum(mission[f"motors.rotor[{i}].thrust"] for i in (1, 2, 3, 4))
        speeds = [mission[f"motors.rotor[{i}].speed"] for i in (1, 2, 3, 4)]
        voltage = mission["battery.bus.voltage"]
    climb = np.zeros(len(times))
    for k in range(len(times) - 1):
        force_n = (thrust_n[k] + thrust_n[k + 1]) / 2 - DRAG * climb[k]
        climb[k + 1] = climb[k] + STEP_S * (force_n / MASS_KG - GRAVITY_M_PER_S2)
    rpm = [np.round(one * 30 / math.pi) for one in speeds]
    return times, [np.round(one * 65535) for one in duty], rpm, np.round(1000 * voltage), climb


def log_bytes(times, duty, rpm, millivolts, climb):
    columns = [one.astype(int).tolist() for one in (*duty, *rpm, millivolts)]
    rows = zip(*columns, climb.tolist(), strict=True)
    return usd_log([STATE], [(0xFFFF, round(1e6 * time), row) for time, row in zip(times.tolist(), rows, strict=True)])


def airframe(folder, name="airframe.json", **changes):
    """Writes an airframe with the mass of the drone in the generated flight."""
    content = json.loads((SOURCE / "configs/airframes/crazyflie_21.json").read_text())
    content["mass_without_cell"] |= {"value": MASS_KG - 0.0071, "interval": [0.02, 0.025]}
    path = folder / name
    path.write_text(json.dumps(content | {"rotor": "crazyflie_l250", "cell": "bitcraze_250"} | changes))
    return path
