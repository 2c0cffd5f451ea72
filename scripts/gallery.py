#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Answers the questions of the site's front page (docs/index.md) with the commands on the page, and draws the pictures.

    scripts/gallery.py BUILD [--results DIR] [--check | --short]

BUILD is a build folder with the programs and FMUs. The commands run in a temporary folder, or in DIR, which keeps the results for
the next call. ``--check`` draws nothing: it compares the output of the commands with the page. ``--short`` does the same with one
flight per design: the best design must be the page's, and all values must be close to the page's.
"""

import argparse
import csv
import dataclasses
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/index.md"
PICTURES = ROOT / "docs/img"
PYTHON = ROOT / ".venv/bin/python"


@dataclasses.dataclass(frozen=True)
class Question:
    """A section of the page: its heading, one command, the lines of the command's output that are the answer, and a picture."""

    title: str
    command: str
    answer: list[str]
    picture: str

    @property
    def name(self):
        """Returns the name, such as ``battery`` of ``question_battery.png``. It is also the name of the results folder.
        """
        return self.picture.removeprefix("question_").removesuffix(".png")


def read_questions(page=PAGE):
    """Returns the questions below the heading "Five questions". Raises ValueError if a section lacks a part."""
    chapter = page.read_text(encoding="utf-8").split("\n## Five questions\n")[1].split("\n## ")[0]
    questions = []
    for section in chapter.split("\n### ")[1:]:
        title = section.split("\n")[0]
        commands = re.findall(r"^    (\S.*?)(?:  +#.*)?$", section, re.MULTILINE)
        answers = re.findall(r"^```none\n(.*?)^```$", section, re.MULTILINE | re.DOTALL)
        pictures = re.findall(r"!\[[^\]]+\]\(img/(question_\w+\.png)\)", section)
        if not (len(commands) == len(answers) == len(pictures) == 1):
            raise ValueError(f"{page.name}: '{title}' has {len(commands)} commands, {len(answers)} answers and {len(pictures)} pictures; it needs one of each")
        questions.append(Question(title, commands[0], answers[0].splitlines(), pictures[0]))
    return questions


