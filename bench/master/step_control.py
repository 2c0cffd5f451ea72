# SPDX-License-Identifier: Apache-2.0
"""Measures the error over the number of steps, with fixed and with controlled communication steps.

The system is libcosim's quarter truck. Compares the result with libcosim's ECCO. Writes a Markdown table and a figure.

    step_control.py MEBOTS FOLDER OSCILLATOR.fmu [--out docs/img/step_control.png]

FOLDER is tests/data/fmi2/quarter_truck of a checkout of libcosim (github.com/open-simulation-platform/libcosim). It contains
Chassis.fmu and Wheel.fmu. libcosimpy comes from PyPI (scripts/setup.sh bench). If it is missing, the comparison with ECCO is omitted.

OSCILLATOR.fmu is built from tests/fmus/oscillator.c. With it, the same truck is at rest for 1.0034 s. Then its wheel meets a kerb
that the master cannot predict. The states of this FMU can be restored. The states of libcosim's FMUs cannot: while a state is
stored, these FMUs return to their first saved state in every step (noSetFMUStatePriorToCurrentPoint = false).

The truck is linear (nd = 0.5), so its exact course is a matrix exponential. Steps inside the FMUs are so short that their own
error is below the error of the coupling. The error is the largest difference of the positions of chassis and wheel from the exact
course at any communication point within 4 s, divided by the largest position.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml
import zipfile

import numpy

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(REPOSITORY / "scripts"))

SECONDS = 4
KERB_TIME = 1.0034
TICK = 1e-5
INNER = 1e-5
MASS, WHEEL_MASS, SPRING, DAMPER, TIRE, GROUND = 400.0, 40.0, 15000.0, 1000.0, 150000.0, 0.1
NAMESPACE = "http://opensimulationplatform.com/MSMI/OSPSystemStructure"


class ExactTruck:
    """Computes the exact positions of chassis and wheel over time. The ground rises at `kerb_time`."""

    def __init__(self, kerb_time):
        self.kerb_time = kerb_time
        # The states are chassis position and velocity, and wheel position and velocity. Positions are relative to rest.
        a = numpy.array([[0, 1, 0, 0],
                         [-SPRING / MASS, -DAMPER / MASS, SPRING / MASS, DAMPER / MASS],
                         [0, 0, 0, 1],
                         [SPRING / WHEEL_MASS, DAMPER / WHEEL_MASS, -(SPRING + TIRE) / WHEEL_MASS, -DAMPER / WHEEL_MASS]])
        self.values, self.vectors = numpy.linalg.eig(a)
        self.weights = numpy.linalg.solve(self.vectors, numpy.array([-GROUND, 0, -GROUND, 0], dtype=complex))

    def positions(self, times):
        modes = self.weights[:, None] * numpy.exp(numpy.outer(self.values, numpy.maximum(times - self.kerb_time, 0)))
        return (self.vectors @ modes).real[[0, 2]] + GROUND


def error_of(exact, times, chassis, wheel):
    right = exact.positions(numpy.array(times))
    return numpy.abs(right - numpy.array([chassis, wheel])).max() / numpy.abs(right).max()


class LibcosimTruck:
    """The truck of libcosim's FMUs. The ground rises at the start."""

    kerb_time = 0.0
    positions = ("chassis.position", "wheel.position")
    effort, flow = "chassis.force", "wheel.in_vel"
    shift = 0.0

    def __init__(self, folder):
        inner = {"solverType": "Euler", "timeStep": INNER}
        self.instances = {"chassis": {"fmu": str(folder / "Chassis.fmu"), "parameters": dict(inner, mass=MASS)},
                          "wheel": {"fmu": str(folder / "Wheel.fmu"), "parameters": dict(inner, mass=WHEEL_MASS)}}
        self.connections = [("chassis.velocity", self.flow), ("wheel.out_spring_damper_f", self.effort)]


