#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the thrust coefficient of the brushless Crazyflie from public flights, with and without a payload.

    .venv/bin/python bench/flight/brushless.py FOLDER

FOLDER is described in flight_data.py. There is no rotor file for these rotors, because their electrical power is not public.
"""
import argparse
from pathlib import Path

import numpy as np

import flight_data as data
from fit_rotor import flight_coefficient

SETS = (("brushless_flights", 0.037), ("brushless_flights_payload", 0.0444))  # masses [kg] from the folders' README.md


def coefficients(folder, name, mass_kg):
    """Returns the median thrust coefficient of each flight."""
    paths = data.distinct(path for path in (Path(folder) / data.IMRC / name / "data").iterdir() if path.stat().st_size and not path.suffix)
    found = [flight_coefficient(data.flight_of(data.read_usd(path), path.name, mass_kg)) for path in paths]
    return np.array([np.median(one) for one in found if len(one)])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    folder = parser.parse_args().folder
    for name, mass_kg in SETS:
        k = coefficients(folder, name, mass_kg)
        print(f"{name}: {len(k)} flights of {1e3 * mass_kg:.1f} g, k = {np.mean(k):.3e} N.s2/rad2, "
              f"5 to 95 %: {np.percentile(k, 5):.3e} to {np.percentile(k, 95):.3e}")


if __name__ == "__main__":
    main()
