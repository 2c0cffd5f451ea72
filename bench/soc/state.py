#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the time for saving, restoring and serialising an FMU's state through fmi2*FMUstate.

Prints the minimum and the median of many repeats.

Usage: state.py [FMU] [--repeats 200]      default: build/release/fmus/fmu_soc.fmu
"""

import argparse
import pathlib
import shutil
import statistics
import time

import fmpy
from fmpy.fmi2 import FMU2Slave

ROOT = pathlib.Path(__file__).resolve().parents[2]


def measure(name, action, repeats):
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(1e3 * (time.perf_counter() - start))
    print(f"{name:12} best {min(times):7.3f} ms  median {statistics.median(times):7.3f} ms")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("fmu", nargs="?", type=pathlib.Path, default=ROOT / "build/release/fmus/fmu_soc.fmu")
    parser.add_argument("--repeats", type=int, default=200)
    arguments = parser.parse_args()

    description = fmpy.read_model_description(str(arguments.fmu))
    folder = fmpy.extract(str(arguments.fmu))
    slave = FMU2Slave(guid=description.guid, unzipDirectory=folder,
                      modelIdentifier=description.coSimulation.modelIdentifier, instanceName="measured")
    try:
        slave.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        for step in range(50):
            slave.doStep(currentCommunicationPoint=0.002 * step, communicationStepSize=0.002)
        state = slave.getFMUstate()
        data = slave.serializeFMUstate(state)
        print(f"{arguments.fmu.name}: {len(data)} bytes")
        measure("save", lambda: slave.freeFMUstate(slave.getFMUstate()), arguments.repeats)
        measure("restore", lambda: slave.setFMUstate(state), arguments.repeats)
        measure("serialise", lambda: slave.serializeFMUstate(state), arguments.repeats)
        measure("deserialise", lambda: slave.freeFMUstate(slave.deSerializeFMUstate(data)), arguments.repeats)
        slave.terminate()
        slave.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