class OwnTruck:
    """The quarter truck of MEbots' FMUs. Positions are relative to the truck's final position on the kerb."""

    kerb_time = KERB_TIME
    positions = ("chassis.x", "wheel.x")
    effort, flow = "chassis.force", "wheel.other_velocity"
    shift = GROUND

    def __init__(self, fmu):
        self.instances = {
            "chassis": {"fmu": str(fmu), "parameters": {"mass": MASS, "stiffness": 0.0, "x": -GROUND}},
            "wheel": {"fmu": str(fmu), "parameters": {"mass": WHEEL_MASS, "stiffness": TIRE, "grip": SPRING, "damping": DAMPER,
                                                      "x": -GROUND, "y": -GROUND, "rest": -GROUND, "rest_until": KERB_TIME}}}
        self.connections = [("chassis.velocity", self.flow), ("wheel.pull", self.effort)]


def held(fmu, target):
    """Writes a copy of the FMU without time derivatives, which libcosim's FMUs do not have either."""
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(target, "w") as copy:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                content = content.replace(b'canInterpolateInputs="true" maxOutputDerivativeOrder="1"', b"")
            copy.writestr(name, content)
    return target


def config(truck, step, control=None, algorithm="jacobi"):
    system = {"step": step, "stop_time": SECONDS, "algorithm": algorithm, "instances": truck.instances,
              "connections": [{"from": source, "to": target} for source, target in truck.connections],
              "record": list(truck.positions)}
    if control:
        system["coupling"] = {"bonds": {"suspension": {"effort": truck.effort, "flow": truck.flow}}}
        system["step_control"] = control
    return system


def run(mebots, truck, *settings, **more):
    """Simulates a truck with mebots. Returns the number of steps, including repeated steps, and the error relative to the exact
    course."""
    exact = ExactTruck(truck.kerb_time)
    system = config(truck, *settings, **more)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "truck.json").write_text(json.dumps(system))
        subprocess.run([mebots, "run", folder / "truck.json", "--out", folder / "out"], check=True, capture_output=True)
        with open(folder / "out" / "results.csv", newline="", encoding="utf-8") as file:
            rows = numpy.array([[float(cell) for cell in row] for row in list(csv.reader(file))[1:]])
        summary = json.loads((folder / "out" / "summary.json").read_text())
    repeated = summary.get("step_control", {}).get("rejected_steps", 0)
    return summary["steps"] + repeated, error_of(exact, rows[:, 0], *(rows[:, 1:3].T + truck.shift))


def ecco(folder, tolerance):
    """Runs libcosim with the settings of its example, except the tolerances. Returns the number of steps and the error.
    """
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    exact = ExactTruck(0.0)
    log_output_level(CosimLogLevel.ERROR)
    tree = xml.parse(folder / "OspSystemStructure.xml")
    for value in tree.iterfind(f".//{{{NAMESPACE}}}InitialValue[@variable='timeStep']/{{{NAMESPACE}}}Real"):
        value.set("value", str(INNER))
    for key in ("RelativeTolerance", "AbsoluteTolerance"):
        tree.find(f".//{{{NAMESPACE}}}{key}").text = str(tolerance)
    with tempfile.TemporaryDirectory() as name:
        for file in folder.iterdir():
            if file.suffix in (".fmu", ".xml"):
                (pathlib.Path(name) / file.name).symlink_to(file)
        target = pathlib.Path(name) / "OspSystemStructure.xml"
        target.unlink()
        xml.register_namespace("", NAMESPACE)
        tree.write(target)
        execution = CosimExecution.from_osp_config_file(osp_path=name)
        observer = CosimObserver.create_last_value()
        execution.add_observer(observer=observer)
        chassis, wheel = (execution.slave_index_from_instance_name(instance) for instance in ("chassis", "wheel"))
        times, positions = [], []
        while not times or times[-1] < SECONDS:
            if not execution.step(step_count=1):
                raise RuntimeError("libcosim did not step")
            times.append(execution.status().current_time * 1e-9)
            positions.append([observer.last_real_values(chassis, [11])[0], observer.last_real_values(wheel, [18])[0]])
    positions = numpy.array(positions)
    return len(times), error_of(exact, times, *positions.T)


