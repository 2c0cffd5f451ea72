#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs an ensemble of Real-valued connections in OMSimulator and in mebots, and compares every Real output.

Usage: omsimulator_check.py MEBOTS CONFIG.json FMU_DIR

Looks for the program OMSimulator on PATH or in $OMSIMULATOR; without it the test is skipped (exit code 77): the
PyPI package fetches its binary from the project's own server at installation, which not every machine reaches.
"""

import csv
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
RELATIVE = 1e-11  # both hand the same doubles to the same FMUs; OMSimulator writes 12 significant digits


def lua_script(config, fmu_dir, folder, result):
    """The ensemble as an OMSimulator script with the same fixed communication step."""
    lines = [
        f'oms_setTempDirectory("{folder}")',
        'oms_newModel("mission")',
        'oms_addSystem("mission.root", oms_system_wc)',
    ]
    for name, instance in config["instances"].items():
        fmu = fmu_dir / pathlib.Path(instance["fmu"]).name
        lines.append(f'oms_addSubModel("mission.root.{name}", "{fmu}")')
        for variable, value in instance.get("parameters", {}).items():
            setter = "oms_setString" if isinstance(value, str) else "oms_setReal"
            literal = json.dumps(value)
            lines.append(f'{setter}("mission.root.{name}.{variable}", {literal})')
    for connection in config["connections"]:
        lines.append(f'oms_addConnection("mission.root.{connection["from"]}", "mission.root.{connection["to"]}")')
    intervals = round(config["stop_time"] / config["step"])
    lines += [
        f'oms_setResultFile("mission", "{result}")',
        f'oms_setStopTime("mission", {config["stop_time"]})',
        f'oms_setFixedStepSize("mission.root", {config["step"]})',
        f'oms_setLoggingInterval("mission", {config["step"]})',
        'oms_instantiate("mission")',
        'oms_initialize("mission")',
        'oms_simulate("mission")',
        'oms_terminate("mission")',
        'oms_delete("mission")',
    ]
    return "\n".join(lines) + "\n", intervals


def read_csv(path, clean):
    with path.open(newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith('"sep=')))
    names = [clean(name) for name in rows[0]]
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(names)}


def at_time(columns, time):
    """Index of the last row at that time: OMSimulator repeats rows at events."""
    best = min(range(len(columns["time"])), key=lambda i: (abs(columns["time"][i] - time), -i))
    return best


def main():
    mebots, config_path, fmu_dir = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    program = os.environ.get("OMSIMULATOR") or shutil.which("OMSimulator")
    if not program:
        print("skipped: OMSimulator is not installed (set OMSIMULATOR to its program to run this test)")
        sys.exit(SKIPPED)

    config = json.loads(config_path.read_text())
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for instance in config["instances"].values():
            instance["fmu"] = str(fmu_dir / pathlib.Path(instance["fmu"]).name)
        ours_config = folder / "ours.json"
        ours_config.write_text(json.dumps(config))
        subprocess.run([mebots, "run", ours_config, "--out", folder / "ours", "--quiet"], check=True)
        ours = read_csv(folder / "ours" / "results.csv", lambda name: name.rsplit(" [", 1)[0])

        script, intervals = lua_script(config, fmu_dir, folder, folder / "theirs.csv")
        (folder / "mission.lua").write_text(script)
        subprocess.run([program, "--mode=cs", folder / "mission.lua"], check=True, cwd=folder)
        theirs = read_csv(folder / "theirs.csv", lambda name: name.strip('"').removeprefix("mission.root.").removeprefix("root."))

        shared = [name for name in ours if name in theirs and name != "time"]
        worst, where = 0.0, ""
        for k in range(0, intervals + 1, max(1, intervals // 200)):
            time = k * config["step"]
            i, j = at_time(ours, time), at_time(theirs, time)
            for name in shared:
                a, b = ours[name][i], theirs[name][j]
                error = abs(a - b) / max(abs(a), abs(b), 1e-9)
                if error > worst or math.isnan(error):
                    worst, where = error, f"{name} at {time} s: ours {a!r}, OMSimulator's {b!r}"
    print(f"{len(shared)} variables compared; largest relative difference {worst:.3g} {where}")
    if not shared or not worst <= RELATIVE:
        sys.exit("FAILED: OMSimulator and mebots disagree")


if __name__ == "__main__":
    main()
