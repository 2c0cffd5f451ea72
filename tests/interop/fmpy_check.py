#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks an FMU with FMPy's validation, and runs it in FMPy with all inputs at their start values.

Usage: fmpy_check.py FILE.fmu
"""

import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

import fmpy
import fmpy.fmi2
import fmpy.validation
import numpy as np

BASE_LIBRARIES = {
    "libc.so.6",
    "libm.so.6",
    "libpthread.so.0",
    "libstdc++.so.6",
    "libgcc_s.so.1",
    "ld-linux-x86-64.so.2",
}


def check(condition, message):
    if not condition:
        sys.exit(f"FAILED: {message}")
    print(f"ok: {message}")


def same(a, b):
    """Returns True if all columns have the same bits."""
    return all(np.array_equal(a[name], b[name], equal_nan=False) for name in a.dtype.names)


class Instance:
    """An FMI instance that records its Real outputs."""

    def __init__(self, description, folder, name, start=True):
        self.outputs = [v for v in description.modelVariables if v.causality == "output" and v.type == "Real"]
        self.references = [v.valueReference for v in self.outputs]
        self.fmu = fmpy.fmi2.FMU2Slave(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.fmu.instantiate()
        if start:
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
            self.fmu.exitInitializationMode()

    def run(self, first, last, h):
        rows = []
        for k in range(first, last):
            self.fmu.doStep(currentCommunicationPoint=k * h, communicationStepSize=h)
            rows.append(self.fmu.getReal(self.references))
        return rows

    def close(self):
        self.fmu.terminate()
        self.fmu.freeInstance()


def check_binary(folder, identifier):
    binaries = folder / "binaries" / "linux64"
    library = binaries / f"{identifier}.so"
    symbols = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    names = [line.split()[-1] for line in symbols.splitlines()]
    # FMUs without state outside of instances may also export mebots_keeps_no_state_outside_instances (docs/master/clean-fmus.md).
    others = [name for name in names if not name.startswith("fmi2") and name != "mebots_keeps_no_state_outside_instances"]
    check(names and not others, f"exports {len(names)} symbols, all fmi2*{' but ' + ', '.join(others) if others else ''}")

    inside = {path.name for path in binaries.iterdir()}
    for path in binaries.iterdir():
        dynamic = subprocess.run(["readelf", "-d", path], capture_output=True, text=True, check=True).stdout
        needed = {line.split("[")[1].rstrip("]") for line in dynamic.splitlines() if "(NEEDED)" in line}
        missing = needed - BASE_LIBRARIES - inside
        check(not missing, f"{path.name} needs nothing from outside the archive but the C and C++ runtime ({missing or 'none'})")


def check_state(description, folder):
    """Checks that a run has the same bits if its state is serialized and restored in another instance."""
    h, half, end = 0.01, 10, 20
    straight = Instance(description, folder, "straight")
    expected = straight.run(0, end, h)
    straight.close()

    first = Instance(description, folder, "first")
    first.run(0, half, h)
    state = first.fmu.getFMUState()
    data = first.fmu.serializeFMUState(state)
    first.fmu.freeFMUState(state)
    first.close()

    second = Instance(description, folder, "second", start=False)
    state = second.fmu.deSerializeFMUstate(data)
    second.fmu.setFMUState(state)
    restored = second.run(half, end, h)
    second.fmu.freeFMUState(state)
    second.close()
    check(restored == expected[half:], "a run restored from serialised state goes on with the same bits")


def first_value(description, folder, variable, changes):
    """Returns an output at t = 0 for other start values of some inputs."""
    instance = Instance(description, folder, "first", start=False)
    instance.fmu.setupExperiment(startTime=0.0)
    instance.fmu.enterInitializationMode()
    for changed, value in changes:
        setter = {"Real": instance.fmu.setReal, "Boolean": instance.fmu.setBoolean}.get(changed.type, instance.fmu.setInteger)
        setter([changed.valueReference], [value])
    getter = {"Real": instance.fmu.getReal, "Boolean": instance.fmu.getBoolean}.get(variable.type, instance.fmu.getInteger)
    value = getter([variable.valueReference])[0]
    instance.fmu.freeInstance()
    return value


def other_start(variable):
    """Returns a permitted value that differs from the variable's start value."""
    if variable.type == "Boolean":
        return variable.start == "false"
    if variable.type == "Enumeration":
        return next(int(i.value) for i in variable.declaredType.items if i.value != variable.start)
    if variable.type == "Integer":
        return int(variable.start) + 1
    start = float(variable.start)
    larger = start + 0.4 * abs(start) + 0.3
    top = math.inf if variable.max is None else float(variable.max)
    return larger if larger <= top else (start + float(variable.min)) / 2


