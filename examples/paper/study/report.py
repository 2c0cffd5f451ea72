# SPDX-License-Identifier: Apache-2.0
"""The report: one HTML file that needs nothing else."""

import html
import json
import pathlib

import figures
from experiments import EASY_SPEEDS, HARD_SPEEDS
from missions import BATTERIES, ROOT, scenario
from results import ENERGIES, Trace, energy_by_phase

STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}
table{border-collapse:collapse;margin:1rem 0}td,th{border-bottom:1px solid #ccc;padding:.3rem .7rem;text-align:left;
vertical-align:top}th{background:#f3f3f3}svg{max-width:100%;height:auto}caption{text-align:left;font-weight:600}"""


def table(head, rows, caption=""):
    cells = "".join(f"<th>{html.escape(h)}</th>" for h in head)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(str(c))}</td>" for c in row) + "</tr>" for row in rows)
    return f"<table><caption>{html.escape(caption)}</caption><tr>{cells}</tr>{body}</table>"


def consumed(summaries):
    """{battery: {speed: (real, equal)}} charge used in %."""
    def used(battery, speed, kind):
        return 100 * (1 - summaries[f"a-{battery}-{speed}-{kind}"]["state_of_charge"])
    return {battery: {speed: (used(battery, speed, "real"), used(battery, speed, "equal")) for speed in EASY_SPEEDS}
            for battery in BATTERIES}


def flight_times(summaries):
    """{battery: {hover, cruise: s}} from leaving the ground to being back on it."""
    times = {}
    for battery in BATTERIES:
        times[battery] = {}
        for kind in ("hover", "cruise"):
            start, end = Trace(summaries[f"endurance-{battery}-{kind}"]["folder"]).flown()
            times[battery][kind] = end - start
    return times


def hard_flights(summaries):
    """[(name, outcome, time at the gate, path to it, charge left, lateral error)]."""
    rows = []
    for name in [str(s) for s in HARD_SPEEDS] + ["adaptive"]:
        summary = summaries[f"b-{name}"]
        trace = Trace(summary["folder"])
        gate = trace.time_at_gate()
        rows.append({"name": name, "outcome": summary["outcome"], "gate_s": gate,
                     "path_m": trace.path_to(gate) if gate is not None else None,
                     "charge": 100 * summary["state_of_charge"], "lateral_m": summary["lateral_error"],
                     "trace": trace, "folder": summary["folder"]})
    return rows


def targets(used, times, hard):
    """The rows: target, the paper's value, ours, difference, reason."""
    by_name = {row["name"]: row for row in hard}
    rows = []

    def number(target, what, paper, ours, unit, reason):
        rows.append((target, what, f"{paper:g} {unit}", f"{ours:.1f} {unit}", f"{ours - paper:+.1f} {unit}", reason))

    def words(target, what, paper, ours, reason):
        rows.append((target, what, paper, ours, "as the paper" if paper == ours else "other", reason))

    number("T1", "flight time, standard battery, hover", 410, times["bitcraze_250"]["hover"], "s",
           "Motor power is the bench table's, of which 410 s would need 8.1 W at 40 g; the bench draws more. "
           "The flight ends at 10 % charge.")
    for speed, paper in zip(EASY_SPEEDS, (3.0, 3.5, 2.8)):
        standard, ufx = used["bitcraze_250"][speed][0], used["ufx_250"][speed][0]
        number("T2", f"UFX uses less than standard, {speed} km/h", paper, 100 * (1 - ufx / standard), "%",
               "Power goes with mass, less the avionics' constant share: 1.3 g of 40 g are 3.3 %.")
    number("T2", "UFX flies longer than standard", 15,
           times["ufx_250"]["hover"] - times["bitcraze_250"]["hover"], "s", "as above; the paper's is 4 % of 410 s")
    number("T3", "Lipol flies longer than standard", 33,
           100 * (times["lipol_350"]["hover"] / times["bitcraze_250"]["hover"] - 1), "%",
           "40 % more charge for 5 % more mass. The paper's 33 % of 410 s are 135 s, its text says 150 s.")
    for speed in EASY_SPEEDS:
        ratio = 100 * (used["cyclone_300"][speed][1] / used["lipol_350"][speed][1] - 1)
        number("T4", f"Cyclone uses more than Lipol at equal mass, {speed} km/h", 16.5, ratio, "%",
               "350 / 300 = 1.167; the rest is the cells' resistance")
    lighter = all(used[b][s][0] < used[b][s][1] for b in BATTERIES if b != "lipol_350" for s in EASY_SPEEDS)
    words("T5", "every lighter battery uses less with its real mass", "yes", "yes" if lighter else "no", "")
    for speed, paper in zip(HARD_SPEEDS, ("passed", "passed", "touched_passed", "missed", "missed")):
        target = "T6" if speed < 0.25 else "T7 (calibrated on)" if speed == 0.3 else "T8"
        row = by_name[str(speed)]
        words(target, f"hard, {speed} km/h", paper, row["outcome"],
              f"{100 * row['lateral_m']:+.0f} cm off the middle where the plane was crossed")
    for speed, paper in ((0.1, 0.55), (0.2, 1.1)):
        rows.append(("T9", f"distance in 20 s of cruise at {speed} km/h", f"{paper:g} m",
                     f"{distance_in_20_s(by_name[str(speed)]['trace']):.2f} m",
                     f"{distance_in_20_s(by_name[str(speed)]['trace']) - paper:+.2f} m", "v t = 0.56 and 1.11 m"))
    number("T10", "adaptive, time to the gate", 89, by_name["adaptive"]["gate_s"] or float("nan"), "s",
           "follows from yaw-rate scale and lens, which are calibrated on T7 alone")
    for speed, paper in ((0.1, 64), (0.2, 38), (0.3, 17)):
        ours = 100 * (1 - by_name["adaptive"]["gate_s"] / by_name[str(speed)]["gate_s"])
        number("T10", f"adaptive less than {speed} km/h", paper, ours, "%", "the paper's times: 247, 143.5, 107 s")
    number("T11", "charge left, 0.1 km/h", 39.85, by_name["0.1"]["charge"], "%",
           "longer or shorter flight and the bench's power")
    number("T11", "charge left, adaptive", 82.34, by_name["adaptive"]["charge"], "%",
           "The paper contradicts itself here: at its 0.244 % per second, 89 s leave 78.4 %.")
    for speed, paper in ((0.1, 1.0), (0.2, 0.17), (0.3, 1.4)):
        number("T12", f"path, adaptive against {speed} km/h", paper,
               100 * (by_name["adaptive"]["path_m"] / by_name[str(speed)]["path_m"] - 1), "%", "")
    return rows


