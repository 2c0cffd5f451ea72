# SPDX-License-Identifier: Apache-2.0
"""Writes the report in two forms from the same parts: an HTML file without dependencies, and REPORT.md with its pictures."""

import html
import json
import math

import chips
import figures
import targets
from experiments import STUCK_S
from landing import STEP, least
from missions import BATTERIES, FIRST_CHIP, MOTORS, ROOT, SECOND_CHIP, scenario
from replay import READINGS

SHOWN = ("0.1", "0.2", "0.3", "adaptive")
# The path of the pictures, relative to REPORT.md. `study.py --publish` copies the pictures there.
PICTURES = "../../docs/img/paper_"
STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:70rem;margin:2rem auto;padding:0 1rem;color:#222}
table{border-collapse:collapse;margin:1rem 0;font-size:.9em}td,th{border-bottom:1px solid #ddd;padding:.25rem .6rem;
text-align:left;vertical-align:top}th{background:#f3f3f3}td.number{text-align:right;white-space:nowrap;
font-variant-numeric:tabular-nums}svg{max-width:100%;height:auto}caption{text-align:left;font-weight:600;padding:.2rem 0}
figure{display:inline-block;margin:.3rem .6rem .3rem 0;width:200px;font-size:.8em;vertical-align:top}"""


class Number(str):
    """Marks a text that a table aligns to the right."""


def n(value, digits=1):
    return Number("-" if value is None else f"{value:.{digits}f}")


def plain(outcome):
    return outcome.replace("_", " ")


class Page:
    """Collects the parts of the page in both forms. Stores each figure as a picture next to the page."""

    def __init__(self, out):
        self.folder = out / "figures"
        self.folder.mkdir(exist_ok=True)
        self.html, self.markdown = [], []

    def heading(self, text, level=2):
        self.html.append(f"<h{level}>{html.escape(text)}</h{level}>")
        self.markdown.append(f"{'#' * level} {text}")

    def text(self, text):
        self.html.append(f"<p>{html.escape(text)}</p>")
        self.markdown.append(text)

    def figure(self, name, title, figure):
        self.html.append(figures.svg(figure))
        self.markdown.append(f"![{title}]({PICTURES}{name}.png)")
        figures.style.save(figure, self.folder / f"{name}.png")

    def table(self, head, rows, caption=""):
        def cell(content):
            kind = " class=number" if isinstance(content, Number) else ""
            return f"<td{kind}>{html.escape(str(content))}</td>"
        cells = "".join(f"<th>{html.escape(h)}</th>" for h in head)
        body = "".join("<tr>" + "".join(map(cell, row)) + "</tr>" for row in rows)
        self.html.append(f"<table><caption>{html.escape(caption)}</caption><tr>{cells}</tr>{body}</table>")
        lines = ["| " + " | ".join(map(str, line)) + " |" for line in (head, ["---"] * len(head), *rows)]
        self.markdown.append((f"{caption}:\n\n" if caption else "") + "\n".join(lines))

    def picture(self, url, text, link=None):
        """Embeds a picture in the HTML file only. `link` is the page of the flight, in the report's folder."""
        picture = f"<img src='{url}' alt='view near the gate'>"
        linked = f"<a href='{html.escape(link)}'>{picture}</a>" if link else picture
        more = f" <a href='{html.escape(link)}'>See it fly</a>" if link else ""
        self.html.append(f"<figure>{linked}<figcaption>{html.escape(text)}{more}</figcaption></figure>")

    def write(self, out, title):
        (out / "report.html").write_text(
            f"<!doctype html><html lang='en'><meta charset='utf-8'><title>{title}</title><style>{STYLE}</style><body>"
            + "\n".join(self.html) + "</body></html>\n")
        (out / "REPORT.md").write_text("\n\n".join(self.markdown) + "\n")


