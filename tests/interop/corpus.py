# SPDX-License-Identifier: Apache-2.0
"""Runs every FMU below a folder in `mebots check`, `run`, `run --isolate`, and FMPy at the same times (scripts/corpus.sh).

Each FMU runs alone from the start of its default experiment. The step is that of the experiment, or else a hundredth of its
length. A run has at most 1000 steps. Both tools pass the default tolerance and no stop time. Times are whole nanoseconds divided
by 1e9. All numeric outputs are compared at every communication point. Files with the same bytes count once.

Three checks do not depend on another tool. First, truths.py contains exact results of known models, and the inputs for them.
Second, the FMU may come with a reference file. Third, an FMU that permits variable steps also runs with halved steps, and its
error must not grow. Without exact results, |y(h/2) - y(h/4)| must not exceed |y(h) - y(h/2)|.

These cases count as explained: both tools refuse the FMU; mebots stops at NaN or infinity (FMPy continues); neither tool finishes
in time; two runs of FMPy differ, too; the FMU differs from a truth, and EXPLAINED contains the FMU.
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

import truths

POINTERS = (".base.lo", ".base.hi", ".size")
MOST_STEPS = 1000
SECONDS = 60   # of processor time, for one tool and one FMU
LATE = f"error: not done after {SECONDS} s"
SAME = 1e-12   # relative: rounding of sums in another order
HALVED_STEPS = 200  # limit for the number of steps of the coarsest run with halved steps
GROWS = 1.05   # of an error: allowance for rounding of the last point

# FMUs that differ from a known solution for a reason in the FMU itself. The key is the end of the FMU's path. The value is
# the reason, which is printed.
EXPLAINED = {
    "MassSpringDamper1.fmu": "adds its steps of 0.01 s up in floating point; five points are one such step ahead, all others exact to 1e-8",
    "initializer/src/test/resources/watertank-c.fmu": "its level rises by 1 in each step, whatever the step's length",
    "quarter_truck/Wheel.fmu": "controls its own step by a tolerance of 1e-4, which a parameter holds",
}


def nanoseconds(seconds):
    return round(seconds * 1e9)


def family(tool):
    """Returns the family of a tool, such as "OpenModelica" for "OpenModelica Compiler OMCompiler v1.13.0-dev"."""
    name = re.split(r" (?:Compiler|Tool|Version)|,| ?v?\d+\.| \(", tool)[0].strip()
    return name if name and name != "none" else "(not said)"


class NotOurs(Exception):
    """Raised for a file that is not a co-simulation FMU of FMI 2.0 for this machine."""


def plan(fmu):
    """Returns the plan of a run: names of outputs by type, start and step in nanoseconds, and number of steps."""
    try:
        with zipfile.ZipFile(fmu) as archive:
            members = set(archive.namelist())
        model = fmpy.read_model_description(str(fmu), validate=False)
    except Exception as error:  # FMPy raises many kinds of exceptions for a broken package
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
    known = truths.truths_of(fmu, model)
    known = [truth for truth in known if truth.inputs == known[0].inputs]
    inputs = known[0].inputs if known else {}
    if known and known[0].step:
        step_ns, steps = nanoseconds(known[0].step), known[0].steps
    types = {v.name: ("Integer" if v.type == "Enumeration" else v.type, v.valueReference) for v in model.modelVariables}
    start_ns = max(nanoseconds(start), 0)
    times = [(start_ns + k * step_ns) / 1e9 for k in range(int(steps) + 1)]
    for truth in known:
        outputs |= {name: types[name] for name in truth.values(truths.np.array(times[:2])) if name in types}
    what = {"fmu": str(fmu), "tool": family(model.generationTool or ""), "outputs": outputs, "start_ns": start_ns, "step_ns": step_ns,
            "steps": int(steps), "tolerance": float(experiment.tolerance) if experiment and experiment.tolerance else None,
            "inputs": {name: [*types[name], value] for name, value in inputs.items()},
            "variable_step": bool(model.coSimulation.canHandleVariableCommunicationStepSize)}
    return what, known


def short(text, length=110):
    line = re.sub(r"\s+", " ", re.sub(r"/\S*/", "", text)).replace("|", "/").strip()
    return line if len(line) <= length else line[: length - 3] + "..."


def complaint(result):
    lines = [line for line in result.stderr.splitlines() if "error" in line]
    return short((lines or result.stderr.splitlines() or [f"ended with code {result.returncode}"])[-1])


def call(command, **more):
    """Runs a program. If the program exceeds its time, returns this as a result. The program's output may not be UTF-8."""
    late = subprocess.CompletedProcess(command, 124, "", LATE)
    try:
        result = subprocess.run(["prlimit", f"--cpu={SECONDS}:{SECONDS + 1}", *command], capture_output=True, text=True,
                                errors="replace", timeout=10 * SECONDS, **more)
    except subprocess.TimeoutExpired:
        return late
    return late if result.returncode == -signal.SIGXCPU or "SIGXCPU" in result.stderr else result


