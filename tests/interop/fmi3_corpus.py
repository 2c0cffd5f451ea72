# SPDX-License-Identifier: Apache-2.0
"""Compares FMUs of FMI 3.0, and FMUs for model exchange, in `mebots run`, `mebots run --isolate` and FMPy (docs/interop.md).

Usage: fmi3_corpus.py FOLDER MEBOTS [--match TEXT]

Runs each FMU below the folder that has a binary for x86-64 Linux alone, once for each kind. FMUs of FMI 3.0 run as co-simulation
and as model exchange. FMUs of FMI 2.0 run as model exchange if they do not support co-simulation. All numeric outputs are
compared at every communication point. If an FMU has no outputs, its local variables are compared. Binaries are compared by their
CRC. The values of inputs are constant (INPUTS).

- Co-simulation: a loop over FMPy's FMU3Slave makes the calls, as FMPy's simulate_fmu has no Clocks. It handles events within a step, and sets
  the Clocks that tick at known times. Values must have the same bits.
- Model exchange: simulate_fmu with CVODE. Both tools get the relative tolerance 1e-10, so values differ by the solvers' errors.
- Exact solution: Dahlquist, StateSpace and Roberts are compared with their solved equations (fmi3_exact.py), within 1e-7.
- Reference file: NAMECS.csv or NAMEME.csv, NAME.csv, NAME_ref.csv beside the FMU, else NAME_out.csv in its extra/org.fmi-standard.fmi-ls-ref.
  mebots runs again, with the inputs of NAME_in.csv if there are any, and is compared at the times that both have.

The exit code is 1 if a difference or an error is unexplained, or if there were no comparisons.
"""

import argparse
import csv
import ctypes
import json
import math
import os
import pathlib
import re
import sys
import tempfile
import zipfile
import zlib
from xml.etree import ElementTree

import fmpy
import fmpy.fmi3

import corpus
import fmi3_exact

TOLERANCE = 1e-10
INPUTS = {"Float": 1.5, "Int": 3, "UInt": 3, "Boolean": True, "Real": 1.5, "Integer": 3}
MOST_VARIABLES = 300
MOST_EVENTS = 1000
SHORT_STEP_NS = 1_000_000
MOST_SOLVER_ERROR = 1e-5  # difference of two solvers at TOLERANCE

# FMUs with an error or a larger difference whose cause is known, by the end of their path. The value is a part of the expected
# message, or the largest difference. docs/interop.md contains the evidence.
EXPECTED_ERROR = {
    # This FMU writes outside of its memory in fmi2GetDirectionalDerivative.
    "MapleSim_2023/FMI_Export/FMI_2/ME/ControlledTemperature/ControlledTemperature.fmu": "SIGABRT",
    # This FMU declares hasEventMode, but rejects instantiation with event mode for co-simulation. It has no events.
    "/Roberts.fmu": "Event Mode is not supported",
    # Debian 12 does not have this library.
    "/Description.fmu": "libgfortran.so.3: cannot open sh",
}
EXPECTED_DIFFERENCE = {"SlidingCrank.fmu": 1e-4}  # FMPy restarts its solver after every step, and has the larger error
MOST_ERROR = 1e-7  # of exact values, relative to the largest
# FMPy 0.3.32 loads this function of scheduled execution for every kind of FMU. Four test FMUs do not export this function.
NOT_LOADED_BY_FMPY = "undefined symbol: fmi3ActivateModelPartition"
NEVER = math.inf
KNOWN_AHEAD = ("constant", "fixed", "countdown")  # Clocks that the importer ticks by time; no public FMU has others


def numeric(variable):
    return variable.type not in ("String", "Clock") and variable.name != "time"


def input_value(variable):
    return next((value for kind, value in INPUTS.items() if variable.type.startswith(kind)), None)


def elements(name, shape):
    """Returns the names of an array's elements in row-major order. mebots uses the same names."""
    indices = [()]
    for size in shape or ():
        indices = [index + (k + 1,) for index in indices for k in range(size)]
    return [f"{name}[{','.join(map(str, index))}]" if index else name for index in indices]


