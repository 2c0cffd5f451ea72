# SPDX-License-Identifier: Apache-2.0
"""Converts flights to the data of the report. One function for each part of the study."""

import base64
import io
import math
import pathlib

import numpy as np
from PIL import Image

from experiments import ADAPTIVE_SPEED, EASY_SPEEDS, HARD_SPEEDS, SPREAD, named
from landing import opening_charge
from missions import BATTERIES, CHIP_PARTS, scenario, scene
from replay import READINGS, Battery, paper_power
from results import CRUISE, PASSED, Trace, energy_by_phase

HARD_NAMES = [*(str(speed) for speed in HARD_SPEEDS), "adaptive"]
WAY_POINTS = {"shown": 300, "start": 60}
COURSE_POINTS = 400
LAST_SECONDS = 15.0  # duration that is shown of a flight whose cell becomes empty [s]


def costs(summaries):
    """Returns the cost of computing the flights."""
    values = list(summaries.values())
    return {"flights": len(values), "simulated_s": sum(s["simulated_time"] for s in values),
            "processor_s": sum(s["processor_s"] for s in values), "memory_mb": max(s["memory_mb"] for s in values)}


def decisions(summaries):
    """Returns {flight: times and energies [J] of its decisions}. `least_j` and `most_j` are the bounds of the chip's energy by
    checks against silicon."""
    return {name: {"outcome": s["outcome"], "pictures": s["pictures"], "latency_s": s["decision"]["mean"]["latency"],
                   "read_out_s": s["decision"]["mean"]["read_out"], "inference_s": s["decision"]["mean"]["inference"],
                   "chip_j": s["chip_energy"]["total"], "least_j": s["chip_energy"]["least"], "most_j": s["chip_energy"]["most"],
                   "camera_j": s["energy"]["camera"], "cell_j": s["energy"]["open_circuit"]}
            for name, s in summaries.items()}


def outcomes(summaries):
    """Returns {outcome: number of flights}."""
    values = [s["outcome"] for s in summaries.values()]
    return {outcome: values.count(outcome) for outcome in sorted(set(values))}


def batteries(summaries):
    """Returns {battery: {speed: {kind: charge used in %}}} and the outcomes of the easy flights."""
    used = {battery: {str(speed): {kind: 100 * (1 - summaries[f"a-{battery}-{speed}-{kind}"]["state_of_charge"]) for kind in ("real", "equal")}
                      for speed in EASY_SPEEDS} for battery in BATTERIES}
    phases = energy_by_phase(Trace(summaries["a-bitcraze_250-1.0-real"]["folder"]))
    return {"used": used, "outcomes": outcomes(summaries), "phases": phases}


def life(summary):
    """Returns two durations from leaving the ground: until 10 % of the charge are left, and until the drone is on the ground [s].
    Also returns the outcome."""
    trace = Trace(summary["folder"])
    start, end = trace.flown()
    charge = trace["battery.cell.state_of_charge"]
    ten = trace.first(charge <= 0.10)
    return {"to_ten_s": None if ten is None else ten - start, "air_s": end - start, "crashed": summary["crashed"],
            "connected": bool(trace["battery.cell.connected"][-1] > 0), "charge": float(100 * charge[-1]),
            "opens": opening_charge(summary)}


def lives(summaries, motors):
    """Returns {battery: {kind of endurance flight (hover, cruise, empty): result of life()}}."""
    return {battery: {kind: life(summaries[named(motors, f"endurance-{battery}-{kind}")])
                      for kind in ("hover", "cruise", "empty")} for battery in BATTERIES}


def last_seconds(summary):
    """Returns the last seconds of a flight whose landing depends on the cell."""
    trace = Trace(summary["folder"])
    return trace.course(COURSE_POINTS, trace.flown()[1] - LAST_SECONDS)


