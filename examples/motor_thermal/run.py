#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the easy gate mission together with a thermal model of one motor, and plots the temperatures.

Usage: run.py [--build BUILD_FOLDER] [--out FOLDER] [--stop-time S]

BUILD_FOLDER (build/release) contains a build of MEbots. If the FMU is missing, it is built there.
"""

import argparse
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent

CONNECTIONS = {
    "motors.power": "thermal.motor.power",
    "world.rotor[1].command": "thermal.motor.command",
    "battery.bus.voltage": "thermal.bus.voltage",
}


def mission(build, stop_time):
    """Returns the config of the easy gate mission with an additional instance."""
    config = json.loads((ROOT / "configs" / "gate_easy.json").read_text())
    config["instances"]["thermal"] = {"fmu": "motor_thermal"}
    config["connections"] += [{"from": a, "to": b} for a, b in CONNECTIONS.items()]
    config["record"] = ["thermal.*", "motors.power", "world.drone.position.z", "world.rotor[1].command"]
    config["summary"]["winding_temperature"] = "thermal.winding.temperature"
    config["summary"]["case_temperature"] = "thermal.case.temperature"
    config.pop("pictures", None)
    if stop_time:
        config["stop_time"] = stop_time
    return config


def plot(results, path):
    sys.path.insert(0, str(ROOT / "scripts"))
    import figure_style as style
    from figure_style import plt

    figure, (top, bottom) = plt.subplots(2, 1, sharex=True, figsize=(8, 5), height_ratios=(2, 1))
    for name in ("winding", "case"):
        top.plot(results.times, results[f"thermal.{name}.temperature"] - 273.15)
        style.label_line(top, name, top.lines[-1].get_color())
    top.set_ylabel("temperature [degC]")
    bottom.plot(results.times, results["thermal.motor.current"], color=style.GREEN)
    bottom.set_ylabel("motor current [A]")
    bottom.set_xlabel("time [s]")
    figure.tight_layout()
    style.save(figure, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "results" / "motor_thermal")
    parser.add_argument("--stop-time", type=float)
    parser.add_argument("--no-plot", action="store_true")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    if not (build / "fmus" / "motor_thermal.fmu").exists():
        subprocess.run(["cmake", "--build", build, "--target", "motor_thermal_archive"], check=True)
    arguments.out.mkdir(parents=True, exist_ok=True)
    config = arguments.out / "motor_thermal.json"
    config.write_text(json.dumps(mission(build, arguments.stop_time), indent=2) + "\n")
    subprocess.run([build / "bin" / "mebots", "run", config, "--out", arguments.out], check=True)
    sys.path.insert(0, str(build / "python"))
    import mebots

    results = mebots.read(arguments.out)
    winding, case = results["thermal.winding.temperature"], results["thermal.case.temperature"]
    if not (winding[-1] > case[-1] > winding[0] and winding.max() < 400):
        sys.exit("FAILED: a flight must warm the winding more than the case, and burn neither")
    print(f"winding: at most {winding.max() - 273.15:.1f} degC, case: {case.max() - 273.15:.1f} degC")
    if not arguments.no_plot:
        plot(results, arguments.out / "temperatures.png")
        print(f"plot: {arguments.out / 'temperatures.png'}")


if __name__ == "__main__":
    main()
