#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the processor time of model exchange over the number of states. The system is a ring of masses on springs. Each mass
is one FMU, whose forces depend on both neighbours.

Usage: solver_size.py MEBOTS SPRINGS.fmu [STATES...]

Prints a row for each size: states, steps and evaluations of the solver, and processor time per simulated second. Subtracts the
time up to t = 0 (a dry run), which excludes the time for opening the FMUs.
"""

import json
import pathlib
import resource
import subprocess
import sys
import tempfile

STEP_S = 0.1
STOP_S = 10


def system(fmu, states):
    names = [f"m{i}" for i in range(states // 2)]
    force = {"sum": True, "factor": 0.4, "convert_units": False}
    return {
        "step": STEP_S, "stop_time": STOP_S, "solver": {"relative_tolerance": 1e-6},
        "instances": {name: {"fmu": fmu, "parameters": {"x[1]": 1 if i == 0 else 0}} for i, name in enumerate(names)},
        "connections": [{"from": f"{names[(i + side) % len(names)]}.x[1]", "to": f"{name}.force[1]", **force}
                        for i, name in enumerate(names) for side in (-1, 1)],
        "record": {"variables": ["m0.x[1]"]},
    }


def processor_time_s(mebots, folder, *words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([mebots, "run", "system.json", "--out", "out", "--quiet", *words], cwd=folder, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    mebots, fmu = (str(pathlib.Path(word).resolve()) for word in sys.argv[1:3])
    sizes = [int(word) for word in sys.argv[3:]] or [10, 100, 300, 1000]
    print("| states | steps | evaluations | Jacobians | processor time for a simulated second |")
    print("|---|---|---|---|---|")
    for states in sizes:
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "system.json").write_text(json.dumps(system(fmu, states)))
            start_s = processor_time_s(mebots, folder, "--dry-run")
            used_s = processor_time_s(mebots, folder)
            (solver,) = json.loads((folder / "out" / "summary.json").read_text())["solvers"]
        print(f"| {states} | {solver['steps']} | {solver['evaluations']} | {solver['jacobians']} | "
              f"{(used_s - start_s) / STOP_S:.2g} s |", flush=True)


if __name__ == "__main__":
    main()
