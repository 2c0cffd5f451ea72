#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs MEbots' FMUs and other FMUs in mebots, FMPy, OMSimulator and libcosim, alone and connected. Prints a table of differences.

Usage: compare.py BUILD_FOLDER [--tool NAME]... [--system NAME]...

Every output is compared with mebots' output at every communication point, after the same steps with the same start values. The
exit code is 1 if the numbers of a tool differ, or if a tool rejects a system that it is known to run. It is 77 if only
OMSimulator is requested and OMSimulator is missing. scripts/interop.sh calls this program. docs/interop.md contains its output.
"""

import argparse
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import tools

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MISSING = 77
# FMUs without functions of optional capabilities. mebots can run them. The other tools require all functions.
PARTIAL = ("probe (C",)
# All tools pass the same doubles to the same FMUs. OMSimulator writes 12 significant digits. The other tools do not round.
TOLERANCE = {"OMSimulator": 1e-11}


def alone(fmu, steps=250, step=0.002, **parameters):
    return {"step": step, "steps": steps, "instances": {"it": {"fmu": str(fmu), "parameters": parameters}}, "connections": []}


def of_config(file, fmus, seconds):
    """Returns one of MEbots' configs with `seconds` as the stop time."""
    config = json.loads(file.read_text())
    for instance in config["instances"].values():
        instance["fmu"] = str(fmus / f"{instance['fmu']}.fmu")
    return {key: config[key] for key in ("step", "instances", "connections")} | {"steps": round(seconds / config["step"])}


def ring(fmu, count, source, target, steps, step):
    """Returns instances of one FMU in a ring."""
    instances = {f"i{k}": {"fmu": str(fmu), "parameters": {}} for k in range(count)}
    connections = [{"from": f"i{k}.{source}", "to": f"i{(k + 1) % count}.{target}"} for k in range(count)]
    return {"step": step, "steps": steps, "instances": instances, "connections": connections}


def of_python(folder):
    """Returns an FMU of pythonfmu, and a system of two instances of this FMU. They exchange values of every type that pythonfmu
    supports. pythonfmu builds one archive for all platforms."""
    import pythonfmu

    fmu = pythonfmu.FmuBuilder.build_FMU(str(pathlib.Path(__file__).parent / "python_slave.py"), dest=str(folder))
    pairs = [("a.y", "b.u"), ("b.area", "a.u"), ("b.count", "a.count_in"), ("a.count", "b.count_in"), ("a.flag", "b.flag_in"),
             ("b.flag", "a.flag_in"), ("a.word", "b.word_in")]
    coupled = {"step": 0.125, "steps": 40, "connections": [{"from": a, "to": b} for a, b in pairs],
               "instances": {"a": {"fmu": str(fmu), "parameters": {"gain": 3.5}},
                             "b": {"fmu": str(fmu), "parameters": {"gain": -0.5}}}}
    return fmu, coupled


def systems(build, folder):
    """Returns a dict of the systems that are compared, with their names as keys. All paths are absolute."""
    fmus, foreign = build / "fmus", build / "test_fmus"
    passthrough = foreign / "passthrough.fmu"
    python, coupled = of_python(folder)
    configs = ROOT / "configs"
    return {
        "fmu_battery": alone(fmus / "fmu_battery.fmu", **{"motors.power": 8.0}),
        "fmu_motors": alone(fmus / "fmu_motors.fmu", **{f"rotor[{i}].command": 0.6 for i in range(1, 5)}),
        "fmu_world": alone(fmus / "fmu_world.fmu", **{f"rotor[{i}].thrust": 0.1 for i in range(1, 5)}),
        "fmu_soc": alone(fmus / "fmu_soc.fmu"),
        "motor_thermal (`mebots new-fmu`)": alone(fmus / "motor_thermal.fmu", **{"motor.power": 8.0}),
        "passthrough (C++, no state)": alone(passthrough, u=1.5),
        "probe (C, lacks functions)": alone(foreign / "probe.fmu", step=0.125, steps=40, real_in=2.0, gain=-0.3, integer_in=4),
        "coupling (C, asynchronous)": alone(foreign / "coupling.fmu", step=0.125, steps=40, a=0.3, b=0.5, loop_in=2.0),
        "python_slave (pythonfmu)": alone(python, step=0.125, steps=40, u=0.25, gain=3.5),
        "two python_slave, all types": coupled,
        "ring of sixteen passthrough": ring(passthrough, 16, "y", "u", 100, 0.125),
        "motor_thermal, passthrough and coupling": {
            "step": 2**-9, "steps": 250,  # exact in binary: this FMU outputs the time that a tool passes
            "instances": {"c": {"fmu": str(foreign / "coupling.fmu")}, "p": {"fmu": str(passthrough)},
                          "thermal": {"fmu": str(fmus / "motor_thermal.fmu")}},
            "connections": [{"from": "c.now", "to": "p.u"}, {"from": "p.sum", "to": "thermal.motor.power"},
                            {"from": "thermal.winding.temperature", "to": "c.kelvin_in"}]},
        "battery and motors": of_config(configs / "battery_motors.json", fmus, 2),
        "all four: the easy gate mission": of_config(configs / "gate_easy.json", fmus, 3),
    }


