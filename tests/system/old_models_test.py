# SPDX-License-Identifier: Apache-2.0
"""Runs a mission with the older default models, which were not fitted to flights. The results must have the same bits as before.

Usage: old_models_test.py MEBOTS CONFIG SHA256

SHA256 is the beginning of the hash of results.csv.
"""
import hashlib
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SETS = ("motors.rotor_data=crazyflie_bench", "motors.bus.resistance=0", "battery.cell.name=bitcraze_250",
        "world.drone.name=crazyflie_bench")


def main():
    mebots, config, expected = sys.argv[1:]
    energies = () if config.endswith("_gap8.json") else ("soc.energy.name=gap8",)  # missions on gap8 already had the energies of silicon
    with tempfile.TemporaryDirectory() as out:
        command = [mebots, "run", ROOT / "configs" / config, "--out", out, "--quiet", "--expect", "passed", "--set", *SETS, *energies]
        subprocess.run([str(word) for word in command], check=True)
        found = hashlib.sha256((pathlib.Path(out) / "results.csv").read_bytes()).hexdigest()
    assert found.startswith(expected), f"{config}: {found}, expected {expected}..."


if __name__ == "__main__":
    main()
