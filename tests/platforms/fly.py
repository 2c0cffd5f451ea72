# SPDX-License-Identifier: Apache-2.0
"""Flies a mission with FMUs for several platforms at once, and compares all values at every communication point.

    fly.py --loader PLATFORM=COMMAND... [--real-s LIMIT] CONFIG FMU_FOLDER STOP_TIME

COMMAND is run_fmu of this folder. This program is the master: outputs at a communication point are inputs of the next step. It
has no code in common with MEbots. Pictures reach the chip as base64. Each platform has its own instances, which are connected
only with each other. LIMIT is the longest real time of a flight in seconds. If this limit stops a flight, the report contains
the simulated time that the flight has reached. The exit code is 1 if a value differs, or if the chip took no picture.
"""

import argparse
import json
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from compare import Fmu, bits

PICTURE = ".camera.frame"  # a connection of this name carries bytes, whose address means nothing in another process


class Instance:
    """An FMU in a separate process of run_fmu."""

    def __init__(self, name, fmu, platform, command):
        self.name, self.fmu = name, fmu
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.kinds = {variable: (kind, reference) for variable, kind, _, reference, _ in fmu.variables}
        self.outputs = [variable for variable, kind, causality, _, _ in fmu.variables
                        if causality == "output" and kind != "string" and not variable.endswith((".base.lo", ".base.hi"))]
        self.reads = ["read {} {} 1".format(*self.kinds[variable]) for variable in self.outputs]
        self.start = [order for order in fmu.orders(platform, steps=0) if not order.startswith(("read", "initialise"))]

    def send(self, orders):
        self.process.stdin.write("".join(order + "\n" for order in [*orders, "answer"]).encode())
        self.process.stdin.flush()

    def receive(self):
        line = self.process.stdout.readline()
        if not line:
            sys.exit(f"{self.name}: run_fmu ended")
        return line.decode().split()

    def close(self):
        self.process.stdin.close()
        self.process.stdout.read()
        if self.process.wait() != 0:
            sys.exit(f"{self.name}: run_fmu ended with exit code {self.process.returncode}")

    def parameter(self, variable, value):
        kind, reference = self.kinds[variable]
        if kind == "real":
            value = bits(float(value))
        elif kind != "string":
            value = format(self.fmu.items.get((variable, value), value) & 0xFFFFFFFF, "x")
        return f"{kind} {reference} {value}"

    def set(self, variable, value):
        return "{} {} {}".format(*self.kinds[variable], value)


class Flight:

    def __init__(self, config, fmus, platform, command):
        self.step_s = config["step"]
        self.instances = {name: Instance(name, fmus[instance["fmu"]], platform, command) for name, instance in config["instances"].items()}
        self.connections = [(link["from"].split(".", 1), link["to"].split(".", 1)) for link in config["connections"]]
        self.values, self.pictures, self.picture_id, self.new_pictures = {}, 0, None, {}
        for name, instance in self.instances.items():
            own = [instance.parameter(*item) for item in config["instances"][name].get("parameters", {}).items()]
            instance.send([*instance.start, *own, "initialise", *instance.reads])

    def begin_step(self, step):
        orders = {name: [] for name in self.instances}
        for (source, output), (target, variable) in self.connections:
            if PICTURE.endswith(output):
                text = self.new_pictures.get((source, output))
                orders[target] += [] if text is None else [self.instances[target].set(variable + ".base64", text)]
            else:
                orders[target].append(self.instances[target].set(variable, self.values[source, output]))
        for name, instance in self.instances.items():
            instance.send([*orders[name], f"step {bits(step * self.step_s)} {bits(self.step_s)}", *instance.reads])

    def end_step(self):
        """Returns all values of this communication point."""
        found = []
        for name, instance in self.instances.items():
            values = instance.receive()
            self.values |= {(name, variable): value for variable, value in zip(instance.outputs, values, strict=True)}
            found += values
        self.new_pictures = {}
        for (source, output), _ in self.connections:
            if PICTURE.endswith(output) and self.values[source, output + "_id"] != self.picture_id:
                self.picture_id = self.values[source, output + "_id"]
                self.instances[source].send(["text " + self.instances[source].kinds[output + ".base64"][1]])
                text = self.instances[source].receive()
                self.new_pictures[source, output] = text[0] if text else ""
                self.pictures += 1
                found += text
        return found

    def close(self):
        for instance in self.instances.values():
            instance.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--loader", action="append", required=True, metavar="PLATFORM=COMMAND")
    parser.add_argument("--real-s", type=float, default=float("inf"), metavar="LIMIT")
    parser.add_argument("config", type=Path)
    parser.add_argument("fmus", type=Path, metavar="FMU_FOLDER")
    parser.add_argument("stop_time", type=float)
    arguments = parser.parse_args()
    config = json.loads(arguments.config.read_text(encoding="utf-8"))
    loaders = {platform: shlex.split(command) for platform, command in (loader.split("=", 1) for loader in arguments.loader)}
    with tempfile.TemporaryDirectory(prefix="mebots fürs Prüfen ") as folder:
        fmus = {name: Fmu(arguments.fmus / f"{name}.fmu", Path(folder) / name)
                for name in {instance["fmu"] for instance in config["instances"].values()}}
        flights = {platform: Flight(config, fmus, platform, command) for platform, command in loaders.items()}
        own = next(iter(flights))
        values = pictures = 0
        equal, first, began = dict.fromkeys(flights, 0), {}, time.monotonic()
        for step in range(round(arguments.stop_time / config["step"]) + 1):
            found = {platform: flight.end_step() for platform, flight in flights.items()}
            values += len(found[own])
            for platform, flight in flights.items():
                equal[platform] += sum(a == b for a, b in zip(found[own], found[platform]))
                if found[platform] != found[own]:
                    first.setdefault(platform, step)
                flight.begin_step(step)
            if time.monotonic() - began > arguments.real_s:
                break
        for flight in flights.values():
            flight.end_step()
            flight.close()
        pictures = flights[own].pictures - 1  # the first is the empty one at the start
    print(f"{arguments.config.name}, {step * config['step']:g} of {arguments.stop_time:g} s: {values} values, {pictures} pictures, "
          f"{time.monotonic() - began:.0f} s of real time")
    for platform in list(flights)[1:]:
        difference = f"; first difference at step {first[platform]}" if platform in first else ""
        print(f"  {platform}: {equal[platform]} of {values} equal{difference}")
    return 0 if not first and pictures > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
