# SPDX-License-Identifier: Apache-2.0
"""Runs all FMUs for co-simulation below a folder that have a binary for 64-bit Windows. Prints tables by tool and by FMU.

    windows_corpus.py FOLDER MEBOTS [--json FILE] [--match TEXT]

An FMU without a binary for Linux runs under wine for STEPS steps. An FMU with both binaries runs twice, once with each binary,
and all values at all communication points are compared. The step is 0.01 s. If an FMU refuses it, the step is that of its default
experiment, or 0.1 s. For a slow FMU, the step is 0.0001 s. Files with the same bytes count once. The exit code is 1 if the values
of a pair differ, or if no FMU ran on Windows.
"""

import argparse
import csv
import hashlib
import json
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from compare import NAMES

STEPS = 20
SECONDS = 100
FOLDERS = {"windows": NAMES["win64"], "linux": NAMES["linux64"]}


class Archive:
    """An FMU's platforms, tool and step sizes to try. Reads the description as text, because some descriptions of the corpus are not
    well-formed."""

    def __init__(self, path):
        with zipfile.ZipFile(path) as packed:
            self.names = [name.replace("\\", "/") for name in packed.namelist()]
            text = packed.read("modelDescription.xml").decode(errors="replace")
        self.path = path
        self.cosimulation = "<CoSimulation" in text
        library = self._attribute(text[text.find("<CoSimulation"):], "modelIdentifier")
        self.version = self._attribute(text, "fmiVersion")
        self.tool = re.split(r" (?:Compiler|Tool|Version)|,| ?v?\d+\.| \(", self._attribute(text, "generationTool"))[0].strip() or "(not said)"
        self.platforms = {platform for platform, (fmi2, fmi3, suffix) in FOLDERS.items()
                          if {f"binaries/{fmi2}/{library}{suffix}", f"binaries/{fmi3}/{library}{suffix}"} & set(self.names)}
        self.start_s = float(self._attribute(text, "startTime") or 0)
        own_step = self._attribute(text, "stepSize")
        float(own_step or 0)  # raises ValueError, as that of the start does
        self.steps = dict.fromkeys(["0.01", own_step, "0.1", "0.0001"])
        self.steps.pop("", None)

    @staticmethod
    def _attribute(text, name):
        found = re.search(rf'\b{name}\s*=\s*"([^"]*)"', text)
        return found[1] if found else ""

    def with_one_platform(self, platform, target):
        """Writes a copy whose only binaries are those of `platform`."""
        keep = tuple(f"binaries/{name}/" for name in FOLDERS[platform][:2])
        with zipfile.ZipFile(self.path) as packed, zipfile.ZipFile(target, "w") as copy:
            for name, member in zip(self.names, packed.infolist()):
                if not name.endswith("/") and (not name.startswith("binaries/") or name.startswith(keep)):
                    copy.writestr(name, packed.read(member))


