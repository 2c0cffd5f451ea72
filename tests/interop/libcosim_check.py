#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Our FMUs in libcosim, each alone and battery and motors connected, compared with our own master.

Usage: libcosim_check.py MEBOTS FMU_DIR
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import fmpy
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

STEP_NS, STEPS = 2_000_000, 250
CONNECTED = {
    "instances": {
        "motors": {"fmu": "fmu_motors.fmu",
                   "parameters": {f"rotor[{i}].command": 0.6 for i in range(1, 5)}},
        "battery": {"fmu": "fmu_battery.fmu"},
    },
    "connections": [("battery.bus.voltage", "motors.bus.voltage"), ("motors.power", "battery.motors.power"),
                    ("motors.avionics.power", "battery.avionics.power")],
}


def ours(mebots, folder, fmus, system):
    config = {
        "step": STEP_NS * 1e-9,
        "stop_time": STEPS * STEP_NS / 1e9,
        "instances": {name: dict(instance, fmu=str(fmus / instance["fmu"])) for name, instance in system["instances"].items()},
        "connections": [{"from": a, "to": b} for a, b in system["connections"]],
        "record": ["*"],
    }
    file = folder / "config.json"
    file.write_text(json.dumps(config))
    subprocess.run([mebots, "run", file, "--out", folder / "ours", "--quiet"], check=True)
    with (folder / "ours" / "results.csv").open(newline="") as stream:
        rows = list(csv.reader(stream))
    return dict(zip((name.rsplit(" [", 1)[0] for name in rows[0]), rows[-1]))


def theirs(fmus, system):
    """Last values of all Real outputs in libcosim, with the same step."""
    execution = CosimExecution.from_step_size(step_size=STEP_NS)
    variables, slaves = {}, {}
    for name, instance in system["instances"].items():
        slave = CosimLocalSlave(fmu_path=str(fmus / instance["fmu"]), instance_name=name)
        slaves[name] = execution.add_local_slave(local_slave=slave)
        description = fmpy.read_model_description(str(fmus / instance["fmu"]))
        variables[name] = {v.name: v for v in description.modelVariables}
        for variable, value in instance.get("parameters", {}).items():
            if not execution.real_initial_value(slaves[name], variables[name][variable].valueReference, value):
                sys.exit(f"FAILED: libcosim refuses {name}.{variable} = {value}")

    def end(path):
        name, variable = path.split(".", 1)
        return slaves[name], variables[name][variable].valueReference

    for source, target in system["connections"]:
        execution.connect_real_variables(*end(source), *end(target))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)
    if not execution.step(step_count=STEPS):
        sys.exit("FAILED: libcosim cannot step")
    values = {}
    for name in slaves:
        outputs = [v for v in variables[name].values() if v.causality == "output" and v.type == "Real"]
        numbers = observer.last_real_values(slaves[name], [v.valueReference for v in outputs])
        values.update({f"{name}.{v.name}": number for v, number in zip(outputs, numbers)})
    return values


def compare(title, mebots, fmus, system):
    with tempfile.TemporaryDirectory() as folder:
        mine = ours(mebots, pathlib.Path(folder), fmus, system)
    other = theirs(fmus, system)
    worst, where = 0.0, ""
    for name, value in other.items():
        # Both hand the same doubles to the same FMU; libcosim's clock adds up steps in whole nanoseconds as ours does.
        difference = abs(float(mine[name]) - value) / max(abs(value), 1e-9)
        if difference > worst:
            worst, where = difference, name
    if not other or worst > 1e-12:
        sys.exit(f"FAILED: {title}: {where}: ours {mine[where]}, libcosim's {other[where]}")
    print(f"ok: {title}: {len(other)} Real outputs after {STEPS} steps, largest relative difference {worst:.2g}")


def main():
    log_output_level(CosimLogLevel.ERROR)
    mebots, fmus = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    for fmu in ("fmu_battery", "fmu_motors", "fmu_world", "fmu_soc"):
        compare(f"{fmu} alone", mebots, fmus, {"instances": {fmu: {"fmu": f"{fmu}.fmu"}}, "connections": []})
    compare("battery and motors connected", mebots, fmus, CONNECTED)


if __name__ == "__main__":
    main()
