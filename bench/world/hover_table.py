#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the table of docs/hover.md: seconds of hover over cell and payload, each with two values of the cell's resistance.

Usage: hover_table.py MEBOTS

The first value uses the resistances of the cell file. The second one multiplies them by 5/3 and divides the capacitances by it, so that
the time constants stay. For bitcraze_250 these are 0.105 and 0.175 ohm.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
CELLS = ROOT / "fmu_battery/params/cells"
NAMES = ("bitcraze_250", "ufx_250", "cyclone_300", "lipol_350")
PAYLOADS = (0, 5, 10, 15)  # g
BARE = 0.0199  # kg, of configs/hover.json
WORST = 5 / 3


def worse_cell(name, folder):
    cell = json.loads((CELLS / f"{name}.json").read_text())
    cell["$schema"] = "mebots-cell.schema.json"
    cell["resistance_factor"]["value"] *= WORST
    cell["capacitance_factor"]["value"] /= WORST
    path = folder / f"{name}.json"
    path.write_text(json.dumps(cell))
    return path


def endurance(mebots, cell, payload, out):
    run = subprocess.run(
        [mebots, "run", ROOT / "configs/hover.json", "--out", out, "--set", f"battery.cell.name={cell}",
         f"world.drone.dry_mass={BARE + payload / 1000:.4f}"], capture_output=True, text=True)
    if run.returncode:
        sys.exit(run.stderr)
    summary = json.loads((out / "summary.json").read_text())
    return f"{summary['simulated_time']:.0f}" + ("" if summary["outcome"] == "battery_empty" else "*")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        print("| payload | " + " | ".join(f"`{name}`" for name in NAMES) + " |")
        print("|---" * (len(NAMES) + 1) + "|")
        for payload in PAYLOADS:
            cells = [f"{endurance(sys.argv[1], worse_cell(name, folder), payload, folder / 'out')} to "
                     f"{endurance(sys.argv[1], name, payload, folder / 'out')} s" for name in NAMES]
            print(f"| {payload} g | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
