#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that each FMU of tests/fmus/tenant uses the gain from its own archive: in missions of one Python process, and in missions
of a sweep.

Usage: separation_test.py MEBOTS FMU_FOLDER (with PYTHONPATH set to the package).
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import mebots

MEBOTS, FMUS = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
INPUT = 0.5


def config(folder, name, *fmus):
    path = folder / f"{name}.json"
    instances = {f"i{k}": {"fmu": str(FMUS / f"tenant_{fmu}.fmu"), "parameters": {"u": INPUT}} for k, fmu in enumerate(fmus)}
    path.write_text(json.dumps({"step": 0.1, "stop_time": 0.5, "instances": instances, "connections": [],
                                "summary": {f"y{k}": f"i{k}.y" for k in range(len(fmus))}}))
    return path


def check(what, found, right):
    if found != right:
        sys.exit(f"FAILED: {what}: {found} instead of {right}")
    print(f"ok: {what}: {found}")


def two_missions(folder):
    """Runs the missions of two FMUs at the same time, and then one after the other. The second case also matters, because
    the loader never unloads a library with unique symbols, so the next mission could use it."""
    for kind in ("library", "unique", "opens"):
        two, three = (mebots.Mission(config(folder, f"{kind}{gain}", f"{kind}_{gain}")) for gain in (2, 3))
        for _ in range(5):
            two.step()
            three.step()
        check(f"{kind}, at a time", (two.value("i0.y"), three.value("i0.y")), (2 * INPUT, 3 * INPUT))
        for gain in (3, 2, 3):
            mission = mebots.Mission(config(folder, f"{kind}{gain}", f"{kind}_{gain}"))
            mission.run()
            check(f"{kind}, in turn", mission.value("i0.y"), gain * INPUT)


def sweep(folder):
    for kind in ("library", "opens"):
        config(folder, "mission", f"{kind}_2", f"{kind}_3")
        study = folder / "study.json"
        study.write_text(json.dumps({
            "mission": "mission.json", "design": {"kind": "grid", "factors": {"i0.u": [0.5, 1], "i1.u": [0.5, 1]}},
            "objectives": {"y0": {"summary": "y0"}, "y1": {"summary": "y1"}}}))
        for jobs in ("1", "2"):
            out = folder / f"{kind}-{jobs}"
            done = subprocess.run([MEBOTS, "sweep", study, "--out", out, "--jobs", jobs], capture_output=True, text=True)
            if done.returncode != 0:
                sys.exit(f"FAILED: {kind}: {done.stdout}{done.stderr}")
            with open(out / "missions.csv", newline="") as stream:
                rows = list(csv.DictReader(stream))
            check(f"{kind}, sweep with {jobs} jobs", sorted((float(row["y0"]), float(row["y1"])) for row in rows),
                  sorted((2 * a, 3 * b) for a in (0.5, 1) for b in (0.5, 1)))


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        two_missions(folder)
        sweep(folder)


if __name__ == "__main__":
    main()