STEPS = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
TOLERANCES = (1, 0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4)


def measure_truck(mebots, truck, rollback, add):
    bond = {truck.effort: False, truck.flow: False}
    signals = {"suspension": False, truck.effort: {}, truck.flow: {}}
    for step in STEPS:
        add("fixed", f"{step:g} s", run(mebots, truck, step))
    for tolerance in TOLERANCES:
        control = {"max_step": 0.05, "relative_tolerance": tolerance, "initial_step": 1e-4, "rollback": rollback}
        add("bond", f"{tolerance:g}", run(mebots, truck, TICK, dict(control, tolerances=bond)))
        add("signals", f"{tolerance:g}", run(mebots, truck, TICK, dict(control, tolerances=signals)))


def measure(mebots, folder, fmu):
    """Measures all trucks with all kinds of steps. Returns {truck: {kind of step: [(setting, steps, error)]}}."""
    trucks = {}

    def adder(truck, suffix=""):
        def add(way, setting, result):
            trucks.setdefault(truck, {}).setdefault(way + suffix, []).append((setting, *result))
            print(f"{truck}, {way}{suffix}, {setting}: {result[0]} steps, error {result[1]:.3g}", file=sys.stderr, flush=True)
        return add

    of_libcosim = adder("Rising ground at the start, FMUs of libcosim")
    measure_truck(mebots, LibcosimTruck(folder), "never", of_libcosim)
    kerb = "A kerb that is not announced, FMUs with states"
    with tempfile.TemporaryDirectory() as name:
        truck = OwnTruck(held(fmu, pathlib.Path(name) / "held.fmu"))
        measure_truck(mebots, truck, "never", adder(kerb))
        measure_truck(mebots, truck, "required", adder(kerb, " with rollback"))
    trucks[kerb].pop("fixed with rollback")
    try:
        import libcosimpy  # noqa: F401
    except ImportError:
        print("libcosimpy is missing: no curve of ECCO", file=sys.stderr)
        return trucks
    for tolerance in (1, 0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4, 1e-5):
        of_libcosim("ECCO of libcosim", f"{tolerance:g}", ecco(folder, tolerance))
    return trucks


def draw(trucks, out):
    import figure_style as style

    colours = {"fixed": style.GREY, "bond": style.BLUE, "signals": style.GREEN, "bond with rollback": style.SKY,
               "signals with rollback": style.OCHRE, "ECCO of libcosim": style.VERMILION}
    figure, panels = style.plt.subplots(1, 2, figsize=(10, 4.4), sharex=True, sharey=True, layout="constrained")
    for panel, (title, ways) in zip(panels, trucks.items(), strict=True):
        for name, rows in ways.items():
            _, steps, errors = zip(*sorted(rows, key=lambda row: row[1]), strict=True)
            panel.plot(steps, errors, "o-", color=colours[name], markersize=4, label=name)
        panel.set(xscale="log", yscale="log", xlabel="communication steps in 4 s, repeated ones included", title=title)
        panel.grid(True)
        panel.legend()
    panels[0].set_ylabel("largest error of the positions, relative")
    style.save(figure, out)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("mebots", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("fmu", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    trucks = measure(arguments.mebots.resolve(), arguments.folder.resolve(), arguments.fmu.resolve())
    print("| truck | way | setting | steps | error |\n|---|---|---|---|---|")
    for truck, ways in trucks.items():
        for way, rows in ways.items():
            for setting, steps, error in rows:
                print(f"| {truck} | {way} | {setting} | {steps} | {error:.3g} |")
    if arguments.out:
        draw(trucks, arguments.out)


if __name__ == "__main__":
    main()
