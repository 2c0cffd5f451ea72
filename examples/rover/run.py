#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a rover whose chip is defined by board.json and a firmware: alone, then as an FMU with wheels and a floor in Python.

Usage: .venv/bin/python examples/rover/run.py [--build BUILD_FOLDER]

BUILD_FOLDER (build/release) contains a build of MEbots.
"""

import argparse
import math
import pathlib
import shutil
import subprocess
import sys

import fmpy
from fmpy.fmi2 import FMU2Slave

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
STEP_S = 0.01
STUCK, BUMPED = 3, 2  # the firmware's exit codes


class Rover:
    """The robot's wheels, which follow the requested speed with a lag. The right wheel is 3 % thinner than the firmware
    assumes."""

    LAG_S, TRACK_M, THINNER = 0.1, 0.2, 0.97

    def __init__(self):
        self.speed, self.way = [0.0, 0.0], [0.0, 0.0]
        self.x = self.y = self.heading = 0.0

    def step(self, wanted, h):
        for i in range(2):
            self.speed[i] += (wanted[i] - self.speed[i]) * h / self.LAG_S
            self.way[i] += self.speed[i] * h
        left, right = self.speed[0], self.speed[1] * self.THINNER
        self.heading += (right - left) / self.TRACK_M * h
        self.x += (left + right) / 2 * math.cos(self.heading) * h
        self.y += (left + right) / 2 * math.sin(self.heading) * h


def require(good, complaint):
    if not good:
        sys.exit(f"FAILED: {complaint}")


def run_alone(build):
    """Runs the firmware without a simulation of the wheels, so the wheels do not turn. The firmware must detect this. Every
    variable of board.json has its value `start`."""
    done = subprocess.run([build / "bin/mebots-soc", "run", build / "firmware/rover.elf", "--board", HERE / "board.json"],
                          text=True, capture_output=True, check=False)
    print(done.stdout, end="")
    require("to go 1000 mm at 500 mm/s, 7400 mV" in done.stdout, "the starts of board.json do not reach the firmware")
    require(done.returncode == STUCK, f"exit code {done.returncode}, not {STUCK}")


def drive(archive, errand, wall_m=math.inf):
    """Runs the FMU and the rover until the firmware ends. Returns the rover and the exit code."""
    description = fmpy.read_model_description(archive)
    reference = {variable.name: variable.valueReference for variable in description.modelVariables}
    folder = fmpy.extract(archive)
    chip = FMU2Slave(guid=description.guid, unzipDirectory=folder,
                     modelIdentifier=description.coSimulation.modelIdentifier, instanceName="chip")
    rover = Rover()
    try:
        chip.instantiate()
        chip.setupExperiment(startTime=0)
        chip.enterInitializationMode()
        chip.setReal([reference[name] for name in errand], list(errand.values()))
        chip.exitInitializationMode()
        step = 0
        while chip.getBoolean([reference["core.running"]])[0]:
            require(step * STEP_S < 20, "the firmware does not end")
            wanted = chip.getReal([reference["wheels.left.speed"], reference["wheels.right.speed"]])
            chip.doStep(step * STEP_S, STEP_S)
            step += 1
            rover.step(wanted, STEP_S)
            values = {"wheels.left.way": rover.way[0], "wheels.right.way": rover.way[1], "body.heading": rover.heading}
            chip.setReal([reference[name] for name in values], list(values.values()))
            chip.setBoolean([reference["body.bumper"]], [rover.x > wall_m])
        return rover, chip.getInteger([reference["core.exit_code"]])[0]
    finally:
        chip.terminate()
        chip.freeInstance()
        shutil.rmtree(folder, ignore_errors=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    build = parser.parse_args().build
    if not (build / "fmus/rover.fmu").exists():
        subprocess.run(["cmake", "--build", build, "--target", "rover_archive", "mebots-soc"], check=True)
    run_alone(build)

    rover, code = drive(build / "fmus/rover.fmu", {"errand.distance": 2.0, "errand.speed": 0.4})
    print(f"errand of 2 m at 0.4 m/s: exit code {code}, x {rover.x:.3f} m, y {rover.y:.3f} m, heading {rover.heading:.4f} rad")
    require(code == 0, "it did not arrive")
    # The rover stops one period of 20 ms and the lag of the wheels late: 0.4 m/s x 0.13 s. The thinner right wheel shortens the
    # way by 1.5 %.
    require(1.95 < rover.x < 2.06, "it did not stop where it should")
    # Without steering, the way of the right wheel would be shorter by 3 % of 2 m. With a track of 0.2 m, this would turn the
    # rover by 0.3 rad.
    require(abs(rover.heading) < 0.1, "the gyro does not keep its heading")

    rover, code = drive(build / "fmus/rover.fmu", {"errand.distance": 2.0}, wall_m=0.8)
    print(f"a wall at 0.8 m: exit code {code}, x {rover.x:.3f} m")
    require(code == BUMPED and 0.8 < rover.x < 0.9, "it did not notice the wall")


if __name__ == "__main__":
    main()
