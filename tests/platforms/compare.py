# SPDX-License-Identifier: Apache-2.0
"""Compares an FMU's binaries for other platforms with the binary for this machine, value by value.

    compare.py --loader PLATFORM=COMMAND... FMU...

COMMAND is run_fmu of this folder, built for the platform, such as `wine64 run_fmu.exe`. Every FMU is unpacked into a folder whose
name contains blanks and letters outside of ASCII. Compares all bits of all outputs at every communication point. The exit code is
1 if a value differs.
"""

import argparse
import shlex
import struct
import subprocess
import sys
import tempfile
import time
import urllib.parse
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

STEPS = 500
STEP_S = 0.002
STRING_EVERY = 100  # a text may be a whole picture
NAMES = {"linux64": ("linux64", "x86_64-linux", ".so"), "win64": ("win64", "x86_64-windows", ".dll"),
         "aarch64-linux": ("aarch64-linux", "aarch64-linux", ".so")}
KINDS = {"Real": "real", "Integer": "integer", "Enumeration": "integer", "Boolean": "boolean", "String": "string",
         "Float64": "real", "Int32": "integer", "UInt64": None, "Binary": None}

# The inputs follow a saw tooth. COURSES maps the start of an input's name to the mean and the amplitude of its saw tooth. Other
# inputs keep their start values.
COURSES = {"motors.power": (6.0, 2.0), "chip.power": (0.1, 0.05), "rotor": (0.55, 0.1), "bus.voltage": (3.8, 0.1), "body.speed": (1.0, 1.0)}
THRUST_N = (0.11, 0.02)


def bits(value):
    return struct.pack(">d", value).hex()


def course(name, step):
    """Returns an input's value at a step. The values form a saw tooth, whose computation needs no function of a mathematical
    library. For inputs that stay constant, returns None.
    """
    mean_range = next((value for start, value in COURSES.items() if name.startswith(start)), None)
    if name.endswith(".thrust"):
        mean_range = THRUST_N
    elif name.startswith("rotor") and not name.endswith("command"):
        return None
    if mean_range is None:
        return None
    phase = (step * 7 + len(name) * 13 + sum(map(ord, name))) % 50 / 25 - 1
    return mean_range[0] + mean_range[1] * phase


