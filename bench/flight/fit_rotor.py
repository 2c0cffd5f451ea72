#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fits thrust, motor and inertia of the Crazyflie's older propellers to data of public flights and motor stands.

    .venv/bin/python bench/flight/fit_rotor.py FOLDER

FOLDER is described in flight_data.py. The fit uses only its CALIBRATION_* files. The equations are those of
fmu_motors/src/electric_motor.hpp: i = (v - K w) / R >= 0, J dw/dt = K i - c w^2, P = v i + g v^2 (1 - d)^2, with c =
torque_per_thrust k.
"""
import argparse

import numpy as np
from scipy.optimize import least_squares, minimize_scalar

import flight_data as data

TORQUE_PER_THRUST = 0.007350863  # in m; source: utiasDSL/drone-models, cf2x_L250
TORQUE_DOUBT = 0.15
LEAST_THRUST_G = 24              # of four rotors: below the weight of the lightest drone, k decreases and load cells
                                 # drift noticeably
LEAST_DUTY = 0.35                # below it, the ripple of the current reaches zero, which the equations neglect
LOG_DELAY_S = 0.004              # time from command to logged speed, by cross correlation on jana04
ENDS_S = 1.0


def flight_coefficient(flight):
    """Returns the coefficient k of each second of a flight: m (g + dv/dt) = k sum w^2 cos(tilt)."""
    found = []
    for s in flight.blocks():
        rise = (flight.climb_m_per_s[s][-1] - flight.climb_m_per_s[s][0]) / np.ptp(flight.time_s[s])
        pull = np.mean((flight.speed_rad_per_s[:, s]**2).sum(axis=0) * flight.upright[s])
        found.append(flight.mass_kg * (data.GRAVITY + rise) / pull)
    return np.array(found)


def stand_coefficient(stand):
    stand = stand.where(stand.grams >= LEAST_THRUST_G)
    return stand.thrust_n @ stand.square_speed / (stand.square_speed @ stand.square_speed)


def motor_at(stand, drag, law):
    """Returns the effective voltage and the power at the measured speed by the law of the motor."""
    emf, resistance, ripple = law
    current = drag * stand.speed_rad_per_s**2 / emf
    voltage = emf * stand.speed_rad_per_s + resistance * current
    return voltage, voltage * current + ripple * voltage**2 * (1 - voltage / stand.voltage_v)**2


def steady_points(flight):
    """Returns mean duty cycle, voltage and speed of each rotor in each second, as a Stand without thrust and current.
    """
    rows = [(flight.duty[i, s].mean(), flight.voltage_v[s].mean(), flight.speed_rad_per_s[i, s].mean())
            for s in flight.blocks() for i in range(4)]
    duty, voltage, speed = np.array(rows).T
    unknown = np.full(len(duty), np.nan)
    return data.Stand(duty, voltage, speed, speed**2, unknown, unknown)


def fit_motor(powered, spun, drag):
    """Fits K, R and g by the least squares of relative errors. Each source has the same weight."""
    def errors(logs):
        law, parts = np.exp(logs), []
        for source in (powered, *spun):
            voltage, power = motor_at(source, drag, law)
            parts.append((voltage / (source.duty * source.voltage_v) - 1) / np.sqrt(len(voltage)))
            if source is powered:
                parts.append((power / source.power_w - 1) / np.sqrt(len(voltage)))
        return np.concatenate(parts)
    return np.exp(least_squares(errors, np.log([9e-4, 1.0, 0.5])).x)


def simulated_speed(flight, drag, law, inertia):
    """Integrates the motor's equations from the first measured speed on. Small explicit steps suffice for a lag of 80 ms."""
    emf, resistance, _ = law
    speed, course = flight.speed_rad_per_s[:, 0].copy(), np.empty_like(flight.speed_rad_per_s)
    steps = np.diff(flight.time_s, append=flight.time_s[-1])
    voltage = flight.duty * flight.voltage_v
    for j, step in enumerate(steps):
        course[:, j] = speed
        current = np.maximum((voltage[:, j] - emf * speed) / resistance, 0)
        speed = speed + step / inertia * (emf * current - drag * speed**2)
    return course


def fit_inertia(flights, drag, law):
    """Returns the inertia J with the least variance of the speed error, and this variance divided by the speed's variance. The
    mean error of each rotor counts as a difference between motors, and is removed."""
    def variance(logarithm):
        found = []
        for flight in flights:
            delay = round(LOG_DELAY_S / np.median(np.diff(flight.time_s)))
            ends = round(ENDS_S / np.median(np.diff(flight.time_s)))
            off = (np.roll(simulated_speed(flight, drag, law, np.exp(logarithm)), delay, axis=1)
                   - flight.speed_rad_per_s)[:, ends:-ends]
            found.append(off.var(axis=1).mean() / flight.speed_rad_per_s[:, ends:-ends].var(axis=1).mean())
        return np.mean(found)
    best = minimize_scalar(variance, bounds=np.log([2e-8, 3e-7]), method="bounded", options={"xatol": 0.02})
    return np.exp(best.x), best.fun


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    folder = parser.parse_args().folder
    flights = [data.flight(folder, name) for name in data.CALIBRATION_FLIGHTS]
    eckart, stock = (data.stand(folder, name) for name in data.CALIBRATION_STANDS)

    sources = {f.name: flight_coefficient(f) for f in flights}
    for name, found in sources.items():
        print(f"thrust {name}: k = {found.mean():.4e}, {len(found)} s, sd of seconds {found.std():.1e}")
    three = np.array([np.mean([found.mean() for found in sources.values()]), stand_coefficient(eckart),
                      stand_coefficient(stock)])
    k, spread = three.mean(), three.std(ddof=1)
    print(f"thrust of flights, {', '.join(data.CALIBRATION_STANDS)}: {three}")
    print(f"thrust_coefficient {k:.4e} interval {k - 2 * spread:.3e} to {k + 2 * spread:.3e} (2 sd of the sources)")

    powered = stock.where(stock.duty > LEAST_DUTY)
    spun = (eckart.where(eckart.duty > LEAST_DUTY), steady_points(flights[0]))
    laws, inertias = [], []
    for factor in (1, 1 - TORQUE_DOUBT, 1 + TORQUE_DOUBT):
        drag = factor * TORQUE_PER_THRUST * k
        law = fit_motor(powered, spun, drag)
        inertia, rest = fit_inertia(flights, drag, law)
        voltage, power = motor_at(powered, drag, law)
        print(f"torque x {factor}: K {law[0]:.4e} R {law[1]:.4f} g {law[2]:.4f} J {inertia:.3e}; errors: speed's share of "
              f"variance {rest:.3f}, power {100 * np.sqrt(np.mean((power / powered.power_w - 1)**2)):.1f} %, voltage "
              + ", ".join(f"{100 * np.sqrt(np.mean((motor_at(s, drag, law)[0] / (s.duty * s.voltage_v) - 1)**2)):.1f} %"
                          for s in (powered, *spun)))
        laws.append([*law, inertia])
    for name, column in zip(("back_emf", "resistance", "ripple_conductance", "inertia"), np.array(laws).T):
        print(f"{name} {column[0]:.4e} interval {column.min():.3e} to {column.max():.3e}")


if __name__ == "__main__":
    main()
