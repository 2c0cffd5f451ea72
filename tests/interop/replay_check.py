#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Replays the reference traces in the documentation/reference of an FMU. Reports the first difference.

Usage: replay_check.py FILE.fmu [--every-output]

With --every-output, the trace must have a column for each Real and Boolean output, as scripts/update_golden.py writes it.

Row k of <fmu>_out.csv contains the outputs at its time. The inputs of the step from row k to the next row are those of the last
row of <fmu>_in.csv that is not later than row k.
"""

import csv
import pathlib
import sys
import tempfile

import fmpy
import fmpy.fmi2

# Another compiler may round differently. Larger differences show that the model has changed.
RELATIVE = 1e-6
ABSOLUTE = 1e-9


def read_csv(path):
    with path.open(newline="") as file:
        rows = [{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(file)]
    if not rows:
        sys.exit(f"FAILED: {path.name} has no rows")
    return rows


def main():
    archive = pathlib.Path(sys.argv[1])
    description = fmpy.read_model_description(str(archive))
    variables = {v.name: v for v in description.modelVariables}
    with tempfile.TemporaryDirectory() as folder:
        fmpy.extract(str(archive), folder)
        reference = pathlib.Path(folder) / "documentation" / "reference"
        inputs = read_csv(reference / f"{archive.stem}_in.csv")
        expected = read_csv(reference / f"{archive.stem}_out.csv")
        if "--every-output" in sys.argv[2:]:
            lacking = [v.name for v in description.modelVariables
                       if v.causality == "output" and v.type in ("Real", "Boolean") and v.name not in expected[0]]
            if lacking:
                sys.exit(f"FAILED: the trace lacks {', '.join(lacking)}; draw it again with scripts/update_golden.py")

        fmu = fmpy.fmi2.FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="replay",
                                  modelIdentifier=description.coSimulation.modelIdentifier)

        def apply(time):
            row = [r for r in inputs if r["time"] <= time + 1e-9][-1]
            for name, value in row.items():
                if name == "time":
                    continue
                variable = variables[name]
                if variable.type == "Real":
                    fmu.setReal([variable.valueReference], [value])
                elif variable.type == "Boolean":
                    fmu.setBoolean([variable.valueReference], [bool(value)])
                else:
                    fmu.setInteger([variable.valueReference], [int(value)])

        def read(name):
            variable = variables[name]
            getter = {"Real": fmu.getReal, "Boolean": fmu.getBoolean}.get(variable.type, fmu.getInteger)
            return float(getter([variable.valueReference])[0])

        fmu.instantiate()
        fmu.setupExperiment(startTime=0.0)
        fmu.enterInitializationMode()
        apply(0.0)
        fmu.exitInitializationMode()
        for k, row in enumerate(expected):
            for name, value in row.items():
                if name == "time":
                    continue
                actual = read(name)
                exact = variables[name].type != "Real"
                if not abs(actual - value) <= (0 if exact else max(ABSOLUTE, RELATIVE * abs(value))):  # NaN fails, too
                    sys.exit(f"FAILED: first divergence at {row['time']} s: {name} is {actual!r}, the trace has {value!r}")
            if k + 1 < len(expected):
                apply(row["time"])
                fmu.doStep(currentCommunicationPoint=row["time"], communicationStepSize=expected[k + 1]["time"] - row["time"])
        fmu.terminate()
        fmu.freeInstance()
    print(f"ok: {len(expected)} rows, {len(expected[0]) - 1} outputs agree with the reference trace")


if __name__ == "__main__":
    main()
