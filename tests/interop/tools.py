# SPDX-License-Identifier: Apache-2.0
"""Runs a system in mebots, FMPy, OMSimulator and libcosim with the same fixed communication step.

A system is a config of mebots with absolute paths, plain connections, and `steps` in place of a stop time. Every tool returns
{"instance.variable": [value at t = 0, h, 2 h ...]} for the outputs that it supports, with None for a missing value. It also
returns the parts of the system that it does not support. If a tool rejects a system, raises Refused with the tool's message.
"""

import csv
import functools
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig

import fmpy
import fmpy.fmi2

POINTERS = (".base.lo", ".base.hi", ".size")  # of an OSMP buffer: addresses, which differ from run to run


class Refused(Exception):
    """Raised if a tool cannot run the system. The message contains the reason."""


@functools.cache
def read_description(fmu):
    """Reads a model description without FMPy's validation, because pythonfmu omits required attributes."""
    return fmpy.read_model_description(fmu, validate=False)


def description(instance):
    return read_description(instance["fmu"])


def of_python(instance):
    """True for FMUs of pythonfmu. They need the Python interpreter of the process that loads them."""
    return (description(instance).generationTool or "").startswith("PythonFMU")


def variables(instance):
    return {v.name: v for v in description(instance).modelVariables}


def outputs(instance, types=("Real", "Integer", "Boolean", "Enumeration", "String")):
    """Returns the outputs to compare. Includes String outputs only for FMUs of pythonfmu, because MEbots' FMUs compute the base64
    text of a picture at each read."""
    texts = of_python(instance)
    return [v for v in variables(instance).values() if v.causality == "output" and v.type in types
            and not v.name.endswith(POINTERS) and (v.type != "String" or texts)]


def plain_connections(system):
    """Returns (from, to, type) of every connection. For an OSMP buffer, returns three connections of type Integer."""
    known = {name: variables(instance) for name, instance in system["instances"].items()}
    result = []
    for connection in system["connections"]:
        (a, source), (b, target) = (connection[end].split(".", 1) for end in ("from", "to"))
        parts = [""] if source in known[a] else POINTERS
        result += [(f"{a}.{source}{part}", f"{b}.{target}{part}", known[a][source + part].type) for part in parts]
    return result


def number_of(variable, value):
    """Returns the number of an enumeration's item. Returns any other value unchanged."""
    if variable.type == "Enumeration" and isinstance(value, str):
        return next(int(item.value) for item in variable.declaredType.items if item.name == value)
    return value


def environment(system):
    """Returns the environment for a program that does not contain Python. If the system has FMUs of pythonfmu, preloads Python's
    library."""
    if not any(of_python(instance) for instance in system["instances"].values()):
        return dict(os.environ)
    library = pathlib.Path(sysconfig.get_config_var("LIBDIR")) / sysconfig.get_config_var("INSTSONAME")
    packages = next(path for path in sys.path if path.endswith("site-packages"))
    return dict(os.environ, LD_PRELOAD=str(library), PYTHONPATH=packages)


def last_words(text):
    """Returns the first error message of a tool, short enough for a table."""
    lines = [line.strip() for line in text.splitlines()
             if line.strip().startswith(("error:", "mebots: error:", "Failed to"))] or text.strip().splitlines()[-1:]
    line = re.sub(r"/\S*/", "", (lines or ["no word"])[0]).replace("|", "/")
    return line if len(line) < 160 else line[:157] + "..."


class Mebots:
    name = "mebots"

    def __init__(self, program):
        self.program = program

    def run(self, system, folder):
        config = {"step": system["step"], "stop_time": round(system["step"] * system["steps"], 9),
                  "instances": system["instances"], "connections": system["connections"],
                  "record": {"variables": [f"{name}.{v.name}" for name, i in system["instances"].items() for v in outputs(i)],
                             "texts": True}}
        config |= {key: system[key] for key in ("algorithm",) if key in system}
        (folder / "config.json").write_text(json.dumps(config))
        result = subprocess.run([self.program, "run", folder / "config.json", "--out", folder / "out", "--quiet"],
                                env=environment(system), capture_output=True, text=True)
        if result.returncode != 0:
            raise Refused(last_words(result.stderr))
        with (folder / "out" / "results.csv").open(newline="", encoding="utf-8") as file:
            header, *rows = csv.reader(file)
        names = [name.rsplit(" [", 1)[0] for name in header]
        texts = {f"{name}.{v.name}" for name, i in system["instances"].items() for v in outputs(i, ("String",))}
        return {name: [row[k] if name in texts else float(row[k]) for row in rows]
                for k, name in enumerate(names) if name != "time"}, []


