#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the exchange of SSPs with OMSimulator. OMSimulator must compute the same numbers from an SSP of MEbots, and mebots must
run an SSP that OMSimulator wrote.

Usage: ssp_check.py MEBOTS CONFIG.json

Searches for OMSimulator in $OMSIMULATOR and on PATH. If OMSimulator is not found, the test is skipped (exit code 77).
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import tools

SKIPPED = 77
RELATIVE = 1e-11  # both pass the same doubles to the same FMUs; OMSimulator writes 12 significant digits


def run(program, folder, script):
    file = folder / "script.lua"
    file.write_text(script)
    result = subprocess.run([program, file], cwd=folder, capture_output=True, text=True)
    if result.returncode != 0 or "error:" in result.stdout:
        sys.exit(f"FAILED: OMSimulator: {result.stdout}{result.stderr}")


def worst_difference(a, b, names, step, intervals):
    worst, where = 0.0, ""
    for k, (i, j) in enumerate(zip(*(tools.at_points(columns["time"], step, intervals) for columns in (a, b)))):
        for name in names:
            x, y = a[name][i], b[name][j]
            error = abs(x - y) / max(abs(x), abs(y), 1e-9)
            if not error <= worst:
                worst, where = error, f"{name} at {k * step} s: {x!r} and {y!r}"
    return worst, where


def main():
    mebots, config_path = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    program = tools.OMSimulator().program
    if not program:
        print("skipped: OMSimulator is not installed (set OMSIMULATOR to its program to run this test)")
        sys.exit(SKIPPED)
    config = json.loads(config_path.read_text())
    config["stop_time"] = 1
    step, intervals = config["step"], round(1 / config["step"])

    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "ours.json").write_text(json.dumps(config))
        subprocess.run([mebots, "run", "ours.json", "--out", "ours", "--quiet"], check=True, cwd=folder)
        ours = tools.read_csv(folder / "ours" / "results.csv", lambda name: name.rsplit(" [", 1)[0])

        subprocess.run([mebots, "convert", "ours.json", "ours.ssp"], check=True, cwd=folder)
        run(program, folder, f"""
oms_setTempDirectory("{folder}/temporary")
model = oms_importFile("{folder}/ours.ssp")
oms_setResultFile("ours", "{folder}/theirs.csv")
oms_setLoggingInterval("ours", {step})
oms_instantiate("ours")
oms_initialize("ours")
oms_simulate("ours")
oms_terminate("ours")
oms_export("ours", "{folder}/back.ssp")
oms_delete("ours")
""")
        theirs = tools.read_csv(folder / "theirs.csv",
                              lambda name: name.strip('"').removeprefix("ours.root.").removeprefix("root."))
        shared = [name for name in ours if name in theirs and name != "time"]
        worst, where = worst_difference(ours, theirs, shared, step, intervals)
        print(f"our SSP in OMSimulator: {len(shared)} variables, largest relative difference {worst:.3g} {where}")
        if not shared or not worst <= RELATIVE:
            sys.exit("FAILED: OMSimulator makes other numbers of our SSP")

        subprocess.run([mebots, "run", "back.ssp", "--out", "back", "--quiet"], check=True, cwd=folder)
        same = (folder / "back" / "results.csv").read_bytes() == (folder / "ours" / "results.csv").read_bytes()
        back = tools.read_csv(folder / "back" / "results.csv", lambda name: name.rsplit(" [", 1)[0])
        worst, where = worst_difference(ours, back, [name for name in ours if name != "time"], step, intervals)
        print(f"OMSimulator's SSP here: largest relative difference {worst:.3g} {where}; same bytes: {same}")
        if not worst <= RELATIVE:
            sys.exit("FAILED: an SSP that went through OMSimulator runs otherwise here")


if __name__ == "__main__":
    main()
