#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Predicts flights and a motor stand that no rotor file was fitted to, and prints every error.

    .venv/bin/python bench/flight/judge_rotor.py build/release/fmus/fmu_motors.fmu FOLDER

FOLDER is described in flight_data.py. Thrust: k times the measured speeds, compared with weight and measured acceleration in each
second. `one flight`: k is from the first flight of the same drone, and is judged on the others. Speed: fmu_motors with the logged
duty cycles and voltage as inputs. `one flight`: a factor per rotor is from the first flight. Power: the steady state of
fmu_motors at the stand's voltage and at its thrust or speed, compared with voltage times current. Up and down are the two
directions of the stand's sweep. The last table uses no model: it shows the power of this stand divided by the power of the stand
that the rotor was fitted to.
"""
import argparse

import numpy as np

import flight_data as data
from fit_rotor import flight_coefficient
from motors_fmu import Motors

ROTORS = ("crazyflie_bench", "crazyflie_legacy")
L250_RPM2THRUST = (-5.382196214637237e-7, 2.4582929831265485e-10)  # source: utiasDSL/drone-models, params.toml
GRAMS = ((15, 20), (20, 25), (25, 30), (30, 35), (35, 40), (40, 45))


def spread(errors):
    """Returns mean, standard deviation, 5th and 95th percentile of relative errors as text, in percent.
    """
    e = 100 * np.asarray(errors)
    return f"{e.mean():+.1f} (sd {e.std():.1f}, 5 to 95 %: {np.percentile(e, 5):+.1f} to {np.percentile(e, 95):+.1f})"


def thrust_errors(flights, k):
    """Returns the relative error of the thrust in each second of each flight."""
    return [k / flight_coefficient(f) - 1 for f in flights]


def thrust_table(sets, models):
    print("| thrust at measured speed | flights | seconds | " + " | ".join(m.rotor for m in models) + " | one flight |")
    print("|---|---|---|" + "---|" * (len(models) + 1))
    for name, flights in sets.items():
        own = flight_coefficient(flights[0]).mean()
        cells = [spread(np.concatenate(thrust_errors(flights, m.thrust_coefficient))) for m in models]
        cells.append(spread(np.concatenate(thrust_errors(flights[1:], own))))
        print(f"| {name} | {len(flights)} | {sum(len(f.blocks()) for f in flights)} | " + " | ".join(cells) + " |")
    for f in (f for flights in sets.values() for f in flights):
        print(f"|   {f.name} | 1 | {len(f.blocks())} | "
              + " | ".join(spread(thrust_errors([f], m.thrust_coefficient)[0]) for m in models) + " | |")


def speed_table(sets, models):
    print("| speed from duty cycle and voltage | flights | " + " | ".join(
        f"{m.rotor}: mean of a rotor | {m.rotor}: rms over time | {m.rotor}: each rotor | {m.rotor}: one flight" for m in models) + " |")
    print("|---|---|" + "---|" * 4 * len(models))
    for name, flights in sets.items():
        cells = []
        for m in models:
            means, squares = [], []
            for f in flights:
                whole = np.concatenate([np.r_[s] for s in f.blocks()])
                off = m.fly(f)[0][:, whole] / f.speed_rad_per_s[:, whole] - 1
                means.append(off.mean(axis=1))
                squares.append(np.mean(off**2))
            means = np.array(means)
            each = ", ".join(f"{100 * mean:+.1f} (sd {100 * sd:.1f})" for mean, sd in zip(means.mean(axis=0), means.std(axis=0)))
            later = (1 + means[1:]) / (1 + means[0]) - 1
            cells += [spread(means), f"{100 * np.sqrt(np.mean(squares)):.1f}", each, spread(later)]
        print(f"| {name} | {len(flights)} | " + " | ".join(cells) + " |")


def stand_errors(stand, model):
    """Returns the errors of four quantities at each point: thrust at the speed, speed at the duty cycle, power at the thrust, and
    power at the speed."""
    points = zip(stand.duty, stand.voltage_v, stand.speed_rad_per_s, stand.square_speed, stand.thrust_n, stand.power_w)
    return np.array([(model.thrust_coefficient * square / thrust - 1, model.speed_at(duty, volt) / speed - 1,
                      model.power_at_thrust(thrust, volt) / power - 1, model.power_at_speed(speed, volt) / power - 1)
                     for duty, volt, speed, square, thrust, power in points])


def stand_table(stand, models):
    rising = np.arange(len(stand.duty)) < np.argmax(stand.duty)
    print("| stock-prop stand | rotor | thrust at speed: up, down, mean | speed at duty | power at thrust: up, down, mean | "
          "power at speed: up, down, mean |")
    print("|---|---|---|---|---|---|")
    for low, high in GRAMS:
        for m in models:
            both = []
            for direction in (rising, ~rising):
                both.append(stand_errors(stand.where(direction & (stand.grams >= low) & (stand.grams < high)), m).mean(axis=0))
            up, down = 100 * np.array(both)
            three = [f"{u:+.1f}, {d:+.1f}, {(u + d) / 2:+.1f}" for u, d in zip(up, down)]
            print(f"| {low} to {high} g | {m.rotor} | {three[0]} | {(up[1] + down[1]) / 2:+.1f} | {three[2]} | {three[3]} |")


def stands_table(judged, fitted):
    """Prints, for ranges of thrust, the power on the judged motor stand divided by the power on the fitted motor stand at the
    same thrust, minus 1."""
    print("| power of stock-prop / stock2 - 1 | up and down averaged | up | down |\n|---|---|---|---|")
    rising = np.arange(len(judged.duty)) < np.argmax(judged.duty)
    order = np.argsort(fitted.grams)
    for low, high in GRAMS:
        inside = (judged.grams >= low) & (judged.grams < high) & (judged.grams <= fitted.grams.max())
        if not inside.any():
            continue
        ratio = judged.power_w / np.interp(judged.grams, fitted.grams[order], fitted.power_w[order]) - 1
        up, down = (100 * ratio[inside & direction].mean() for direction in (rising, ~rising))
        print(f"| {low} to {high} g | {(up + down) / 2:+.1f} | {up:+.1f} | {down:+.1f} |")


def drone_models_table(models):
    print("| drone-models L250 | " + " | ".join(m.rotor for m in models) + " |")
    print("|---|" + "---|" * len(models))
    for grams in (27, 34.7, 40):
        thrust = grams * 1e-3 * data.GRAVITY / 4
        linear, square = L250_RPM2THRUST
        rpm = (-linear + np.sqrt(linear**2 + 4 * square * thrust)) / (2 * square)
        print(f"| thrust at its speed for {grams} g | " + " | ".join(
            f"{100 * (m.thrust_coefficient * (rpm * np.pi / 30)**2 / thrust - 1):+.1f}" for m in models) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("fmu")
    parser.add_argument("folder")
    given = parser.parse_args()
    models = [Motors(given.fmu, rotor) for rotor in ROTORS]
    sets = {"same drone, other flights": [data.flight(given.folder, n) for n in data.JUDGED_FLIGHTS],
            "second drone": [data.flight(given.folder, n) for n in data.SECOND_DRONE_FLIGHTS]}
    print("Errors in percent: model / measured - 1\n")
    thrust_table(sets, models)
    print()
    speed_table(sets, models)
    print()
    stand_table(data.stand(given.folder, data.JUDGED_STAND), models)
    print()
    stands_table(data.stand(given.folder, data.JUDGED_STAND), data.stand(given.folder, data.CALIBRATION_STANDS[1]))
    print()
    drone_models_table(models)


if __name__ == "__main__":
    main()