def readings(fmu, summaries):
    """Returns results of the battery's FMU with the paper's motors, for each entry of READINGS: {battery: {entry: seconds of
    hovering until 10 % are left}}, and {speed: {entry: charge of the hard flight at the gate and at the end [%]}}. Also replays
    each hard flight's own loads, and returns the largest difference from the flight's own charge [%]."""
    battery = Battery(fmu)

    def hovering(name, kind="hover"):
        return Trace(summaries[named("paper", f"endurance-{name}-{kind}")]["folder"])

    ten = {name: {reading: battery.to_ten_s(hovering(name), name, avionics, resistance)
                  for reading, (_, avionics, resistance) in READINGS.items()} for name in BATTERIES}
    left, error = {}, 0.0
    standard = "bitcraze_250"
    for name in HARD_NAMES:
        trace = Trace(summaries[f"b-{name}"]["folder"])
        gate = trace.time_at_gate()
        at = None if gate is None else np.searchsorted(trace.time, gate)
        own = trace["battery.cell.state_of_charge"]
        again = battery.of_flight(trace, trace["motors.power"], standard, True, True)
        error = max(error, float(100 * np.abs(again - own).max()))
        motors_w = paper_power(trace, hovering(standard), hovering(standard, "cruise"))
        charges = {"bench": own, **{reading: battery.of_flight(trace, motors_w, standard, avionics, resistance)
                                    for reading, (_, avionics, resistance) in READINGS.items()}}
        left[name] = {reading: {"gate": None if at is None else float(100 * charge[at]), "end": float(100 * charge[-1])}
                      for reading, charge in charges.items()}
    return {"ten": ten, "left": left, "error": error}


def embedded(path, edge):
    """Reduces the size of a picture, and returns the picture as a data URL."""
    out = io.BytesIO()
    Image.open(path).resize((edge, edge), Image.Resampling.BOX).save(out, "JPEG", quality=85)
    return "data:image/jpeg;base64," + base64.b64encode(out.getvalue()).decode()


def pictures(folder):
    """Returns [(time s, path)] of the recorded pictures of a flight."""
    found = sorted(pathlib.Path(folder, "pictures").rglob("*.png"))
    return [(float(path.stem), path) for path in found]


def lateral_m(summary):
    """Returns the offset from the opening's centre at the crossing of the gate's plane [m]. If the drone did not reach it,
    returns None."""
    return summary.get("lateral_error")


def speeds(summaries):
    """Returns {speed: results of the hard flight}."""
    flights = {}
    for name in HARD_NAMES:
        summary = summaries[f"b-{name}"]
        trace = Trace(summary["folder"])
        gate = trace.time_at_gate()
        flights[name] = {
            "outcome": summary["outcome"], "crashed": summary["crashed"], "touched": summary["gate"]["touched"],
            "lateral_m": lateral_m(summary), "cruise_from_s": trace.first(trace["world.drone.phase"] == CRUISE),
            "gate_s": gate, "end_s": trace.flown()[1], "path_m": trace.path_to(gate) if gate is not None else None,
            "in_20_s_m": trace.distance_in_20_s(), "charge": 100 * summary["state_of_charge"],
            "charge_at_gate": None if gate is None else
            float(100 * trace["battery.cell.state_of_charge"][np.searchsorted(trace.time, gate)]),
            "way": trace.way(WAY_POINTS["shown"]), **costs({name: summary})}
    return flights


def adaptive(summary):
    """Returns the results of the hard adaptive flight."""
    trace = Trace(summary["folder"])
    shares = {name: entry["time"] for name, entry in summary["statistics"]["instances"].items()}
    return {"first_view": embedded(pictures(summary["folder"])[0][1], 240), "phases": energy_by_phase(trace),
            "course": trace.course(COURSE_POINTS),
            "chip": {name.rsplit(".", 1)[1]: float(trace[name][-1]) for name in CHIP_PARTS},
            "pictures": summary["pictures"], "profile": {**shares, "master": summary["statistics"]["master"]["time"]}}


def wilson(passed, count, z=1.96):
    """Returns the 95 % confidence interval of a share (Wilson 1927)."""
    share = passed / count
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    return middle - half, middle + half


