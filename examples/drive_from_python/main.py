#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the easy gate mission from Python, switches a lamp on during the flight, and prints its energy.

Usage: PYTHONPATH=build/release/python .venv/bin/python examples/drive_from_python/main.py CONFIG.json
"""

import sys

import mebots


def main():
    mission = mebots.Mission(sys.argv[1])
    mission.set("soc.core.clock", 150e6)  # [Hz], replaces the value in the config
    mission.record(["battery.cell.*", "world.drone.position.*"])
    mission.run_until(2.0)
    mission.write("battery.auxiliary.power", 0.5)  # power of a lamp [W]
    mission.run()

    voltage = mission["battery.cell.voltage"]  # a NumPy array with one value per entry of mission.times
    print(f"outcome: {mission.outcome} after {mission.time:.3f} s ({mission.end_text})")
    print(f"lowest cell voltage: {voltage.min():.3f} {mission.unit('battery.cell.voltage')}"
          f" at {mission.times[voltage.argmin()]:.3f} s")
    print(f"the lamp took {mission.value('battery.auxiliary.energy'):.3f} J")
    return 0 if mission.outcome == "passed" else 1


if __name__ == "__main__":
    sys.exit(main())
