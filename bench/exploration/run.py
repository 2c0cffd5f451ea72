#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures missions per second of one FMU: mebots sweep with one and two jobs, a shell loop of mebots run, and FMPy with
dask.bag.

Usage: run.py BUILD_DIR [MISSIONS]

Each program runs the battery's FMU with the same draws of its load. The programs alternate, and the fastest of three rounds
counts. Processor time is the sum over all processes.
"""

import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

LOAD_W = (1.0, 9.0)
STOP_S, STEP_S = 60, 0.01

FMPY = """
import sys, fmpy, dask, dask.bag
def fly(power):
    return fmpy.simulate_fmu(sys.argv[1], stop_time={stop}, output_interval={step}, start_values={{'motors.power': power, 'cell.name': 'bitcraze_250'}},
                             output=['cell.state_of_charge'], fmi_type='CoSimulation')[-1][1]
if __name__ == '__main__':
    loads = [float(word) for word in open(sys.argv[2])]
    dask.bag.from_sequence(loads, npartitions=2 * int(sys.argv[3])).map(fly).compute(scheduler='processes', num_workers=int(sys.argv[3]))
"""


def timed(command, environment):
    """Returns wall and processor time of a command and its descendants [s]."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{command}: {done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.monotonic() - begun, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    if len(sys.argv) < 2:
        sys.exit("usage: run.py BUILD_DIR [MISSIONS]")
    build = pathlib.Path(sys.argv[1]).resolve()
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 100
    mebots, fmu = str(build / "bin" / "mebots"), str(build / "fmus" / "fmu_battery.fmu")
    environment = dict(os.environ, MEBOTS_PYTHON=sys.executable)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)  # as in installed packages, Python may write bytecode
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "mission.json").write_text(json.dumps({
            "step": STEP_S, "stop_time": STOP_S, "instances": {"battery": {"fmu": fmu, "parameters": {"cell.name": "bitcraze_250"}}},
            "connections": [], "record": ["battery.cell.state_of_charge"], "summary": {"charge": "battery.cell.state_of_charge"}}))
        loads = [LOAD_W[0] + (LOAD_W[1] - LOAD_W[0]) * i / count for i in range(count)]
        (folder / "loads.txt").write_text("\n".join(map(repr, loads)))
        (folder / "study.json").write_text(json.dumps({
            "mission": "mission.json", "design": {"kind": "grid", "factors": {"battery.motors.power": loads}},
            "objectives": {"charge": {"summary": "charge"}}}))
        (folder / "fly.py").write_text(FMPY.format(stop=STOP_S, step=STEP_S))
        loop = f'i=0; while read -r load; do i=$((i+1)); {mebots} run {folder}/mission.json --set battery.motors.power=$load --quiet --out {folder}/run/$i; done < {folder}/loads.txt'
        ways = {
            "mebots sweep, 1 job": lambda turn: [mebots, "sweep", f"{folder}/study.json", "--out", f"{folder}/one{turn}", "--jobs", "1"],
            "mebots sweep, 2 jobs": lambda turn: [mebots, "sweep", f"{folder}/study.json", "--out", f"{folder}/two{turn}", "--jobs", "2"],
            "shell loop of mebots run": lambda turn: ["bash", "-c", loop],
            "FMPy, dask.bag, 1 process": lambda turn: [sys.executable, f"{folder}/fly.py", fmu, f"{folder}/loads.txt", "1"],
            "FMPy, dask.bag, 2 processes": lambda turn: [sys.executable, f"{folder}/fly.py", fmu, f"{folder}/loads.txt", "2"],
        }
        best = {way: (float("inf"), float("inf")) for way in ways}
        for turn in range(3):
            for way, command in ways.items():
                best[way] = tuple(map(min, best[way], timed(command(turn), environment)))
        print(f"{'':30}{'missions a second':>20}{'ms of processor time':>24}")
        for way, (wall_s, processor_s) in best.items():
            print(f"{way:30}{count / wall_s:20.1f}{1e3 * processor_s / count:24.1f}")


if __name__ == "__main__":
    main()
