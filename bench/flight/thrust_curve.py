#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the thrust of one rotor over its command, for a drone file. Uses the FMUs of motors and battery.

    MEBOTS_FMU_PATH=BUILD/fmus PYTHONPATH=BUILD/python .venv/bin/python bench/flight/thrust_curve.py

Each point is a steady state: a half-charged cell supplies the motors.
"""
import json
import pathlib
import tempfile

import mebots

ROOT = pathlib.Path(__file__).resolve().parents[2]
COMMANDS = (0, 0.0625, 0.125, 0.1875, 0.25, 0.3125, 0.375, 0.4325, 0.5, 0.5625, 0.625, 0.6875, 0.75, 0.8125, 0.875, 0.9375, 1)
ROTOR, CELL, CHARGE = "crazyflie_legacy", "bitcraze_250_flights", 0.5
SETTLED_S = 60
NEVER_EMPTY_C = 1e9  # so large that the charge is practically constant


def mission(folder):
    cell = json.loads((ROOT / f"fmu_battery/params/cells/{CELL}.json").read_text())
    cell["capacity"]["value"] = NEVER_EMPTY_C
    (folder / "cell.json").write_text(json.dumps(cell))
    config = {
        "step": 0.002, "stop_time": SETTLED_S * len(COMMANDS),
        "instances": {
            "motors": {"fmu": "fmu_motors", "parameters": {"rotor_data": ROTOR, "bus.resistance": 0.15}},
            "battery": {"fmu": "fmu_battery", "parameters": {"cell.name": str(folder / "cell.json"), "cell.initial_state_of_charge": CHARGE}},
        },
        "connections": [
            {"from": "motors.power", "to": "battery.motors.power"},
            {"from": "motors.avionics.power", "to": "battery.avionics.power"},
            {"from": "battery.bus.voltage", "to": "motors.bus.voltage"},
        ],
    }
    file = folder / "settle.json"
    file.write_text(json.dumps(config))
    return file


def main():
    thrust_n = []
    with tempfile.TemporaryDirectory() as name, mebots.Mission(mission(pathlib.Path(name))) as run:
        run.start()
        for place, command in enumerate(COMMANDS):
            for rotor in range(1, 5):
                run.write(f"motors.rotor[{rotor}].command", command)
            run.run_until(SETTLED_S * (place + 1) - 1)
            thrust_n.append(round(run.value("motors.rotor[1].thrust"), 7))
    print(json.dumps({"command": COMMANDS, "thrust": thrust_n}))


if __name__ == "__main__":
    main()
