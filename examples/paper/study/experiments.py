# SPDX-License-Identifier: Apache-2.0
"""The flights of the paper's two experiments, and of the questions beyond them."""

from missions import BATTERIES, Flight

EASY_SPEEDS = (0.5, 1.0, 1.5)   # km/h
HARD_SPEEDS = (0.1, 0.2, 0.3, 0.4, 0.5)
ADAPTIVE_SPEED = 1.0
CLOCKS_MHZ = (25, 50, 87, 131, 175)


def experiment_a():
    """Batteries: consumed charge of the easy flight, with real and with equal masses."""
    return [Flight(f"a-{battery}-{speed}-{'equal' if equal else 'real'}", "easy", speed, battery=battery,
                   equal_mass=equal)
            for battery in BATTERIES for speed in EASY_SPEEDS for equal in (False, True)]


def endurance():
    """Batteries: time from take-off to landing at 10 % charge, hovering and cruising, in a world without gates. A
    picture a second, since there is nothing to see."""
    nothing = (("world.scene.name", "empty"), ("world.start.offset.y", 0.0), ("soc.mission.frame_period", 1.0))
    return [Flight(f"endurance-{battery}-{name}", "easy", speed, battery=battery, extra=nothing, stop_time=1200.0)
            for battery in BATTERIES for name, speed in (("hover", 0.0), ("cruise", 1.5))]


def experiment_b():
    """Speeds: the hard flight at constant speeds and with the adaptive policy."""
    flights = [Flight(f"b-{speed}", "hard", speed, pictures=True) for speed in HARD_SPEEDS]
    return [*flights, Flight("b-adaptive", "hard", ADAPTIVE_SPEED, adaptive=True, pictures=True)]


def clocks():
    """What the cluster's clock does to the hard adaptive flight. The voltage is the least that allows the clock."""
    flights = []
    for clock in CLOCKS_MHZ:
        voltage = 1.0 if clock <= 87 else round(1.0 + 0.2 * (clock - 87) / (175 - 87) + 0.0005, 3)
        flights.append(Flight(f"clock-{clock}", "hard", ADAPTIVE_SPEED, adaptive=True,
                              extra=(("soc.cluster.clock", clock * 1e6), ("soc.core.supply_voltage", min(voltage, 1.2)),
                                     ("soc.core.clock", 50e6))))
    return flights
