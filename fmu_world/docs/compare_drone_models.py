#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the built fmu_world with utiasDSL's drone-models at the same rotor speeds, and prints the differences.

    python3 -m venv /tmp/compare && /tmp/compare/bin/pip install fmpy drone-models
    /tmp/compare/bin/python fmu_world/docs/compare_drone_models.py build/release/fmus/fmu_world.fmu

drone-models contains the equations of Newton and Euler for a Crazyflie (cf2x_L250) with drag, thrust and gyroscopic torque. This
script integrates them with a Runge-Kutta method of fourth order. In each millisecond, the FMU receives the thrusts, torques and
speeds of the same rotors. Its drone has the same mass, inertia, arm and drag. Therefore the comparison covers the FMU's dynamics:
frames, signs of all torques, rotations, drag, gyroscopic torque.
"""
import json
import shutil
import sys
import tempfile
from pathlib import Path

import fmpy
import numpy as np
from drone_models.first_principles import dynamics
from drone_models.core import load_params
from fmpy.fmi2 import FMU2Slave
from scipy.spatial.transform import Rotation

STEP, END = 0.001, 1.0
BASE = 18_650.0  # rpm: a hover of 31.9 g
SWING = np.array([300.0, 220.0, -280.0, 250.0])
TURN = np.array([9.0, 7.0, 8.0, 6.0])
PHASE = np.array([0.0, 1.0, 0.0, 2.0])


def speeds(t):
    """Returns rotor speeds [rpm] that turn the drone about all three axes."""
    return BASE + SWING * np.sin(TURN * t + PHASE)


def command(p, t):
    """Returns the commands with which the rotors of drone-models turn at the speeds speeds(t)."""
    rpm, change = speeds(t), SWING * TURN * np.cos(TURN * t + PHASE)
    up, _, _, down = p["rotor_dyn_coef"]
    return np.where(change > 0, rpm + change / up, np.sqrt(rpm**2 + change / down))


def reference(p, gyroscopic_sign):
    """Returns the states at each step: position, quaternion (xyzw), velocity, body rate."""
    inertia = np.array(p["J"])

    def rates(t, y):
        pos, quat, vel, rate = y[:3], y[3:7] / np.linalg.norm(y[3:7]), y[7:10], y[10:13]
        rpm = speeds(t)
        params = {k: np.asarray(p[k]) for k in ("mass", "L", "prop_inertia", "gravity_vec", "J", "J_inv", "rpm2thrust", "rpm2torque",
                                                "mixing_matrix", "drag_matrix", "rotor_dyn_coef")}
        _, _, acc, rate_dot, *_ = dynamics(pos, quat, vel, rate, command(p, t), rpm, **params)
        if gyroscopic_sign:
            # In drone-models 0.1.0, the gyroscopic torque about x has the wrong sign, so it would do work. Adds twice the
            # correct torque.
            momentum = p["prop_inertia"] * np.sum(np.array(p["mixing_matrix"])[-1] * rpm) * 2 * np.pi / 60
            rate_dot = rate_dot + np.linalg.solve(inertia, [2 * rate[1] * momentum, 0, 0])
        quat_dot = 0.5 * np.array([
            rate[0] * quat[3] + rate[2] * quat[1] - rate[1] * quat[2], rate[1] * quat[3] - rate[2] * quat[0] + rate[0] * quat[2],
            rate[2] * quat[3] + rate[1] * quat[0] - rate[0] * quat[1], -rate @ quat[:3]])
        return np.concatenate([vel, quat_dot, acc, rate_dot])

    y = np.zeros(13)
    y[2], y[6] = 5.0, 1.0
    states = [y.copy()]
    for k in range(round(END / STEP)):
        t, h = k * STEP, STEP
        k1 = rates(t, y)
        k2 = rates(t + h / 2, y + h / 2 * k1)
        k3 = rates(t + h / 2, y + h / 2 * k2)
        k4 = rates(t + h, y + h * k3)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        y[3:7] /= np.linalg.norm(y[3:7])
        states.append(y.copy())
    return np.array(states)


def quantity(value, unit):
    return {"value" if np.isscalar(value) else "values": value, "unit": unit, "source": "drone-models, cf2x_L250"}


def ours(fmu, p, spinning):
    folder = Path(tempfile.mkdtemp())
    unpacked = fmpy.extract(fmu)
    drone = json.loads((Path(unpacked) / "resources/drones/crazyflie.json").read_text())
    drone["reference_mass"] = quantity(p["mass"], "kg")
    drone["inertia"] = quantity(np.diag(p["J"]).tolist(), "kg.m2")
    drone["arm"] = quantity(p["L"], "m")
    drone["drag"] = quantity((-np.diag(p["drag_matrix"])).tolist(), "N.s/m")
    scene = json.loads((Path(unpacked) / "resources/scenes/empty.json").read_text())
    scene["drone"] = "drone.json"
    scene["start"]["position"] = [0, 0, 5]
    (folder / "drone.json").write_text(json.dumps(drone))
    (folder / "scene.json").write_text(json.dumps(scene))
    description = fmpy.read_model_description(fmu)
    reference_of = {v.name: v.valueReference for v in description.modelVariables}
    slave = FMU2Slave(guid=description.guid, unzipDirectory=unpacked, modelIdentifier=description.coSimulation.modelIdentifier,
                      instanceName="world")
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.setString([reference_of["scene.name"]], [str(folder / "scene.json")])
    slave.setReal([reference_of[n] for n in ("drone.dry_mass", "cell.mass", "rotors.inertia")],
                  [p["mass"], 0.0, p["prop_inertia"] if spinning else 0.0])
    slave.setReal([reference_of[f"rotor[{i}].speed"] for i in (1, 2, 3, 4)], list(speeds(-0.5 * STEP) * 2 * np.pi / 60))
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    names = [f"drone.position.{a}" for a in "xyz"] + ["drone.roll", "drone.pitch", "drone.yaw"] + \
            [f"drone.velocity.{a}" for a in "xyz"] + [f"drone.angular_velocity.{a}" for a in "xyz"]
    inputs = [f"rotor[{i}].{what}" for what in ("thrust", "torque", "speed") for i in (1, 2, 3, 4)]
    rows = []
    for k in range(round(END / STEP) + 1):
        rows.append(slave.getReal([reference_of[n] for n in names]))
        rpm = speeds((k + 0.5) * STEP)  # the mean over the step, to second order
        thrust = p["rpm2thrust"][1] * rpm + p["rpm2thrust"][2] * rpm**2
        torque = p["rpm2torque"][1] * rpm + p["rpm2torque"][2] * rpm**2
        slave.setReal([reference_of[n] for n in inputs], [*thrust, *torque, *(rpm * 2 * np.pi / 60)])
        slave.doStep(k * STEP, STEP)
    slave.terminate()
    slave.freeInstance()
    shutil.rmtree(folder)
    return np.array(rows)


def report(name, mine, theirs):
    rotation = Rotation.from_euler("ZYX", mine[:, [5, 4, 3]])
    turned = (rotation.inv() * Rotation.from_quat(theirs[:, 3:7])).magnitude()
    print(f"{name}: place {1e3 * np.abs(mine[:, :3] - theirs[:, :3]).max():.2f} mm of "
          f"{np.linalg.norm(theirs[-1, :3] - theirs[0, :3]):.2f} m, attitude {np.degrees(turned.max()):.3f} of "
          f"{np.degrees(Rotation.from_quat(theirs[:, 3:7]).magnitude().max()):.0f} degrees, rate "
          f"{np.abs(mine[:, 9:] - theirs[:, 10:]).max():.4f} of {np.abs(theirs[:, 10:]).max():.2f} rad/s")


def main():
    p = load_params("first_principles", "cf2x_L250")
    p = {k: (v.tolist() if hasattr(v, "tolist") else v) for k, v in p.items()}
    p["gravity_vec"] = [0.0, 0.0, -9.80665]  # replaces the model's own value of 9.81
    with_spin = ours(sys.argv[1], p, True)
    report("gyroscopic torque in both, their sign along x put right", with_spin, reference(p, True))
    report("the same, drone-models as it is", with_spin, reference(p, False))
    report("no gyroscopic torque here", ours(sys.argv[1], p, False), reference(p, True))


if __name__ == "__main__":
    main()
