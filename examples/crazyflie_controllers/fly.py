#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds the Crazyflie's controllers from a checkout, compares chip and host, flies the controllers, and prints a table.

    ./fly.py BUILD CHECKOUT [--out FOLDER]
"""
import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
NAMES = ("pid", "mellinger", "brescianini", "lee")
CALLS = 4000


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


class MEbots:
    """The paths of programs and files in a build folder or in an installation."""

    def __init__(self, folder):
        folder = folder.resolve()
        installed = folder / "share/mebots"
        root = installed if installed.exists() else HERE.parents[1]
        self.package = folder / "lib/cmake/mebots"
        self.programs = folder / "bin"
        self.configs = root / "configs"
        self.environment = dict(os.environ)
        if root != installed:
            self.environment["MEBOTS_FMU_PATH"] = str(folder / "fmus")
        if not self.package.exists():
            sys.exit(f"{folder} is neither a build folder nor an installation of MEbots: there is no lib/cmake/mebots")


def checksum(text):
    return re.search(r"checksum ([0-9a-f]{16})", text)[1]


def compare(mebots, build, name, math):
    """Runs a controller on host and chip. Returns both checksums and the chip's cycles."""
    report = build / "report.json"
    host = checksum(run(build / f"checksum_{name}_{math}"))
    chip = checksum(run(mebots.programs / "mebots-soc", "run", build / f"firmware/checksum_{name}_{math}.elf", "--board",
                        mebots.configs / "boards/flight_controller.json", "--json", report))
    return host, chip, json.loads(report.read_text())["controller"]["cycles"]


def fly(mebots, build, name, out):
    run(mebots.programs / "mebots", "run", mebots.configs / "gate_easy_fc.json", "--quiet", "--out", out, "--stop-time", 60, "--set",
        f"fc.firmware={build / f'firmware/crazyflie_{name}.elf'}", env=mebots.environment)
    return json.loads((out / "summary.json").read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mebots", type=Path, metavar="BUILD", help="build folder or installation of MEbots")
    parser.add_argument("checkout", type=Path, metavar="CHECKOUT", help="of crazyflie-firmware")
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="keep the build and the results of the missions there")
    given = parser.parse_args()
    mebots = MEbots(given.mebots)
    with tempfile.TemporaryDirectory() as scratch:
        out = (given.out or Path(scratch)).resolve()
        build = out / "build"
        run("cmake", "-S", HERE, "-B", build, f"-Dmebots_DIR={mebots.package}", f"-DCRAZYFLIE={given.checkout.resolve()}")
        run("cmake", "--build", build, "--parallel", 2)
        print("| controller | checksum, own library: chip, host | same functions: chip, host | cycles per call | mission | load at 100 MHz |")
        print("|---|---|---|---|---|---|")
        differs = False
        failed = []
        for name in NAMES:
            host, chip, cycles = compare(mebots, build, name, "own")
            same_host, same_chip, _ = compare(mebots, build, name, "same")
            differs = differs or same_host != same_chip
            summary = fly(mebots, build, name, out / name)
            if summary["outcome"] != "passed":
                failed.append(name)
            end = summary["simulated_time"]
            load = summary["flight_controller"]["cycles"] / (100e6 * end)
            print(f"| {name} | {chip}, {'the same' if host == chip else host} | {same_chip}, {'the same' if same_host == same_chip else same_host} | "
                  f"{cycles / CALLS:.0f} | {summary['outcome']}, {end:.1f} s | {100 * load:.1f} % |", flush=True)
    faults = ["chip and host differ although they use the same functions"] if differs else []
    if failed:
        faults.append(f"missions that did not pass: {', '.join(failed)}")
    if faults:
        sys.exit("\n".join(faults))


if __name__ == "__main__":
    main()