def distance_in_20_s(trace):
    """Distance flown in 20 s in the middle of the cruise [m]."""
    cruise = trace["world.drone.phase"] == 2
    middle = (trace.time[cruise][0] + (trace.time_at_gate() or trace.time[cruise][-1])) / 2
    return trace.path_to(middle + 10) - trace.path_to(middle - 10)


def sources():
    data = json.loads((ROOT / "examples/paper/scenarios.json").read_text())
    return [(name, key, entry["value"], entry["source"]) for name, entries in data.items()
            for key, entry in entries.items()]


def first_picture(folder):
    """The first picture that the network decided by."""
    found = sorted(pathlib.Path(folder, "pictures").rglob("*.pgm"))
    return found[0] if found else None


def write(summaries, path, wall_s):
    used, times, hard = consumed(summaries), flight_times(summaries), hard_flights(summaries)
    shown = [row for row in hard if row["name"] in ("0.1", "0.2", "0.3", "adaptive")]
    titles = [("adaptive" if row["name"] == "adaptive" else f"{row['name']} km/h")
              + f": {row['outcome'].replace('_', ' and ')}"
              + (f", gate after {row['gate_s']:.0f} s" if row["gate_s"] else "")
              + f", {row['charge']:.1f} % left" for row in shown]
    rows = targets(used, times, hard)
    phases = energy_by_phase(shown[-1]["trace"])
    simulated = sum(s["simulated_time"] for s in summaries.values())
    parts = [
        "<h1>The paper's study, flown again</h1>",
        f"<p>{len(summaries)} flights, {simulated:.0f} s of flight, in {wall_s:.0f} s.</p>",
        "<h2>Experiment A: batteries</h2>", figures.batteries(used),
        table(("battery", "hover s", "cruise at 1.5 km/h s"),
              [(BATTERIES[b][0], f"{t['hover']:.0f}", f"{t['cruise']:.0f}") for b, t in times.items()],
              "Flight time from take-off to landing at 10 % charge"),
        "<h2>Experiment B: speeds</h2>",
        figures.trajectories([row["trace"] for row in shown], titles, scenario("hard")["world.scene.name"],
                             first_picture(shown[0]["folder"])),
        table(("speed km/h", "outcome", "at the gate s", "path to it m", "charge left %", "off the middle m"),
              [(r["name"], r["outcome"], f"{r['gate_s']:.1f}" if r["gate_s"] else "-",
                f"{r['path_m']:.2f}" if r["path_m"] else "-", f"{r['charge']:.2f}", f"{r['lateral_m']:+.3f}")
               for r in hard]),
        "<h2>Targets</h2>", table(("target", "what", "paper", "ours", "difference", "reason"), rows),
        "<h2>Where the joules go (adaptive, hard)</h2>", figures.phases(phases),
        table(("phase", *ENERGIES, "all J"),
              [(name, *(f"{e[c]:.3f}" for c in ENERGIES), f"{sum(e.values()):.2f}") for name, e in phases.items()]),
        "<h2>What was assumed</h2>", table(("scenario", "parameter", "value", "source"), sources()),
    ]
    path.write_text("<!doctype html><html lang='en'><meta charset='utf-8'><title>MEbots: the paper's study</title>"
                    f"<style>{STYLE}</style><body>" + "\n".join(parts) + "</body></html>\n")
    return {"targets": rows, "batteries": used, "flight_times": times, "phases": phases,
            "hard": [{k: v for k, v in row.items() if k != "trace"} for row in hard]}
