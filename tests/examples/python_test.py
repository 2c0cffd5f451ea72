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

        # Runs a mission step by step, and sets an input between steps.
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
        assert (power[:51] == 0).all() and (power[51:] > 0).all() and power[-1] > 4
        assert mission["battery.cell.voltage"][-1] < mission["battery.cell.voltage"][0]
        assert mission.unit("motors.power") == "W" and mission.variables == ["battery.cell.voltage", "motors.power"]

        # Equal inputs give equal bits.
        runs = []
        for _ in range(2):
            again = mebots.Mission(str(path))
            again.set("motors.rotor[1].command", 0.5)
            again.set_stop_time(0.3)
            again.run()
            runs.append(again["battery.cell.voltage"])
        assert (runs[0] == runs[1]).all() and len(runs[0]) == 31

        # An instance in a separate process must give the same bits.
        isolated = mebots.Mission(config(folder, process="own"))
        isolated.set("motors.rotor[1].command", 0.5)
        isolated.set_stop_time(0.3)
        isolated.run()
        assert (isolated["battery.cell.voltage"] == runs[0]).all()

        # Mistakes must raise errors.
        raises(mebots.InputError, lambda: mebots.Mission("nowhere.json"), "nowhere.json")
        fresh = mebots.Mission(config(folder))
        raises(mebots.InputError, lambda: fresh.set("batery.x", 1), "battery")
        raises(mebots.InputError, lambda: fresh.value("battery.cell.voltag"), "cell.voltage")
        raises(mebots.InputError, lambda: fresh.write("battery.motors.power", 1), "is connected to 'motors.power'")
        raises(mebots.InputError, lambda: fresh.write("battery.cell.voltage", 1), "only inputs")
        raises(mebots.InputError, lambda: fresh.set("motors.rotor[1].command", 1), "too late")
        raises(KeyError, lambda: fresh["world.drone"], "is not recorded")
        raises(KeyError, lambda: fresh["battery.cell.voltag"], "battery.cell.voltage")

        # Creates a mission with all options as keyword arguments, and closes it before its end. Its files must equal those
        # of the command line, and must have the same bits after reading.
        out = pathlib.Path(folder) / "out"
        points = []
        with mebots.Mission(path, set={"motors.rotor[1].command": 0.5, "battery.cell.name": "lipol_350"}, stop_time=0.5,
                            record=["battery.cell.voltage", "battery.cell.connected"], out=out, statistics=True) as short:
            assert short.state == "open" and short.outcome == "" and short.times.size == 0 and short.summary == {}
            short.on_point(points.append)
            short.run_until(0.2)
            assert short.state == "running" and short.end_reason is None
            voltage = short["battery.cell.voltage"]
        assert short.state == "ended" and short.outcome == short.end_reason == "closed" and len(points) == 21
        results = mebots.read(out)
        assert results.outcome == "closed" and results.variables == ["battery.cell.voltage", "battery.cell.connected"]
        assert (results["battery.cell.voltage"] == voltage).all() and (results.times == short.times).all()
        assert results.unit("battery.cell.voltage") == "V" and results["battery.cell.connected"].all()
        assert results.summary["parameters"]["battery"]["cell.name"] == "lipol_350"
        assert results.summary["statistics"]["instances"]["motors"]["steps"] == 20
        raises(KeyError, lambda: results["battery.cell.volt"], "battery.cell.voltage")
        raises(mebots.InputError, lambda: mebots.read(folder), "is this the folder of a run?")
        raises(mebots.InputError, lambda: mebots.read("nowhere"), "no such folder")
        assert mebots.Mission.run.__doc__ and mebots.Mission.__doc__ and mebots.read.__doc__

        # Listeners may read variables at a point and request the end of the run, but may not step. If a listener causes an
        # error, run() raises it and the mission fails.
        seen = []
        watched = mebots.Mission(path)
        watched.on_point(lambda time: time > 0 and seen.append(watched.value("battery.cell.voltage")))
        watched.on_point(lambda time: time >= 0.3 and watched.interrupt())
        watched.run()
        assert watched.outcome == "interrupted" and abs(watched.time - 0.3) < 1e-12
        assert (np.array(seen) == watched["battery.cell.voltage"][1:]).all()
        nested = mebots.Mission(path)
        nested.on_point(lambda time: nested.step())
        raises(mebots.InputError, nested.run, "from a listener")
        assert nested.state == "failed"
        early = mebots.Mission(path)
        early.interrupt()
        early.start()
        assert early.state == "ended" and early.outcome == "interrupted"
        raises(mebots.InputError, lambda: early.value("battery.cell.voltage"), "has not reached t = 0")

        # Any numeric type is accepted. The order of reported changes does not depend on the order of the calls.
        changed = mebots.Mission(path, out=out)
        changed.set_stop_time(2)
        changed.set("motors.rotor[1].command", np.float32(0.5))
        changed.set_stop_time(0.1)
        changed.run()
        assert changed.summary["inputs"]["changes"] == ["set motors.rotor[1].command=0.5", "stop_time 0.1"]
        raises(TypeError, lambda: mebots.Mission(path).set("motors.rotor[1].command", None), "bool, int, float or str")

        # If a listener raises an exception, run() raises it and the mission fails. Errors of mebots have codes.
        bad = mebots.Mission(path)
        bad.on_point(lambda time: 1 / 0)
        raises(ZeroDivisionError, bad.run, "division")
        assert bad.state == "failed" and bad.outcome == "failed"
        raises(mebots.InputError, bad.step, "failed")
        try:
            mebots.Mission(path, set={"battery.cell.nam": "x"})
        except mebots.InputError as error:
            assert error.code == "unknown_name" and "cell.name" in str(error)
    print("ok: missions can be driven from Python")


if __name__ == "__main__":
    main()
