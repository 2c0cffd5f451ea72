#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a table of configs through the three interfaces: command line, C++ and Python.

Usage: interfaces_test.py MEBOTS CPP_RUN PROBE_FMU COUPLING_FMU FMU_DIR (with PYTHONPATH set to the package).

For each case, results, log and summary (without wall-clock times) must be equal byte by byte. Outcome, state and error must also
be equal. The C++ program runs each case twice: at once, and step by step.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import mebots

MEBOTS, CPP_RUN, PROBE, COUPLING, FMU_DIR = (str(pathlib.Path(word).resolve()) for word in sys.argv[1:6])


def system(instances, connections=(), step=0.1, stop_time=1, **more):
    return {"step": step, "stop_time": stop_time, "instances": instances,
            "connections": [{"from": a, "to": b} for a, b in connections], **more}


def probe(**parameters):
    more = parameters.pop("more", {})
    return {"fmu": PROBE, "parameters": parameters, **more}


def coupling(**parameters):
    more = parameters.pop("more", {})
    return {"fmu": COUPLING, "parameters": parameters, **more}


TWO = {"a": probe(gain=2, real_in=3), "b": probe()}
LINK = [("a.real_out", "b.real_in")]


class Case:
    def __init__(self, name, config, outcome, state="ended", *, settings=(), scenario=None, stop_time=None, isolate=False,
                 statistics=False, checkpoint=None, resume=False, ssp=False):
        self.name, self.config, self.outcome, self.state = name, config, outcome, state
        self.settings, self.scenario, self.stop_time = dict(settings), scenario, stop_time
        self.isolate, self.statistics = isolate, statistics
        self.checkpoint, self.resume, self.ssp = checkpoint, resume, ssp