def all_targets(page, rows):
    page.heading("Targets")
    page.text("The paper names its motor model, but not the other loads and losses that it includes. Column \"bench motors\" has the motors of "
              "MEbots, measured on Bitcraze's bench, the flight controller's 0.96 W and the cell's resistance. The next column has the paper's "
              "motors instead. Each further column leaves out one more load or loss. The last three columns were not flown: the battery "
              "model was run with the recorded powers of a flight (study/replay.py). A dash means that the value was not computed with these motors.")
    page.table(("target", "what", "paper", "bench motors", *(label for label, _, _ in READINGS.values()), "what it depends on"),
               [(row.target, row.what, row.paper, *row.texts(), row.tells) for row in rows])


def life(entry):
    if entry["crashed"]:
        return f"fell: protection opened at {entry['opens']:.1f} %"
    return f"landed with {entry['charge']:.1f} %"


def endurance(page, data):
    page.heading("Endurance and end of each flight")
    rows = [(MOTORS[motors], BATTERIES[battery][0], kind, n(entry["to_ten_s"], 0), n(entry["air_s"], 0), life(entry))
            for motors, lives in data["lives"].items() for battery, kinds in lives.items()
            for kind, entry in kinds.items() if kind != "empty"]
    fell = {motors: sum(entry["crashed"] for kinds in lives.values() for kind, entry in kinds.items() if kind != "empty")
            for motors, lives in data["lives"].items()}
    flights = 2 * len(BATTERIES)
    page.text("The drone begins to land at 10 % charge, as in the paper. It falls if the cell's voltage drops below the 2.8 V of the protection "
              "before the drone has landed. Then the motors stop, and the drone hits the ground at more than 1 m/s. " + " ".join(
                  f"With the {MOTORS[motors]}, {count} of {flights} flights end in a fall." for motors, count in fell.items())
              + " Times start when the drone leaves the ground.")
    page.table(("motors", "battery", "flight", "until 10 % are left [s]", "in the air [s]", "end"), rows)
    if "landing" in data:
        landing(page, data)


def landing(page, data):
    page.heading("The charge at which a landing must begin", 3)
    page.text("In these flights, the drone hovers at 1 m and begins to land at a different charge in each flight. A landing takes 3.5 s. The "
              "drone lands under power if the protection does not open during the landing. A smaller cell has a higher resistance "
              "for the same current, so the drone must begin to land at a higher charge. With the bench motors, 10 %, which the paper uses for "
              "all cells, is too low for the two cells of 250 mAh.")
    rows = [(MOTORS[motors], BATTERIES[battery][0], n(entry["opens"]),
             ", ".join(f"{f['charge']:.1f}" for f in entry["flights"] if f["landed"]) or "-",
             ", ".join(f"{f['charge']:.1f}" for f in entry["flights"] if not f["landed"]) or "-",
             n(least(entry)))
            for motors, cells in data["landing"].items() for battery, entry in cells.items()]
    page.table(("motors", "battery", "protection opens in hover at [%]", "landed under power from [%]", "fell from [%]",
                f"least charge, to {STEP} % [%]"), rows)
    page.figure("landing", "Least charge for a landing under power", figures.landing(data["landing"]))
    if "ends" in data:
        page.figure("ends", "The last seconds of two flights: fell, landed", figures.ends(data["ends"]))


def batteries(page, data):
    page.heading("Experiment A: batteries")
    page.figure("batteries", "Charge used by battery and speed", figures.batteries(data["batteries"]["used"]))
    told = ", ".join(f"{count} {plain(name)}" for name, count in data["batteries"]["outcomes"].items())
    page.text(f"24 flights with the bench's motors: {told}.")


def title(name, flight):
    gate = f"plane after {flight['gate_s']:.0f} s, " if flight["gate_s"] else ""
    return ((name if name == "adaptive" else f"{name} km/h") + f": {plain(flight['outcome'])}\n"
            + f"{gate}{flight['charge']:.1f} % left")


