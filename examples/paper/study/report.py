# SPDX-License-Identifier: Apache-2.0
"""The report: one HTML file that needs nothing else."""

import html
import json

import matplotlib.pyplot as plt

import figures
import targets
from missions import BATTERIES, ROOT, scenario

SHOWN = ("0.1", "0.2", "0.3", "adaptive")
STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;color:#222}
table{border-collapse:collapse;margin:1rem 0;font-size:.93em}td,th{border-bottom:1px solid #ddd;padding:.25rem .6rem;
text-align:left;vertical-align:top}th{background:#f3f3f3}td.number{text-align:right;white-space:nowrap;
font-variant-numeric:tabular-nums}svg{max-width:100%;height:auto}caption{text-align:left;font-weight:600;padding:.2rem 0}
figure{display:inline-block;margin:.3rem .6rem .3rem 0;width:200px;font-size:.8em;vertical-align:top}"""


class Number(str):
    """A text of a table that stands to the right."""


def table(head, rows, caption=""):
    def cell(content):
        kind = " class=number" if isinstance(content, Number) else ""
        return f"<td{kind}>{html.escape(str(content))}</td>"
    cells = "".join(f"<th>{html.escape(h)}</th>" for h in head)
    body = "".join("<tr>" + "".join(map(cell, row)) + "</tr>" for row in rows)
    return f"<table><caption>{html.escape(caption)}</caption><tr>{cells}</tr>{body}</table>"


def n(value, digits=1):
    return Number("-" if value is None else f"{value:.{digits}f}")


class Page:
    """Collects the parts of the page, and keeps each figure as a picture beside it."""

    def __init__(self, out):
        self.folder = out / "figures"
        self.folder.mkdir(exist_ok=True)
        self.parts = []

    def figure(self, name, figure):
        figure.savefig(self.folder / f"{name}.png", dpi=110, metadata={"Software": None})
        self.parts.append(figures.svg(figure))
        plt.close(figure)

    def text(self, *parts):
        self.parts += parts


def experiment_a(page, data):
    page.text("<h2>Experiment A: batteries</h2>")
    page.figure("batteries", figures.batteries(data["batteries"]["used"]))
    outcomes = ", ".join(f"{count} {name.replace('_', ' and ')}" for name, count in data["batteries"]["outcomes"].items())
    page.text(f"<p>Outcomes: {outcomes}.</p>",
              table(("battery", "hover s", "cruise at 1.5 km/h s"),
                    [(BATTERIES[b][0], n(t["hover"], 0), n(t["cruise"], 0)) for b, t in data["endurance"].items()],
                    "Flight time from take-off to landing at 10 % charge"))


def title(name, flight):
    gate = f"gate after {flight['gate_s']:.0f} s, " if flight["gate_s"] else ""
    return ((name if name == "adaptive" else f"{name} km/h") + f": {flight['outcome'].replace('_', ' and ')}\n"
            + f"{gate}{flight['charge']:.1f} % left")


def experiment_b(page, data):
    flights = data["speeds"]["flights"]
    page.text("<h2>Experiment B: speeds</h2>")
    page.figure("trajectories", figures.trajectories(
        [flights[name] for name in SHOWN], [title(name, flights[name]) for name in SHOWN],
        scenario("hard")["world.scene.name"], data["speeds"]["first_view"]))
    page.text(table(("speed km/h", "outcome", "at the gate s", "path to it m", "charge left %", "off the middle cm"),
                    [(name, f["outcome"].replace("_", " and "), n(f["gate_s"]), n(f["path_m"], 2), n(f["charge"], 2),
                      n(100 * f["lateral_m"])) for name, f in flights.items()]))


def robustness(page, data):
    page.text("<h2>From starts drawn at random</h2>")
    for name, part in data["robustness"].items():
        forwards, sideways, turned = part["spread"]
        page.text(
            f"<p><b>{name}: {part['passed']} of {part['flights']} passed, "
            f"{100 * part['passed'] / part['flights']:.1f} %</b> (95 % confidence, Wilson: {100 * part['low']:.1f} to "
            f"{100 * part['high']:.1f} %). {html.escape(str(part['outcomes']))}. Starts up to {forwards} m forwards or "
            f"back, {sideways} m sideways, {turned} rad turned; the camera's noise differs too. "
            f"Straight on, without looking, {100 * part['straight']:.0f} % would meet the opening.</p>")
        page.figure(f"starts_{name}", figures.starts(part["ways"], scenario(name)["world.scene.name"]))
        for failed in part["failures"]:
            page.text(f"<figure><img src='{failed['picture']}' alt='view near the gate'><figcaption>{failed['name']}: "
                      f"{failed['outcome']}, {100 * failed['lateral_m']:+.0f} cm; start {failed['start']}; the view a metre "
                      "before the gate</figcaption></figure>")


def clocks(page, data):
    page.text("<h2>The cluster's clock</h2><p>The hard flight with the adaptive policy from the same random starts at "
              "each clock, at the least voltage that allows it, the fabric controller at 50 MHz. Times and energies up "
              "to the gate are means over the flights that passed. Front: no other clock is as good in time, "
              "energy of the chip and success, and better in one.</p>")
    page.figure("clocks", figures.clocks(data["clocks"]))
    page.text(table(("cores", "MHz", "V", "passed", "95 % confidence", "touched", "pictures/s", "chip mW", "gate s",
                     "chip J", "front"),
                    [(n(r["cores"], 0), n(r["clock_mhz"], 0), n(r["voltage_v"], 2), Number(f"{r['passed']} of {r['flights']}"),
                      Number(f"{100 * r['low']:.0f} to {100 * r['high']:.0f} %"), n(r["touched"], 0),
                      n(r["pictures_per_s"]), n(r["chip_mw"], 2), n(r["gate_s"], 1), n(r["chip_j"], 3),
                      "front" if r["front"] else "") for r in data["clocks"]]))


def joules(page, data):
    page.text("<h2>Where the joules go</h2>")
    shown = {"hard, adaptive": data["speeds"]["phases"], "easy, 1 km/h": data["batteries"]["phases"]}
    page.figure("joules", figures.phases(shown))
    for name, phases in shown.items():
        consumers = list(next(iter(phases.values())))
        rows = [(phase, *(n(e[c], 3) for c in consumers), n(sum(e.values()), 2)) for phase, e in phases.items()]
        sums = [sum(e[c] for e in phases.values()) for c in consumers]
        rows.append(("all", *(n(s, 3) for s in sums), n(sum(sums), 2)))
        page.text(table(("phase", *consumers, "all"), rows, f"{name}, J"))
    chip, pictures = data["speeds"]["chip"], data["speeds"]["pictures"]
    total = sum(chip.values())
    page.text(table(("part", "mJ", "%", "uJ a picture"),
                    [(part.replace("_", " "), n(1e3 * j), n(100 * j / total), n(1e6 * j / pictures, 2))
                     for part, j in sorted(chip.items(), key=lambda item: -item[1])],
                    f"The chip's joules in the hard adaptive flight, {pictures:.0f} pictures"))


def speed(page, data):
    page.text("<h2>What it costs to fly</h2>")
    flights, costs = data["speeds"]["flights"], data["costs"]
    wall = f", {data['wall_s']:.0f} s with {data['jobs']} flights at a time" if data.get("wall_s") else ""
    page.text(f"<p>Both experiments: {costs['flights']} flights, {costs['simulated_s']:.0f} s of flight, "
              f"{costs['processor_s']:.0f} s of processor time{wall}. Most memory of a flight: "
              f"{costs['memory_mb']:.0f} MB.</p>")
    page.text(table(("hard flight", "flown s", "processor s", "times real time", "memory MB"),
                    [(name, n(f["simulated_s"]), n(f["processor_s"]), n(f["simulated_s"] / f["processor_s"]),
                      n(f["memory_mb"], 0)) for name, f in flights.items()],
                    "30 pictures a second, on one core, by processor time"))
    profile = data["speeds"]["profile"]
    page.text(table(("part", "s", "%"), [(name, n(s, 2), n(100 * s / sum(profile.values()))) for name, s in profile.items()],
                    "Where the time of the adaptive hard flight goes"))


def sources():
    data = json.loads((ROOT / "examples/paper/scenarios.json").read_text())
    return [(name, key, entry["value"], entry["source"]) for name, entries in data.items()
            for key, entry in entries.items()]


def write(data, out):
    """Writes report.html and its figures; returns the table of targets as lines of text."""
    page = Page(out)
    page.text("<h1>The paper's study, flown again</h1>",
              "<p>The drone's firmware on the simulated chip, its network on every picture, instruction by instruction; "
              "world, motors and battery around it.</p>")
    lines = []
    if "speeds" in data:
        rows = targets.rows(data)
        experiment_a(page, data)
        experiment_b(page, data)
        page.text("<h2>Targets</h2>", table(("target", "what", "paper", "ours", "difference", "reason"), rows))
        lines = [f"{target:18} {what:52} paper {paper:16} ours {ours:16} {difference}"
                 for target, what, paper, ours, difference, _ in rows]
    if "robustness" in data:
        robustness(page, data)
    if "clocks" in data:
        clocks(page, data)
    if "speeds" in data:
        joules(page, data)
        speed(page, data)
    page.text("<h2>What was assumed</h2>", table(("scenario", "parameter", "value", "source"), sources()))
    (out / "report.html").write_text(
        "<!doctype html><html lang='en'><meta charset='utf-8'><title>MEbots: the paper's study</title>"
        f"<style>{STYLE}</style><body>" + "\n".join(page.parts) + "</body></html>\n")
    return lines
