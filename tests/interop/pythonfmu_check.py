#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that mebots runs FMUs of pythonfmu without special options, each in its own process. The FMUs use the Python
interpreter of MEBOTS_PYTHON or of PATH.

Usage: pythonfmu_check.py MEBOTS

compare.py compares more outputs of such FMUs.
"""

import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import pythonfmu

GAIN = 3.5
INPUT = 0.25
STEP = 0.125
STOP = 1


def run(mebots, folder, fmu, keys, environment):
    instance = {"fmu": str(fmu), "parameters": {"u": INPUT, "gain": GAIN}, **keys}
    config = {"step": STEP, "stop_time": STOP, "instances": {"a": instance, "b": instance}, "connections": [], "record": ["*.y"]}
    (folder / "config.json").write_text(json.dumps(config))
    return subprocess.run([mebots, "run", folder / "config.json", "--out", folder / "out"], capture_output=True, text=True,
                          env=environment)


def check(name, result, folder):
    if result.returncode != 0:
        sys.exit(f"FAILED: {name}: exit code {result.returncode}: {result.stderr}")
    if "Python interpreter" not in (folder / "out" / "log.txt").read_text() and not name.startswith("own"):
        sys.exit(f"FAILED: {name}: no notice says why the FMU has its own process")
    with open(folder / "out" / "results.csv", newline="") as stream:
        last = list(csv.DictReader(stream))[-1]
    print(f"ok: {name}: {last}")
    return last


def main():
    mebots = sys.argv[1]
    script = pathlib.Path(__file__).parent / "python_slave.py"
    packages = next(path for path in sys.path if path.endswith("site-packages"))
    plain = {name: value for name, value in os.environ.items() if name not in ("LD_PRELOAD", "PYTHONPATH")}
    with tempfile.TemporaryDirectory(prefix="foreign fmus ") as folder:
        folder = pathlib.Path(folder)
        fmu = pythonfmu.FmuBuilder.build_FMU(str(script), dest=str(folder))
        # Uses the virtual environment of this program, which contains pythonfmu. MEBOTS_PYTHON names its interpreter, so
        # PYTHONPATH need not be set.
        of_environment = dict(plain, MEBOTS_PYTHON=sys.executable)
        rows = [check("automatic", run(mebots, folder, fmu, {}, of_environment), folder),
                check("own", run(mebots, folder, fmu, {"process": "own"}, of_environment), folder),
                check("own, sandboxed", run(mebots, folder, fmu, {"process": "sandboxed"}, dict(of_environment, PYTHONPATH=packages)), folder),
                check("automatic, PYTHONPATH", run(mebots, folder, fmu, {}, dict(of_environment, PYTHONPATH=packages)), folder)]
        right = GAIN * INPUT + STOP - STEP  # the slave adds the time at which its last step started
        if any(float(row[name]) != right for row in rows for name in row if not name.startswith("time")):
            sys.exit(f"FAILED: every y is {right} at the end, not {rows}")


if __name__ == "__main__":
    main()