def run_mebots(program, what, folder, *more):
    values = {name: bool(value) if kind == "Boolean" else value for name, (kind, _, value) in what["inputs"].items()}
    config = {"step": what["step_ns"] / 1e9, "start_time": what["start_ns"] / 1e9,
              "stop_time": (what["start_ns"] + what["steps"] * what["step_ns"]) / 1e9, "connections": [],
              "instances": {"it": {"fmu": what["fmu"], "parameters": values}},
              "record": [f"it.{name}" for name in what["outputs"]]}
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
    for kind, reference, value in what["inputs"].values():
        getattr(slave, "set" + kind)([reference], [value])
    slave.setupExperiment(tolerance=what["tolerance"], startTime=what["start_ns"] / 1e9, stopTime=None)
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
    os._exit(0)  # freeing the FMU is not part of the comparison


def difference(one, other):
    """Returns the largest difference, relative to the largest value of the column, and its place."""
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
    """Sets the row's `verdict`, and whether a difference is explained."""
    ours, alone, theirs = row.pop("ours"), row.pop("alone"), row.pop("theirs")
    row["run"] = "runs" if "columns" in ours else ours["error"]
    row["FMPy"] = "runs" if "columns" in theirs else theirs["error"]
    row["isolated"] = "as run"
    if ours.get("error") == LATE and theirs.get("error") == LATE:  # for a single FMU, host and master each have the
                                                                   # limit
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


def times_of(what):
    return [(what["start_ns"] + k * what["step_ns"]) / 1e9 for k in range(what["steps"] + 1)]