class Fmpy:
    """Runs one FMU with simulate_fmu, and several FMUs with a loop over FMPy's slaves, as a user would write."""

    name = "FMPy"

    def run(self, system, folder):
        if len(system["instances"]) == 1 and not system["connections"]:
            return self.alone(system), []
        return self.coupled(system), []

    def alone(self, system):
        (name, instance), = system["instances"].items()
        known = variables(instance)
        recorded = [v.name for v in outputs(instance, ("Real", "Integer", "Boolean", "Enumeration"))]
        start = {n: number_of(known[n], v) for n, v in instance.get("parameters", {}).items()}
        h = system["step"]
        result = fmpy.simulate_fmu(instance["fmu"], stop_time=round(h * system["steps"], 9), step_size=h, output_interval=h, set_stop_time=False,
                                   start_values=start, output=recorded, validate=False)
        return {f"{name}.{n}": [float(v) for v in result[n]] for n in recorded}

    def coupled(self, system):
        slaves, known, tolerances = {}, {}, {}
        for name, instance in system["instances"].items():
            model = description(instance)
            known[name] = {v.name: v for v in model.modelVariables}
            slaves[name] = fmpy.fmi2.FMU2Slave(guid=model.guid, unzipDirectory=fmpy.extract(instance["fmu"]), instanceName=name,
                                               modelIdentifier=model.coSimulation.modelIdentifier)
            slaves[name].instantiate()
            tolerances[name] = model.defaultExperiment and model.defaultExperiment.tolerance

        def call(verb, path, *arguments):
            name, variable = path.split(".", 1)
            v = known[name][variable]
            kind = "Integer" if v.type == "Enumeration" else v.type
            return getattr(slaves[name], verb + kind)([v.valueReference], *arguments)

        def get(path):
            value = call("get", path)[0]
            return value.decode() if isinstance(value, bytes) else value

        for name, instance in system["instances"].items():
            for variable, value in instance.get("parameters", {}).items():
                call("set", f"{name}.{variable}", [number_of(known[name][variable], value)])
        for name, slave in slaves.items():
            tolerance = float(tolerances[name]) if tolerances[name] else None
            slave.setupExperiment(tolerance=tolerance, startTime=0.0)
            slave.enterInitializationMode()
        connections = plain_connections(system)

        def exchange():
            values = [get(source) for source, _, _ in connections]
            for (_, target, _), value in zip(connections, values):
                call("set", target, [value])

        for _ in range(2 * len(slaves)):  # repeated, so that initial values pass along chains of connections
            exchange()
        for slave in slaves.values():
            slave.exitInitializationMode()
        names = [f"{name}.{v.name}" for name, i in system["instances"].items() for v in outputs(i)]
        columns = {name: [get(name)] for name in names}
        for k in range(system["steps"]):
            exchange()
            for slave in slaves.values():
                slave.doStep(currentCommunicationPoint=k * system["step"], communicationStepSize=system["step"])
            for name in names:
                columns[name].append(get(name))
        for slave in slaves.values():
            slave.terminate()
            slave.freeInstance()
        return columns


class OMSimulator:
    """Runs a system in OMSimulator, found in $OMSIMULATOR or on PATH. The PyPI package would fetch the program from the project's
    server.

    OMSimulator does not connect Strings. In a loop of direct dependencies before t = 0, it supports only Reals. If it rejects a
    system, runs the system again with only the connections of Reals.
    """

    name = "OMSimulator"

    def __init__(self):
        self.program = os.environ.get("OMSIMULATOR") or shutil.which("OMSimulator")

    def script(self, system, kinds, folder):
        stop = round(system["step"] * system["steps"], 9)
        lines = [f'oms_setTempDirectory("{folder}")', 'oms_newModel("m")', 'oms_addSystem("m.root", oms_system_wc)']
        setters = {"Real": "oms_setReal", "Integer": "oms_setInteger", "Enumeration": "oms_setInteger",
                   "Boolean": "oms_setBoolean", "String": "oms_setString"}
        for name, instance in system["instances"].items():
            known = variables(instance)
            lines.append(f'oms_addSubModel("m.root.{name}", "{instance["fmu"]}")')
            for variable, value in instance.get("parameters", {}).items():
                literal = json.dumps(number_of(known[variable], value), ensure_ascii=False)
                lines.append(f'{setters[known[variable].type]}("m.root.{name}.{variable}", {literal})')
        lines += [f'oms_addConnection("m.root.{a}", "m.root.{b}")' for a, b, kind in plain_connections(system)
                  if kind in kinds]
        return "\n".join(lines + [
            f'oms_setResultFile("m", "{folder}/result.csv")', f'oms_setStopTime("m", {stop})',
            f'oms_setFixedStepSize("m.root", {system["step"]})', f'oms_setLoggingInterval("m", {system["step"]})',
            'oms_instantiate("m")', 'oms_initialize("m")', 'oms_simulate("m")', 'oms_terminate("m")', 'oms_delete("m")']) + "\n"

    def run(self, system, folder):
        kinds = {kind for _, _, kind in plain_connections(system)} - {"String"}
        try:
            return self.run_with(kinds, system, folder)
        except Refused:
            if kinds <= {"Real"}:
                raise
            return self.run_with({"Real"}, system, folder)

    def run_with(self, kinds, system, folder):
        left_out = [f"{a} -> {b}" for a, b, kind in plain_connections(system) if kind not in kinds]
        (folder / "run.lua").write_text(self.script(system, kinds, folder))
        result = subprocess.run([self.program, "--mode=cs", "run.lua"], cwd=folder, env=environment(system),
                                capture_output=True, text=True)
        if result.returncode != 0 or "error:" in result.stdout + result.stderr or not (folder / "result.csv").exists():
            raise Refused(last_words(result.stdout + "\n" + result.stderr))
        rows = read_csv(folder / "result.csv", lambda name: name.strip('"').removeprefix("m.root.").removeprefix("root."))
        points = at_points(rows["time"], system["step"], system["steps"])
        names = [f"{name}.{v.name}" for name, i in system["instances"].items()
                 for v in outputs(i, ("Real", "Integer", "Boolean", "Enumeration"))]
        return {name: [rows[name][i] for i in points] for name in names if name in rows}, left_out


