#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares an FMU of FMI 3.0 with its twin of FMI 2.0 in FMPy. Both must give the same bits, alone and (with --connected) in a
system.

Usage: twins_check.py FOLDER NAME
       twins_check.py FOLDER --connected CONFIG.json --until SECONDS --step SECONDS

FOLDER contains NAME.fmu and NAME_fmi3.fmu. Alone, both receive the inputs of the reference trace of NAME.fmu. In a system, both
have the connections of the config. Pictures pass as OSMP triples in FMI 2.0, and as Binary in FMI 3.0.
"""

import argparse
import collections
import csv
import ctypes
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import fmpy
import fmpy.fmi2
import fmpy.fmi3
import fmpy.validation
from lxml import etree

SCHEMAS = pathlib.Path(fmpy.__file__).parent / "schema" / "fmi3"
OSMP = (".base.lo", ".base.hi", ".size")


def check(condition, message):
    if not condition:
        sys.exit(f"FAILED: {message}")
    print(f"ok: {message}")


def signed(number):
    """Returns the low 32 bits as an Integer of FMI 2.0."""
    return ctypes.c_int32(number & 0xFFFFFFFF).value


class Two:
    """An instance of FMI 2.0. Its values are accessed by scalar name. An OSMP triple counts as one value, its bytes."""

    def __init__(self, archive, folder, name):
        self.description = fmpy.read_model_description(str(archive))
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.buffers = {}
        self.fmu = fmpy.fmi2.FMU2Slave(guid=self.description.guid, unzipDirectory=str(folder), instanceName=name,
                                       modelIdentifier=self.description.coSimulation.modelIdentifier)
        self.fmu.instantiate()

    def names(self, causality):
        found = [v.name for v in self.description.modelVariables if v.causality == causality]
        whole = [n.removesuffix(OSMP[0]) for n in found if n.endswith(OSMP[0])]
        return [n for n in found if not any(n == w + part for w in whole for part in OSMP)] + whole

    def begin(self):
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()

    def of_type(self, name):
        kind = self.variables[name].type
        return {"Enumeration": "Integer"}.get(kind, kind)

    def number_of(self, name, value):
        """Returns the number of an enumeration's item that a config names."""
        variable = self.variables[name]
        if variable.type != "Enumeration" or not isinstance(value, str):
            return value
        return next(int(item.value) for item in variable.declaredType.items if item.name == value)

    def get(self, name):
        if name + OSMP[0] in self.variables:
            low, high, size = (self.get(name + part) for part in OSMP)
            address = ((high & 0xFFFFFFFF) << 32) | (low & 0xFFFFFFFF)
            return ctypes.string_at(address, size) if address and size > 0 else b""
        value = getattr(self.fmu, "get" + self.of_type(name))([self.variables[name].valueReference])[0]
        if self.of_type(name) == "Boolean":
            return bool(value)
        return value.decode() if isinstance(value, bytes) else value

    def set(self, values):
        for name, value in values.items():
            if isinstance(value, bytes):
                buffer = self.buffers[name] = ctypes.create_string_buffer(value, len(value))
                address = ctypes.addressof(buffer) if value else 0
                self.set({name + part: number for part, number in
                          zip(OSMP, (signed(address), signed(address >> 32), len(value)))})
                continue
            convert = {"Real": float, "Integer": int, "Boolean": bool, "String": str}[self.of_type(name)]
            getattr(self.fmu, "set" + self.of_type(name))([self.variables[name].valueReference], [convert(value)])