def speeds(page, data):
    flights = data["speeds"]
    page.heading("Experiment B: speeds")
    page.figure("trajectories", "Four flights through the hard gate", figures.trajectories(
        [flights[name] for name in SHOWN], [title(name, flights[name]) for name in SHOWN],
        scenario("hard")["world.scene.name"], data["adaptive"]["first_view"]))
    page.table(("speed [km/h]", "outcome", "at the plane [s]", "on the ground [s]", "path to the plane [m]", "charge left [%]",
                "off the centre [cm]"),
               [(name, plain(f["outcome"]), n(f["gate_s"]), n(f["end_s"]), n(f["path_m"], 2), n(f["charge"], 2),
                 n(None if f["lateral_m"] is None else 100 * f["lateral_m"])) for name, f in flights.items()])
    page.text("The figure shows the adaptive flight over time. When the drone is free of the frame, it flies back at 5 km/h. The likely "
              "cause is the stabiliser's integrals, which had pushed against the frame for 50 s; we did not examine it.")
    page.figure("course", "Time course of the hard adaptive flight", figures.course(data["adaptive"]["course"]))


def robustness(page, data):
    page.heading("From starts drawn at random")
    page.text("A flight passes if the drone's centre crosses the opening and the drone lands behind the frame without touching it. "
              "Intervals are 95 % (Wilson). "
              f"A flight ends {STUCK_S:.0f} s after the world has reported that the drone is stuck.")
    page.table(("starts", "flights", "passed", "95 %", "without a touch", "crossed the opening", "not passed", "would pass in a straight line"),
               [(name, n(part["flights"], 0), n(part["passed"], 0),
                 Number(" to ".join(f"{100 * x:.0f}" for x in part["interval"]) + " %"), n(part["clean"], 0),
                 n(part["crossed"], 0),
                 ", ".join(f"{count} {plain(o)}" for o, count in part["outcomes"].items()
                           if o not in ("passed", "touched_passed")) or "none",
                 Number(f"{100 * part['straight']:.0f} %")) for name, part in data["robustness"].items()])
    for name, part in data["robustness"].items():
        forwards, sideways, turned = part["spread"]
        page.text(f"{name}: each start is moved by up to {forwards} m forwards or back and {sideways} m sideways, and turned by up to {turned} rad. "
                  "The camera's noise also differs.")
        page.figure(f"starts_{name}", f"Random starts: {name}", figures.starts(part, scenario(name)["world.scene.name"]))
        failures(page, name, part["failures"])


def failures(page, name, found):
    if not found:
        return
    page.text(f"{name}: {len(found)} flights that did not pass, each with the camera's picture a metre before the gate. "
              "`examples/paper/run.sh --parts hard` repeats these flights, records everything, and writes a page for each. Then a click on "
              "a picture opens the page of the flight.")
    page.markdown.append(f"![The camera's picture a metre before the gate]({PICTURES}failures_{name}.png)")
    figures.style.save(figures.failures(found), page.folder / f"failures_{name}.png")
    for failed in found:
        forwards, left, turned = failed["start"]
        page.picture(failed["picture"], f"{figures.short_name(failed['name'])}: {plain(failed['outcome'])}. It began "
                     f"{100 * abs(forwards):.0f} cm {'nearer' if forwards > 0 else 'farther away'}, {100 * abs(left):.0f} cm to the "
                     f"{'left' if left > 0 else 'right'}, turned by {math.degrees(turned):.1f} degrees.", failed.get("replay"))


def clocks(page, data):
    page.heading("The cluster's clock")
    page.text("The table has the hard flight with the adaptive policy, from the same random starts at each clock. The voltage is the "
              "lowest that the clock allows, and the fabric controller runs at 50 MHz. Values are means over the flights that "
              "crossed the opening. Ten flights per row are too few to compare the rates of success, so only energy is compared.")
    page.figure("clocks", "The chip's energy up to the gate by clock and cores", figures.clocks(data["clocks"]))
    page.table(("cores", "clock [MHz]", "supply [V]", "crossed", "pictures/s", "chip [mW]", "at the gate [s]", "chip up to it [J]"),
               [(n(r["cores"], 0), n(r["clock_mhz"], 0), n(r["voltage_v"], 2), Number(f"{r['crossed']} of {r['flights']}"),
                 n(r["pictures_per_s"]), n(r["chip_mw"], 2), n(r["gate_s"]), n(r["chip_j"], 3)) for r in data["clocks"]])


