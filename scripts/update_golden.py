#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rewrites reference/<fmu>_in.csv and _out.csv of fmu_battery, fmu_motors and fmu_world by running the built FMUs.

    .venv/bin/python scripts/update_golden.py build/release/fmus

Row k of _in.csv contains the inputs from its time until the next row. Row k of _out.csv contains the outputs at this time.
Parameters have their start values. Before you commit the files, check the differences.
"""
import csv
import math
import shutil
import sys
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave

ROOT = Path(__file__).resolve().parent.parent


def battery(k):
    """Returns the battery's inputs in step k of a flight with a drone of 40 g. The flight ends when the protection opens.
    For one minute, a source supplies power."""
    return {
        "motors.power": 9.5 + math.sin(0.3 * k) if k > 2 else 0.0,
        "soc.power": 0.06 if k % 4 else 0.12,
        "camera.power": 0.0049 if k % 2 else 0.0004,
        "avionics.power": 0.96,
        "auxiliary.power": 0.0,
        "source.power": 2.0 if 60 <= k < 90 else 0.0,
    }


def motors(k):
    """Returns the inputs of the motors in step k: spin-up, hover with a manoeuvre, a sagging bus, a stop."""
    flying = 5 <= k < 170
    swing = 0.1 * math.sin(0.2 * k)
    return {
        "rotor[1].command": 0.72 + swing if flying else 0.0,
        "rotor[2].command": 0.72 - swing if flying else 0.0,
        "rotor[3].command": 0.72 + swing if flying else 0.0,
        "rotor[4].command": 0.72 - swing if flying else 0.0,
        "bus.voltage": 3.9 - 0.004 * k,
        "air.density": 1.225,
        "body.mass": 0.04,
        "body.speed": 0.28 if 60 <= k < 150 else 0.0,
    }


def world(k):
    """Returns the inputs of the world in step k of a flight without control. In a side wind with a little yaw torque, the drone
    rises from the ground, and then drops and crashes."""
    thrust = 0.12 if k < 20 else 0.08 if k < 32 else 0.0
    return {
        **{f"rotor[{i}].thrust": thrust for i in (1, 2, 3, 4)},
        **{f"rotor[{i}].torque": 0.0072 * thrust if i % 2 else 0.00735 * thrust for i in (1, 2, 3, 4)},
        "wind.velocity.x": 0.0,
        "wind.velocity.y": 1.0 if k >= 8 else 0.0,
        "wind.velocity.z": 0.0,
        "cell.mass": 0.0071,
    }


def write(path, header, rows):
    with open(path, "w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)


def run(archive, inputs_at, step, count):
    """Runs an FMU. Returns the names and the rows of inputs, and of Real and Boolean outputs, at count + 1 communication
    points."""
    description = fmpy.read_model_description(archive)
    folder = fmpy.extract(archive)
    references = {v.name: v.valueReference for v in description.modelVariables}
    outputs = [v for v in description.modelVariables if v.causality == "output" and v.type in ("Real", "Boolean")]
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="golden",
                    modelIdentifier=description.coSimulation.modelIdentifier)

    def apply(values):
        fmu.setReal([references[name] for name in values], list(values.values()))

    def read():
        return [(fmu.getReal if v.type == "Real" else fmu.getBoolean)([v.valueReference])[0] for v in outputs]

    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    apply(inputs_at(0))
    fmu.exitInitializationMode()
    inputs, results = [], []
    for k in range(count + 1):
        values = inputs_at(k)
        inputs.append([repr(k * step), *map(repr, values.values())])
        results.append([repr(k * step), *(repr(float(x)) if isinstance(x, float) else int(x) for x in read())])
        if k < count:
            apply(values)
            fmu.doStep(currentCommunicationPoint=k * step, communicationStepSize=step)
    fmu.terminate()
    fmu.freeInstance()
    shutil.rmtree(folder)
    return ["time", *inputs_at(0)], inputs, ["time", *(v.name for v in outputs)], results


def main():
    fmus = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release/fmus")
    for name, inputs_at, step, count in (("fmu_battery", battery, 2.0, 150), ("fmu_motors", motors, 0.0625, 192),
                                         ("fmu_world", world, 0.0625, 64)):
        in_names, in_rows, out_names, out_rows = run(fmus / f"{name}.fmu", inputs_at, step, count)
        folder = ROOT / name / "reference"
        folder.mkdir(exist_ok=True)
        write(folder / f"{name}_in.csv", in_names, in_rows)
        write(folder / f"{name}_out.csv", out_names, out_rows)
        print(f"{name}: {len(out_rows)} rows")


if __name__ == "__main__":
    main()
