# SPDX-License-Identifier: Apache-2.0
"""Flies the paper's two experiments and writes the report."""

import argparse
import json
import os
import pathlib
import time

import experiments
import report
from missions import ROOT
from run import fly_all


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release", help="folder of the build")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "results/paper", help="folder to write to")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="flights at a time")
    arguments = parser.parse_args()

    flights = experiments.experiment_b() + experiments.endurance() + experiments.experiment_a()
    started = time.monotonic()
    summaries = fly_all(flights, arguments.build.resolve(), arguments.out.resolve(), arguments.jobs)
    seconds = time.monotonic() - started
    (arguments.out / "summaries.json").write_text(json.dumps({"seconds": seconds, "flights": summaries}, indent=1) + "\n")
    figures = report.write(summaries, arguments.out / "report.html", seconds)
    (arguments.out / "figures.json").write_text(json.dumps(figures, indent=1) + "\n")
    for target, what, paper, ours, difference, _ in figures["targets"]:
        print(f"{target:18} {what:52} paper {paper:16} ours {ours:16} {difference}")
    print(f"wrote {arguments.out / 'report.html'}")


if __name__ == "__main__":
    main()
