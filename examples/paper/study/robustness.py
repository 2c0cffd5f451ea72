# SPDX-License-Identifier: Apache-2.0
"""How often the drone passes the gate from starts drawn at random, with the failures as a picture."""

import argparse
import json
import math
import os
import pathlib
import random

import figures
from experiments import ADAPTIVE_SPEED
from missions import ROOT, Flight, scenario
from results import Trace
from run import fly_all

# Largest offsets of a start, each uniform to both sides: forwards and sideways [m], turned [rad].
SPREAD = {"easy": (0.5, 0.05, 0.02), "hard": (0.3, 0.1, 0.02)}


def flights(name, count, seed):
    """Starts around the scenario's own; the camera's noise differs too."""
    draw = random.Random(f"{name} {seed}")
    own = scenario(name)
    forwards, sideways, turned = SPREAD[name]
    made = []
    for i in range(count):
        extra = (("world.start.offset.x", draw.uniform(-forwards, forwards)),
                 ("world.start.offset.y", own.get("world.start.offset.y", 0.0) + draw.uniform(-sideways, sideways)),
                 ("world.start.yaw_offset", draw.uniform(-turned, turned)), ("world.sensors.seed", i + 1))
        made.append(Flight(f"{name}-{seed}-{i:03}", name, ADAPTIVE_SPEED, adaptive=name == "hard", extra=extra,
                           stop_time=300.0, record=("world.drone.position.x", "world.drone.position.y")))
    return made


def wilson(passed, count, z=1.96):
    """Confidence interval of a share, 95 % (Wilson 1927)."""
    share = passed / count
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    return middle - half, middle + half


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "results/robustness")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--count", type=int, default=200, help="flights of each scenario")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenarios", nargs="+", choices=SPREAD, default=list(SPREAD))
    arguments = parser.parse_args()

    page = []
    answers = {}
    for name in arguments.scenarios:
        summaries = fly_all(flights(name, arguments.count, arguments.seed), arguments.build.resolve(),
                            arguments.out.resolve(), arguments.jobs)
        outcomes = [s["outcome"] for s in summaries.values()]
        passed = sum(o in ("passed", "touched_passed") for o in outcomes)
        low, high = wilson(passed, len(outcomes))
        answers[name] = {"flights": len(outcomes), "passed": passed, "low": low, "high": high,
                         "outcomes": {o: outcomes.count(o) for o in sorted(set(outcomes))}}
        text = (f"{name}: {passed} of {len(outcomes)} passed, {100 * passed / len(outcomes):.1f} % "
                f"(95 % confidence: {100 * low:.1f} to {100 * high:.1f} %), {answers[name]['outcomes']}")
        print(text)
        ways = []
        for summary in summaries.values():
            trace = Trace(summary["folder"])
            ways.append((trace["world.drone.position.x"], trace["world.drone.position.y"],
                         summary["outcome"] in ("passed", "touched_passed")))
        page += [f"<h2>{text}</h2>", figures.starts(ways, scenario(name)["world.scene.name"])]
    (arguments.out / "robustness.json").write_text(json.dumps(answers, indent=1) + "\n")
    (arguments.out / "robustness.html").write_text("<!doctype html><meta charset='utf-8'><title>Robustness</title>"
                                                   "<p>Failures are red.</p>" + "\n".join(page) + "\n")


if __name__ == "__main__":
    main()