CASES = [
    Case("ended", system(TWO, LINK), "completed"),
    Case("stopped by a condition", system(TWO, LINK, stop_when=[{"variable": "b.integral", "above": 2}],
                                          outcomes=[{"outcome": "far", "when": [{"variable": "b.integral", "above": 2}]}]),
         "far"),
    Case("stopped at t = 0", system(TWO, LINK, stop_when=[{"variable": "a.real_out", "above": 2}]), "completed"),
    Case("failed by fmi2Error", system({"a": probe(fault="error", fault_time=0.5), "b": probe()}), "failed", "failed"),
    Case("failed by fmi2Fatal", system({"a": probe(fault="fatal", fault_time=0.5), "b": probe()}), "failed", "failed"),
    Case("failed by NaN", system({"a": probe(fault="nan", fault_time=0.5), "b": probe()}, LINK), "failed", "failed"),
    Case("failed by a crash of its own process",
         system({"a": probe(fault="crash", fault_time=0.5, more={"process": "own"}), "b": probe()}, LINK),
         "failed", "failed"),
    Case("refused before t = 0", system({"a": probe(fault="initialisation")}), "failed", "failed"),
    Case("terminated by an FMU", system({"a": probe(fault="terminate", fault_time=0.5), "b": probe()}, LINK), "completed"),
    Case("interrupted", system({"a": probe(fault="interrupt", fault_time=0.5, string_in="once"), "b": probe()}, LINK), "interrupted"),
    Case("interrupted and resumed", system({"a": probe(fault="interrupt", fault_time=0.5, string_in="once"), "b": probe()}, LINK), "completed",
         checkpoint=0.2, resume=True),
    Case("everything at once, interrupted and resumed",
         system({"a": probe(fault="interrupt", fault_time=0.5, string_in="once"), "b": probe()}, LINK), "completed",
         settings={"a.gain": 2.5, "b.offset": 1e-3}, stop_time=0.9, checkpoint=0.2, resume=True, statistics=True,
         scenario={"scenario": [{"variable": "a.real_out", "offset": 1, "from": 0.3, "until": 0.6}]}),
    Case("Gauss-Seidel, interrupted", system(
        {"a": probe(gain=2, real_in=3), "b": probe(fault="interrupt", fault_time=0.5, string_in="once")}, LINK,
        algorithm="gauss-seidel", record={"interval": 0.2}), "interrupted"),
    Case("isolated", system(TWO, LINK), "completed", isolate=True),
    Case("a tolerated loss", system({"a": probe(fault="error", fault_time=0.5, more={"on_failure": "continue"}),
                                     "b": probe()}, LINK), "completed"),
    Case("an SSP", system(TWO, LINK), "completed", ssp=True),
    Case("several rates", system({"a": probe(gain=2, real_in=3, more={"step": 0.2}), "b": probe(), "c": probe(
        more={"step": 0.3})}, [*LINK, ("b.real_out", "c.real_in")], stop_time=1.2), "completed"),
    Case("several rates of a ratio", system({"a": probe(gain=2, real_in=3, more={"step": "1/20"}), "b": probe(), "c": probe(
        more={"step": 0.03333333333333333})}, [*LINK, ("b.real_out", "c.real_in")], step="1/60"), "completed"),
    Case("a ratio in two processes", system({"a": probe(gain=2, real_in=3), "b": probe(more={"process": "own"})}, LINK,
                                            step="3/7", stop_time=3), "completed"),
    Case("a ratio, interrupted and resumed",
         system({"a": probe(fault="interrupt", fault_time=0.5, string_in="once"), "b": probe()}, LINK, step="1/60"),
         "completed", checkpoint=0.2, resume=True, stop_time=0.9,
         scenario={"scenario": [{"variable": "a.real_out", "offset": 1, "from": "1/3", "until": "2/3"}]}),
    Case("a ratio as an SSP", system(TWO, LINK, step="1/60"), "completed", ssp=True),
    Case("a ratio and divided steps", system({"a": coupling(behaviour="short", max_step=0.025, more={"on_discard": "divide"})},
                                             step="1/3"), "completed"),
    Case("a start before 0 s, interrupted and resumed",
         system({"a": probe(fault="interrupt", fault_time=-0.5, string_in="once"), "b": probe()}, LINK,
                start_time=-1.2, stop_time=-0.2), "completed", checkpoint=0.25, resume=True,
         scenario={"scenario": [{"variable": "a.real_out", "offset": 1, "from": -0.9, "duration": 0.3}]}),
    Case("Gauss-Seidel", system(TWO, LINK, algorithm={"type": "gauss-seidel", "order": ["b", "a"]}), "completed"),
    Case("a scenario", system(TWO, LINK), "completed",
         scenario={"scenario": [{"variable": "a.real_out", "offset": 1, "from": 0.3, "until": 0.6}]}),
    Case("settings of all types", system({"a": probe(), "b": probe()}, LINK), "completed",
         settings={"a.gain": 2.5, "a.mode_in": "both", "a.boolean_in": True, "a.string_in": "hello there",
                   "a.integer_in": 4, "b.offset": 1e-3}),
    Case("settings of a group, interrupted and resumed",
         system({"a": probe(fault="interrupt", fault_time=0.5, string_in="once"), "b": probe()}, LINK), "completed",
         settings={"?.gain": 2.5, "*.offset": 1e-3, "b.gain": 3}, checkpoint=0.2, resume=True),
    Case("another stop time", system(TWO, LINK), "completed", stop_time=0.7),
    Case("another record", system(TWO, LINK, record={"interval": 0.2, "texts": True, "parameters": ["a.*"],
                                                     "variables": ["a.*", "b.string_out"]}), "completed"),
    Case("threads", system({name: probe(real_in=1) for name in "abcd"}, threads=2), "completed"),
    Case("divided steps", system({"a": coupling(behaviour="short", max_step=0.025, more={"on_discard": "divide"})}),
         "completed"),
    Case("a refused step", system({"a": coupling(behaviour="refuse")}), "failed", "failed"),
    Case("pending steps", system({"a": coupling(behaviour="callback", pause=0.002)}), "completed"),
    Case("statistics", system(TWO, LINK), "completed", statistics=True),
    Case("an unknown parameter", system({"a": probe(gian=1)}), "", "failed"),
    Case("battery and motors",
         system({"battery": {"fmu": f"{FMU_DIR}/fmu_battery.fmu", "parameters": {"cell.name": "bitcraze_250"}},
                 "motors": {"fmu": f"{FMU_DIR}/fmu_motors.fmu", "parameters": {"rotor[1].command": 0.6}}},
                [("motors.power", "battery.motors.power"), ("battery.bus.voltage", "motors.bus.voltage")], step=0.01),
         "completed", checkpoint=0.5),
    Case("battery and motors at 60 Hz from before 0 s",
         system({"battery": {"fmu": f"{FMU_DIR}/fmu_battery.fmu", "parameters": {"cell.name": "bitcraze_250"}},
                 "motors": {"fmu": f"{FMU_DIR}/fmu_motors.fmu", "parameters": {"rotor[1].command": 0.6}}},
                [("motors.power", "battery.motors.power"), ("battery.bus.voltage", "motors.bus.voltage")], step="1/60",
                start_time=-100, stop_time=100),
         "completed", checkpoint=50),
]


