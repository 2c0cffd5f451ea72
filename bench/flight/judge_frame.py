#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the drag of fmu_world's drone with flights: along the body's x and y axes, and along the vertical by climb.

    .venv/bin/python bench/flight/judge_frame.py FOLDER

FOLDER is described in flight_data.py. An accelerometer in flight does not measure gravity. Perpendicular to the rotors' axis, it
measures only drag: a = -d v / m. v is the velocity along the same body axis. The sensor has a constant error. Values are means
over 0.1 s. Climb: m (g + dv/dt), divided by the sum of the squared rotor speeds, is proportional to 1 - d v / (m g). Here, v is
the climb rate.
"""
import argparse
import json
from pathlib import Path

import numpy as np

import flight_data as data

ROOT = Path(__file__).resolve().parents[2]
ROWS = 50        # rows in 0.1 s
SLICE_S = 0.25
ENDS = 5


def body_velocity(log):
    x, y, z, w = (log[f"stateEstimate.q{c}"] for c in "xyzw")
    velocity = np.array([log[f"stateEstimate.v{c}"] for c in "xyz"])
    forward = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)])
    left = np.array([2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)])
    return np.array([(forward * velocity).sum(axis=0), (left * velocity).sum(axis=0)])


def means(values):
    whole = values.shape[1] // ROWS * ROWS
    return values[:, :whole].reshape(2, -1, ROWS).mean(axis=2)[:, ENDS:-ENDS]


def horizontal_drag(folder, name):
    """Returns the drag [N s/m] and the standard deviation of the velocity [m/s] along x and y."""
    log = data.read_usd(Path(folder) / data.FLIGHTS / name)
    velocity = means(body_velocity(log))
    acceleration = means(data.GRAVITY * np.array([log["acc.x"], log["acc.y"]]))
    drag = [-data.JANA_MASS_KG * np.polyfit(v, a, 1)[0] for v, a in zip(velocity, acceleration)]
    return np.array(drag), velocity.std(axis=1)


def climb_drag(folder):
    """Returns the drag along the vertical [N s/m], its standard error, and the number of slices. Uses the mean of rotors 2 to 4,
    because the first rotor's sensor fails in these flights."""
    rise, share = [], []
    for name in data.CLIMBING_FLIGHTS:
        f = data.flight(folder, name)
        speed = f.speed_rad_per_s[1:]
        for at in np.arange(f.time_s[0] + 1, f.time_s[-1] - 1, SLICE_S):
            s = slice(*np.searchsorted(f.time_s, (at, at + SLICE_S)))
            if not (speed[:, s] > 500).all():
                continue
            acceleration = (f.climb_m_per_s[s][-1] - f.climb_m_per_s[s][0]) / np.ptp(f.time_s[s])
            pull = 4 / 3 * np.mean((speed[:, s]**2).sum(axis=0) * f.upright[s])
            rise.append(f.climb_m_per_s[s].mean())
            share.append(f.mass_kg * (data.GRAVITY + acceleration) / pull)
    slope, level = np.polyfit(rise, share, 1)
    doubt = np.std(np.polyval((slope, level), rise) - share) / np.std(rise) / np.sqrt(len(rise))
    weight = data.JANA_MASS_KG * data.GRAVITY
    return -weight * slope / level, weight * doubt / level, len(rise)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    folder = parser.parse_args().folder
    ours = json.loads((ROOT / "fmu_world/params/drones/crazyflie.json").read_text())["drag"]["values"]
    print("| flights | drag along x [N s/m] | along y |\n|---|---|---|")
    for label, names in (("jana00 to 03, 10, 11", data.JUDGED_FLIGHTS), ("jana20 to 33", data.CLIMBING_FLIGHTS)):
        drags, speeds = zip(*(horizontal_drag(folder, name) for name in names))
        weights = np.square(speeds)
        mean = (weights * drags).sum(axis=0) / weights.sum(axis=0)
        print(f"| {label}: {len(names)} | " + " | ".join(f"{m:.4f}, sd of flights {s:.4f}" for m, s in zip(mean, np.std(drags, axis=0))) + " |")
    print(f"| fmu_world | {ours[0]:.4f} | {ours[1]:.4f} |")
    drag, doubt, count = climb_drag(folder)
    print(f"\nvertical: {drag:.4f} +- {doubt:.4f} N s/m from {count} slices of {SLICE_S} s, "
          f"{100 * drag / data.JANA_MASS_KG / data.GRAVITY:.1f} % of the thrust per m/s; fmu_world {ours[2]:.4f}")


if __name__ == "__main__":
    main()
