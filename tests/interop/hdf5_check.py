# SPDX-License-Identifier: Apache-2.0
"""Runs a config with results in both formats, and reads results.h5 with h5py. Compares names, units, types and all bits with
results.csv."""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

mebots, config = sys.argv[1], pathlib.Path(sys.argv[2])
with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    system = json.loads(config.read_text())
    system["record"] = {"format": "both", "parameters": ["battery.cell.name", "battery.*converter*", "motors.*"]}
    system["stop_time"] = 2
    (folder / "both.json").write_text(json.dumps(system))
    subprocess.run([mebots, "run", "both.json", "--quiet", "--out", "out"], cwd=folder, check=True)

    with open(folder / "out/results.csv", newline="") as file:
        rows = list(csv.reader(file))
    header, columns = rows[0], list(zip(*rows[1:]))
    with h5py.File(folder / "out/results.h5") as h5:
        assert h5["time"].attrs["unit"] == "s"
        assert np.array_equal(h5["time"][:], np.array(columns[0], dtype=float))
        for title, column in zip(header[1:], columns[1:]):
            name, unit = title[:-1].rsplit(" [", 1)
            dataset = h5[name.replace(".", "/", 1)]
            assert dataset.attrs["name"] == name, title
            assert dataset.attrs["unit"] == ("" if unit == "-" else unit), title
            assert dataset.chunks is not None, title
            assert np.array_equal(dataset[:].astype(float), np.array(column, dtype=float)), title
        with open(folder / "out/parameters.csv", newline="") as file:
            parameters = list(csv.DictReader(file))
        assert parameters
        for parameter in parameters:
            value = h5["parameters"][parameter["parameter"]][()]
            text = value.decode() if isinstance(value, bytes) else value
            assert text == parameter["value"] or float(text) == float(parameter["value"]), parameter
    print(f"{len(header) - 1} datasets of {len(rows) - 1} rows and {len(parameters)} parameters agree")