def read_csv(path, clean):
    """Returns the columns of a CSV file of numbers by the names that `clean` returns. Skips the line that defines the separator
    for spreadsheets."""
    with path.open(newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith('"sep=')))
    names = [clean(name) for name in rows[0]]
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(names)}


def at_points(times, step, steps):
    """Returns the index of the last row of every communication point. OMSimulator writes several rows at an event."""
    last = {round(time / step): row for row, time in enumerate(times)}
    return [last[k] for k in range(steps + 1)]


class Libcosim:
    """Runs a system in libcosim. Its interface does not support enumerations, so connections and parameters of enumerations are
    omitted and listed."""

    name = "libcosim"
    types = {"Real": "real", "Integer": "integer", "Boolean": "boolean", "String": "string"}

    def connect(self, execution, kind):
        if kind == "Integer":  # libcosimpy 0.0.6 declares a member with one name and uses it with another
            return functools.partial(execution._CosimExecution__connect_int_variables, execution._CosimExecution__ptr)
        return getattr(execution, f"connect_{self.types[kind]}_variables")

    def run(self, system, folder):
        from libcosimpy.CosimExecution import CosimExecution
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
        from libcosimpy.CosimObserver import CosimObserver
        from libcosimpy.CosimSlave import CosimLocalSlave

        log_output_level(CosimLogLevel.ERROR)
        left_out = []
        execution = CosimExecution.from_step_size(step_size=round(system["step"] * 1e9))
        known, slaves = {}, {}
        for name, instance in system["instances"].items():
            slave = CosimLocalSlave(fmu_path=instance["fmu"], instance_name=name)
            if not slave.ptr():
                raise Refused("does not load the FMU")
            slaves[name] = execution.add_local_slave(local_slave=slave)
            known[name] = variables(instance)
            for variable, value in instance.get("parameters", {}).items():
                v = known[name][variable]
                if v.type not in self.types:
                    left_out.append(f"{name}.{variable}")
                elif not getattr(execution, f"{self.types[v.type]}_initial_value")(slaves[name], v.valueReference, value):
                    raise Refused(f"refuses {name}.{variable} = {value}")

        def end(path):
            name, variable = path.split(".", 1)
            return slaves[name], known[name][variable].valueReference

        for source, target, kind in plain_connections(system):
            if kind not in self.types:
                left_out.append(f"{source} -> {target}")
            elif self.connect(execution, kind)(*end(source), *end(target)) != 0:
                raise Refused(f"refuses the connection {source} -> {target}")
        observer = CosimObserver.create_last_value()
        execution.add_observer(observer=observer)
        shown = [(name, word, outputs(instance, (kind,))) for name, instance in system["instances"].items()
                 for kind, word in self.types.items() if outputs(instance, (kind,))]
        # The observer has no values before the first step.
        columns = {f"{name}.{v.name}": [None] for name, _, chosen in shown for v in chosen}
        for _ in range(system["steps"]):
            if not execution.step(step_count=1):
                raise Refused("does not step")
            for name, word, chosen in shown:
                values = getattr(observer, f"last_{word}_values")(slaves[name], [v.valueReference for v in chosen])
                for v, value in zip(chosen, values):
                    columns[f"{name}.{v.name}"].append(value.decode() if isinstance(value, bytes) else value)
        return columns, left_out
