# SPDX-License-Identifier: Apache-2.0
"""Defines the flights of the paper's two experiments, and of further questions."""

import dataclasses
import random

from missions import BATTERIES, CHIP_PARTS, RECORDED, Flight, scenario

EASY_SPEEDS = (0.5, 1.0, 1.5)   # speeds of the easy flights [km/h]
HARD_SPEEDS = (0.1, 0.2, 0.3, 0.4, 0.5)
ADAPTIVE_SPEED = 1.0
CLOCKS_MHZ = (25, 50, 87, 131, 175)
CORES = (8, 1)
# The time for which a flight continues after the referee has reported that the drone is stuck on the frame. Some drones get free.
STUCK_S = 30.0
STARTS_RECORDED = ("world.drone.position.x", "world.drone.position.y", "world.drone.position.z", "world.gate.crossed",
                   "world.gate.distance")
# The largest offsets of a random start: forward and sideways [m], rotation [rad]. Each offset is uniform between minus this value
# and this value.
SPREAD = {"shipped": (0.5, 0.5, 0.3), "easy": (0.5, 0.05, 0.02), "hard": (0.3, 0.1, 0.02)}


def named(motors, name):
    """Returns the name of a flight. The names of flights with the bench's motors have no prefix."""
    return name if motors == "bench" else f"{motors}-{name}"


def batteries():
    """Returns the easy flights with real and with equal masses. The report compares the charge that they use."""
    return [Flight(f"a-{battery}-{speed}-{'equal' if equal else 'real'}", "easy", speed, battery=battery,
                   equal_mass=equal)
            for battery in BATTERIES for speed in EASY_SPEEDS for equal in (False, True)]


def in_the_air(motors, battery, name, speed, landing_charge):
    """Returns a flight in a world without gates, from take-off until it lands at a given charge. It takes five pictures per
    second, because the firmware reads its gauge once per picture."""
    extra = (("world.scene.name", "empty"), ("world.start.offset.y", 0.0), ("soc.mission.frame_period", 0.2),
             ("soc.mission.landing_charge", landing_charge))
    return Flight(named(motors, f"endurance-{battery}-{name}"), "easy", speed, battery=battery, motors=motors,
                  extra=extra, stop_time=1200.0)


def endurance(motors="bench"):
    """Returns the flights that hover or cruise, and land at 10 % charge."""
    return [in_the_air(motors, battery, name, speed, 0.10)
            for battery in BATTERIES for name, speed in (("hover", 0.0), ("cruise", 1.5))]


def empties(motors="bench"):
    """Returns the flights that hover until the protection opens."""
    return [in_the_air(motors, battery, "empty", 0.0, 0.0) for battery in BATTERIES]


def landing(motors, battery, percent):
    """Returns a flight that hovers and starts to land at a given charge."""
    return in_the_air(motors, battery, f"landing-{percent:.1f}", 0.0, percent / 100)


def speeds():
    """Returns the hard flights at constant speeds and with the adaptive policy."""
    record = tuple(RECORDED + CHIP_PARTS)
    flights = [Flight(f"b-{speed}", "hard", speed, pictures=True) for speed in HARD_SPEEDS]
    return [*flights, Flight("b-adaptive", "hard", ADAPTIVE_SPEED, adaptive=True, pictures=True, record=record)]


def least_voltage(clock_mhz):
    """Returns the lowest voltage of the chip that permits a clock of the cluster [V], in steps of 50 mV."""
    return next(v for v in (1.0, 1.05, 1.1, 1.15, 1.2) if clock_mhz <= 87 + (v - 1.0) / 0.2 * (175 - 87) + 1e-6)


def starts(name, count, seed):
    """Returns flights that start at random offsets from the scenario's start. The noise of the camera also differs."""
    draw = random.Random(f"{name} {seed}")
    own = scenario(name)
    forwards, sideways, turned = SPREAD[name]
    flights = []
    for i in range(count):
        extra = (("world.start.offset.x", draw.uniform(-forwards, forwards)),
                 ("world.start.offset.y", own.get("world.start.offset.y", 0.0) + draw.uniform(-sideways, sideways)),
                 ("world.start.yaw_offset", draw.uniform(-turned, turned)), ("world.sensors.seed", i + 1))
        flights.append(Flight(f"{name}-{seed}-{i:03}", name, ADAPTIVE_SPEED, adaptive=name == "hard", extra=extra,
                              stop_time=300.0, stuck_s=STUCK_S, record=STARTS_RECORDED))
    return flights


def clocks(count):
    """Returns {(cores, clock in MHz): flights}, for several clocks of the cluster, on eight cores and on one core. All entries
    have the same random starts of the hard scenario and the adaptive policy."""
    drawn = starts("hard", count, seed=2)

    def at(clock, cores):
        chip = (("soc.cluster.clock", clock * 1e6), ("soc.cluster.cores", cores),
                ("soc.core.supply_voltage", least_voltage(clock)), ("soc.core.clock", 50e6))
        return [dataclasses.replace(flight, name=f"clock-{clock}-{cores}-{i:02}", extra=(*flight.extra, *chip))
                for i, flight in enumerate(drawn)]
    return {(cores, clock): at(clock, cores) for cores in CORES for clock in CLOCKS_MHZ}
