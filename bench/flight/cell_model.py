# SPDX-License-Identifier: Apache-2.0
"""Models the cell of fmu_battery and the power of a hovering drone, vectorised over flights."""
import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from flight_data import GRAVITY, STEP_S

PARAMS = Path(__file__).resolve().parents[2]
RUNNING_OUT_V2 = 1e-3  # minimum discriminant: beyond its maximum power, a cell delivers the maximum
GRID = np.linspace(0, 1, 4001)


class Rotors:
    """Computes the steady power of the four rotors in a rotor file with `motor`."""

    def __init__(self, name="crazyflie_legacy"):
        data = json.loads((PARAMS / f"fmu_motors/params/rotors/{name}.json").read_text())
        self.thrust = data["thrust_coefficient"]["value"]
        self.drag = data["torque_per_thrust"]["value"] * self.thrust
        self.emf, self.ohm, self.ripple = (data["motor"][k]["value"] for k in ("back_emf", "resistance", "ripple_conductance"))

    def _power(self, effective_v, speed, supply_v):
        current = np.maximum((effective_v - self.emf * speed) / self.ohm, 0)
        return effective_v * current + self.ripple * effective_v**2 * (1 - effective_v / supply_v)**2

    def hovering(self, mass_kg, supply_v):
        speed = np.sqrt(mass_kg * GRAVITY / 4 / self.thrust)
        needed = self.emf * speed + self.ohm * self.drag * speed**2 / self.emf
        return 4 * self._power(np.minimum(needed, supply_v), speed, supply_v)

    def driven(self, duty, supply_v):
        """Returns the power of four rotors together [W]. The first axis of `duty` contains their duty cycles."""
        effective = duty * supply_v
        square = self.ohm * self.drag / self.emf
        speed = 2 * effective / (self.emf + np.sqrt(self.emf**2 + 4 * square * effective))
        return self._power(effective, speed, supply_v).sum(axis=0)


def _curve(data):
    if "state_of_charge" in data:
        return np.interp(GRID, data["state_of_charge"], data["value"])
    factor, rate = data["exponential"]
    return factor * np.exp(-rate * GRID) + np.polyval(data["polynomial"][::-1], GRID)


@dataclass
class Cell:
    """The curves of a cell over GRID. `resistance` scales all resistances."""
    open_circuit: np.ndarray
    series: np.ndarray
    pairs: list                # list of (resistance, time constant)
    capacity_c: float

    @staticmethod
    def load(name):
        data = json.loads((PARAMS / f"fmu_battery/params/cells/{name}.json").read_text())
        held = np.maximum(GRID, data["hold_below_state_of_charge"]["value"])
        ohms, farads = data["resistance_factor"]["value"], data["capacitance_factor"]["value"]
        at = lambda key: np.interp(held, GRID, _curve(data[key]))
        pairs = [(ohms * at(f"pair{k}_resistance"),
                  ohms * farads * at(f"pair{k}_resistance") * at(f"pair{k}_capacitance")) for k in (1, 2)]
        return Cell(_curve(data["open_circuit_voltage"]), ohms * at("series_resistance"), pairs,
                    data["capacity"]["value"] * data.get("capacity_factor", {"value": 1})["value"])


def at(curve, charge):
    return np.interp(charge, GRID, curve)


def discharge(cell, rest_v, factor, power, steps, rest_w):
    """Returns the mean voltage in each of `steps` intervals, one row per flight. The voltage at rest determines the state of
    charge. `factor` scales all resistances of a flight. power(k, voltage) is the power of all loads in interval k."""
    rest_a = rest_w / rest_v
    charge = np.interp(rest_v + rest_a * factor * at(cell.series, np.full_like(rest_v, 0.9)), cell.open_circuit, GRID)
    pairs = [np.zeros_like(rest_v) for _ in cell.pairs]
    voltage, rows = rest_v - 0.4, []
    for k in range(steps):
        series = factor * at(cell.series, charge)
        source = at(cell.open_circuit, charge) - sum(pairs)
        watts = power(k, np.maximum(voltage, 2.0))
        current = 2 * watts / (source + np.sqrt(np.maximum(source**2 - 4 * series * watts, RUNNING_OUT_V2)))
        moved = []
        for pair, (ohm, tau) in zip(pairs, cell.pairs):
            goal, left = factor * at(ohm, charge) * current, np.exp(-STEP_S / 2 / at(tau, charge))
            moved.append((goal + (pair - goal) * left, goal + (pair - goal) * left**2))
        middle = charge - current * STEP_S / 2 / cell.capacity_c
        voltage = at(cell.open_circuit, middle) - sum(m for m, _ in moved) - factor * at(cell.series, middle) * current
        rows.append(voltage)
        pairs = [end for _, end in moved]
        charge = np.maximum(charge - current * STEP_S / cell.capacity_c, 0)
    return np.array(rows).T


CRACIUN_MASS_KG = 0.0376    # mass with Crazyflie 2.0 (27 g), Multi-ranger 2.3 g, Qi charger 5.0 g, Loco positioning 3.3 g (Bitcraze)
AVIONICS_W = 0.96           # parameter avionics.base_power of fmu_motors
CRACIUN_DECKS_W = 0.5       # assumption: the receiver of the Loco deck takes 160 mA at 3.3 V (DW1000 data sheet)


@dataclass
class Set:
    """The flights of one set as arrays of equal length, padded with nan."""
    flights: list
    rotors: Rotors

    def __post_init__(self):
        self.steps = max(len(f.voltage_v) for f in self.flights)
        pad = lambda values: np.pad(values, [(0, 0)] * (values.ndim - 1) + [(0, self.steps - values.shape[-1])],
                                    constant_values=np.nan)
        self.voltage_v = np.array([pad(f.voltage_v) for f in self.flights])
        self.rest_v = np.array([f.rest_v for f in self.flights])
        self.duty = None
        if self.flights[0].duty is not None:
            self.duty = np.nan_to_num(np.array([pad(f.duty) for f in self.flights]).transpose(1, 0, 2))

    def subset(self, mask):
        return replace(self, flights=[f for f, yes in zip(self.flights, mask) if yes])

    def loads_w(self, k, voltage):
        if self.duty is None:
            return self.rotors.hovering(CRACIUN_MASS_KG, voltage) + self.rest_w
        return self.rotors.driven(self.duty[:, :, k], voltage) + self.rest_w

    @property
    def rest_w(self):
        return AVIONICS_W + (CRACIUN_DECKS_W if self.duty is None else 0)

    def errors(self, cell, factor):
        """Returns the model's voltage minus the measured voltage. After the end of a flight, returns nan."""
        factor = np.broadcast_to(factor, self.rest_v.shape)
        return discharge(cell, self.rest_v, factor, self.loads_w, self.steps, self.rest_w) - self.voltage_v

    def best_factor(self, cell, first_s=None):
        """Returns the factor of each flight's resistances that gives the least squares of errors, over the flight's first seconds
        or over the whole flight."""
        last = self.steps if first_s is None else round(first_s / STEP_S)
        tries = np.geomspace(0.3, 3.0, 60)
        sums = np.array([np.nansum(self.errors(cell, t)[:, :last]**2, axis=1) for t in tries])
        return tries[sums.argmin(axis=0)]


def rms(errors):
    return np.sqrt(np.nanmean(errors**2, axis=1))