def run(program, fmu, start_s, step, folder, *more):
    """Returns the recorded rows, or the reason why there are none."""
    out = folder / "out"
    stop = str(start_s + STEPS * float(step))
    command = [program, "run", fmu, "--isolate", "--quiet", "--step", step, "--stop-time", stop, "--out", out, *more]
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, timeout=SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return None, f"does not end within {SECONDS} s"
    if done.returncode != 0:
        lines = [line for line in done.stderr.decode(errors="replace").splitlines() if line.strip()]
        errors = [line for line in lines if "error" in line.lower()]
        reason = re.sub(r"\s+", " ", (errors or lines or [f"exit code {done.returncode}"])[0])
        return None, reason.replace("|", "/").replace(str(folder) + "/", "")[:230]
    with (out / "results.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file)), "runs"


def try_steps(program, fmu, start_s, steps, folder):
    """Runs the FMU with one step size after the other until a run succeeds. Returns its rows, its outcome and the step size. If
    no run succeeds, returns None, the outcome of the first run, and None."""
    first = None
    for step in steps:
        rows, outcome = run(program, fmu, start_s, step, folder, "--record", "*")
        if rows is None and "no variable that can be recorded" in outcome:
            rows, outcome = run(program, fmu, start_s, step, folder)
        if rows is not None:
            return rows, outcome, step
        first = first or outcome
    return None, first, None


def values_of(rows):
    """Returns all values except those in the column of time."""
    return [value for row in rows[1:] for value in row[1:]]


def changing_columns(rows):
    """Returns the number of recorded variables that change. If it is 0, the FMU runs to its end without computing anything.
    """
    return sum(len(set(column)) > 1 for column in list(zip(*rows[1:]))[1:])


def relative_difference(one, other):
    try:
        a, b = float(one), float(other)
    except ValueError:
        return float("inf")
    return abs(a - b) / max(abs(a), abs(b), sys.float_info.min)


def examine_pair(program, archive, folder):
    found, step = {}, None
    for platform in ("linux", "windows"):
        fmu = folder / f"{platform}.fmu"
        archive.with_one_platform(platform, fmu)
        rows, outcome, used = try_steps(program, fmu, archive.start_s, [step] if step else archive.steps, folder)
        found[platform] = (rows, outcome)
        step = step or used
    result = {platform: outcome for platform, (_, outcome) in found.items()}
    if any(rows is None for rows, _ in found.values()):
        return result
    expected, values = (values_of(rows) for rows, _ in found.values())
    different = [pair for pair in zip(expected, values) if pair[0] != pair[1]]
    result |= {"values": len(expected), "equal": len(expected) - len(different) if len(expected) == len(values) else 0,
               "largest": max((relative_difference(*pair) for pair in different), default=0.0)}
    return result


def examine(program, archive, base):
    row = {"fmu": str(archive.path.relative_to(base)), "tool": archive.tool, "version": archive.version, "pair": "linux" in archive.platforms}
    with tempfile.TemporaryDirectory(prefix="corpus") as folder:
        if row["pair"]:
            return row | examine_pair(program, archive, Path(folder))
        rows, outcome, step = try_steps(program, archive.path.resolve(), archive.start_s, archive.steps, Path(folder))
        return row | {"windows": outcome, "step": step, "values": len(values_of(rows)) if rows else 0,
                      "changing": changing_columns(rows) if rows else 0}


def archives_below(base):
    seen = set()
    for path in sorted(base.rglob("*.fmu")):
        digest = hashlib.sha256(path.read_bytes()).digest()
        if digest in seen:
            continue
        seen.add(digest)
        try:
            archive = Archive(path)
        except (zipfile.BadZipFile, KeyError, ValueError) as error:
            print(f"{path}: left out: {error}", file=sys.stderr)
            continue
        if archive.cosimulation and "windows" in archive.platforms:
            yield archive


def runs(row, platform):
    return row[platform].startswith("runs")


def show(rows):
    alone, pairs = ([row for row in rows if row["pair"] == pair] for pair in (False, True))
    both = [row for row in pairs if "values" in row]
    print("| tool | Windows alone | run | with values that change | with both binaries | run on Windows | run on Linux | values of both | equal |\n" + "|---" * 9 + "|")
    for name in [*sorted({row["tool"] for row in rows}), "all"]:
        def of(selected, name=name):
            return [row for row in selected if name in (row["tool"], "all")]
        print(f"| {name} | {len(of(alone))} | {sum(runs(row, 'windows') for row in of(alone))} | "
              f"{sum(row['changing'] > 0 for row in of(alone))} | {len(of(pairs))} | "
              f"{sum(runs(row, 'windows') for row in of(pairs))} | {sum(runs(row, 'linux') for row in of(pairs))} | "
              f"{sum(row['values'] for row in of(both))} | {sum(row['equal'] for row in of(both))} |")
    print("\nWindows alone, not run:")
    for row in alone:
        if not runs(row, "windows"):
            print(f"- {row['fmu']} [{row['tool']}, FMI {row['version']}]: {row['windows']}")
    print("\nWindows alone, run, but no recorded value changes:")
    for row in alone:
        if runs(row, "windows") and not row["changing"]:
            print(f"- {row['fmu']} [{row['tool']}, FMI {row['version']}]: {row['values']} values")
    print("\nBoth binaries, one of them does not run:")
    for row in pairs:
        if "values" not in row:
            print(f"- {row['fmu']} [{row['tool']}, FMI {row['version']}]: Linux: {row['linux']}; Windows: {row['windows']}")
    print("\nBoth binaries, different values:")
    for row in both:
        if row["equal"] != row["values"]:
            print(f"- {row['fmu']} [{row['tool']}, FMI {row['version']}]: {row['equal']} of {row['values']} equal, largest relative difference "
                  f"{row['largest']:.1e}")
    return any(runs(row, "windows") for row in rows) and all(row["equal"] == row["values"] for row in both)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("program", type=Path, metavar="MEBOTS")
    parser.add_argument("--json", type=Path, help="write the rows there, and take those of an earlier run from there")
    parser.add_argument("--match", default="", help="only FMUs whose path has this text")
    arguments = parser.parse_args()
    base = arguments.folder.resolve()
    rows = json.loads(arguments.json.read_text(encoding="utf-8")) if arguments.json and arguments.json.exists() else []
    done = {row["fmu"] for row in rows}
    for archive in archives_below(base):
        name = str(archive.path.relative_to(base))
        if arguments.match not in name or name in done:
            continue
        rows.append(examine(arguments.program.resolve(), archive, base))
        print(json.dumps(rows[-1]), file=sys.stderr, flush=True)
        if arguments.json:  # after each FMU, because a long run may be interrupted
            arguments.json.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    return 0 if show(rows) else 1


if __name__ == "__main__":
    sys.exit(main())
