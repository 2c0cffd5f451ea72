# SPDX-License-Identifier: Apache-2.0
"""Measures the cost of separate processes. Compares the master's process, a separate process and a sandbox: opening an instance,
and its communication step. Usage: isolation.py MEBOTS PASSTHROUGH.fmu [--sizes 1,50,500] [--repeats 3]

Measures wall time and the processor time of mebots and all its processes. A step is the difference between a long run and a short
run, divided by steps and instances. An opening is the short run minus the short run of one instance in the master's process,
divided by instances. The minimum of the repeats counts.
"""

import argparse
import json
import pathlib
import resource
import subprocess
import tempfile
import time

KINDS = ("shared", "own", "sandboxed")
SHORT = 2
CALLS = 20_000  # approximate product of steps and instances in the long run


def run(program, config, folder):
    """Runs a config. Returns processor and wall seconds."""
    def used():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime
    before, began = used(), time.monotonic()
    subprocess.run([program, "run", config, "--quiet", "--out", folder / "out"], check=True, cwd=folder)
    return used() - before, time.monotonic() - began


def least(program, fmu, kind, count, steps, repeats, folder):
    names = [f"i{k}" for k in range(count)]
    config = {"step": 0.1, "stop_time": round(0.1 * steps, 1), "record": ["i0.y"],
              "instances": {name: {"fmu": str(fmu), "process": kind} for name in names},
              "connections": [{"from": f"{names[k - 1]}.y", "to": f"{name}.u"} for k, name in enumerate(names) if count > 1]}
    file = folder / f"{kind}-{count}-{steps}.json"
    file.write_text(json.dumps(config))
    runs = [run(program, file, folder) for _ in range(repeats)]
    return min(one[0] for one in runs), min(one[1] for one in runs)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("fmu", type=pathlib.Path)
    parser.add_argument("--sizes", default="1,50,500")
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    program, fmu = arguments.program.resolve(), arguments.fmu.resolve()
    print("| instances | process | opening: processor | wall | step: processor | wall |\n|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        empty = least(program, fmu, "shared", 1, SHORT, arguments.repeats, folder)
        for count in map(int, arguments.sizes.split(",")):
            steps = SHORT + max(CALLS // count, 20)
            for kind in KINDS:
                short = least(program, fmu, kind, count, SHORT, arguments.repeats, folder)
                long = least(program, fmu, kind, count, steps, arguments.repeats, folder)
                opening = [1e3 * max(short[k] - empty[k], 0) / count for k in (0, 1)]
                step = [1e6 * (long[k] - short[k]) / (steps - SHORT) / count for k in (0, 1)]
                print(f"| {count} | {kind} | {opening[0]:.2f} ms | {opening[1]:.2f} ms | {step[0]:.2f} us | {step[1]:.2f} us |",
                      flush=True)


if __name__ == "__main__":
    main()
