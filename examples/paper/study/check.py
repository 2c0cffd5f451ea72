# SPDX-License-Identifier: Apache-2.0
"""Repeats some published flights. Checks that the results have the same bits as the published results."""

import experiments
from missions import BATTERIES
from results import Trace
from run import fly_all


def _speeds(published, count, place):
    """Repeats `count` hard flights. Starts with the fastest, which are the shortest. Yields (name, new values, published values)."""
    names = list(reversed(experiments.HARD_SPEEDS))[:count]
    flights = [flight for flight in experiments.speeds() if flight.speed_km_h in names and not flight.adaptive]
    for flight, summary in zip(flights, fly_all(flights, place).values()):
        stored, trace = published["speeds"][str(flight.speed_km_h)], Trace(summary["folder"])
        yield flight.name, {"outcome": summary["outcome"], "charge": 100 * summary["state_of_charge"],
                            "gate_s": trace.time_at_gate(), "lateral_m": summary.get("lateral_error"),
                            "way": trace.way(len(stored["way"]["x"]))}, stored


def _batteries(published, count, place):
    flights = [flight for flight in experiments.batteries() if flight.speed_km_h == max(experiments.EASY_SPEEDS)]
    chosen = [flight for flight in flights if flight.battery in list(BATTERIES)[:count]]
    for flight, summary in zip(chosen, fly_all(chosen, place).values()):
        used = published["batteries"]["used"][flight.battery][str(flight.speed_km_h)]
        kind = "equal" if flight.equal_mass else "real"
        yield flight.name, {"charge used": 100 * (1 - summary["state_of_charge"])}, {"charge used": used[kind]}


def _starts(published, count, place):
    for name, part in published["robustness"].items():
        flights = experiments.starts(name, part["flights"], seed=1)
        numbers = range(0, len(flights), -(-len(flights) // count))  # spreads the flights over the whole part
        chosen = [flights[number] for number in numbers]
        for number, flight, summary in zip(numbers, chosen, fly_all(chosen, place).values()):
            way = part["ways"][number]
            found = Trace(summary["folder"]).way(len(way["x"]))
            lateral = summary.get("lateral_error")
            yield flight.name, {"outcome": summary["outcome"], "way": {axis: found[axis] for axis in "xy"},
                                "lateral_m": None if lateral is None else round(lateral, 3)}, {
                "outcome": way["outcome"], "way": {axis: way[axis] for axis in "xy"}, "lateral_m": part["lateral_m"][number]}


def differences(published, count, place):
    """Repeats the first flights of each part. Yields (flight, differences from the published results: {value: (published,
    new)})."""
    for part in (_speeds, _batteries, _starts):
        for name, now, stored in part(published, count, place):
            yield name, {key: (stored[key], value) for key, value in now.items() if stored[key] != value}