def plans(fmu):
    """Returns a plan for each kind (co-simulation, model exchange) for which the FMU is compared. Raises NotOurs if there
    is none."""
    try:
        with zipfile.ZipFile(fmu) as archive:
            members = set(archive.namelist())
        model = fmpy.read_model_description(str(fmu), validate=False)
    except Exception as error:  # FMPy raises many kinds of exceptions for a broken package
        raise corpus.NotOurs(f"cannot be read: {corpus.short(str(error))}") from error
    kinds = {"co_simulation": model.coSimulation, "model_exchange": model.modelExchange}
    if model.fmiVersion == "2.0":
        kinds = {"model_exchange": None if model.coSimulation else model.modelExchange}
    elif model.fmiVersion != "3.0":
        kinds = {}
    platform = "linux64" if model.fmiVersion == "2.0" else "x86_64-linux"
    kinds = {kind: part for kind, part in kinds.items() if part and f"binaries/{platform}/{part.modelIdentifier}.so" in members}
    if not kinds:
        raise corpus.NotOurs(f"FMI {model.fmiVersion}, no kind to compare or no binary")
    experiment = model.defaultExperiment
    start, stop, step, tolerance = (float(getattr(experiment, name, None) or 0) for name in ("startTime", "stopTime", "stepSize", "tolerance"))
    stop = stop if stop > start else start + 1
    step = step or float(getattr(model.coSimulation, "fixedInternalStepSize", None) or 0) or (stop - start) / 100
    step_ns = max(corpus.nanoseconds(step), 1)
    start_ns = corpus.nanoseconds(start)
    outputs = [v for v in model.modelVariables if v.causality == "output" and numeric(v)]
    compared = outputs or [v for v in model.modelVariables if v.causality == "local" and numeric(v) and v.variability not in ("constant", "fixed")]
    compared = compared[:MOST_VARIABLES]
    inputs = [v for v in model.modelVariables if v.causality == "input" and input_value(v) is not None]
    base = {"fmu": str(fmu), "version": model.fmiVersion, "tool": corpus.family(model.generationTool or ""), "start_ns": start_ns,
            "step_ns": step_ns, "steps": int(min(corpus.MOST_STEPS, max(1, (corpus.nanoseconds(stop) - start_ns) // step_ns))),
            "tolerance": tolerance or None,
            "outputs": [name for v in compared for name in elements(v.name, v.shape)], "variables": [v.name for v in compared],
            "inputs": {name: input_value(v) for v in inputs for name in elements(v.name, v.shape)},
            "start_values": {v.name: [input_value(v)] * math.prod(v.shape) if v.shape else input_value(v) for v in inputs}}
    result = [base | {"kind": kind} for kind in kinds]
    if "model_exchange" in kinds:  # simulate_fmu records no Binary
        binaries = {v.name for v in compared if v.type == "Binary"}
        result[-1] |= {key: [name for name in base[key] if name not in binaries] for key in ("outputs", "variables")}
    return result


def reference_of(what):
    """Returns the times and columns of the FMU's reference file, and the path of the file with its inputs. If there is no
    reference, returns None."""
    fmu = pathlib.Path(what["fmu"])
    kind = "CS" if what["kind"] == "co_simulation" else "ME"
    files = [fmu.with_name(fmu.stem + end) for end in (f"{kind}.csv", ".csv", "_ref.csv")]
    text = next((file.read_text() for file in files if file.exists() and file.stat().st_size > 0), None)
    inner = f"extra/org.fmi-standard.fmi-ls-ref/{fmu.stem}_out.csv"
    with zipfile.ZipFile(fmu) as archive:
        if text is None and inner in archive.namelist():
            text = archive.read(inner).decode()
    if text is None:
        return None
    header, *rows = csv.reader(text.splitlines())
    columns = {}
    for k, name in enumerate(header[1:], 1):
        cells = [row[k].split(" ") for row in rows]
        if any(not re.fullmatch(r"[-+.0-9e]+", number) for number in cells[-1]):
            continue
        names = [name] if len(cells[0]) == 1 else elements(name, (len(cells[0]),))
        columns |= {element: [float(cell[i]) for cell in cells] for i, element in enumerate(names)}
    inputs = fmu.with_name(fmu.stem + "_in.csv")
    return [float(row[0]) for row in rows], columns, inputs if inputs.exists() else None


def compare_with_file(program, what, folder):
    """Returns a text with the largest difference between mebots and the reference file."""
    reference = reference_of(what)
    if reference is None:
        return ""
    times, columns, inputs = reference
    what = what | {"inputs": {}, "outputs": [name for name in columns if name in what["outputs"]]}
    if not what["outputs"]:
        return "no common columns"
    if inputs is not None:  # a step holds its inputs, so it must be short
        what |= {"step_ns": SHORT_STEP_NS}
        what["steps"] = corpus.nanoseconds(times[-1] - times[0]) // what["step_ns"]
    ours = run_mebots(program, what, folder, *(["--inputs", prefixed(inputs, folder)] if inputs else []))
    if "error" in ours:
        return ours["error"]
    place_of = {corpus.nanoseconds(t): k for k, t in enumerate(times)}  # of several rows of one time, the last
    rows = min(len(column) for column in ours["columns"].values())  # fewer than steps if the FMU ends the run
    common = [(k, place_of[corpus.nanoseconds(t)]) for k, t in enumerate(corpus.times_of(what)[:rows]) if corpus.nanoseconds(t) in place_of]
    gap, place = corpus.difference({name: [columns[name][j] for _, j in common] for name in what["outputs"]},
                                   {name: [ours["columns"][name][k] for k, _ in common] for name in what["outputs"]})
    return f"{gap:.1e} ({place}; {len(common)} points)" if common else "no common points"


def prefixed(inputs, folder):
    """Returns a copy of the input file. Its columns have names as in a config."""
    header, *rows = csv.reader(inputs.read_text().splitlines())
    copy = folder / "in.csv"
    with copy.open("w", newline="") as file:
        csv.writer(file).writerows([["time", *(f"it.{name}" for name in header[1:])], *rows])
    return copy


def run_mebots(program, what, folder, *more):
    binaries = {v.name for v in fmpy.read_model_description(what["fmu"], validate=False).modelVariables if v.type == "Binary"}
    config = {"step": what["step_ns"] / 1e9, "start_time": what["start_ns"] / 1e9,
              "stop_time": (what["start_ns"] + what["steps"] * what["step_ns"]) / 1e9,
              "instances": {"it": {"fmu": what["fmu"], "kind": what["kind"], "parameters": what["inputs"]}},
              "record": [f"it.{name}" for name in what["outputs"]]}
    if what["kind"] == "model_exchange":
        config["solver"] = {"relative_tolerance": TOLERANCE}
    (folder / "config.json").write_text(json.dumps(config))
    result = corpus.call([program, "run", folder / "config.json", "--out", folder / "out", "--quiet", *more], cwd=folder)
    if result.returncode != 0:
        return {"error": corpus.complaint(result)}
    with (folder / "out" / "results.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    names = [re.sub(r" \[[^\]]*\]$", "", name).removeprefix("it.") if name.removeprefix("it.") not in what["outputs"]
             else name.removeprefix("it.") for name in header]
    crc = {k for k, name in enumerate(names) if re.sub(r"\[[\d,]+\]$", "", name) in binaries}
    return {"columns": {name: [float(zlib.crc32(bytes.fromhex(row[k]))) if k in crc else float(row[k]) for row in rows]
                        for k, name in enumerate(names) if k > 0}}


def run_fmpy(what, folder):
    (folder / "what.json").write_text(json.dumps(what))
    result = corpus.call([sys.executable, __file__, "--fmpy", folder / "what.json", folder / "columns.json"], cwd=folder)
    if result.returncode != 0:
        return {"error": corpus.complaint(result)}
    return {"columns": json.loads((folder / "columns.json").read_text())}


class Ended(Exception):
    """Raised if the FMU ends the simulation."""


def declared_times(fmu):
    """Returns shift and interval of each Clock that declares them. FMPy 0.3.32 does not read them."""
    with zipfile.ZipFile(fmu) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    return {clock.get("name"): (float(clock.get("shiftDecimal", 0)), float(clock.get("intervalDecimal")))
            for clock in root.iter("Clock") if clock.get("intervalDecimal")}


class Stepped:
    """A co-simulation instance in FMPy, with events and Clocks. Makes the calls of an importer without connections."""

    def __init__(self, what):
        model = fmpy.read_model_description(what["fmu"], validate=False)
        self.variables = {v.name: v for v in model.modelVariables}
        self.events = model.coSimulation.hasEventMode
        self.fmu = fmpy.fmi3.FMU3Slave(guid=model.guid, unzipDirectory=fmpy.extract(what["fmu"]), instanceName="it",
                                       modelIdentifier=model.coSimulation.modelIdentifier)
        self.fmu.instantiate(eventModeUsed=self.events, earlyReturnAllowed=self.events)
        clocks = [v for v in model.modelVariables if v.type == "Clock"]
        self.next_s = {v.name: NEVER for v in clocks if v.causality == "input" and v.intervalVariability in KNOWN_AHEAD}
        self.count = dict.fromkeys(self.next_s, 0)
        self.times = declared_times(what["fmu"])
        self.ticking_outputs = [v for v in clocks if v.causality == "output"]
        self.clocked = [v for v in model.modelVariables if v.clocks]
        self.held = {v.name: [b"" if v.type == "Binary" else 0.0] for v in self.clocked}

    def get(self, name):
        variable = self.variables[name]
        kind = {"Enumeration": "Int64"}.get(variable.type, variable.type)
        return getattr(self.fmu, "get" + kind)([variable.valueReference], nValues=math.prod(variable.shape) if variable.shape else 1)

    def set(self, name, value):
        variable = self.variables[name]
        getattr(self.fmu, "set" + variable.type)([variable.valueReference], value if isinstance(value, list) else [value])

    def value(self, name):
        """Returns the values of a variable. If it belongs to a Clock, returns the values of the last tick."""
        values = self.held[name] if name in self.held else self.get(name)
        return [float(zlib.crc32(value or b"")) if isinstance(value, (bytes, type(None))) else float(value) for value in values]

    def plan_ticks(self, time_s, start=False):
        for name in self.next_s:
            clock = self.variables[name]
            if clock.intervalVariability != "countdown":
                self.next_s[name] = time_s + self.times[name][0] if start else self.next_s[name]
                continue
            interval, qualifier = (ctypes.c_double * 1)(), (ctypes.c_int * 1)()
            self.fmu.getIntervalDecimal((ctypes.c_uint32 * 1)(clock.valueReference), interval, qualifier)
            if qualifier[0] == 2:  # fmi3IntervalChanged
                self.next_s[name] = time_s + interval[0]

    def event(self, time_s):
        """Updates discrete states in event mode until no Clock ticks and the FMU needs no further update. Then enters step
        mode."""
        for _ in range(MOST_EVENTS):
            due = [name for name, next_s in self.next_s.items() if next_s <= time_s + 0.5e-9]
            for name in due:
                self.fmu.setClock([self.variables[name].valueReference], [True])
                self.count[name] += 1
                self.next_s[name] = NEVER
                if name in self.times:
                    shift_s, interval_s = self.times[name]
                    self.next_s[name] = shift_s + self.count[name] * interval_s
            ticking = set(due) | {v.name for v in self.ticking_outputs if self.fmu.getClock([v.valueReference])[0]}
            for variable in self.clocked:
                if variable.causality == "output" and any(clock.name in ticking for clock in variable.clocks):
                    self.held[variable.name] = self.get(variable.name)
            needs_update, ends, *_ = self.fmu.updateDiscreteStates()
            if ends:
                raise Ended
            self.plan_ticks(time_s)
            if not needs_update and min(self.next_s.values(), default=NEVER) > time_s + 0.5e-9:
                self.fmu.enterStepMode()
                return
        raise RuntimeError("the event does not end")

    def initialize(self, what):
        for name, value in what["start_values"].items():
            self.set(name, value)
        self.fmu.enterInitializationMode(tolerance=what["tolerance"], startTime=what["start_ns"] / 1e9, stopTime=None)
        self.plan_ticks(what["start_ns"] / 1e9, start=True)
        self.fmu.exitInitializationMode()
        if self.events:
            self.event(what["start_ns"] / 1e9)

    def step(self, time_s, end_s):
        for _ in range(MOST_EVENTS):
            target_s = min(end_s, *self.next_s.values()) if self.next_s else end_s
            if end_s - target_s <= 0.5e-9:
                target_s = end_s
            event, ends, early, last_s = self.fmu.doStep(time_s, target_s - time_s)
            if ends:
                raise Ended
            time_s = last_s if early else target_s
            if event or min(self.next_s.values(), default=NEVER) <= time_s + 0.5e-9:
                self.fmu.enterEventMode()
                self.event(time_s)
            if time_s >= end_s:
                return
        raise RuntimeError("the step does not end")


def columns_of_slave(what):
    slave = Stepped(what)
    slave.initialize(what)
    columns = {name: [] for name in what["outputs"]}

    def read():
        for name in what["variables"]:
            for element, value in zip(elements(name, slave.variables[name].shape), slave.value(name), strict=True):
                columns[element].append(value)

    read()
    times = corpus.times_of(what)
    for time_s, end_s in zip(times, times[1:]):
        try:
            slave.step(time_s, end_s)
        except Ended:
            break
        read()
    return columns


def columns_of_model(what):
    times = corpus.times_of(what)
    model = fmpy.read_model_description(what["fmu"], validate=False)
    result = fmpy.simulate_fmu(what["fmu"], model_description=model, validate=False, fmi_type="ModelExchange", solver="CVode",
                               start_time=times[0], stop_time=times[-1], output_interval=what["step_ns"] / 1e9,
                               relative_tolerance=TOLERANCE, record_events=False, set_stop_time=False, output=what["variables"],
                               start_values=what["start_values"])
    shapes = {v.name: v.shape for v in model.modelVariables}
    columns = {}
    for name in what["variables"]:
        values = result[name].reshape(len(result), -1)
        for k, element in enumerate(elements(name, shapes[name])):
            columns[element] = [float(value) for value in values[:, k]]
    return columns


def fmpy_child(what, target):
    columns = columns_of_slave(what) if what["kind"] == "co_simulation" else columns_of_model(what)
    pathlib.Path(target).write_text(json.dumps(columns))
    sys.stdout.flush()
    os._exit(0)  # freeing the FMU is not part of the comparison


def entry_of(table, fmu):
    """Returns the value whose key is the end of the FMU's path. If there is none, returns None."""
    return next((entry for end, entry in table.items() if fmu.endswith(end)), None)


def compare_with_equations(what, ours):
    """Returns a text with the largest difference from the exact solution, and whether the difference is small enough."""
    if "columns" not in ours:
        return "", True
    model = fmpy.read_model_description(what["fmu"], validate=False)
    exact = fmi3_exact.exact_columns(model, what["kind"], corpus.times_of(what), what["inputs"])
    if exact is None:
        return "", True
    gap, place = corpus.difference(exact, {name: ours["columns"][name] for name in exact})
    return f"{gap:.1e} ({place})", gap <= MOST_ERROR


def examine(program, what):
    with tempfile.TemporaryDirectory(prefix="fmi3_corpus") as name:
        folders = [pathlib.Path(name) / part for part in ("run", "isolated", "fmpy", "file")]
        for folder in folders:
            folder.mkdir()
        ours = run_mebots(program, what, folders[0])
        alone = run_mebots(program, what, folders[1], "--isolate")
        theirs = run_fmpy(what, folders[2])
        against_file = compare_with_file(program, what, folders[3])
    row = {"kind": "CS" if what["kind"] == "co_simulation" else "ME", "values": f"{len(what['outputs'])} x {what['steps'] + 1}",
           "isolated": "same bits" if ours == alone else alone.get("error", "differs"),
           "file": against_file, "result": ours.get("error") or (f"FMPy: {theirs['error']}" if "error" in theirs else "")}
    row["exact"], exact_agrees = compare_with_equations(what, ours)
    row["compared"] = "columns" in ours and "columns" in theirs
    if row["compared"]:
        gap, place = corpus.difference(theirs["columns"], ours["columns"])
        row["result"] = "same bits" if gap == 0 else f"{gap:.1e} ({place})"
        most = entry_of(EXPECTED_DIFFERENCE, what["fmu"]) or MOST_SOLVER_ERROR
        row["explained"] = ours == alone and exact_agrees and gap <= (most if row["kind"] == "ME" else 0)
    elif "columns" in ours:
        row["explained"] = ours == alone and exact_agrees and NOT_LOADED_BY_FMPY in theirs.get("error", "")
    else:
        expected = entry_of(EXPECTED_ERROR, what["fmu"])
        row["explained"] = expected is not None and expected in ours["error"] and expected in alone.get("error", "")
    return row


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--match", default="", help="only FMUs whose path has this text")
    arguments = parser.parse_args()
    base = arguments.folder.resolve()
    fmus, repeated = corpus.different([fmu for fmu in sorted(base.rglob("*.fmu")) if arguments.match in str(fmu.relative_to(base))])
    left_out, unexplained, compared = [], [], 0
    print("| FMU | tool | kind | values | with --isolate | mebots and FMPy | mebots and reference file | mebots and exact solution |\n"
          "|---|---|---|---|---|---|---|---|")
    for fmu in fmus:
        try:
            todo = plans(fmu)
        except corpus.NotOurs as why:
            left_out.append(f"left out: {fmu.relative_to(base)}: {why}")
            continue
        for what in todo:
            row = examine(arguments.program.resolve(), what)
            compared += row["compared"]
            if not row["explained"]:
                unexplained.append(f"{fmu.relative_to(base)} ({row['kind']})")
            print(f"| {fmu.relative_to(base)} | {what['tool']}, {what['version']} | {row['kind']} | {row['values']} | {row['isolated']} | "
                  f"{row['result']} | {row['file']} | {row['exact']} |", flush=True)
    print(f"\n{repeated} files with the same bytes as another", *left_out, sep="\n")
    if unexplained:
        sys.exit(f"fmi3_corpus: unexplained: {', '.join(unexplained)}")
    if compared == 0:
        sys.exit(f"fmi3_corpus: nothing in {base} could be compared")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--fmpy"]:
        fmpy_child(json.loads(pathlib.Path(sys.argv[2]).read_text()), sys.argv[3])
    else:
        main()
