#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that an SSP written by mebots is valid by the standard's schemas. Also tests that FMPy reads the same values from it.

Usage: ssp_schema_check.py MEBOTS CONFIG.json
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import zipfile

from fmpy.ssp.ssd import read_ssd, read_ssv


def values_of(ssp, binding):
    """Returns the values of a parameter set in a separate file. Numeric values are converted to numbers."""
    result = {}
    for parameter in read_ssv(ssp, binding.source, validate=True).parameters:
        text = {"true": True, "false": False}.get(parameter.value, parameter.value)
        result[parameter.name] = float(text) if parameter.type in ("Real", "Integer") else text
    return result


def main():
    mebots, config_path = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    instances = json.loads(config_path.read_text())["instances"]
    with tempfile.TemporaryDirectory() as folder:
        ssp = str(pathlib.Path(folder) / "ours.ssp")
        subprocess.run([mebots, "convert", config_path, ssp], check=True, stdout=subprocess.DEVNULL)
        components = {component.name: component for component in read_ssd(ssp, validate=True).system.elements}
        if set(components) != set(instances):
            sys.exit(f"FAILED: FMPy sees the components {sorted(components)}")
        compared = 0
        for name, instance in instances.items():
            bindings = components[name].parameterBindings
            read = {key: value for binding in bindings for key, value in values_of(ssp, binding).items()}
            written = instance.get("parameters", {})
            if read != written:
                sys.exit(f"FAILED: {name}: written {written}, read {read}")
            compared += len(read)
        with zipfile.ZipFile(ssp) as archive:
            files = [entry for entry in archive.namelist() if entry.endswith(".ssv")]
        print(f"{len(components)} components, {compared} values in {len(files)} .ssv files")
        if compared == 0:
            sys.exit("FAILED: the config gives no values, so nothing was compared")


if __name__ == "__main__":
    main()