def joules(page, data):
    page.heading("Energy by consumer")
    shown = {"hard, adaptive": data["adaptive"]["phases"], "easy, 1 km/h": data["batteries"]["phases"]}
    page.figure("joules", "Joules by phase and consumer", figures.phases(shown))
    for name, phases in shown.items():
        consumers = list(next(iter(phases.values())))
        rows = [(phase, *(n(e[c], 3) for c in consumers), n(sum(e.values()), 2)) for phase, e in phases.items()]
        sums = [sum(e[c] for e in phases.values()) for c in consumers]
        rows.append(("all", *(n(s, 3) for s in sums), n(sum(sums), 2)))
        page.table(("phase", *consumers, "all"), rows, f"{name}, in J")
    chip, pictures = data["adaptive"]["chip"], data["adaptive"]["pictures"]
    total = sum(chip.values())
    page.table(("part", "mJ", "%", "uJ a picture"),
               [(part.replace("_", " "), n(1e3 * j), n(100 * j / total), n(1e6 * j / pictures, 2))
                for part, j in sorted(chip.items(), key=lambda item: -item[1])],
               f"The chip's joules in the hard adaptive flight, {pictures:.0f} pictures")


def what_it_rests_on(page, data):
    page.heading("Sources and assumptions")
    for line in data.get("notes", []):
        page.text(line)
    page.text("If the battery model is run with the recorded loads of the hard flights, the charge differs by at most "
              f"{data['readings']['error']:.2f} % of the capacity.")
    sources = json.loads((ROOT / "examples/paper/scenarios.json").read_text())
    page.table(("scenario", "parameter", "value", "source"),
               [(name, key, entry["value"], entry["source"]) for name, entries in sources.items()
                for key, entry in entries.items()], "Assumed values")


def numbers(rows, texts):
    """Aligns all cells after the first `texts` cells of each row to the right."""
    return [(*row[:texts], *map(Number, row[texts:])) for row in map(tuple, rows)]