def text_of(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(value)


def options_of(case, folder):
    words = []
    for name, value in case.settings.items():
        words += ["--set", f"{name}={text_of(value)}"]
    if case.scenario:
        words += ["--scenario", str(folder / "scenario.json")]
    if case.stop_time:
        words += ["--stop-time", str(case.stop_time)]
    if case.checkpoint:
        words += ["--checkpoint-every", str(case.checkpoint)]
    return words + ["--isolate"] * case.isolate + ["--statistics"] * case.statistics


def by_command_line(case, config, out):
    """Reads outcome and state from the exit code and summary.json, as a user of the program does."""
    result = subprocess.run([MEBOTS, "run", config, "--out", out, *options_of(case, config.parent)],
                            capture_output=True, text=True, cwd=config.parent)
    if case.resume:
        assert result.returncode == 1 and "mebots resume" in result.stdout, result
        result = subprocess.run([MEBOTS, "resume", out], capture_output=True, text=True, cwd=config.parent)
    errors = [line for line in result.stderr.splitlines() if line.startswith("mebots: error: ")]
    error = errors[-1].removeprefix("mebots: error: ") if errors else ""
    state = "failed" if errors else "ended"
    summary = out / "summary.json"
    outcome = json.loads(summary.read_text())["outcome"] if summary.exists() else "failed"
    return outcome, state, error


def by_cpp(case, config, out, *more):
    def run(*words):
        result = subprocess.run([CPP_RUN, *map(str, words)], capture_output=True, text=True, cwd=config.parent)
        lines = [line for line in result.stdout.split("\n")]
        return lines[1], lines[2], "\n".join(lines[3:]).strip()

    state, outcome, error = run(config, out, *options_of(case, config.parent), *more)
    if case.resume:
        assert outcome == "interrupted", (state, outcome, error)
        state, outcome, error = run("--resume", out, *more)
    return outcome, state, error


def by_python(case, config, out):
    os.chdir(config.parent)
    mission = mebots.Mission(config, out=out, set=case.settings, stop_time=case.stop_time, isolate=case.isolate,
                             statistics=case.statistics, checkpoint_every=case.checkpoint,
                             scenarios=[config.parent / "scenario.json"] if case.scenario else [])
    try:
        mission.run()
    except mebots.Error:
        assert mission.state == "failed"
    except KeyboardInterrupt:
        assert mission.outcome == "interrupted"
        if case.resume:
            del mission
            mission = mebots.Mission.resume(out)
            mission.run()
    if (out / "results.csv").exists():  # results in memory are those in the file
        results = mebots.read(out)
        assert (mission.times == results.times).all() and mission.times.shape == results.times.shape
        for variable in mission.variables:
            assert (mission[variable] == results[variable]).all(), variable
    if mission.state == "failed":
        try:
            mission.step()
            raise AssertionError("a failed mission stepped")
        except mebots.InputError:
            pass
    return mission.outcome, mission.state, mission.error


def without_wall_time(summary):
    for key in ("wall_clock", "real_time_factor"):
        summary.pop(key, None)
    statistics = summary.get("statistics")
    if statistics:
        summary["statistics"] = {name: {key: one[key] for key in ("calls", "steps")}
                                 for name, one in statistics["instances"].items()}
    return summary


def kept_in(out):
    """Returns {name: content} of all files of a run except checkpoint.bin."""
    kept = {}
    for file in sorted(out.rglob("*")) if out.exists() else []:
        if file.is_dir() or file.name == "checkpoint.bin":
            continue
        content = file.read_bytes()
        kept[str(file.relative_to(out))] = (without_wall_time(json.loads(content)) if file.name == "summary.json"
                                            else content)
    return kept


def check(case, folder):
    config = folder / "case.json"
    config.write_text(json.dumps(case.config))
    if case.scenario:
        (folder / "scenario.json").write_text(json.dumps(case.scenario))
    if case.ssp:
        subprocess.run([MEBOTS, "convert", config, folder / "case.ssp"], check=True, capture_output=True)
        config = folder / "case.ssp"
    interfaces = {"command line": by_command_line, "C++": by_cpp, "Python": by_python,
             "C++, step by step": lambda *words: by_cpp(*words, "--step-by-step")}
    found = {}
    for name, run in interfaces.items():
        out = folder / "out"  # the same path for all: some FMUs output it
        if out.exists():
            shutil.rmtree(out)
        if (folder / "once").exists():  # the FMU creates it when it interrupts the run
            (folder / "once").rmdir()
        outcome, state, error = run(case, config, out)
        found[name] = {"outcome": outcome, "state": state, "error": error, **kept_in(out)}
    first = found["command line"]
    for name, other in found.items():
        for key in sorted({*first, *other}):
            assert first.get(key) == other.get(key), (
                f"{case.name}: {key} differs between the command line and {name}:\n{first.get(key)}\n{other.get(key)}")
    if case.outcome:
        assert (first["outcome"], first["state"]) == (case.outcome, case.state), (case.name, first)
    return first


def main():
    print(f"{'case':<38} {'outcome':<12} {'state':<8} files")
    for case in CASES:
        with tempfile.TemporaryDirectory() as folder:
            first = check(case, pathlib.Path(folder).resolve())
        files = [name for name in first if name not in ("outcome", "state", "error")]
        print(f"{case.name:<38} {first['outcome']:<12} {first['state']:<8} {', '.join(files) or '-'}")
    print(f"ok: {len(CASES)} cases give the same results through three interfaces")


if __name__ == "__main__":
    main()
