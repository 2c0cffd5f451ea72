# SPDX-License-Identifier: Apache-2.0
"""Runs the paper's two experiments, and further parts on request. Writes the report.

Reuses results of earlier runs with the same programs, so an interrupted study continues.
"""

import argparse
import collections
import dataclasses
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

import check
import collect
import experiments
import landing
import report
from missions import CHIPS, FIRST_CHIP, MODELS, MOTORS, ROOT, SECOND_CHIP
from results import PASSED
from run import Place, fly_all

PARTS = ("experiments", "landing", "clocks", *experiments.SPREAD)
PUBLISHED = {FIRST_CHIP: ROOT / "examples/paper/results.json", SECOND_CHIP: ROOT / "examples/paper/results_gap8.json"}
STARTS_PER_CLOCK = 20  # one in this many of a scenario's random starts is also run at each clock


def fly_experiments(place, data):
    """Runs both experiments of the paper. If no results were reused, stores their duration."""
    in_the_air = {motors: experiments.endurance(motors) + experiments.empties(motors) for motors in MOTORS}
    started = time.monotonic()
    summaries = fly_all(experiments.speeds() + sum(in_the_air.values(), []) + experiments.batteries(), place)
    if all(s["fresh"] for s in summaries.values()):
        data["wall_s"], data["jobs"] = time.monotonic() - started, place.jobs
    data["models"] = MODELS
    data["costs"] = collect.costs(summaries)
    data["batteries"] = collect.batteries({n: s for n, s in summaries.items() if n.startswith("a-")})
    data["lives"] = {motors: collect.lives(summaries, motors) for motors in MOTORS}
    data["speeds"] = collect.speeds(summaries)
    data["decisions"] = collect.decisions({n: s for n, s in summaries.items() if n.startswith(("a-bitcraze_250", "b-"))})
    data["adaptive"] = collect.adaptive(summaries["b-adaptive"])
    data["readings"] = collect.readings(place.build / "fmus/fmu_battery.fmu", summaries)


def fly_landings(place, data):
    data["landing"] = {motors: landing.fly(place, motors) for motors in MOTORS}
    # Takes the last failed and the first successful landing with the standard battery.
    charges = [landing.least(data["landing"]["bench"]["bitcraze_250"]) - landing.STEP * too_low for too_low in (1, 0)]
    flights = [experiments.landing("bench", "bitcraze_250", charge) for charge in charges]
    flown = fly_all(flights, place)
    data["ends"] = [{"charge": charge, "landed": landing.under_power(flown[flight.name]),
                     "course": collect.last_seconds(flown[flight.name])} for charge, flight in zip(charges, flights)]


def fly_clocks(place, data, count):
    flights = experiments.clocks(count)
    data["clocks"] = collect.clocks(flights, fly_all([f for group in flights.values() for f in group], place))


def replay(place, name, summary):
    """Writes the page of a flight. Returns its path relative to the report."""
    file = place.results.parent / "replays" / f"{name}.html"
    file.parent.mkdir(exist_ok=True)
    subprocess.run([place.build / "bin/mebots", "report", summary["folder"], "--out", file], check=True, stdout=subprocess.DEVNULL)
    return file.relative_to(place.results.parent).as_posix()


def fly_starts(place, data, name, count, pages):
    """Runs random starts of a scenario. Repeats the first `pages` flights that fail, each for a separate page."""
    flights = experiments.starts(name, count, seed=1)
    summaries = fly_all(flights, place)
    part = collect.robustness(name, flights, summaries)
    failed = [f for f in flights if summaries[f.name]["outcome"] not in PASSED][:pages]
    again = [dataclasses.replace(f, name=f"{f.name}-replay", replay=True) for f in failed]
    if again:
        pictured = fly_all(again, place)
        part["failures"] = [{**collect.failure(f, pictured[f.name]), "replay": replay(place, f.name, pictured[f.name])} for f in again]
    data.setdefault("robustness", {})[name] = part


