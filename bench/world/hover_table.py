#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the table of docs/hover.md: seconds of hover over cell and payload, with intervals. Also draws docs/img/hover_cells.png.

    PYTHONPATH=BUILD/python .venv/bin/python bench/world/hover_table.py [--jobs N]

Each cell of the table is one run with the values of the data files, and 19 runs with parameters drawn from their intervals, as in
`mebots run configs/hover.json --uncertainty calibration`.
"""
import argparse
import collections
import csv
import pathlib
import sys
import tempfile

import mebots

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import figure_style as style  # noqa: E402
from figure_style import plt  # noqa: E402

CELLS = ("bitcraze_250_flights", "ufx_250_scaled", "cyclone_300_scaled", "lipol_350_scaled")
PAYLOADS_G = (0, 5, 10, 15)
BARE_KG = 0.0199  # mass of the drone in configs/hover.json
CELL, MASS = "battery.cell.name", "world.drone.dry_mass"


DRAWS = {"draws": {"replicates": 19}, "uncertainty": "calibration"}  # members of a study


def flown(folder, jobs, cells=CELLS, **sections):
    """Runs the study. Returns {(cell, payload): [(seconds, outcome)]}."""
    masses = {round(BARE_KG + payload / 1000, 4): payload for payload in PAYLOADS_G}
    study = {
        "mission": str(ROOT / "configs/hover.json"),
        "design": {"kind": "grid", "factors": {CELL: list(cells), MASS: list(masses)}},
        "objectives": {"charge": {"summary": "state_of_charge"}},
    } | sections
    mebots.sweep(study, folder, jobs=jobs)
    found = collections.defaultdict(list)
    with open(folder / "missions.csv", newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            if row["message"]:
                sys.exit(row["message"])
            found[row[CELL], masses[float(row[MASS])]].append((float(row["simulated_time [s]"]), row["outcome"]))
    return found


def shown(value, draws):
    """Returns the least and the greatest value of the draws. Also returns the number of draws in which the drone did not take
    off, or descended before the cell was empty."""
    seconds = [time for time, _ in draws]
    early = sum(outcome != "battery_empty" for _, outcome in draws)
    (time, outcome), = value
    note = f", {early} of {len(draws)} sank" if early else ""
    return f"{time:.0f} s{'' if outcome == 'battery_empty' else f' ({outcome})'} ({min(seconds):.0f} to {max(seconds):.0f}{note})"


def draw(values, draws):
    figure, axis = plt.subplots(figsize=(7, 3.8), layout="constrained")
    for cell, colour in zip(CELLS, style.PALETTE, strict=False):
        ranges = [[time for time, _ in draws[cell, payload]] for payload in PAYLOADS_G]
        axis.fill_between(PAYLOADS_G, [min(one) for one in ranges], [max(one) for one in ranges], color=colour, alpha=0.12, lw=0)
        axis.plot(PAYLOADS_G, [values[cell, payload][0][0] for payload in PAYLOADS_G], "o-", ms=4, color=colour, label=cell)
    axis.set(xlabel="payload [g]", ylabel="hover [s]", xticks=PAYLOADS_G, ylim=(0, None))
    axis.legend(fontsize=8)
    style.save(figure, ROOT / "docs/img/hover_cells.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int)
    jobs = parser.parse_args().jobs
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        values = flown(folder / "values", jobs)
        draws = flown(folder / "draws", jobs, **DRAWS)
    print("| payload | " + " | ".join(f"`{cell}`" for cell in CELLS) + " |")
    print("|---" * (len(CELLS) + 1) + "|")
    for payload in PAYLOADS_G:
        print(f"| {payload} g | " + " | ".join(shown(values[cell, payload], draws[cell, payload]) for cell in CELLS) + " |")
    draw(values, draws)


if __name__ == "__main__":
    main()