class Fmu:
    """An unpacked archive and its description."""

    def __init__(self, archive, folder):
        with zipfile.ZipFile(archive) as packed:
            for member in packed.infolist():
                member.filename = member.filename.replace("\\", "/")  # some tools for Windows write it
                packed.extract(member, folder)
        self.folder = folder
        root = ElementTree.parse(folder / "modelDescription.xml").getroot()
        self.is_fmi3 = root.get("fmiVersion").startswith("3")
        self.guid = root.get("instantiationToken" if self.is_fmi3 else "guid")
        self.identifier = root.find("CoSimulation").get("modelIdentifier")
        self.variables = list(self._variables(root))
        self.items = dict(self._items(root))

    def _variables(self, root):
        """Yields name, kind, causality, value reference and number of elements of each variable."""
        structural = {node.get("valueReference"): int(node.get("start")) for node in root.find("ModelVariables")
                      if node.get("causality") == "structuralParameter"}
        for node in root.find("ModelVariables"):
            kind = KINDS.get(node.tag if self.is_fmi3 else node[0].tag)
            if self.is_fmi3 and node.tag == "Enumeration":
                kind = "int64"
            count = 1
            for dimension in node.findall("Dimension"):
                count *= int(dimension.get("start") or structural[dimension.get("valueReference")])
            if kind is not None and node.get("variability") != "constant":
                yield node.get("name"), kind, node.get("causality"), node.get("valueReference"), count

    @staticmethod
    def _items(root):
        """Yields the value of each item of each enumeration of FMI 2.0. The key is the variable and the item's name.
        """
        types = {kind.get("name"): kind.findall("Enumeration/Item") for kind in root.iterfind("TypeDefinitions/SimpleType")}
        for node in root.iterfind("ModelVariables/ScalarVariable"):
            for item in types.get(node[0].get("declaredType"), []):
                yield (node.get("name"), item.get("name")), int(item.get("value"))

    def library(self, platform):
        fmi2, fmi3, suffix = NAMES[platform]
        return self.folder / "binaries" / (fmi3 if self.is_fmi3 else fmi2) / (self.identifier + suffix)

    def orders(self, platform, steps=STEPS):
        """Yields the lines for run_fmu. Under wine, the file system is drive Z:."""
        drive = "Z:" if platform == "win64" else ""
        resources = f"{drive}{self.folder}/resources"
        if not self.is_fmi3:
            resources = "file://" + ("/" if drive else "") + urllib.parse.quote(resources, safe="/:")
        yield f"library {drive}{self.library(platform)}"
        yield f"guid {self.guid}"
        yield f"resources {resources}"
        yield f"instantiate {3 if self.is_fmi3 else 2}"
        yield "initialise"
        outputs = [(kind, f"read {kind} {reference} {count}") for name, kind, causality, reference, count in self.variables
                   if causality == "output" and not name.endswith((".base.lo", ".base.hi"))]  # OSMP's addresses differ between runs
        yield from (order for _, order in outputs)
        for step in range(steps):
            for name, kind, causality, reference, count in self.variables:
                value = course(name, step)
                if causality == "input" and kind == "real" and value is not None:
                    yield f"real {reference} {' '.join(bits(value * (1 + 0.01 * element)) for element in range(count))}"
            yield "answer"
            yield f"step {bits(step * STEP_S)} {bits(STEP_S)}"
            yield from (order for kind, order in outputs if kind != "string" or step % STRING_EVERY == 0)


def run(command, orders):
    text = "".join(line + "\n" for line in orders)
    began = time.monotonic()
    ended = subprocess.run(command, input=text.encode(), capture_output=True, timeout=600, check=False)
    seconds = time.monotonic() - began
    if ended.returncode != 0:
        sys.exit(f"{shlex.join(command)}: exit code {ended.returncode}\n{ended.stderr.decode(errors='replace')[-2000:]}")
    return ended.stdout.decode().split("\n"), seconds


def compare(fmu, loaders):
    """Prints a line for each platform. Returns True if all values are equal."""
    expected, own_s = run(loaders["linux64"], fmu.orders("linux64"))
    values = sum(len(line.split()) for line in expected)
    changing = len(set(expected))
    good = changing > 2
    print(f"{fmu.identifier} FMI {3 if fmu.is_fmi3 else 2}: {values} values, {changing} different points; linux64 {own_s:.1f} s")
    for platform, command in loaders.items():
        if platform == "linux64" or not fmu.library(platform).exists():
            continue
        found, seconds = run(command, fmu.orders(platform))
        equal = sum(a == b for one, two in zip(expected, found) for a, b in zip(one.split(), two.split()))
        first = next((point for point, pair in enumerate(zip(expected, found)) if pair[0].split() != pair[1].split()), None)
        print(f"  {platform}: {equal} of {values} equal, {seconds:.1f} s" + ("" if first is None else f"; first difference at point {first}"))
        good = good and equal == values and first is None
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--loader", action="append", required=True, metavar="PLATFORM=COMMAND", help="as in `win64=wine64 run_fmu.exe`")
    parser.add_argument("fmus", nargs="+", type=Path, metavar="FMU")
    arguments = parser.parse_args()
    loaders = {platform: shlex.split(command) for platform, command in (loader.split("=", 1) for loader in arguments.loader)}
    good = True
    for archive in arguments.fmus:
        with tempfile.TemporaryDirectory(prefix="mebots fürs Prüfen ") as folder:
            good = compare(Fmu(archive, Path(folder)), loaders) and good
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