def make(name, mebots):
    return {"mebots": lambda: tools.Mebots(mebots), "FMPy": tools.Fmpy, "OMSimulator": tools.OMSimulator,
            "libcosim": tools.Libcosim}[name]()


def run_apart(name, system, mebots, folder):
    """Runs a tool in a separate process. If the tool crashes, the table contains this result."""
    folder = pathlib.Path(tempfile.mkdtemp(dir=folder))
    job, answer = folder / "job.json", folder / "answer.json"
    job.write_text(json.dumps({"tool": name, "system": system, "mebots": str(mebots)}))
    result = subprocess.run([sys.executable, __file__, "--job", job, answer], capture_output=True, text=True)
    if not answer.exists():
        how = f"signal {-result.returncode}" if result.returncode < 0 else tools.last_words(result.stderr)
        return {"refused": f"ends with {how}"}
    return json.loads(answer.read_text())


def do_job(job, answer):
    job = json.loads(job.read_text())
    try:
        columns, left_out = make(job["tool"], job["mebots"]).run(job["system"], answer.parent)
        answer.write_text(json.dumps({"columns": columns, "left_out": left_out}))
    except tools.Refused as refusal:
        answer.write_text(json.dumps({"refused": str(refusal)}))


def without(system, left_out):
    """Returns the system without the connections and parameters in `left_out`."""
    connections = [{"from": a, "to": b} for a, b, _ in tools.plain_connections(system) if f"{a} -> {b}" not in left_out]
    instances = {name: dict(i, parameters={n: v for n, v in i.get("parameters", {}).items() if f"{name}.{n}" not in left_out})
                 for name, i in system["instances"].items()}
    return dict(system, connections=connections, instances=instances)


def difference(ours, theirs):
    """Returns (number of compared values, number of equal values, largest relative difference, its place)."""
    count, equal, worst, where = 0, 0, 0.0, ""
    for name, column in theirs.items():
        for k, (a, b) in enumerate(zip(ours[name], column, strict=True)):
            if b is None:
                continue
            count += 1
            if a == b:
                equal += 1
                continue
            error = math.inf if isinstance(a, str) else abs(a - b) / max(abs(a), abs(b), 1e-9)
            if not error <= worst:
                worst, where = error, f"{name} at point {k}: ours {a!r}, theirs {b!r}"
    return count, equal, worst, where


class Table:
    def __init__(self, mebots, folder):
        self.mebots, self.folder, self.failures, self.notes = mebots, folder, [], []
        self.references = {}

    def reference(self, name, system, left_out):
        """Returns mebots' results for the system without the parts in `left_out`."""
        key = (name, *left_out)
        if key not in self.references:
            self.references[key] = run_apart("mebots", without(system, left_out), self.mebots, self.folder)
        return self.references[key]

    def cell(self, name, system, tool):
        answer = run_apart(tool, system, self.mebots, self.folder)
        if "refused" in answer:
            if not name.startswith(PARTIAL):
                self.failures.append(f"{tool}, {name}: refused: {answer['refused']}")
            return f"refused: {answer['refused']}"
        reference = self.reference(name, system, answer["left_out"])
        if "refused" in reference:
            self.failures.append(f"mebots, {name}: {reference['refused']}")
            return f"mebots refuses: {reference['refused']}"
        count, equal, worst, where = difference(reference["columns"], answer["columns"])
        if count == 0 or not worst <= TOLERANCE.get(tool, 0):
            self.failures.append(f"{tool}, {name}: {worst:.2g}, {where}")
        text = ("same bits" if equal == count else f"{worst:.1g}") + f", {len(answer['columns'])} x {system['steps']}"
        if answer["left_out"]:
            if answer["left_out"] not in self.notes:
                self.notes.append(answer["left_out"])
            text += f" {self.notes.index(answer['left_out']) + 1})"
        return text


def main():
    if sys.argv[1:2] == ["--job"]:
        return do_job(*map(pathlib.Path, sys.argv[2:4]))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--tool", action="append", choices=("FMPy", "OMSimulator", "libcosim"))
    parser.add_argument("--system", action="append", help="the beginning of a system's name")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    chosen = arguments.tool or ["FMPy", "OMSimulator", "libcosim"]
    if "OMSimulator" in chosen and not tools.OMSimulator().program:
        print("OMSimulator is not installed (set OMSIMULATOR to its program)")
        if arguments.tool == ["OMSimulator"]:
            return MISSING
        chosen.remove("OMSimulator")
    print("| system | " + " | ".join(chosen) + " |\n" + "|---" * (1 + len(chosen)) + "|", flush=True)
    with tempfile.TemporaryDirectory(prefix="mebots interop ") as folder:
        table = Table(build / "bin" / "mebots", folder)
        for name, system in systems(build, pathlib.Path(folder)).items():
            if arguments.system and not any(name.startswith(start) for start in arguments.system):
                continue
            print(f"| {name} | " + " | ".join(table.cell(name, system, tool) for tool in chosen) + " |", flush=True)
    for number, left_out in enumerate(table.notes, 1):
        print(f"\n{number}) without " + ", ".join(f"`{part}`" for part in left_out))
    for failure in table.failures:
        print(f"FAILED: {failure}")
    return 1 if table.failures else 0


if __name__ == "__main__":
    sys.exit(main())
