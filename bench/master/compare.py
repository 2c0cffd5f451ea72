#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the cost of one communication step in mebots, OMSimulator, FMPy and libcosim.

Usage: compare.py MEBOTS PASSTHROUGH.fmu [--repeats N] [--processor-time] [--json FILE]

Each of SCENES runs without recording, and with every output of every step recorded as CSV. The cost of a tool is the slope
between a short and a long run, which excludes the time for starting. The tools alternate, so that other work on the machine
affects all of them. The result is in microseconds of wall time per communication step. With --processor-time, it is the processor
time of all threads, on which other work has less influence.

Searches for OMSimulator in $OMSIMULATOR and on PATH (its PyPI package fetches the program from its own server). FMPy and
libcosimpy come from PyPI: scripts/setup.sh bench. Lists missing tools.
"""

import argparse
import json
import os
import pathlib
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

STEP = 0.1
SCENES = {
    # Maps a name to the number of instances and to the connections as (from, to).
    "one FMU": (1, []),
    "chain of four": (4, [(0, 1), (1, 2), (2, 3)]),
    "ring of sixteen": (16, [(i, (i + 1) % 16) for i in range(16)]),
}


def processor_time():
    """Returns the processor time of all threads of this process and its children."""
    return sum(usage.ru_utime + usage.ru_stime
               for usage in (resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)))


clock = time.perf_counter


def timed(work):
    start = clock()
    work()
    return clock() - start


class Mebots:
    name = "mebots"
    steps = 2_000_000  # steps for a single FMU in the long run; fewer for more FMUs

    def __init__(self, program, fmu):
        self.program, self.fmu = program, fmu

    def run(self, scene, csv, steps, folder):
        count, connections = SCENES[scene]
        config = {
            "step": STEP,
            "stop_time": round(steps * STEP, 6),
            "instances": {f"i{i}": {"fmu": str(self.fmu)} for i in range(count)},
            "connections": [{"from": f"i{a}.y", "to": f"i{b}.u"} for a, b in connections],
        }
        config["instances"]["i0"]["parameters"] = {"u": 1.0} if scene != "ring of sixteen" else {}
        if not csv:
            config["record"] = {"variables": [], "interval": config["stop_time"]}
        (folder / "config.json").write_text(json.dumps(config))
        command = [self.program, "run", folder / "config.json", "--quiet", "--out", folder / "out"]
        return timed(lambda: subprocess.run(command, check=True))


class OMSimulator:
    name = "OMSimulator"
    steps = 400_000

    def __init__(self, program, fmu):
        self.program, self.fmu = program, fmu

    def run(self, scene, csv, steps, folder):
        count, connections = SCENES[scene]
        stop = round(steps * STEP, 6)
        lines = ['oms_setTempDirectory("tmp")', 'oms_newModel("m")', 'oms_addSystem("m.root", oms_system_wc)']
        lines += [f'oms_addSubModel("m.root.i{i}", "{self.fmu}")' for i in range(count)]
        lines += [f'oms_addConnection("m.root.i{a}.y", "m.root.i{b}.u")' for a, b in connections]
        lines += [
            f'oms_setResultFile("m", "{"out.csv" if csv else ""}")',
            f'oms_setStopTime("m", {stop})',
            f'oms_setFixedStepSize("m.root", {STEP})',
            f'oms_setLoggingInterval("m", {STEP})',
            'oms_instantiate("m")', 'oms_initialize("m")', 'oms_simulate("m")', 'oms_terminate("m")', 'oms_delete("m")',
        ]
        (folder / "run.lua").write_text("\n".join(lines) + "\n")
        command = [self.program, "--mode=cs", "run.lua"]
        return timed(lambda: subprocess.run(command, check=True, cwd=folder, stdout=subprocess.DEVNULL,
                                            stderr=subprocess.DEVNULL))


class Fmpy:
    """Runs one FMU with simulate_fmu, and several FMUs with a loop over FMPy's slaves, as a user would."""

    name = "FMPy"
    steps = 20_000

    def __init__(self, fmu):
        import fmpy
        import fmpy.fmi2
        import fmpy.util

        self.fmpy, self.fmu = fmpy, str(fmu)
        self.unpacked = fmpy.extract(self.fmu)
        self.description = fmpy.read_model_description(self.unpacked)

    def run(self, scene, csv, steps, folder):
        count, connections = SCENES[scene]
        if count == 1:
            def simulate():
                result = self.fmpy.simulate_fmu(self.unpacked, stop_time=steps * STEP, step_size=STEP,
                                                output_interval=STEP, output=None if csv else [],
                                                model_description=self.description, set_stop_time=False)
                if csv:
                    self.fmpy.util.write_csv(folder / "out.csv", result)
            return timed(simulate)
        slaves = []
        for i in range(count):
            slave = self.fmpy.fmi2.FMU2Slave(guid=self.description.guid, unzipDirectory=self.unpacked,
                                             modelIdentifier="passthrough", instanceName=f"i{i}")
            slave.instantiate()
            slave.setupExperiment(startTime=0.0)
            slave.enterInitializationMode()
            slave.exitInitializationMode()
            slaves.append(slave)

        def loop(file):
            outputs = [slave.getReal([1, 2]) for slave in slaves]
            for k in range(steps):
                for a, b in connections:
                    slaves[b].setReal([0], [outputs[a][0]])
                for slave in slaves:
                    slave.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)
                outputs = [slave.getReal([1, 2]) for slave in slaves]
                if file:
                    file.write(f"{(k + 1) * STEP!r},{','.join(repr(v) for pair in outputs for v in pair)}\n")
        if csv:
            with (folder / "out.csv").open("w") as file:
                result = timed(lambda: loop(file))
        else:
            result = timed(lambda: loop(None))
        for slave in slaves:
            slave.terminate()
            slave.freeInstance()
        return result