def ask(question, build, folder):
    """Runs the command of a question in a folder, as a user runs it in a checkout. Returns its output."""
    if not (folder / "configs").exists():
        (folder / "configs").symlink_to(ROOT / "configs")
    environment = os.environ | {
        "PATH": f"{build / 'bin'}:{os.environ['PATH']}", "PYTHONPATH": str(build / "python"), "MEBOTS_PYTHON": str(PYTHON)}
    done = subprocess.run(["bash", "-c", question.command], cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=600)
    if done.returncode != 0:
        raise RuntimeError(f"{question.command}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def missing_lines(question, output):
    """Returns the lines of the page's answer that the output lacks, or has in another order. "..." means any lines."""
    lines = [line.rstrip() for line in output.splitlines()]
    missing, at = [], 0
    for wanted in question.answer:
        if wanted.strip() in ("", "..."):
            continue
        if wanted.rstrip() in lines[at:]:
            at = lines.index(wanted.rstrip(), at) + 1
        else:
            missing.append(wanted)
    return missing


def shorten_studies(folder):
    """Writes a copy of configs/ in which each study has one mission per design."""
    shutil.copytree(ROOT / "configs", folder / "configs")
    for file in (folder / "configs/questions").glob("*.json"):
        study = json.loads(file.read_text(encoding="utf-8"))
        if "draws" in study:
            study["draws"]["replicates"] = 1
        file.write_text(json.dumps(study), encoding="utf-8")


def stated_values(lines):
    """Reads headlines and rows of tables. Returns {key: (value, low, high)} and the set of best designs. A key contains the
    objective or column and the design."""
    texts, best = {}, []
    for line in lines:
        if headline := re.match(r"(?:Lowest|Highest) (\S+) .*: (.+), (-?\d+(?:\.\d+)?(?: \w+)?(?: \([^)]*\))?)\. ", line):
            texts[headline[1], headline[2]] = headline[3]
            best.append(headline[2])
        elif re.match(r"\d+ +#\d+ ", line):
            cells = re.split("  +", line.strip())
            texts |= {(column, cells[2]): text for column, text in enumerate(cells[4:], 4)}
            best += [cells[2]] if cells[-1].startswith("best") else []
    values = {}
    for key, text in texts.items():
        if found := re.match(r"(-?\d+(?:\.\d+)?)(?! of )[^(]*(?:\((-?[\d.]+) to (-?[\d.]+)\))?$", text):
            values[key] = tuple(float(one or found[1]) for one in found.groups())
    return values, best


def far_values(question, output):
    """Returns the values of a shortened study that contradict the page's answer. A value must be within the page's interval,
    widened on each side by the interval's width and 0.1 % of the value.
    """
    (page, page_best), (values, best) = stated_values(question.answer), stated_values(output.splitlines())
    if not page or not page_best:
        raise ValueError(f"{PAGE.name}: '{question.title}' states no value that a short study could have")
    wrong = [f"best design {name}" for name in page_best if name not in best]
    for key, (value, low, high) in page.items():
        margin = high - low + 1e-3 * abs(value)
        if key not in values or not low - margin <= values[key][0] <= high + margin:
            wrong.append(f"{key[1]}: {value:g} (it has {values.get(key, ('nothing',))[0]})")
    return wrong


def table(folder, name):
    with open(folder / name, newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def columns(folder, factor, objective, scale=1.0):
    """Returns the designs' values of a factor, and the mean and both ends of the interval of an objective. If a design has no
    interval, both ends are the mean."""
    names, means, ends = [], [], ([], [])
    for row in table(folder, "designs.csv"):
        mean = float(row[f"{objective}: mean"])
        names.append(row[factor])
        means.append(scale * mean)
        for end, title in zip(ends, ("low", "high"), strict=True):
            end.append(scale * float(row[f"{objective}: {title}"] or mean))
    return names, means, ends


def draw_bars(axis, names, values, label, colour, digits):
    """Draws horizontal bars with their values, in the order of the study from top to bottom."""
    axis.barh(names[::-1], values[::-1], color=colour, height=0.62)
    for place, value in enumerate(values[::-1]):
        axis.annotate(f"{value:.{digits}f}", (value, place), xytext=(4, 0), textcoords="offset points", va="center", fontsize=9)
    axis.set(xlabel=label, xlim=(0, 1.16 * max(values)))


def draw_battery(folder, style):
    figure, (left, right) = style.plt.subplots(1, 2, figsize=(7.6, 2.2), sharey=True, layout="constrained")
    names, joules, _ = columns(folder, "battery.cell.name", "energy")
    draw_bars(left, names, joules, "energy of the flight [J]", style.BLUE, 1)
    _, charges, _ = columns(folder, "battery.cell.name", "charge", 100)
    draw_bars(right, names, [100 - charge for charge in charges], "charge used [%]", style.OCHRE, 2)
    return figure


def draw_clock(folder, style):
    figure, axis = style.plt.subplots(figsize=(7.6, 2.2), layout="constrained")
    names, joules, _ = columns(folder, "cluster", "chip", 1e3)
    draw_bars(axis, names, joules, "energy of the chip [mJ]", style.BLUE, 1)
    return figure


def draw_payload(folder, style):
    figure, axis = style.plt.subplots(figsize=(7.6, 2.4), layout="constrained")
    names, seconds, _ = columns(folder, "payload", "hover time")
    axis.plot([float(name.split()[0]) for name in names], seconds, "o-", color=style.BLUE)
    for name, value in zip(names, seconds, strict=True):
        axis.annotate(f"{value:.0f} s", (float(name.split()[0]), value), xytext=(6, 5), textcoords="offset points", fontsize=9)
    axis.set(xlabel="payload [g]", ylabel="hover [s]", ylim=(0, 1.15 * max(seconds)), xlim=(-0.5, 16.5))
    return figure


def draw_gust(folder, style):
    figure, axis = style.plt.subplots(figsize=(7.6, 2.4), layout="constrained")
    names, misses, (low, high) = columns(folder, "gust", "miss", 100)
    speeds = [0.0 if name == "none" else float(name.split()[0]) for name in names]
    axis.vlines(speeds, low, high, color=style.BLUE, lw=6, alpha=0.3)
    axis.plot(speeds, misses, "o-", color=style.BLUE)
    for row, speed, miss in zip(table(folder, "designs.csv"), speeds, misses, strict=True):
        text = f"{row['success: successes']} of {row['success: of']} passed"
        axis.annotate(text, (speed, miss), xytext=(0, -16), textcoords="offset points", ha="center", fontsize=8, color=style.INK)
    axis.set(xlabel="speed of the gust [m/s]", ylabel="off the middle [cm]", ylim=(-3, 1.1 * max(high)), xlim=(-0.35, 4.35))
    return figure


def draw_energy(folder, style):
    figure, (left, right) = style.plt.subplots(1, 2, figsize=(7.6, 2.6), width_ratios=(1.9, 1), layout="constrained")
    rows = table(folder, "results.csv")
    times = [float(row["time [s]"]) for row in rows]
    span = 10  # number of rows in 0.3 s, so that the figure shows the mean of the controller's switching
    loads = {"motors": style.BLUE, "avionics": style.OCHRE, "chip": style.VERMILION, "camera": style.GREEN}
    energies = {name: [float(row[f"battery.{'soc' if name == 'chip' else name}.energy [J]"]) for row in rows] for name in loads}
    powers = {name: [(values[i] - values[i - span]) / (times[i] - times[i - span]) for i in range(span, len(rows))] for name, values in energies.items()}
    left.stackplot(times[span:], list(powers.values()), colors=list(loads.values()), alpha=0.85, lw=0)
    left.set(xlabel="time [s]", ylabel="power [W]", xlim=(0, times[-1]), ylim=(0, None))
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["energy"]
    joules = [summary["soc" if name == "chip" else name] for name in loads]
    right.barh(list(loads)[::-1], joules[::-1], color=list(loads.values())[::-1], height=0.62)
    for place, value in enumerate(joules[::-1]):
        right.annotate(f"{value:.3g} J", (value, place), xytext=(4, 0), textcoords="offset points", va="center", fontsize=9)
    right.set(xlabel="energy [J], logarithmic", xscale="log", xlim=(1e-2, 1e4))
    return figure


DRAW = {"battery": draw_battery, "clock": draw_clock, "payload": draw_payload, "gust": draw_gust, "energy": draw_energy}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path, help="build folder with the programs and FMUs")
    parser.add_argument("--results", type=pathlib.Path, help="folder that keeps the results")
    parser.add_argument("--check", action="store_true", help="compare the answers with the page, and draw nothing")
    parser.add_argument("--short", action="store_true", help="as --check, with one flight of each design")
    parser.add_argument("--only", metavar="NAME", help="one question, by the last word of its picture")
    arguments = parser.parse_args()
    asked, failed = 0, False
    with tempfile.TemporaryDirectory() as scratch:
        folder = (arguments.results or pathlib.Path(scratch)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        if arguments.short:
            shorten_studies(folder)
        for question in read_questions():
            if arguments.only not in (None, question.name):
                continue
            asked += 1
            output = ask(question, arguments.build.resolve(), folder)
            missing = far_values(question, output) if arguments.short else missing_lines(question, output)
            for line in missing:
                print(f"{PAGE.name}: '{question.title}' states, but the command does not print: {line}")
            if missing:
                print(output)
            failed = failed or bool(missing)
            if not (arguments.check or arguments.short):
                import figure_style as style  # imported here, because a check does not need matplotlib

                style.save(DRAW[question.name](folder / "results" / question.name, style), PICTURES / question.picture)
    if asked == 0:
        sys.exit(f"{PAGE.name}: no question has a picture question_{arguments.only}.png")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
