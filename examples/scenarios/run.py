#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the easy gate mission without disturbance and with each of the scenarios. Draws all flights in one picture.

Usage: run.py [--build BUILD_FOLDER] [--out FOLDER]

BUILD_FOLDER (build/release) contains a build of MEbots. The picture is FOLDER/scenarios.png (results/scenarios).
"""

import argparse
import json
import math
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FLIGHTS = {None: ("undisturbed", "INK"), "gust": ("gust across the track", "BLUE"),
           "sensor_freeze": ("camera frozen, then range sensor 5 cm off", "GREEN"),
           "motor_loss": ("weak rotor, then one lost", "VERMILION")}
COLUMNS = ["world.drone.position.*", "motors.power"]


def fly(build, scenario, out):
    """Runs one flight. Returns its results. Records only the drawn variables."""
    config = json.loads((ROOT / "configs" / "gate_easy.json").read_text())
    config["record"] = COLUMNS
    config.pop("pictures")
    out.mkdir(parents=True, exist_ok=True)
    file = out / "config.json"
    file.write_text(json.dumps(config, indent=2) + "\n")
    command = [build / "bin" / "mebots", "run", file, "--out", out, "--quiet"]
    if scenario:
        command += ["--scenario", ROOT / "configs" / "scenarios" / f"{scenario}.json"]
    subprocess.run(command, check=True)
    import mebots

    return mebots.read(out)


def running_mean(values, count):
    """Returns the moving mean over `count` steps. It hides the stabiliser's changes from step to step."""
    total, result = 0.0, []
    for k, value in enumerate(values):
        total += value - (values[k - count] if k >= count else 0.0)
        result.append(total / min(k + 1, count))
    return result


def draw(flights, path):
    sys.path.insert(0, str(ROOT / "scripts"))
    import figure_style
    from figure_style import plt

    figure, axes = plt.subplots(2, 2, figsize=(12, 7.5), constrained_layout=True)
    (above, height), (side, power) = axes
    scene = json.loads((ROOT / "fmu_world" / "params" / "scenes" / "gate_easy.json").read_text())
    for gate in scene["gates"]:
        along = (-math.sin(gate.get("yaw", 0.0)), math.cos(gate.get("yaw", 0.0)))
        for sign in (-1, 1):
            ends = [[gate["position"][k] + sign * along[k] * gate[size] / 2 for size in ("inner", "outer")] for k in (0, 1)]
            above.plot(*ends, color=figure_style.FAINT, linewidth=5, solid_capstyle="butt")
    for scenario, results in flights.items():
        text, colour = FLIGHTS[scenario][0], getattr(figure_style, FLIGHTS[scenario][1])
        summary = results.summary
        style = {"color": colour, "linewidth": 1.8 if scenario is None else 1.2}
        time = results.times
        x, y, z = (results[f"world.drone.position.{axis}"] for axis in "xyz")
        passed = f", {100 * summary['lateral_error']:+.1f} cm in the gate" if summary["outcome"] == "passed" else f" at {time[-1]:.1f} s"
        above.plot(x, y, label=f"{text}: {summary['outcome']}{passed}", **style)
        above.plot(x[-1], y[-1], "x" if summary["outcome"] == "crashed" else "s", color=colour)
        height.plot(time, z, **style)
        side.plot(time, y, **style)
        step = time[1] - time[0]
        power.plot(time, running_mean(results["motors.power"], round(0.25 / step)), **style)
        for entry in summary.get("scenario") or []:
            if entry["applied"] and "noise" not in entry["action"] and entry["until"] - entry["from"] < 15:
                for panel in (height, side, power):
                    panel.axvspan(entry["from"], entry["until"], color=colour, alpha=0.06, linewidth=0)
    above.set(xlabel="x [m]", ylabel="y [m]", title="path from above; the gate's posts in grey", ylim=(-1.3, 0.6))
    above.legend(loc="lower right", fontsize=8)
    height.set(xlabel="time [s]", ylabel="height [m]", title="height; shaded while a scenario acts")
    side.set(xlabel="time [s]", ylabel="y [m]", title="across the track")
    power.set(xlabel="time [s]", ylabel="power [W]", title="electrical power of the motors, mean over 0.25 s")
    figure_style.save(figure, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "results" / "scenarios")
    arguments = parser.parse_args()
    sys.path.insert(0, str(arguments.build.resolve() / "python"))
    flights = {}
    for scenario, (text, _) in FLIGHTS.items():
        flights[scenario] = fly(arguments.build.resolve(), scenario, arguments.out / (scenario or "undisturbed"))
        print(f"{text}: {flights[scenario].outcome} after {flights[scenario].times[-1]:.2f} s")
    draw(flights, arguments.out / "scenarios.png")
    print(f"picture: {arguments.out / 'scenarios.png'}")


if __name__ == "__main__":
    main()
