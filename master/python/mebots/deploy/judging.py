# SPDX-License-Identifier: Apache-2.0
"""Determines the accuracy of a deployed network, and accuracy and cost with smaller inputs."""

from __future__ import annotations

import dataclasses
import os
import pathlib
from typing import Any

from mebots.deploy import sizes
from mebots.deploy.accuracy import Outputs, accuracy_of, comparison, difference, outputs_of
from mebots.deploy.checking import check
from mebots.deploy.deployed import Deployed, Options, Size
from mebots.deploy.lowering import lower
from mebots.deploy.measure import measure_settings
from mebots.errors import InputError


class Judgement:
    def __init__(self, model: str | os.PathLike[str], data: str | os.PathLike[str], deployed: Deployed, options: Options) -> None:
        """Reads labels, pictures and sizes. Raises InputError if they do not match the network."""
        self._model, self._data = model, data
        self._deployed = deployed
        self._options = options
        self._compared = comparison(deployed, options)
        self._sizes = sizes.chosen(deployed.graph.inputs[0], options.sizes)
        if options.sizes and not options.measure:
            raise InputError("--sizes needs the measurement on the chip. Leave --no-measure or --sizes out", "invalid_value")

    def result(self, objects: pathlib.Path) -> dict[str, Any]:
        """Returns the members "accuracy" and "sizes" of network.json. ``objects`` is a folder for object files of kernels; each size has a
        subfolder."""
        whole = outputs_of(self._deployed, self._compared)
        accuracy = accuracy_of(whole, self._compared)
        if self._options.equalise:
            usual = lower(self._model, self._data, dataclasses.replace(self._options, equalise=False))
            accuracy["without_equalisation"] = accuracy_of(outputs_of(usual, self._compared), self._compared)
        if not self._options.measure:
            return {"accuracy": accuracy, "sizes": {"rows": [], "none": "it was deployed with --no-measure"}}
        rows: list[dict[str, Any]] = []
        for size in self._sizes:
            try:
                smaller = lower(self._model, self._data, self._options, size)
            except InputError as error:
                reason = sizes.reason(error, size, self._deployed.model.path)
                if self._options.sizes is not None:
                    raise InputError(f"--sizes: {reason}", error.code) from error
                return {"accuracy": accuracy, "sizes": {"rows": rows, "none": reason}}
            rows.append(self._row(smaller, size, whole, objects))
        return {"accuracy": accuracy, "sizes": {"rows": rows}}

    def _row(self, smaller: Deployed, size: Size, whole: Outputs, objects: pathlib.Path) -> dict[str, Any]:
        place = objects / f"input {size[0]} {size[1]}"
        smaller.sources.write(place)
        program = check(place, place, smaller, True, objects)
        assert program is not None
        compared = comparison(smaller, self._options)
        outputs = outputs_of(smaller, compared)
        layers = smaller.network.layers
        row: dict[str, Any] = {
            "rows": size[0],
            "columns": size[1],
            "macs": sum(one.macs for one in layers),
            "accuracy": accuracy_of(outputs, compared),
            "settings": [
                {"cores": one.cores, "cluster_clock": one.clock_hz, "time": one.total.time_s, "energy": one.total.energy_j} for one in measure_settings(program)
            ],
        }
        if whole.floats is not None and all(outputs.integers[name].shape == values.shape for name, values in whole.floats.items()):
            row["whole"] = difference(outputs.integers, whole.floats)
        return row
