# SPDX-License-Identifier: Apache-2.0
"""Every FMU below a folder through `mebots check`, `run`, `run --isolate`, and FMPy at the same times (scripts/corpus.sh).

Each FMU runs alone with its start values, from its default experiment's start on: with the experiment's step where it says one, else
a hundredth of its length, at most 1000 steps. Times are whole nanoseconds divided by 1e9 in both tools. All numeric outputs are
compared at every communication point. Files of the same bytes count once. What is explained: an FMU that both refuse, one that
mebots stops at NaN or infinity (FMPy goes on with it), one that neither brings to its end in time, and differences that FMPy shows
against itself when it runs twice.
"""

import argparse
import concurrent.futures
import csv
import ctypes
import hashlib
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import zipfile

import fmpy
import fmpy.fmi2

POINTERS = (".base.lo", ".base.hi", ".size")
MOST_STEPS = 1000
SECONDS = 60   # of processor time, for one tool and one FMU
LATE = f"error: not done after {SECONDS} s"
SAME = 1e-12   # relative: rounding of sums in another order


def nanoseconds(seconds):
    return round(seconds * 1e9)


def family(tool):
    """OpenModelica Compiler OMCompiler v1.13.0-dev -> OpenModelica"""
    name = re.split(r" (?:Compiler|Tool|Version)|,| ?v?\d+\.| \(", tool)[0].strip()
    return name if name and name != "none" else "(not said)"


class NotOurs(Exception):
    """No FMI 2.0 co-simulation FMU for this machine."""