def on_both_chips(page, data, second_data):
    """Adds the comparison of both chips to a page. `second_data` contains the results of the second chip."""
    first, second = FIRST_CHIP, SECOND_CHIP
    both = {first: data, second: second_data}
    page.heading("The same flights on GAP8's own devices")
    page.text(f"All results above are for board {first}, which has MEbots' own devices. Its camera needs 16.7 ms for a picture, as in the "
              "paper, and starts the exposure when the picture of the co-simulation has arrived. "
              f"Board {second} has GAP8's own devices and an HM01B0, whose rows take 20.2 ms. The sensor draws its active current for a "
              "frame of 21.6 ms. So it can take the study's 30 pictures per second, but not the paper's 60. Application, network, "
              "world, starts and seeds are the same for both boards, and both cameras see the same in the middle of the picture.")
    page.text("Checks against silicon allow " + " and ".join(
        "{:.2f} to {:.2f} times the joules of {}'s chip".format(*chips.bounds(of), chip) for chip, of in both.items())
        + ". These ranges are not confidence intervals.")
    for told in (chips.describe_experiments, chips.describe_decisions, chips.describe_joules):
        page.text(" ".join(told(both)))
    if "landing" not in second_data:
        page.text(f"Not flown with {second}: the search for the charge at which a landing must begin, which has steps of {STEP} %.")
    bench, read = chips.of_targets(data, second_data)
    page.table(("target", "what", "paper", first, second), bench, "Targets, bench motors")
    page.table(("target", "what", "reading", first, second), read, "Targets, other readings")
    chip_columns = ("chip [J]", "camera [J]", "chip's part of the cell's joules [%]")
    page.table(("speed [km/h]", "chip", "outcome", "at the plane [s]", "off the centre [cm]", "charge left [%]", "pictures", "latency [ms]",
                *chip_columns), numbers(chips.of_speeds(both), 3), "Experiment B")
    page.text(f"Experiment A: the charges used in the 24 easy flights are at most {chips.charge_apart(data, second_data):.3f} % of the "
              f"capacity apart. With {second}: "
              + ", ".join(f"{count} {plain(name)}" for name, count in second_data["batteries"]["outcomes"].items()) + ".")
    page.table(("speed [km/h]", "chip", "outcome", "charge used [%]", "pictures", "latency [ms]", "read-out [ms]", "inference [ms]",
                *chip_columns), numbers(chips.of_easy(both), 3), "Easy flights, standard battery")
    page.table(("motors", "battery", "flight", f"until 10 % are left, {first} [s]", f"{second} [s]", f"end, {first}", f"end, {second}"),
               list(chips.of_lives(data, second_data)), "Endurance")
    if "robustness" in data:
        starts_of_both(page, both)
    if "clocks" in data:
        clocks_of_both(page, both)
    page.table(("part", f"{first} [mJ]", "%", f"{second} [mJ]", "%"), numbers(chips.of_parts(both), 1),
               "The chip's joules in the hard adaptive flight")


def clocks_of_both(page, both):
    page.figure("chips", "The chip's energy up to the gate by clock, cores and chip",
                figures.chips({chip: (of["clocks"], chips.bounds(of)) for chip, of in both.items()}))
    page.text("The energy is least " + "; ".join(
        f"with {chip} at {chips.least(of['clocks'], 8)} MHz on eight cores and at {chips.least(of['clocks'], 1)} MHz on one"
        for chip, of in both.items()) + ".")
    page.table(("cores", "clock [MHz]", "supply [V]", "chip", "crossed", "pictures/s", "at the gate [s]", "chip [mW]", "chip up to it [J]"),
               numbers(chips.of_clocks(both), 4), "The cluster's clock")


def starts_of_both(page, both):
    page.table(("starts", "chip", "flights", "passed", "95 %", "without a touch", "crossed the opening", "not passed"),
               numbers(chips.of_starts(both), 2), "From the random starts that both flew")
    for name in chips.scenarios_of_both(*both.values()):
        page.text(chips.describe_starts(both, name))
    page.text("The adaptive policy slows down where the magnitude of the mean of ten outputs is above 0.3. The noise and the times of the "
              "pictures depend on the chip. So the rates of the two chips can be compared, but single starts cannot.")


def write(data, out, second_data=None):
    """Writes report.html, REPORT.md and their figures. Returns the lines of the table of targets. `data` contains the results of
    the first of CHIPS, `second_data` those of the second."""
    page = Page(out)
    page.heading("The paper's study, flown again", 1)
    page.text("See how the results of the paper compare with those of MEbots. In every flight, the simulated chip executes the drone's "
              "firmware and its network instruction by instruction, together with models of world, motors and battery. "
              "`study/study.py` writes this page.")
    lines = []
    if "speeds" in data:
        rows = targets.rows(data)
        all_targets(page, rows)
        endurance(page, data)
        batteries(page, data)
        speeds(page, data)
        lines = [f"{row.target:18} {row.what:60} paper {row.paper:20} ours {' | '.join(row.texts())}" for row in rows]
    if "robustness" in data:
        robustness(page, data)
    if "clocks" in data:
        clocks(page, data)
    if "speeds" in data:
        joules(page, data)
        if second_data is not None and "decisions" in data:
            on_both_chips(page, data, second_data)
        what_it_rests_on(page, data)
    page.write(out, "MEbots: the paper's study")
    return lines
