# SPDX-License-Identifier: Apache-2.0
"""Runs configs/hover.json. Compares its power with the weight that the rotors carry.

Usage: hover_test.py MEBOTS
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
GRAVITY = 9.80665
AVIONICS = 0.96  # power [W] of the parameter avionics.base_power of fmu_motors
BENCH = ("motors.rotor_data=crazyflie_bench", "motors.bus.resistance=0", "battery.cell.name=bitcraze_250",
         "world.drone.name=crazyflie_bench")


def hover(mebots, out, *sets):
    command = [mebots, "run", ROOT / "configs/hover.json", "--out", out, "--uncertainty", "none"]
    if sets:
        command += ["--set", *sets]
    subprocess.run([str(part) for part in command], check=True, capture_output=True)
    return json.loads((out / "summary.json").read_text())


def bench_power(mass):
    """Returns the electrical power [W] of four rotors that carry this mass [kg], by the fit in the rotor file."""
    rotor = json.loads((ROOT / "fmu_motors/params/rotors/crazyflie_bench.json").read_text())
    thrust = mass * GRAVITY / 4
    speed = math.sqrt(thrust / rotor["thrust_coefficient"]["value"])
    return 4 * (rotor["power_per_speed"]["value"] * speed + rotor["power_per_thrust"]["value"] * thrust)


def motor_power(mass, voltage):
    """Returns the electrical power [W] of four rotors that carry this mass [kg] at a bus voltage [V]. Uses the equations for
    rotor files with a section `motor`."""
    rotor = json.loads((ROOT / "fmu_motors/params/rotors/crazyflie_legacy.json").read_text())
    emf, ohm, ripple = (rotor["motor"][key]["value"] for key in ("back_emf", "resistance", "ripple_conductance"))
    square = mass * GRAVITY / 4 / rotor["thrust_coefficient"]["value"]
    current = rotor["torque_per_thrust"]["value"] * mass * GRAVITY / 4 / emf
    effective = emf * math.sqrt(square) + ohm * current
    return 4 * (effective * current + ripple * effective**2 * (1 - effective / voltage)**2)


def near(value, expected, relative, what):
    assert abs(value - expected) <= relative * expected, f"{what}: {value}, expected {expected} within {relative:.1%}"


def main():
    mebots = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        out = pathlib.Path(scratch) / "out"

        bare = hover(mebots, out, *BENCH)
        assert bare["outcome"] == "battery_empty", bare["outcome"]
        near(bare["mass"], 0.027, 1e-9, "mass without payload")
        seconds = bare["simulated_time"]
        near(bare["energy"]["motors"] / seconds, bench_power(0.027), 0.005, "motor power without payload")
        near(bare["energy"]["avionics"] / seconds, AVIONICS, 0.001, "power of the avionics")

        loaded = hover(mebots, out, *BENCH, "world.drone.dry_mass=0.0299")
        assert loaded["outcome"] == "battery_empty", loaded["outcome"]
        near(loaded["energy"]["motors"] / loaded["simulated_time"], bench_power(0.037), 0.005, "motor power with 10 g")
        # The loss in the cell rises with the square of the current, so the endurance falls by a larger factor than the power
        # rises.
        powers = [AVIONICS + bench_power(mass) for mass in (0.027, 0.037)]
        assert loaded["simulated_time"] / seconds < powers[0] / powers[1], (loaded["simulated_time"], seconds)

        # During the discharge, the bus voltage falls from 3.9 to 3.0 V. The loss by the current ripple falls with the voltage.
        flown = hover(mebots, out, "world.drone.dry_mass=0.0299")
        assert flown["outcome"] == "battery_empty", flown["outcome"]
        power = flown["energy"]["motors"] / flown["simulated_time"]
        assert motor_power(0.037, 3.0) < power < motor_power(0.037, 3.9), power
        assert flown["simulated_time"] < 0.8 * hover(mebots, out)["simulated_time"]

        sinks = hover(mebots, out, "world.drone.dry_mass=0.042")
        assert sinks["outcome"] == "thrust_lost", sinks["outcome"]
        stays = hover(mebots, out, "world.drone.dry_mass=0.09")
        assert stays["outcome"] == "no_take_off", stays["outcome"]
    print("ok")


if __name__ == "__main__":
    main()
