#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs gate_easy with FMUs of FMI 2.0, of FMI 3.0 and of both. All values and pictures must be the same.

Usage: mixed_versions.py MEBOTS CONFIG FMUS
FMUS contains NAME.fmu and NAME_fmi3.fmu. The names in the config are those of FMI 2.0: `rotor[1].thrust` is `rotor.thrust[1]` in
FMI 3.0, and `wind.velocity.x` is `wind.velocity[1]`.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
import zipfile

AXES = "xyz"
MIXTURES = [[], ["world"], ["soc"], ["soc", "world"], ["motors", "battery"], ["soc", "world", "motors", "battery"]]


def arrays_of(archive):
    """Returns the names of the FMU's arrays."""
    description = xml.etree.ElementTree.fromstring(zipfile.ZipFile(archive).read("modelDescription.xml"))
    return {v.get("name") for v in description.find("ModelVariables") if v.find("Dimension") is not None}


def element_name(name, arrays):
    """Converts a variable's name in FMI 2.0 to its name in FMI 3.0."""
    row = re.fullmatch(r"(.*)\[(\d)\]\.(.*)", name)
    if row and f"{row[1]}.{row[3]}" in arrays:
        return f"{row[1]}.{row[3]}[{row[2]}]"
    axis = re.fullmatch(r"(.*)\.([xyz])", name)
    if axis and axis[1] in arrays:
        return f"{axis[1]}[{AXES.index(axis[2]) + 1}]"
    return name


def renamed(value, arrays):
    """Replaces the names of variables in a value of the config. `arrays` maps an instance to the names of its arrays."""
    if isinstance(value, dict):
        return {renamed(k, arrays): renamed(v, arrays) for k, v in value.items()}
    if isinstance(value, list):
        return [renamed(v, arrays) for v in value]
    instance, dot, variable = value.partition(".") if isinstance(value, str) else ("", "", "")
    return f"{instance}.{element_name(variable, arrays[instance])}" if dot and instance in arrays else value


def mixture(config, fmus, chosen):
    """Returns the config in which the chosen instances use FMUs of FMI 3.0."""
    instances = {}
    arrays = {}
    for name, instance in config["instances"].items():
        archive = fmus / (instance["fmu"] + ("_fmi3.fmu" if name in chosen else ".fmu"))
        arrays[name] = arrays_of(archive) if name in chosen else set()
        parameters = {element_name(k, arrays[name]): v for k, v in instance.get("parameters", {}).items()}
        instances[name] = {**instance, "fmu": str(archive.resolve()), "parameters": parameters}
    rest = {k: v for k, v in config.items() if k not in ("instances", "view", "$schema")}
    return {"instances": instances, **renamed(rest, arrays)}


def fly(mebots, config, folder):
    """Runs a config. Returns the text of results.csv without the header, and {name: bytes} of the pictures."""
    folder.mkdir()
    (folder / "config.json").write_text(json.dumps(config))
    subprocess.run([mebots, "run", folder / "config.json", "--out", folder / "out", "--quiet"], check=True)
    values = (folder / "out/results.csv").read_text().split("\n", 1)[1]
    return values, {p.name: p.read_bytes() for p in sorted(folder.glob("out/pictures/**/*.png"))}


def main():
    mebots, config_file, fmus = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    config = json.loads(config_file.read_text())
    with tempfile.TemporaryDirectory() as folder:
        flights = [fly(mebots, mixture(config, fmus, chosen), pathlib.Path(folder) / str(i))
                   for i, chosen in enumerate(MIXTURES)]
    values, pictures = flights[0]
    assert len(pictures) > 10 and values.count("\n") > 900, "the mission was not flown to its end"
    for chosen, flight in zip(MIXTURES, flights):
        assert flight == flights[0], f"FMI 3.0 for {', '.join(chosen)} gives other values or pictures"
    print(f"{len(MIXTURES)} mixtures: the same {values.count(chr(10))} rows and {len(pictures)} pictures")


if __name__ == "__main__":
    main()