def plan(fmu):
    """What is run: names of outputs by type, start, step and number of steps in nanoseconds."""
    try:
        with zipfile.ZipFile(fmu) as archive:
            members = set(archive.namelist())
        model = fmpy.read_model_description(str(fmu), validate=False)
    except Exception as error:  # whatever FMPy makes of a broken package
        raise NotOurs(f"cannot be read: {short(str(error))}") from error
    if model.fmiVersion != "2.0":
        raise NotOurs(f"FMI {model.fmiVersion}")
    if model.coSimulation is None:
        raise NotOurs("model exchange only")
    if f"binaries/linux64/{model.coSimulation.modelIdentifier}.so" not in members:
        raise NotOurs("no binary for linux64")
    experiment = model.defaultExperiment
    start = float(experiment.startTime or 0) if experiment else 0.0
    stop = float(experiment.stopTime or start + 1) if experiment else start + 1
    step = float(experiment.stepSize) if experiment and experiment.stepSize else (stop - start) / 100
    fixed = getattr(model.coSimulation, "fixedInternalStepSize", None)
    if fixed and not (experiment and experiment.stepSize):
        step = float(fixed)
    step_ns = max(nanoseconds(step), 1)
    steps = min(MOST_STEPS, max(1, (nanoseconds(stop) - nanoseconds(start)) // step_ns))
    outputs = {v.name: ("Integer" if v.type == "Enumeration" else v.type, v.valueReference) for v in model.modelVariables
               if v.causality == "output" and v.type != "String" and not v.name.endswith(POINTERS)}
    return {"fmu": str(fmu), "tool": family(model.generationTool or ""), "outputs": outputs, "start_ns": max(nanoseconds(start), 0), "step_ns": step_ns, "steps": int(steps)}


def short(text, length=110):
    line = re.sub(r"\s+", " ", re.sub(r"/\S*/", "", text)).replace("|", "/").strip()
    return line if len(line) <= length else line[: length - 3] + "..."


def complaint(result):
    lines = [line for line in result.stderr.splitlines() if "error" in line]
    return short((lines or result.stderr.splitlines() or [f"ended with code {result.returncode}"])[-1])


def call(command, **more):
    """Runs a program; a run past the time is an answer too. Its texts need not be UTF-8."""
    late = subprocess.CompletedProcess(command, 124, "", LATE)
    try:
        result = subprocess.run(["prlimit", f"--cpu={SECONDS}:{SECONDS + 1}", *command], capture_output=True, text=True,
                                errors="replace", timeout=10 * SECONDS, **more)
    except subprocess.TimeoutExpired:
        return late
    return late if result.returncode == -signal.SIGXCPU or "SIGXCPU" in result.stderr else result


def run_mebots(program, what, folder, *more):
    config = {"step": what["step_ns"] / 1e9, "start_time": what["start_ns"] / 1e9,
              "stop_time": (what["start_ns"] + what["steps"] * what["step_ns"]) / 1e9, "connections": [],
              "instances": {"it": {"fmu": what["fmu"]}}, "record": [f"it.{name}" for name in what["outputs"]]}
    (folder / "config.json").write_text(json.dumps(config))
    out = folder / "out"
    result = call([program, "run", folder / "config.json", "--out", out, "--quiet", *more], cwd=folder)
    if result.returncode != 0:
        return {"error": complaint(result)}
    with (out / "results.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    names = [name.rsplit(" [", 1)[0].removeprefix("it.") for name in header]
    return {"columns": {name: [float(row[k]) for row in rows] for k, name in enumerate(names) if k > 0}}


def run_fmpy(what, folder):
    (folder / "what.json").write_text(json.dumps(what))
    result = call([sys.executable, __file__, "--fmpy", folder / "what.json", folder / "columns.json"], cwd=folder)
    if result.returncode != 0:
        return {"error": complaint(result)}
    return {"columns": json.loads((folder / "columns.json").read_text())}


def fmpy_child(what, target):
    model = fmpy.read_model_description(what["fmu"], validate=False)
    slave = fmpy.fmi2.FMU2Slave(guid=model.guid, unzipDirectory=fmpy.extract(what["fmu"]), instanceName="it",
                                modelIdentifier=model.coSimulation.modelIdentifier)
    slave.instantiate()
    end_ns = what["start_ns"] + what["steps"] * what["step_ns"]
    slave.setupExperiment(startTime=what["start_ns"] / 1e9, stopTime=end_ns / 1e9)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    by_type = {}
    for name, (kind, reference) in what["outputs"].items():
        by_type.setdefault(kind, []).append((name, reference))
    columns = {name: [] for name in what["outputs"]}

    def read():
        for kind, variables in by_type.items():
            values = getattr(slave, "get" + kind)([reference for _, reference in variables])
            for (name, _), value in zip(variables, values):
                columns[name].append(float(value))

    read()
    for k in range(what["steps"]):
        try:
            slave.doStep(currentCommunicationPoint=(what["start_ns"] + k * what["step_ns"]) / 1e9,
                         communicationStepSize=what["step_ns"] / 1e9)
        except fmpy.fmi1.FMICallException as error:
            terminated = fmpy.fmi2.fmi2Boolean(0)
            slave.fmi2GetBooleanStatus(slave.component, fmpy.fmi2.fmi2Terminated, ctypes.byref(terminated))
            if error.status != fmpy.fmi2.fmi2Discard or not terminated.value:
                raise
            break  # the FMU ends the simulation
        read()
    pathlib.Path(target).write_text(json.dumps(columns))
    sys.stdout.flush()
    os._exit(0)  # what an FMU does when it is freed is not compared


def difference(one, other):
    """The largest difference relative to the largest value of its column, and where it is."""
    largest, place = 0.0, ""
    for name, values in one.items():
        if len(values) != len(other[name]):
            return math.inf, f"{name} has {len(values)} and {len(other[name])} points"
        scale = max((abs(v) for v in values if math.isfinite(v)), default=0.0) or 1.0
        for k, (a, b) in enumerate(zip(values, other[name])):
            if a == b or (math.isnan(a) and math.isnan(b)):
                continue
            gap = abs(a - b) / scale if math.isfinite(a - b) else math.inf
            if gap > largest:
                largest, place = gap, f"{name} at step {k}"
    return largest, place


def judge(row, what, folder):
    """Fills in the row's verdict; the sign says whether it is explained."""
    ours, alone, theirs = row.pop("ours"), row.pop("alone"), row.pop("theirs")
    row["run"] = "runs" if "columns" in ours else ours["error"]
    row["FMPy"] = "runs" if "columns" in theirs else theirs["error"]
    row["isolated"] = "as run"
    if ours.get("error") == LATE and theirs.get("error") == LATE:  # alone, host and master have the limit each
        row["isolated"] = alone.get("error", "runs")
        row["verdict"], row["explained"] = "neither is done in time", True
        return
    if ("columns" in ours) != ("columns" in alone):
        row["isolated"] = alone.get("error", "runs")
        row["verdict"], row["explained"] = "isolation differs", False
        return
    if "columns" in ours and difference(ours["columns"], alone["columns"])[0] != 0:
        gap, place = difference(ours["columns"], alone["columns"])
        row["isolated"] = f"{gap:.1e} ({place})"
    if "columns" not in ours or "columns" not in theirs:
        if "columns" not in ours and "columns" not in theirs:
            row["verdict"], row["explained"] = "both refuse", True
        elif "columns" in ours:
            row["verdict"], row["explained"] = "runs here only", True
        else:
            at_nan = re.search(r" is (-?nan|-?inf)\b", ours["error"]) is not None
            row["verdict"], row["explained"] = ("stopped at NaN" if at_nan else "runs in FMPy only"), at_nan
        return
    gap, place = difference(theirs["columns"], ours["columns"])
    row["difference"] = gap
    if gap == 0 and row["isolated"] == "as run":
        row["verdict"], row["explained"] = "same bits", True
    elif gap <= SAME and row["isolated"] == "as run":
        row["verdict"], row["explained"] = f"{gap:.0e}", True
    else:
        again = run_fmpy(what, folder)
        own = difference(theirs["columns"], again["columns"])[0] if "columns" in again else math.inf
        row["explained"] = own > 0
        row["verdict"] = f"{gap:.1e} ({place})" + (f"; FMPy against itself {own:.1e}" if own > 0 else "")


def examine(program, base, fmu):
    row = {"fmu": str(fmu.relative_to(base))}
    try:
        what = plan(fmu)
    except NotOurs as why:
        return row | {"verdict": "left out", "why": str(why), "explained": True}
    with tempfile.TemporaryDirectory(prefix="corpus") as name:
        folders = [pathlib.Path(name) / part for part in ("check", "run", "isolated", "fmpy", "again")]
        for folder in folders:
            folder.mkdir()
        checked = call([program, "check", fmu], cwd=folders[0])
        row["check"] = {0: "clean", 1: "findings", 2: "cannot be used", 124: "not done"}.get(checked.returncode,
                                                                                         f"code {checked.returncode}")
        row |= {"tool": what["tool"], "points": what["steps"] + 1, "outputs": len(what["outputs"]),
                "ours": run_mebots(program, what, folders[1]), "alone": run_mebots(program, what, folders[2], "--isolate"),
                "theirs": run_fmpy(what, folders[3])}
        judge(row, what, folders[4])
    return row


def different(fmus):
    """One of each, and how many more there are of the same bytes."""
    first, repeated = {}, 0
    for fmu in fmus:
        digest = hashlib.sha256(fmu.read_bytes()).digest()
        repeated += digest in first
        first.setdefault(digest, fmu)
    return list(first.values()), repeated


def word_of(row):
    """The verdict as a class."""
    if not re.match(r"\d", row["verdict"]):
        return row["verdict"]
    return "within 1e-12" if row["difference"] <= SAME else "numbers differ"


def show(rows, repeated):
    print("| FMU | check | mebots | isolated | FMPy | outputs x points | result |\n|---|---|---|---|---|---|---|")
    for row in rows:
        if row["verdict"] == "left out":
            continue
        print(f"| {row['fmu']} | {row['check']} | {row['run']} | {row['isolated']} | {row['FMPy']} | "
              f"{row['outputs']} x {row['points']} | {row['verdict']}{'' if row['explained'] else ' (unexplained)'} |")
    table = {}
    for row in rows:
        line = table.setdefault(row.get("tool", "left out"), {})
        for key in ("all", word_of(row)):
            line[key] = line.get(key, 0) + 1
        line["largest"] = max(line.get("largest", 0), row.get("difference", 0))
        if row.get("check") == "clean":
            line["clean"] = line.get("clean", 0) + 1
    others = table.pop("left out", {"all": 0})["all"]
    words = sorted({word_of(row) for row in rows if row["verdict"] != "left out"})
    print("\n| tool | FMUs | " + " | ".join(words) + " | largest difference | clean by check |\n" + "|---" * (len(words) + 4) + "|")
    for tool, line in sorted(table.items(), key=lambda item: -item[1]["all"]):
        print(f"| {tool} | {line['all']} | " + " | ".join(str(line.get(word, "")) for word in words) +
              f" | {line['largest']:.0e} | {line.get('clean', 0)} |")
    print(f"\n{len(rows)} different FMUs, and {repeated} more files of the same bytes; {others} left out:")
    for row in rows:
        if row["verdict"] == "left out":
            print(f"left out: {row['fmu']}: {row['why']}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path, help="write the rows there too")
    parser.add_argument("--jobs", type=int, default=1, help="FMUs at the same time")
    parser.add_argument("--match", default="", help="only FMUs whose path holds this text")
    arguments = parser.parse_args()
    base = arguments.folder.resolve()
    fmus = [fmu for fmu in sorted(base.rglob("*.fmu")) if arguments.match in str(fmu.relative_to(base)) and fmu.is_file()]
    if not fmus:
        sys.exit(f"corpus: no FMU below {base}")
    fmus, repeated = different(fmus)
    rows = []
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for row in pool.map(lambda fmu: examine(arguments.program.resolve(), base, fmu), fmus):
            rows.append(row)
            print(f"{len(rows)}/{len(fmus)} {row['fmu']}: {row['verdict']}", file=sys.stderr)
    show(rows, repeated)
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1) + "\n")
    unexplained = [row["fmu"] for row in rows if not row["explained"]]
    if unexplained:
        sys.exit(f"corpus: unexplained: {', '.join(unexplained)}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--fmpy"]:
        fmpy_child(json.loads(pathlib.Path(sys.argv[2]).read_text()), sys.argv[3])
    else:
        main()