class Libcosim:
    """Runs libcosim with its default number of threads, because its C interface has no setting for it."""

    name = "libcosim"
    steps = 200_000

    def __init__(self, fmu):
        from libcosimpy.CosimExecution import CosimExecution
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
        from libcosimpy.CosimObserver import CosimObserver
        from libcosimpy.CosimSlave import CosimLocalSlave

        log_output_level(CosimLogLevel.WARNING)
        self.execution, self.observer, self.slave, self.fmu = CosimExecution, CosimObserver, CosimLocalSlave, str(fmu)

    def run(self, scene, csv, steps, folder):
        count, connections = SCENES[scene]
        step_ns = round(STEP * 1e9)
        execution = self.execution.from_step_size(step_size=step_ns)
        indices = [execution.add_local_slave(self.slave(fmu_path=self.fmu, instance_name=f"i{i}")) for i in range(count)]
        for a, b in connections:
            execution.connect_real_variables(indices[a], 1, indices[b], 0)
        if csv:
            observer = self.observer.create_to_dir(log_dir=str(folder))
            execution.add_observer(observer)

        def simulate():
            if not execution.step(steps):
                raise RuntimeError("libcosim did not step")
        return timed(simulate)


def available(arguments):
    tools, missing = [Mebots(arguments.mebots, arguments.fmu)], []
    program = os.environ.get("OMSIMULATOR") or shutil.which("OMSimulator")
    if program:
        tools.append(OMSimulator(program, arguments.fmu))
    else:
        missing.append("OMSimulator: not found (set OMSIMULATOR to its program)")
    for tool, package in ((Fmpy, "fmpy"), (Libcosim, "libcosimpy")):
        try:
            tools.append(tool(arguments.fmu))
        except ImportError as error:
            missing.append(f"{tool.name}: not found ({error}; scripts/setup.sh bench installs {package})")
    return tools, missing


def measure(tool, scene, csv):
    """Returns microseconds per communication step."""
    count = SCENES[scene][0]
    many = max(tool.steps // count, 1000)
    few = many // 10
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "tmp").mkdir()
        short = tool.run(scene, csv, few, folder)
        long = tool.run(scene, csv, many, folder)
    return (long - short) / (many - few) * 1e6


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mebots", type=pathlib.Path)
    parser.add_argument("fmu", type=pathlib.Path)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--processor-time", action="store_true", help="measure processor time instead of wall time")
    parser.add_argument("--json", type=pathlib.Path, help="write all figures there, too")
    arguments = parser.parse_args()
    arguments.mebots, arguments.fmu = arguments.mebots.resolve(), arguments.fmu.resolve()

    if arguments.processor_time:
        global clock
        clock = processor_time
    tools, missing = available(arguments)
    for text in missing:
        print(text)
    print(f"microseconds of {'processor' if arguments.processor_time else 'wall'} time per communication step, {arguments.repeats} interleaved repeats: min / median / max\n")
    figures = {}
    for csv in (False, True):
        for scene in SCENES:
            times = {tool.name: [] for tool in tools}
            for _ in range(arguments.repeats):
                for tool in tools:
                    times[tool.name].append(measure(tool, scene, csv))
            figures[f"{scene}, {'CSV' if csv else 'no recording'}"] = times
            ours = statistics.median(times["mebots"])
            print(f"{scene}, {'every output of every step as CSV' if csv else 'no recording'}")
            for name, values in times.items():
                middle = statistics.median(values)
                ratio = "" if name == "mebots" else f"   {middle / ours:8.1f} x mebots"
                print(f"  {name:<12} {min(values):9.3f} / {middle:9.3f} / {max(values):9.3f}{ratio}")
            sys.stdout.flush()
    if arguments.json:
        arguments.json.write_text(json.dumps(figures, indent=2) + "\n")


if __name__ == "__main__":
    main()