def fly_failed_again(place, data, name, count):
    """Repeats the first `count` starts of a scenario that did not pass before, with this build. Keeps all other results. Prints
    the changes."""
    part = data["robustness"][name]
    before = {way["name"]: way["outcome"] for way in part["ways"]}
    flights = [f for f in experiments.starts(name, part["flights"], seed=1) if before[f.name] not in PASSED][:count]
    part = data["robustness"][name] = collect.flown_again(name, part, fly_all(flights, place))
    after = {way["name"]: way["outcome"] for way in part["ways"]}
    for (was, now), count in collections.Counter((before[f.name], after[f.name]) for f in flights).items():
        print(f"{name}: {count} {was} -> {now}")


def check_published(count, place):
    """Repeats published flights. If a flight differs from the published flight, returns exit code 1."""
    published = json.loads(PUBLISHED[place.chip].read_text())
    differ = 0
    for name, found in check.differences(published, count, place):
        differ += bool(found)
        print(f"{name}: " + ("as published" if not found else "; ".join(
            key if key == "way" else f"{key} {now}, published {before}" for key, (before, now) in found.items())))
    return 1 if differ else 0


def published_beside(chip):
    """Returns the second chip's published data for the first chip's report. If the data of the two chips are from different
    models, returns None."""
    if chip != FIRST_CHIP:
        return None
    first, second = (json.loads(PUBLISHED[one].read_text()) for one in (FIRST_CHIP, SECOND_CHIP))
    return second if second.get("models") == first.get("models") else None


def publish(chip, data, folder):
    """Stores the results of a chip's flights, the report of both chips (REPORT.md) and its figures in the repository."""
    PUBLISHED[chip].write_text(json.dumps(data) + "\n")
    folder.mkdir(exist_ok=True)
    report.write(json.loads(PUBLISHED[FIRST_CHIP].read_text()), folder, published_beside(FIRST_CHIP))
    (ROOT / "examples/paper/REPORT.md").write_text((folder / "REPORT.md").read_text())
    for figure in (folder / "figures").glob("*.png"):
        shutil.copyfile(figure, ROOT / f"docs/img/paper_{figure.name}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release", help="folder of the build")
    parser.add_argument("--chip", choices=list(CHIPS), default=FIRST_CHIP, help="the chip that flies: its board")
    parser.add_argument("--out", type=pathlib.Path, help="folder to write to: default results/paper, of another chip results/paper_CHIP")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="flights at a time")
    parser.add_argument("--parts", nargs="*", choices=PARTS, default=["experiments", "landing"], help="what to fly; shipped, easy and hard are random starts; none: report only")
    parser.add_argument("--count", type=int, default=200, help="random starts of each scenario; at most so many again")
    parser.add_argument("--pages", type=int, metavar="N", help="make pages of N random starts that do not pass: default all")
    parser.add_argument("--data", type=pathlib.Path, help="what was found, added to: default OUT/data.json")
    parser.add_argument("--check", type=int, metavar="N", help="fly N flights of each part again, and compare with what is published")
    parser.add_argument("--failed-again", choices=list(experiments.SPREAD), metavar="SCENARIO", help="fly the random starts again that did not pass")
    parser.add_argument("--publish", action="store_true", help="also put data and figures where the README shows them")
    arguments = parser.parse_args()

    chip = arguments.chip
    out = (arguments.out or ROOT / "results" / ("paper" if chip == FIRST_CHIP else f"paper_{chip}")).resolve()
    out.mkdir(parents=True, exist_ok=True)
    place = Place(arguments.build.resolve(), out / "flights", arguments.jobs, chip)
    if arguments.check:
        return check_published(arguments.check, place)
    kept = arguments.data or out / "data.json"
    data = json.loads(kept.read_text()) if kept.exists() else {}
    for part in (part for part in PARTS if part in arguments.parts):
        print(f"{part}:", file=sys.stderr)
        if part == "experiments":
            fly_experiments(place, data)
        elif part == "landing":
            fly_landings(place, data)
        elif part == "clocks":
            fly_clocks(place, data, max(1, arguments.count // STARTS_PER_CLOCK))
        else:
            fly_starts(place, data, part, arguments.count, arguments.pages)
        kept.write_text(json.dumps(data) + "\n")
    if arguments.failed_again:
        fly_failed_again(place, data, arguments.failed_again, arguments.count)
        kept.write_text(json.dumps(data) + "\n")
    for line in report.write(data, out, published_beside(chip)):
        print(line)
    if arguments.publish:
        publish(chip, data, out / "published")
    print(f"wrote {out / 'report.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