class Three:
    """An instance of the twin of FMI 3.0, with access by the scalar names of FMI 2.0. The value reference of a variable in FMI
    3.0 is that of its first scalar in FMI 2.0.
    """

    def __init__(self, archive, folder, name, twin):
        self.description = fmpy.read_model_description(str(archive))
        self.places = {}  # scalar name -> variable, index of the element
        by_row = {v.valueReference: v.name for v in twin.description.modelVariables}
        for variable in self.description.modelVariables:
            if variable.causality == "independent":
                continue
            stride = len(OSMP) if variable.type == "Binary" else 1
            for element in range(variable.shape[0] if variable.shape else 1):
                scalar = by_row.pop(variable.valueReference + element * stride)
                if variable.type == "Binary":
                    scalar = scalar.removesuffix(OSMP[0])
                    by_row.pop(variable.valueReference + element * stride + 1)
                    by_row.pop(variable.valueReference + element * stride + 2)
                self.places[scalar] = (variable, element)
        if by_row:
            sys.exit(f"FAILED: FMI 3.0 lacks {', '.join(by_row.values())}")
        self.inputs = {}  # variable name -> last set values of its elements
        self.fmu = fmpy.fmi3.FMU3Slave(guid=self.description.guid, unzipDirectory=str(folder), instanceName=name,
                                       modelIdentifier=self.description.coSimulation.modelIdentifier)
        self.fmu.instantiate()

    def begin(self):
        self.fmu.enterInitializationMode(startTime=0.0)

    @staticmethod
    def of_type(variable):
        return {"Enumeration": "Int64"}.get(variable.type, variable.type)

    def values(self, variable):
        count = variable.shape[0] if variable.shape else 1
        values = getattr(self.fmu, "get" + self.of_type(variable))([variable.valueReference], nValues=count)
        return [b"" if value is None else value for value in values]

    def get(self, name):
        variable, element = self.places[name]
        return self.values(variable)[element]

    def set(self, values):
        changed = {}
        for name, value in values.items():
            variable, element = self.places[name]
            elements = self.inputs.setdefault(variable.name, self.values(variable))
            convert = {"Float64": float, "Boolean": bool, "String": str, "Binary": bytes}.get(variable.type, int)
            elements[element] = convert(value)
            changed[variable.name] = variable
        for name, variable in changed.items():
            if variable.causality == "structuralParameter":
                self.fmu.fmi3EnterConfigurationMode(self.fmu.component)
            getattr(self.fmu, "set" + self.of_type(variable))([variable.valueReference], self.inputs[name])
            if variable.causality == "structuralParameter":
                self.fmu.fmi3ExitConfigurationMode(self.fmu.component)


class Twins:
    """Unpacks the FMI 2.0 and FMI 3.0 versions of an FMU, and creates an instance of each."""

    def __init__(self, folder, name, into):
        self.archives = [folder / f"{name}.fmu", folder / f"{name}_fmi3.fmu"]
        self.folders = [into / name, into / f"{name} of 3.0 ä"]
        for archive, unpacked in zip(self.archives, self.folders):
            fmpy.extract(str(archive), str(unpacked))

    def instances(self, name):
        two = Two(self.archives[0], self.folders[0], name)
        return two, Three(self.archives[1], self.folders[1], name, two)


def step(instance, time, h):
    instance.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=h)


def compare(two, three, names, time):
    for name in names:
        first, second = two.get(name), three.get(name)
        if first != second or type(first) is not type(second):
            sys.exit(f"FAILED: at {time} s, {name} is {first!r} in FMI 2.0 and {second!r} in FMI 3.0")
    return len(names)


def check_archive(archive, folder):
    problems = fmpy.validation.validate_fmu(str(archive))
    check(not problems, f"fmpy validate, which knows the XML schema of FMI 3.0, says nothing: {problems}")
    description = etree.parse(str(folder / "modelDescription.xml"))
    names = {v.get("name") for v in description.find("ModelVariables")}
    terminals = folder / "terminalsAndIcons" / "terminalsAndIcons.xml"
    if terminals.exists():
        document = etree.parse(str(terminals))
        schema = etree.XMLSchema(etree.parse(str(SCHEMAS / "fmi3TerminalsAndIcons.xsd")))
        check(schema.validate(document), f"terminalsAndIcons.xml is valid: {schema.error_log}")
        members = [m.get("variableName") for m in document.iter("TerminalMemberVariable")]
        check(set(members) <= names, f"all {len(members)} members of terminals are variables")
        check((folder / "terminalsAndIcons" / "icon.png").exists() == (document.find("GraphicalRepresentation") is not None),
              "an icon is there if the terminals' file announces one")
    library = next((folder / "binaries" / "x86_64-linux").glob(f"{description.find('CoSimulation').get('modelIdentifier')}.so"))
    symbols = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    exported = {line.split()[-1] for line in symbols.splitlines()} - {"mebots_keeps_no_state_outside_instances"}
    header = (pathlib.Path(fmpy.__file__).parent / "c-code" / "fmi3Functions.h").read_text()
    wanted = set(re.findall(r"fmi3FullName\((fmi3\w+)\)", header))
    check(exported == wanted, f"exports the {len(wanted)} functions of FMI 3.0 and nothing else: {exported ^ wanted}")


