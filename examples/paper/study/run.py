# SPDX-License-Identifier: Apache-2.0
"""Runs flights with `mebots sweep`. Each kind of flight is a study. The study's journal records the completed flights."""

import collections
import csv
import dataclasses
import json
import pathlib
import shutil
import sys
import time

from missions import FIRST_CHIP, config
from results import PASSED


@dataclasses.dataclass(frozen=True)
class Place:
    """The folders of programs and results, the number of parallel flights, and the chip."""
    build: pathlib.Path
    results: pathlib.Path
    jobs: int
    chip: str = FIRST_CHIP

    def sweep(self, *arguments, **options):
        """Calls mebots.sweep of this build in this process."""
        sys.path.insert(0, str(self.build / "python"))
        import mebots

        return mebots.sweep(*arguments, jobs=self.jobs, **options)


def write_study(name, flights, folder, chip):
    """Writes the files of a study with these flights as designs. They may differ only in parameters. `mebots sweep` can also run
    the study. Returns the study's file."""
    folder.mkdir(parents=True, exist_ok=True)
    mission = config(flights[0], chip)
    mission["text"] = name
    varied = list(flights[0].parameters(chip))
    for variable in varied:
        instance, parameter = variable.split(".", 1)
        del mission["instances"][instance]["parameters"][parameter]
    (folder / "mission.json").write_text(json.dumps(mission, indent=2) + "\n")
    with open(folder / "designs.csv", "w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(varied)
        rows.writerows([flight.parameters(chip)[variable] for variable in varied] for flight in flights)
    study = {
        "text": f"{name}: {len(flights)} flights",
        "mission": "mission.json",
        "design": {"kind": "list", "file": "designs.csv"},
        "objectives": {"success": {"outcome": list(PASSED)}, "charge": {"summary": "state_of_charge", "unit": "1"}},
        "results": True,
    }
    (folder / "study.json").write_text(json.dumps(study, indent=2) + "\n")
    return folder / "study.json"


def studies(flights, chip):
    """Groups flights that differ only in the values of parameters, so that one study can run them. Returns {name of the first
    flight: flights}."""
    groups = collections.defaultdict(list)
    for flight in flights:
        system = config(flight, chip)
        for instance in system["instances"].values():
            del instance["parameters"]
        del system["text"]
        groups[json.dumps([system, list(flight.parameters(chip))])].append(flight)
    return {group[0].name: group for group in groups.values()}


def fly_all(flights, place):
    """Runs all flights. Returns {name: summary} in their order. A summary includes the folder of its files, its cost, and whether
    it was run now. Reuses results of the same programs in the folder. Raises RuntimeError if a flight fails."""
    flown = {}
    for name, group in studies(flights, place.chip).items():
        folder = place.results / "studies" / name
        before = set(_costs(place.results))
        started = time.monotonic()
        place.sweep(write_study(name, group, folder, place.chip), place.results, progress=lambda now, name=name: _tell(name, now))
        print(f"\r\033[K{name}: {len(group)} flights, {time.monotonic() - started:.0f} s", file=sys.stderr)
        for table in ("missions.csv", "report.html"):  # the next study in this folder writes its own tables
            shutil.copyfile(place.results / table, folder / table)
        costs = _costs(place.results)
        with open(folder / "missions.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        for flight, row in zip(group, rows, strict=True):
            mission = row["mission"]
            if row["message"]:
                raise RuntimeError(f"{flight.name}: {row['message']}")
            files = place.results / "flights" / mission[:2] / mission
            summary = json.loads((files / "summary.json").read_text())
            flown[flight.name] = {**summary, **costs[mission], "folder": str(files), "fresh": mission not in before}
    return {flight.name: flown[flight.name] for flight in flights}


def fly(flight, place):
    """Runs one flight. Returns its summary."""
    return fly_all([flight], place)[flight.name]


def _costs(folder):
    """Returns {mission: processor time [s] and peak memory [MB] of its process}."""
    journal = folder / "journal.jsonl"
    records = map(json.loads, journal.read_text().splitlines() if journal.exists() else [])
    return {one["mission"]: {"processor_s": one["processor_time"], "memory_mb": one.get("memory_mb", 0.0)} for one in records}


def _tell(name, now):
    print(f"\r\033[K{name}: {now.flown} flown, at most {now.most_left} left ({now.rate_per_s:.2f} a second)", end="",
          file=sys.stderr, flush=True)