def check_first_outputs(description, folder):
    """Checks the dependencies in ModelStructure at t = 0. Inputs that are not listed must not change an output, neither
    individually nor all together."""
    inputs = [v for v in description.modelVariables if v.causality == "input" and v.type != "String"
              and not v.name.endswith((".base.lo", ".base.hi", ".size"))]
    stated = 0
    for unknown in description.initialUnknowns:
        output = unknown.variable
        if unknown.dependencies is None or output.type == "String" or output.name.endswith((".base.lo", ".base.hi")):
            continue
        stated += 1
        others = [(v, other_start(v)) for v in inputs if v not in unknown.dependencies]
        value = first_value(description, folder, output, [])
        for changes in [[change] for change in others] + [others]:
            now = first_value(description, folder, output, changes)
            if now != value:
                sys.exit(f"FAILED: {output.name} is {now}, not {value}, at t = 0 with other {[v.name for v, _ in changes]}")
    print(f"ok: {stated} of {len(description.initialUnknowns)} first outputs say which inputs count, and others do not")


def check_instances(description, folder):
    """Checks that two instances do not affect each other if their steps alternate."""
    h, end = 0.02, 10
    alone = Instance(description, folder, "alone")
    expected = alone.run(0, end, h)
    alone.close()
    pair = [Instance(description, folder, name) for name in ("left", "right")]
    results = [[], []]
    for k in range(end):
        for result, instance in zip(results, pair):
            result += instance.run(k, k + 1, h)
    for instance in pair:
        instance.close()
    check(results[0] == expected and results[1] == expected, "two instances side by side give what one alone gives")


def main():
    fmu = pathlib.Path(sys.argv[1])
    with tempfile.TemporaryDirectory(prefix="a path with späces ") as folder:
        folder = pathlib.Path(folder)
        copy = folder / fmu.name
        shutil.copy(fmu, copy)

        problems = fmpy.validation.validate_fmu(str(copy))
        check(not problems, f"fmpy validate says nothing: {problems}")

        description = fmpy.read_model_description(str(copy))
        outputs = [v.name for v in description.modelVariables if v.causality == "output" and v.type != "String"]
        pointers = {v.name for v in description.modelVariables if v.name.endswith((".base.lo", ".base.hi"))}
        outputs = [name for name in outputs if name not in pointers]
        runs = [fmpy.simulate_fmu(str(copy), stop_time=0.5, step_size=h, output_interval=h, output=outputs)
                for h in (0.01, 0.01, 0.1)]
        check(len(runs[0]) == 51 and len(runs[2]) == 6, "fmpy simulates 0.5 s with h = 0.01 s and h = 0.1 s")
        check(same(runs[0], runs[1]), "two fmpy runs agree bit for bit")
        check(all(np.all(np.isfinite(run[name])) for run in runs for name in run.dtype.names), "all outputs are finite")

        unpacked = folder / "unpacked"
        fmpy.extract(str(copy), str(unpacked))
        check_binary(unpacked, description.coSimulation.modelIdentifier)
        check_state(description, unpacked)
        check_instances(description, unpacked)
        check_first_outputs(description, unpacked)


if __name__ == "__main__":
    main()
