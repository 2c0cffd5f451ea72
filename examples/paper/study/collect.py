# SPDX-License-Identifier: Apache-2.0
"""From flights to the compact data that the report is written from: one function for each part of the study."""

import base64
import io
import math
import pathlib

import numpy as np
from PIL import Image

from experiments import ADAPTIVE_SPEED, EASY_SPEEDS, HARD_SPEEDS, SPREAD
from missions import BATTERIES, CHIP_PARTS, scene, scenario
from results import PASSED, Trace, energy_by_phase

HARD_NAMES = [*(str(speed) for speed in HARD_SPEEDS), "adaptive"]
WAY_POINTS = {"shown": 300, "start": 30}


def costs(summaries):
    """What flights cost the machine that flew them."""
    values = list(summaries.values())
    return {"flights": len(values), "simulated_s": sum(s["simulated_time"] for s in values),
            "processor_s": sum(s["processor_s"] for s in values), "memory_mb": max(s["memory_mb"] for s in values)}


def batteries(summaries):
    """{battery: {speed: {kind: charge used in %}}} and the outcomes."""
    used = {battery: {str(speed): {kind: 100 * (1 - summaries[f"a-{battery}-{speed}-{kind}"]["state_of_charge"])
                                   for kind in ("real", "equal")}
                      for speed in EASY_SPEEDS} for battery in BATTERIES}
    outcomes = [s["outcome"] for s in summaries.values()]
    phases = energy_by_phase(Trace(summaries["a-bitcraze_250-1.0-real"]["folder"]))
    return {"used": used, "outcomes": {o: outcomes.count(o) for o in sorted(set(outcomes))}, "phases": phases}


def endurance(summaries):
    """{battery: {hover, cruise: s}} from leaving the ground to being back on it."""
    times = {}
    for battery in BATTERIES:
        times[battery] = {}
        for kind in ("hover", "cruise"):
            start, end = Trace(summaries[f"endurance-{battery}-{kind}"]["folder"]).flown()
            times[battery][kind] = end - start
    return times


def embedded(path, edge):
    """A picture of a flight as a data URL, made smaller."""
    out = io.BytesIO()
    Image.open(path).resize((edge, edge), Image.Resampling.BOX).save(out, "JPEG", quality=85)
    return "data:image/jpeg;base64," + base64.b64encode(out.getvalue()).decode()


def pictures(folder):
    """[(time s, path)] of the pictures that a flight kept."""
    found = sorted(pathlib.Path(folder, "pictures").rglob("*.png"))
    return [(float(path.stem), path) for path in found]


def speeds(summaries):
    flights = {}
    for name in HARD_NAMES:
        summary = summaries[f"b-{name}"]
        trace = Trace(summary["folder"])
        gate = trace.time_at_gate()
        flights[name] = {"outcome": summary["outcome"], "gate_s": gate, "lateral_m": summary["lateral_error"],
                         "path_m": trace.path_to(gate) if gate is not None else None,
                         "in_20_s_m": trace.distance_in_20_s(), "charge": 100 * summary["state_of_charge"],
                         "way": trace.way(WAY_POINTS["shown"]), **costs({name: summary})}
    adaptive = summaries["b-adaptive"]
    trace = Trace(adaptive["folder"])
    first = pictures(adaptive["folder"])[0][1]
    shares = {name: entry["time"] for name, entry in adaptive["statistics"]["instances"].items()}
    return {"flights": flights, "first_view": embedded(first, 240), "phases": energy_by_phase(trace),
            "chip": {name.rsplit(".", 1)[1]: float(trace[name][-1]) for name in CHIP_PARTS},
            "pictures": adaptive["pictures"], "profile": {**shares, "master": adaptive["statistics"]["master"]["time"]},
            "stepping_s": adaptive["wall_clock"]["stepping"]}


def wilson(passed, count, z=1.96):
    """Confidence interval of a share, 95 % (Wilson 1927)."""
    share = passed / count
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    return middle - half, middle + half


def front(rows):
    """Which rows no other one beats: at least as good in time, the chip's energy and success, and better in one. A row
    none of whose flights passed is on no front."""
    keys = [(row["gate_s"], row["chip_j"], -row["passed"]) for row in rows if row["passed"]]

    def beaten(key):
        return any(other != key and all(a <= b for a, b in zip(other, key)) for other in keys)
    return [row["passed"] > 0 and not beaten((row["gate_s"], row["chip_j"], -row["passed"])) for row in rows]


def clocks(flights, summaries):
    """A row for each of flights' {(cores, clock): flights}. Times and energies are means over the flights that passed. The
    energy up to the gate is the flight's mean power times the time: what comes after a touch is long or short by chance."""
    rows = []
    for (cores, clock), group in flights.items():
        flown = [summaries[flight.name] for flight in group]
        passed = [s for s in flown if s["outcome"] in PASSED]
        low, high = wilson(len(passed), len(flown))

        def mean(value, of=passed):
            return float(np.mean([value(s) for s in of])) if of else None

        def gate_s(summary):
            return Trace(summary["folder"]).time_at_gate()

        def power_w(summary):
            return summary["energy"]["soc"] / summary["simulated_time"]
        rows.append({"clock_mhz": clock, "cores": cores, "voltage_v": dict(group[0].extra)["soc.core.supply_voltage"],
                     "flights": len(flown), "passed": len(passed), "low": low, "high": high,
                     "touched": sum(s["outcome"] == "touched_passed" for s in flown),
                     "pictures_per_s": mean(lambda s: s["pictures"] / s["simulated_time"], flown),
                     "chip_mw": mean(lambda s: 1000 * power_w(s), flown), "gate_s": mean(gate_s),
                     "chip_j": mean(lambda s: power_w(s) * gate_s(s))})
    for row, on_front in zip(rows, front(rows)):
        row["front"] = on_front
    return rows


def straight(name, flights):
    """Share of starts from which a drone that flies straight on meets the opening, less the drone's half width."""
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
    outcomes = [s["outcome"] for s in summaries.values()]
    passed = sum(outcome in PASSED for outcome in outcomes)
    low, high = wilson(passed, len(outcomes))
    ways = [{**Trace(s["folder"]).way(WAY_POINTS["start"]), "passed": s["outcome"] in PASSED}
            for s in summaries.values()]
    return {"flights": len(outcomes), "passed": passed, "low": low, "high": high, "spread": SPREAD[name],
            "straight": straight(name, flights), "speed_km_h": ADAPTIVE_SPEED,
            "lateral_m": np.round([s["lateral_error"] for s in summaries.values()], 3).tolist(),
            "outcomes": {o: outcomes.count(o) for o in sorted(set(outcomes))}, "ways": ways, "failures": []}


def failure(flight, summary):
    """What the camera saw a metre before the gate, or at the end when the drone never came so near."""
    trace = Trace(summary["folder"])
    near = trace["world.gate.distance"] < 1.0
    when = trace.time[np.argmax(near)] if near.any() else trace.time[-1]
    _, path = min(pictures(summary["folder"]), key=lambda entry: abs(entry[0] - when))
    extra = dict(flight.extra)
    return {"name": flight.name, "outcome": summary["outcome"], "lateral_m": summary["lateral_error"],
            "start": [round(extra[key], 3) for key in ("world.start.offset.x", "world.start.offset.y",
                                                       "world.start.yaw_offset")],
            "picture": embedded(path, 200)}
