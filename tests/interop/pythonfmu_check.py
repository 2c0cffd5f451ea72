#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds an FMU with pythonfmu, runs two of them coupled by mebots, and does the same by hand with FMPy.

Usage: pythonfmu_check.py MEBOTS
"""

import csv
import json
import os
import pathlib
import subprocess
import sys
import sysconfig
import tempfile

import fmpy
import fmpy.fmi2
import pythonfmu

STEP, STEPS = 0.125, 40  # exact in binary: both hand the same times to the FMU
PARAMETERS = {"a": {"gain": 3.5, "u": 0.25, "word_in": "grüß", "flag_in": True}, "b": {"gain": -0.5}}
CONNECTIONS = [("a.y", "b.u"), ("b.area", "a.u"), ("b.count", "a.count_in"), ("a.count", "b.count_in"),
               ("a.flag", "b.flag_in"), ("b.flag", "a.flag_in"), ("a.word", "b.word_in")]
RECORDED = ["a.y", "a.area", "a.count", "a.flag", "b.y", "b.area", "b.count", "b.flag", "b.word"]


def by_hand(fmu):
    """The same Jacobi coupling with FMPy's bindings."""
    description = fmpy.read_model_description(str(fmu), validate=False)  # it leaves out variability, which we forgive
    folder = fmpy.extract(str(fmu))
    variables = {v.name: v for v in description.modelVariables}
    instances = {}
    for name, values in PARAMETERS.items():
        instance = fmpy.fmi2.FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName=name,
                                       modelIdentifier=description.coSimulation.modelIdentifier)
        instance.instantiate()
        instances[name] = instance

    def split(path):
        name, variable = path.split(".")
        return instances[name], variables[variable]

    def get(path):
        instance, variable = split(path)
        value = getattr(instance, "get" + variable.type)([variable.valueReference])[0]
        return value.decode() if isinstance(value, bytes) else value

    def put(path, value):
        instance, variable = split(path)
        getattr(instance, "set" + variable.type)([variable.valueReference], [value])

    for name, values in PARAMETERS.items():
        for variable, value in values.items():
            put(f"{name}.{variable}", value)
    for instance in instances.values():
        instance.setupExperiment(startTime=0.0, stopTime=STEP * STEPS)
        instance.enterInitializationMode()
    for _ in range(4):  # initial values travel along the longest chain
        values = [get(source) for source, _ in CONNECTIONS]
        for (_, target), value in zip(CONNECTIONS, values):
            put(target, value)
    for instance in instances.values():
        instance.exitInitializationMode()
    rows = [[get(name) for name in RECORDED]]
    for k in range(STEPS):
        values = [get(source) for source, _ in CONNECTIONS]
        for (_, target), value in zip(CONNECTIONS, values):
            put(target, value)
        for instance in instances.values():
            instance.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)
        rows.append([get(name) for name in RECORDED])
    for instance in instances.values():
        instance.terminate()
        instance.freeInstance()
    return rows


def main():
    mebots = sys.argv[1]
    script = pathlib.Path(__file__).parent / "python_slave.py"
    with tempfile.TemporaryDirectory(prefix="foreign fmus ") as folder:
        folder = pathlib.Path(folder)
        fmu = pythonfmu.FmuBuilder.build_FMU(str(script), dest=str(folder))
        config = {
            "step": STEP,
            "stop_time": STEP * STEPS,
            "instances": {name: {"fmu": str(fmu), "parameters": values} for name, values in PARAMETERS.items()},
            "connections": [{"from": source, "to": target} for source, target in CONNECTIONS],
            "record": {"variables": RECORDED, "texts": True},
        }
        (folder / "config.json").write_text(json.dumps(config))

        alone = subprocess.run([mebots, "run", folder / "config.json", "--out", folder / "refused"],
                               capture_output=True, text=True)
        library = pathlib.Path(sysconfig.get_config_var("LIBDIR")) / sysconfig.get_config_var("INSTSONAME")
        if alone.returncode != 0 and "LD_PRELOAD" not in alone.stderr:
            sys.exit(f"FAILED: without a Python interpreter the message must say how to get one: {alone.stderr}")
        print(f"ok: without Python: {alone.stderr.strip()[-160:]}")

        environment = dict(os.environ, LD_PRELOAD=str(library), PYTHONPATH=str(pathlib.Path(pythonfmu.__file__).parent.parent))
        result = subprocess.run([mebots, "run", folder / "config.json", "--out", folder / "ours"], env=environment,
                                capture_output=True, text=True)
        if result.returncode != 0:
            sys.exit(f"FAILED: mebots ended with {result.returncode}: {result.stdout}{result.stderr}")
        with (folder / "ours" / "results.csv").open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        names = [name.rsplit(" [", 1)[0] for name in rows[0]]
        expected = by_hand(fmu)
        if len(rows) - 1 != len(expected):
            sys.exit(f"FAILED: {len(rows) - 1} rows instead of {len(expected)}")
        for k, (row, wanted) in enumerate(zip(rows[1:], expected)):
            for name, value in zip(RECORDED, wanted):
                cell = row[names.index(name)]
                # The same doubles in, so the same doubles out: compared exactly.
                same = cell == value if isinstance(value, str) else float(cell) == float(value)
                if not same:
                    sys.exit(f"FAILED: {name} in row {k} is {cell!r}, by hand {value!r}")
    print(f"ok: {len(expected)} rows, {len(RECORDED)} variables of two coupled pythonfmu FMUs agree exactly with FMPy's")


if __name__ == "__main__":
    main()
