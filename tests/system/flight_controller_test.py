# SPDX-License-Identifier: Apache-2.0
"""Runs configs/gate_easy_fc.json. Its control loop is firmware on a chip with sensors and PWM outputs.

Usage: flight_controller_test.py MEBOTS
"""
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
# The greatest permitted root mean square of estimate - truth in flight. Each limit is two to three times the standard deviation
# that the sensors' noise causes in the firmware's observers. The noise of the flow sensor is 0.41 m/s per sample at a height of
# 1 m. Together with the noise of the gyroscope, it causes 0.065 m/s and 0.016 rad. The noise of the range sensor is 2.5 mm. In
# a climb, the sensor's lag also causes an error.
LIMITS = {
    ("fc.estimate.roll", "world.drone.roll"): 0.035,
    ("fc.estimate.pitch", "world.drone.pitch"): 0.035,
    ("fc.estimate.altitude", "world.drone.position.z"): 0.05,
    ("fc.estimate.forward_velocity", "world.drone.forward_velocity"): 0.15,
}


def main():
    mebots = sys.argv[1]
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([mebots, "run", str(ROOT / "configs/gate_easy_fc.json"), "--out", out, "--quiet", "--expect", "passed"], check=True)
        with (pathlib.Path(out) / "results.csv").open(encoding="utf-8") as file:
            rows = [{key.split(" [")[0]: value for key, value in row.items()} for row in csv.DictReader(file)]
    flight = [row for row in rows if row["world.drone.phase"] in ("flying", "2")]
    assert len(flight) > 100, f"{len(flight)} rows in flight"
    for (estimate, truth), limit in LIMITS.items():
        square = sum((float(row[estimate]) - float(row[truth])) ** 2 for row in flight) / len(flight)
        assert math.sqrt(square) < limit, f"{estimate}: root mean square {math.sqrt(square):.4f}, at most {limit}"
        assert square > 0, f"{estimate} is the truth"
    end = rows[-1]
    load = float(end["fc.cycles"]) / (100e6 * float(end["time"]))
    assert 0.005 < load < 0.1, f"load {load:.3f}"


if __name__ == "__main__":
    main()
