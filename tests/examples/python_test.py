#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Drives missions through the Python package. Usage: python_test.py FMU_DIR (with PYTHONPATH set)."""

import json
import pathlib
import sys
import tempfile

import numpy as np

import mebots

FMU_DIR = pathlib.Path(sys.argv[1]).resolve()


def config(folder, **battery):
    path = pathlib.Path(folder) / "config.json"
    path.write_text(json.dumps({
        "step": 0.01, "stop_time": 1,
        "instances": {"battery": {"fmu": str(FMU_DIR / "fmu_battery.fmu"),
                                  "parameters": {"cell.name": "bitcraze_250"}} | battery,
                      "motors": {"fmu": str(FMU_DIR / "fmu_motors.fmu")}},
        "connections": [{"from": "motors.power", "to": "battery.motors.power"},
                        {"from": "battery.bus.voltage", "to": "motors.bus.voltage"}],
    }))
    return path


def raises(kind, work, text):
    try:
        work()
    except kind as error:
        assert text in str(error), str(error)
        return
    raise AssertionError(f"no {kind.__name__} with {text!r}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        path = config(folder)

        # Step by step, with an input set in between.
        mission = mebots.Mission(path)
        mission.record(["battery.cell.voltage", "motors.power"])
        assert mission.step_size == 0.01 and mission.stop_time == 1 and not mission.ended
        mission.run_until(0.5)
        assert abs(mission.time - 0.5) < 1e-12
        assert mission.value("motors.power") == 0
        for i in range(1, 5):
            mission.write(f"motors.rotor[{i}].command", 0.6)
        steps = 0
        while mission.step():
            steps += 1
        assert steps == 50 and mission.ended and mission.outcome == "completed"
        power = mission["motors.power"]
        assert isinstance(power, np.ndarray) and power.dtype == np.float64 and power.shape == mission.times.shape == (101,)
        assert mission.times[0] == 0 and mission.times[-1] == 1
        assert (power[:51] == 0).all() and (power[51:] > 0).all() and power[-1] > 10 * power[51]
        assert mission["battery.cell.voltage"][-1] < mission["battery.cell.voltage"][0]
        assert mission.unit("motors.power") == "W" and mission.variables == ["battery.cell.voltage", "motors.power"]

        # The same inputs give the same bits.
        runs = []
        for _ in range(2):
            again = mebots.Mission(str(path))
            again.set("motors.rotor[1].command", 0.5)
            again.set_stop_time(0.3)
            again.run()
            runs.append(again["battery.cell.voltage"])
        assert (runs[0] == runs[1]).all() and len(runs[0]) == 31

        # And so does an instance in a process of its own, whose program stands beside the package.
        isolated = mebots.Mission(config(folder, process="own"))
        isolated.set("motors.rotor[1].command", 0.5)
        isolated.set_stop_time(0.3)
        isolated.run()
        assert (isolated["battery.cell.voltage"] == runs[0]).all()

        # Mistakes are told.
        raises(mebots.InputError, lambda: mebots.Mission("nowhere.json"), "nowhere.json")
        fresh = mebots.Mission(config(folder))
        raises(mebots.InputError, lambda: fresh.set("batery.x", 1), "battery")
        raises(mebots.InputError, lambda: fresh.value("battery.cell.voltag"), "cell.voltage")
        raises(mebots.InputError, lambda: fresh.write("battery.motors.power", 1), "is connected to 'motors.power'")
        raises(mebots.InputError, lambda: fresh.write("battery.cell.voltage", 1), "only inputs")
        raises(mebots.InputError, lambda: fresh.set("motors.rotor[1].command", 1), "too late")
        raises(KeyError, lambda: fresh["world.drone"], "is not recorded")
    print("ok: missions can be driven from Python")


if __name__ == "__main__":
    main()
