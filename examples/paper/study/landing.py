# SPDX-License-Identifier: Apache-2.0
"""Determines the charge at which a landing must start so that the drone reaches the ground under power. For each cell and motor
model, runs flights that start to land at different charges, in steps of STEP. Ends when a flight that lands and a flight that
falls are one step apart."""

import experiments
from missions import BATTERIES
from results import Trace
from run import fly_all

STEP = 0.5  # resolution of the search [% of charge]
DESCENT = 1.5  # [%]: the search starts this much above the charge at which the protection opens; affects only its length


def under_power(summary):
    """True if the drone landed upright before the protection opened."""
    return bool(summary["landed"] and not summary["crashed"] and Trace(summary["folder"])["battery.cell.connected"][-1] > 0)


def opening_charge(summary):
    """Returns the charge at which the protection opened [%]. If it did not open, returns None."""
    trace = Trace(summary["folder"])
    open_ = trace["battery.cell.connected"] < 0.5
    return float(100 * trace["battery.cell.state_of_charge"][open_.argmax()]) if open_.any() else None


class Search:
    """Searches the lowest charge from which a landing succeeds, for one cell and one motor model. Changes the charge by one STEP
    per flight."""

    def __init__(self, motors, battery, empty):
        self.motors, self.battery = motors, battery
        self.opens = opening_charge(empty)
        self.at = round((self.opens + DESCENT) / STEP)
        self.flown = {}

    def flight(self):
        """Returns the next flight to run. If the result is known, returns None."""
        landed = [at for at, ok in self.flown.items() if ok]
        fell = [at for at, ok in self.flown.items() if not ok]
        if landed and fell:
            if min(landed) == max(fell) + 1:
                return None
        if self.flown:
            self.at = min(landed) - 1 if landed else max(fell) + 1
        return experiments.landing(self.motors, self.battery, self.at * STEP)

    def found(self):
        return {"opens": self.opens, "flights": [{"charge": at * STEP, "landed": ok}
                                                 for at, ok in sorted(self.flown.items())]}


def least(found):
    """Returns the lowest charge [%] from which a flight landed, if the flight that started one step lower fell. Otherwise returns
    None."""
    landed = [f["charge"] for f in found["flights"] if f["landed"]]
    fell = [f["charge"] for f in found["flights"] if not f["landed"]]
    return min(landed) if landed and fell and min(landed) - max(fell) <= STEP + 1e-9 else None


def fly(place, motors):
    """Performs the search for each battery. Returns {battery: {opens: %, flights: [{charge: %, landed}]}}."""
    empty = fly_all(experiments.empties(motors), place)
    searches = [Search(motors, battery, empty[experiments.named(motors, f"endurance-{battery}-empty")])
                for battery in BATTERIES]
    while True:
        flights = {search: flight for search in searches if (flight := search.flight()) is not None}
        if not flights:
            break
        summaries = fly_all(list(flights.values()), place)
        for search, flight in flights.items():
            search.flown[search.at] = under_power(summaries[flight.name])
    return {search.battery: search.found() for search in searches}
