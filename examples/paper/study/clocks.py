# SPDX-License-Identifier: Apache-2.0
"""What the cluster's clock does to the adaptive hard flight: outcome, time and energy."""

import argparse
import json
import os
import pathlib

from experiments import clocks
from missions import ROOT
from results import Trace
from run import fly_all


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "results/clocks")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    flights = clocks()
    summaries = fly_all(flights, arguments.build.resolve(), arguments.out.resolve(), arguments.jobs)
    rows = []
    for flight in flights:
        summary = summaries[flight.name]
        rows.append({"clock_mhz": dict(flight.extra)["soc.cluster.clock"] / 1e6,
                     "voltage_v": dict(flight.extra)["soc.core.supply_voltage"], "outcome": summary["outcome"],
                     "gate_s": Trace(summary["folder"]).time_at_gate(), "lateral_m": summary["lateral_error"],
                     "chip_mj": 1e3 * summary["energy"]["soc"], "all_j": summary["energy"]["open_circuit"]})
    # On the Pareto front: no other flight is at least as good in all of success, time and energy, and better in one.
    keys = [(row["outcome"] not in ("passed", "touched_passed"), row["gate_s"] or 1e9, row["chip_mj"]) for row in rows]
    for row, key in zip(rows, keys):
        row["front"] = not any(all(a <= b for a, b in zip(other, key)) and other != key for other in keys)
        print("| {clock_mhz:.0f} | {voltage_v:.3f} | {outcome} | {gate_s:.2f} | {lateral_m:+.3f} | {chip_mj:.2f} | "
              "{all_j:.1f} | {front} |".format(**row))
    (arguments.out / "clocks.json").write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