def finer(what, parts):
    """Returns the plan `what` of a run, with each step divided into `parts`. The undivided run has at most HALVED_STEPS
    steps."""
    steps = min(what["steps"], HALVED_STEPS)
    return what | {"step_ns": what["step_ns"] // parts, "steps": steps * parts}


def compare_with_truths(row, what, known):
    """Stores in the row the differences of mebots' outputs from each known solution."""
    row["truths"] = []
    for truth in known:
        ratio, error, place = truths.compare(truth, times_of(what), what["step_ns"] / 1e9, row["ours"].get("columns", {}))
        row["truths"].append({"kind": truth.kind, "source": truth.source, "bound": truth.bound_text, "error": error,
                              "agrees": ratio <= 1, "place": place})


def error_of(what, columns, known):
    """Returns the largest error against the first known solution, at the points of the plan `what`, which has the longest
    steps."""
    return truths.compare(known[0], times_of(what), what["step_ns"] / 1e9, columns)[1]


def halved_steps(program, what, known, folder):
    """Returns the change of the error with halved steps: "exact", "within 10 x tolerance", "shrinks", "stays", "grows from ... to
    ...", or the reason why the change is not known."""
    if not what["variable_step"]:
        return "fixed steps only"
    if what["step_ns"] % 4:
        return "steps cannot be halved twice"
    runs = []
    for parts in (1, 2, 4):
        result = run_mebots(program, finer(what, parts), folder)
        if "columns" not in result:
            return "a run fails"
        runs.append(result["columns"])
    if not any(len(set(values)) > 1 for values in runs[0].values()):
        return "all outputs are constant"
    same_points = [{name: values[::parts] for name, values in columns.items()} for parts, columns in zip((1, 2, 4), runs)]
    if known:
        errors = [error_of(finer(what, 1), columns, known) for columns in same_points]
    else:
        errors = [difference(same_points[0], same_points[1])[0], difference(same_points[1], same_points[2])[0]]
    if max(errors) <= truths.ROUNDING:
        return "exact"
    if max(errors) <= 10 * (what["tolerance"] or 0):
        return "within 10 x tolerance"
    if errors[-1] <= 0.75 * errors[0]:
        return "shrinks"
    return "stays" if errors[-1] <= GROWS * errors[0] else f"grows from {errors[0]:.1e} to {errors[-1]:.1e}"


def explanation(row):
    return next((why for end, why in EXPLAINED.items() if row["fmu"].endswith(end)), "")


def judge_truths(row):
    """Marks the row as unexplained if an output differs from a known solution or its error grows with smaller steps, and
    EXPLAINED lacks the FMU."""
    wrong = [truth for truth in row.get("truths", []) if not truth["agrees"]]
    if row["run"] == "runs" and (wrong or row["halved"].startswith("grows")) and not explanation(row):
        row["explained"] = False


def examine(program, base, fmu):
    row = {"fmu": str(fmu.relative_to(base))}
    try:
        what, known = plan(fmu)
    except NotOurs as why:
        return row | {"verdict": "left out", "why": str(why), "explained": True}
    with tempfile.TemporaryDirectory(prefix="corpus") as name:
        folders = [pathlib.Path(name) / part for part in ("check", "run", "isolated", "fmpy", "again", "halved")]
        for folder in folders:
            folder.mkdir()
        checked = call([program, "check", fmu], cwd=folders[0])
        row["check"] = {0: "clean", 1: "findings", 2: "cannot be used", 124: "not done"}.get(checked.returncode,
                                                                                         f"code {checked.returncode}")
        row["stop_time"] = next((word for word in ("needs a stop time", "values depend on the stop time") if word in checked.stdout), "")
        row |= {"tool": what["tool"], "points": what["steps"] + 1, "outputs": len(what["outputs"]),
                "ours": run_mebots(program, what, folders[1]), "alone": run_mebots(program, what, folders[2], "--isolate"),
                "theirs": run_fmpy(what, folders[3])}
        compare_with_truths(row, what, known)
        runs = "columns" in row["ours"]
        judge(row, what, folders[4])
        row["halved"] = halved_steps(program, what, known, folders[5]) if runs else "does not run"
        judge_truths(row)
    return row


def different(fmus):
    """Returns one FMU for each distinct content, and the number of other FMUs with equal bytes."""
    first, repeated = {}, 0
    for fmu in fmus:
        digest = hashlib.sha256(fmu.read_bytes()).digest()
        repeated += digest in first
        first.setdefault(digest, fmu)
    return list(first.values()), repeated


def word_of(row):
    """Returns a row's verdict for the summary. If the verdict is a number, returns "within 1e-12" or "numbers differ"."""
    if not re.match(r"\d", row["verdict"]):
        return row["verdict"]
    return "within 1e-12" if row["difference"] <= SAME else "numbers differ"


def truth_text(row):
    texts = [f"{truth['kind']}: {truth['error']:.0e} ({'agrees' if truth['agrees'] else truth['place']}; bound: {truth['bound']})"
             for truth in row["truths"]]
    return "; ".join(texts) or "none"


def show_truths(rows):
    """Prints the FMUs with known solutions. Then prints for each kind of solution how many FMUs have one, and how many of
    these agree with it."""
    rows = [row for row in rows if row["verdict"] != "left out" and row["run"] == "runs"]
    print("\n| FMU | truth | halved steps | explanation |\n|---|---|---|---|")
    for row in rows:
        if row["truths"] or row["halved"].startswith(("grows", "stays")):
            print(f"| {row['fmu']} | {truth_text(row)} | {row['halved']} | {explanation(row)} |")
    print("\n| truth | FMUs that run | agree | explained | unexplained |\n|---|---|---|---|---|")

    def line(name, having, agreeing):
        explained = sum(1 for row in having if not agreeing(row) and explanation(row))
        agree = sum(1 for row in having if agreeing(row))
        print(f"| {name} | {len(having)} | {agree} | {explained} | {len(having) - agree - explained} |")

    for kind in ("analytic", "equations", "reference file"):
        line(kind, [row for row in rows if any(truth["kind"] == kind for truth in row["truths"])],
             lambda row, kind=kind: all(truth["agrees"] for truth in row["truths"] if truth["kind"] == kind))
    line("any of the three above", [row for row in rows if row["truths"]], lambda row: all(truth["agrees"] for truth in row["truths"]))
    judged = [row for row in rows if row["halved"].startswith(("exact", "within", "shrinks", "stays", "grows"))]
    line("halved steps", judged, lambda row: not row["halved"].startswith("grows"))
    line("any of the four", [row for row in rows if row["truths"] or row in judged],
         lambda row: all(truth["agrees"] for truth in row["truths"]) and not row["halved"].startswith("grows"))
    for row in rows:
        if row["stop_time"]:
            print(f"stop time: {row['fmu']}: {row['stop_time']}")
    for why in sorted({row["halved"] for row in rows if row not in judged}):
        print(f"halved steps: {why}: {sum(1 for row in rows if row['halved'] == why)}")


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
            if arguments.json:  # after each FMU, because a long run may be interrupted
                arguments.json.write_text(json.dumps(rows, indent=1) + "\n")
    show(rows, repeated)
    show_truths(rows)
    unexplained = [row["fmu"] for row in rows if not row["explained"]]
    if unexplained:
        sys.exit(f"corpus: unexplained: {', '.join(unexplained)}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--fmpy"]:
        fmpy_child(json.loads(pathlib.Path(sys.argv[2]).read_text()), sys.argv[3])
    else:
        main()