def clocks(flights, summaries):
    """Returns a row for each entry of {(cores, clock): flights}. Times and energies are means over the flights that crossed the
    opening. The energy up to the gate is the flight's mean power times the time, because the duration after a contact is
    random."""
    rows = []
    for (cores, clock), group in flights.items():
        flown = [summaries[flight.name] for flight in group]
        crossed = [s for s in flown if s["gate"]["crossed"]]

        def mean(value, of):
            return float(np.mean([value(s) for s in of])) if of else None

        def gate_s(summary):
            return Trace(summary["folder"]).time_at_gate()

        def power_w(summary):
            return summary["energy"]["soc"] / summary["simulated_time"]
        rows.append({"clock_mhz": clock, "cores": cores, "voltage_v": dict(group[0].extra)["soc.core.supply_voltage"],
                     "flights": len(flown), "crossed": len(crossed),
                     "pictures_per_s": mean(lambda s: s["pictures"] / s["simulated_time"], flown),
                     "chip_mw": mean(lambda s: 1000 * power_w(s), flown), "gate_s": mean(gate_s, crossed),
                     "chip_j": mean(lambda s: power_w(s) * gate_s(s), crossed)})
    return rows


def straight(name, flights):
    """Returns the share of starts from which a drone that flies straight ahead crosses the opening. Reduces the opening by half
    the drone's width on each side."""
    place = scene(scenario(name)["world.scene.name"])
    gate, (x, y, _) = place["gates"][0], place["start"]["position"]
    free = gate["inner"] / 2 - 0.046
    hits = 0
    for flight in flights:
        extra = dict(flight.extra)
        dx = gate["position"][0] - x - extra["world.start.offset.x"]
        left = y + extra["world.start.offset.y"] + dx * math.tan(extra["world.start.yaw_offset"])
        hits += abs(left - gate["position"][1]) < free
    return hits / len(flights)


def robustness(name, flights, summaries):
    return {"spread": SPREAD[name], "straight": straight(name, flights), "speed_km_h": ADAPTIVE_SPEED,
            **counted(start_ways(summaries), start_offsets(summaries)), "failures": []}


def start_way(name, summary):
    """Returns path and outcome of a flight from a random start, and the duration of its last stretch."""
    trace = Trace(summary["folder"])
    return {"name": name, **trace.way(WAY_POINTS["start"]), "outcome": summary["outcome"],
            "crossed": bool(summary["gate"]["crossed"]), "last_stretch_s": trace.last_stretch_s()}


def start_ways(summaries):
    return [start_way(name, summary) for name, summary in summaries.items()]


def start_offsets(summaries):
    return [None if x is None else round(x, 3) for x in map(lateral_m, summaries.values())]


def counted(ways, offsets):
    """Counts the outcomes over the random starts of a scenario."""
    ends = [way["outcome"] for way in ways]
    passed, clean = sum(end in PASSED for end in ends), ends.count("passed")
    return {"flights": len(ways), "passed": passed, "interval": wilson(passed, len(ways)), "clean": clean,
            "clean_interval": wilson(clean, len(ways)),
            "crossed": sum(way["crossed"] for way in ways), "lateral_m": offsets,
            "outcomes": {end: ends.count(end) for end in sorted(set(ends))}, "ways": ways}


def start_rows(name, part):
    """Returns (path, offset) of each flight from a random start. If a stored flight does not state whether the drone crossed the
    opening, derives this from the position in the gate's plane."""
    half = scene(scenario(name)["world.scene.name"])["gates"][0]["inner"] / 2
    return [({"crossed": offset is not None and abs(offset) < half, **way}, offset)
            for way, offset in zip(part["ways"], part["lateral_m"])]


def flown_again(name, part, summaries):
    """Returns the part of a scenario with new rows for these flights."""
    new = dict(zip(summaries, zip(start_ways(summaries), start_offsets(summaries))))
    rows = [new.get(way["name"], (way, offset)) for way, offset in start_rows(name, part)]
    return {**part, **counted([way for way, _ in rows], [offset for _, offset in rows])}


def failure(flight, summary):
    """Returns the outcome, the start and a picture of a flight. The picture is from a metre before the gate. If the drone did not
    get that close, the picture is from the end."""
    trace = Trace(summary["folder"])
    near = trace.first(trace["world.gate.distance"] < 1.0)
    when = trace.time[-1] if near is None else near
    _, path = min(pictures(summary["folder"]), key=lambda entry: abs(entry[0] - when))
    extra = dict(flight.extra)
    return {"name": flight.name, "outcome": summary["outcome"], "lateral_m": lateral_m(summary),
            "start": [round(extra[key], 3) for key in ("world.start.offset.x", "world.start.offset.y",
                                                       "world.start.yaw_offset")],
            "picture": embedded(path, 200)}