def read_inputs(folder):
    reference = folder / "documentation" / "reference"
    (cases,) = reference.glob("*.mebots-test.json")
    path = reference / json.loads(cases.read_text())["cases"]["recorded"]["inputs"]
    with path.open(newline="") as file:
        return [{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(file)]


def at(inputs, time):
    row = [r for r in inputs if r["time"] <= time + 1e-9][-1]
    return {name: value for name, value in row.items() if name != "time"}


def check_alone(twins, points):
    """Compares outputs for the reference inputs. Also restores a state in a second instance of FMI 3.0."""
    inputs = read_inputs(twins.folders[0])
    two, three = twins.instances("first")
    _, other = twins.instances("second")
    outputs = [n for n in two.names("output")]
    h = two.description.defaultExperiment.stepSize
    h = float(h) * max(1, round(inputs[-1]["time"] / points / float(h)))
    for instance in (two, three, other):
        instance.begin()
        instance.set(at(inputs, 0.0))
        instance.fmu.exitInitializationMode()
    compared = compare(two, three, outputs, 0.0)
    for k in range(points):
        for instance in (two, three):
            instance.set(at(inputs, k * h))
            step(instance, k * h, h)
        compared += compare(two, three, outputs, (k + 1) * h)
        if k == points // 2:
            state = three.fmu.getFMUState()
            data = three.fmu.serializeFMUState(state)
            three.fmu.freeFMUState(state)
            state = other.fmu.deserializeFMUState(data)
            other.fmu.setFMUState(state)
            other.fmu.freeFMUState(state)
        if k > points // 2:
            other.set(at(inputs, k * h))
            step(other, k * h, h)
    check(True, f"{compared} values at {points + 1} points from 0 to {points * h:g} s are the same to the last bit")
    compare(two, other, outputs, points * h)
    check(True, "a second instance resumes from a serialised state of the first with the same bits")
    for instance in (two, three, other):
        instance.fmu.terminate()
        instance.fmu.freeInstance()


def check_connected(folder, into, config_file, until, h):
    config = json.loads(config_file.read_text())
    instances = {}
    for name, instance in config["instances"].items():
        fmu = pathlib.Path(instance["fmu"]).stem
        two, three = Twins(folder, fmu, into / name).instances(name)
        parameters = {k: two.number_of(k, v) for k, v in instance.get("parameters", {}).items()}
        for twin in (two, three):
            twin.set(parameters)
        instances[name] = (two, three)
    into_inputs = collections.defaultdict(list)
    for connection in config["connections"]:
        source, output = connection["from"].split(".", 1)
        target, name = connection["to"].split(".", 1)
        into_inputs[target].append((source, output, name))
    both = list(instances.values())
    for kind in (0, 1):
        for name, twins in instances.items():
            twins[kind].begin()
        for name, twins in instances.items():
            twins[kind].fmu.exitInitializationMode()
    pictures, compared = set(), 0
    steps = round(until / h)
    for k in range(steps):
        for kind in (0, 1):
            values = {target: {name: instances[source][kind].get(output) for source, output, name in sources}
                      for target, sources in into_inputs.items()}
            for target, row in values.items():
                instances[target][kind].set(row)
            for name, twins in instances.items():
                step(twins[kind], k * h, h)
        for two, three in both:
            compared += compare(two, three, two.names("output"), (k + 1) * h)
            pictures |= {v for n in two.names("output") if isinstance(v := two.get(n), bytes)} - {b""}
    check(len(pictures) > 1, f"{len(pictures)} different pictures passed")
    check(True, f"{compared} values of {len(instances)} FMUs in {steps} steps are the same to the last bit")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("name", nargs="?")
    parser.add_argument("--connected", type=pathlib.Path)
    parser.add_argument("--until", type=float, default=1.0)
    parser.add_argument("--step", type=float, default=0.01)
    parser.add_argument("--points", type=int, default=100)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as into:
        into = pathlib.Path(into)
        if arguments.connected:
            check_connected(arguments.folder, into, arguments.connected, arguments.until,
                            arguments.step)
            return
        twins = Twins(arguments.folder, arguments.name, into)
        check_archive(twins.archives[1], twins.folders[1])
        check_alone(twins, arguments.points)


if __name__ == "__main__":
    main()
