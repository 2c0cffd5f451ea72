# SPDX-License-Identifier: Apache-2.0
"""Runs an OspSystemStructure.xml whose FMUs are for Windows with a master that shares no code with MEbots. Compares all values
with those of `mebots run`.

    osp_system.py WINE RUN_FMU_EXE MEBOTS SYSTEM STOP_TIME

Each FMU is in its own run_fmu (fly.py). Outputs at a communication point are inputs of the next step. During initialisation,
outputs are passed to the connected inputs until no output changes. The exit code is 1 if a value differs.
"""

import csv
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from compare import Fmu, bits
from fly import Instance

TURNS = 10
PLACE = "{http://opensimulationplatform.com/MSMI/OSPSystemStructure}"


class System:
    """A system's FMUs, connections and step."""

    def __init__(self, file, folder):
        root = ElementTree.parse(file).getroot()
        self.simulators = {node.get("name"): node for node in root.iter(PLACE + "Simulator")}
        self.files = {name: file.parent / node.get("source") for name, node in self.simulators.items()}
        self.fmus = {name: Fmu(archive, folder / name) for name, archive in self.files.items()}
        steps = {float(node.get("stepSize") or root.find(PLACE + "BaseStepSize").text) for node in self.simulators.values()}
        if len(steps) > 1:
            sys.exit(f"{file}: its FMUs have different steps, which this program does not support")
        self.step_s = steps.pop()
        self.links = [self._link(*node) for node in root.iter(PLACE + "VariableConnection")]
        for node in root.iter(PLACE + "VariableGroupConnection"):
            one, other = ([(end.get("simulator"), variable) for variable in self._group(*map(end.get, ("simulator", "name")))] for end in node)
            self.links += [self._directed(*ends) for ends in zip(one, other, strict=True)]

    def _link(self, one, other):
        return self._directed(*((end.get("simulator"), end.get("name")) for end in (one, other)))

    def _directed(self, one, other):
        """Returns the output and the input of a connection of two variables."""
        causalities = {variable: causality for variable, _, causality, _, _ in self.fmus[one[0]].variables}
        return (other, one) if causalities[one[1]] == "input" else (one, other)

    def _group(self, simulator, name):
        file = self.files[simulator].with_name(self.files[simulator].stem + "_OspModelDescription.xml")
        group = next(node for node in ElementTree.parse(file).iter() if node.get("name") == name)
        parts = sorted(group, key=lambda node: node.tag)  # by kind, because a port may list velocity and force in any order
        return [node.get("ref") for part in parts for node in part.iter() if node.get("ref")]

    def start(self, name, command):
        """Returns an instance in initialisation mode, with the initial values of the system."""
        instance = Instance(name, self.fmus[name], "win64", command)
        own = [instance.parameter(node.get("variable"), float(node[0].get("value"))) for node in self.simulators[name].iter(PLACE + "InitialValue")]
        instance.send([*instance.start, *own, "enter", *instance.reads])
        return instance

    def orders(self, instance, values):
        """Returns the lines for run_fmu that set the connected inputs of an instance."""
        return [instance.set(target[1], values[source]) for source, target in self.links if target[0] == instance.name]

    def started(self, command):
        """Returns the instances and their outputs after initialisation."""
        instances = [self.start(name, command) for name in self.fmus]
        values = read(instances)
        for _ in range(TURNS):
            before = values
            for instance in instances:
                instance.send([*self.orders(instance, values), *instance.reads])
            values = read(instances)
            if values == before:
                break
        else:
            sys.exit(f"the outputs at the start still change after {TURNS} turns")
        for instance in instances:
            instance.send(["exit", *instance.reads])
        return instances, read(instances)

    def points(self, command, count):
        """Yields all outputs at each communication point."""
        instances, values = self.started(command)
        yield values
        for step in range(count - 1):
            for instance in instances:
                instance.send([*self.orders(instance, values), f"step {bits(self.time(step))} {bits(self.step_s)}", *instance.reads])
            values = read(instances)
            yield values
        for instance in instances:
            instance.close()

    def time(self, step):
        """Returns the time of a communication point: a whole number of nanoseconds, divided by 1e9."""
        return round(step * self.step_s, 9)

    def number(self, variable, word):
        """Converts the hexadecimal digits that run_fmu has written to a number."""
        kinds = {name: kind for name, kind, _, _, _ in self.fmus[variable[0]].variables}
        return struct.unpack(">d", bytes.fromhex(word.zfill(16)))[0] if kinds[variable[1]] == "real" else float(int(word, 16))


def read(instances):
    return {(instance.name, output): word for instance in instances for output, word in zip(instance.outputs, instance.receive(), strict=True)}


def recorded(program, file, stop_time, folder):
    """Returns the rows of `mebots run`: for each time, the values by name."""
    command = [program, "run", file, "--stop-time", stop_time, "--quiet", "--record", "*", "--out", folder]
    subprocess.run(command, check=True, capture_output=True)
    with (folder / "results.csv").open(newline="", encoding="utf-8") as table:
        header, *rows = csv.reader(table)
    names = [name.rsplit(" [", 1)[0] for name in header]
    return {round(float(row[0]), 9): dict(zip(names, row)) for row in rows}


def main():
    wine, loader, program, file, stop_time = sys.argv[1:]
    different, count = {}, 0
    with tempfile.TemporaryDirectory(prefix="mebots system ") as folder:
        system = System(Path(file), Path(folder))
        rows = recorded(program, file, stop_time, Path(folder) / "out")
        points = system.points([wine, loader], round(float(stop_time) / system.step_s) + 1)
        for step, values in enumerate(points):
            row = rows[system.time(step)]
            for variable, word in values.items():
                text = row.get(".".join(variable))
                if text is None:
                    continue
                count += 1
                number = system.number(variable, word)
                if number != float(text):
                    different.setdefault(".".join(variable), []).append((step, number, float(text)))
    print(f"{file}, {stop_time} s: {count - sum(map(len, different.values()))} of {count} values equal, {len(system.links)} connections")
    for name, found in different.items():
        print(f"  {name}: {len(found)} values differ; at step {found[0][0]}: {found[0][1]!r}, mebots has {found[0][2]!r}")
    return 1 if different or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
