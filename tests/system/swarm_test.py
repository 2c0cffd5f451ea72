#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the start of configs/hover_16.json. Checks that the statistics in the summary are those of the 16 drones' values, and
that they name the drone whose battery is less charged.

Usage: swarm_test.py MEBOTS
"""

import json
import pathlib
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def fly(mebots, out, *options):
    config = SOURCE / "configs/hover_16.json"
    done = subprocess.run([mebots, "run", config, "--stop-time", "0.2", "--out", out, *options], text=True, capture_output=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr, json.loads((pathlib.Path(out) / "summary.json").read_text())


def main():
    with tempfile.TemporaryDirectory() as folder:
        text, summary = fly(sys.argv[1], f"{folder}/a", "--set", "battery[7].cell.initial_state_of_charge=0.5")
        charge = summary["state_of_charge"]
        values = list(charge["each"].values())
        assert len(values) == 16
        assert charge["least"] == min(values) == charge["each"]["7"] and charge["least_of"] == "7"
        assert charge["most"] == max(values)
        assert abs(charge["mean"] - sum(values) / 16) < 1e-12
        assert summary["crashed"]["count"] == 0 and summary["crashed"]["of"] == 16
        assert summary["phase"]["counts"] == {"climbing": 16}
        assert summary["units"]["altitude"]["least"] == "m"
        lines = text.splitlines()
        shown = [line for line in lines if "state_of_charge" in line]
        assert len(shown) == 1 and "(7) to" in shown[0], shown
        assert len([line for line in lines if line.startswith("  ")]) < 10, text
        detailed, _ = fly(sys.argv[1], f"{folder}/b", "--verbose")
        assert "state_of_charge.each.16" in detailed
        of_one, of_many = (len((SOURCE / f"configs/{name}.json").read_text().splitlines()) for name in ("hover", "hover_16"))
        assert of_many <= of_one + 10
    print("ok")


if __name__ == "__main__":
    main()
