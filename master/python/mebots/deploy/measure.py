# SPDX-License-Identifier: Apache-2.0
"""Time and energy of each layer on the chip: runs of the first 0, 1, 2 ... layers, of which the differences count."""

from __future__ import annotations

import dataclasses
import pathlib

import numpy as np

from mebots.deploy import chip
from mebots.deploy.layers import Network


@dataclasses.dataclass(frozen=True)
class Cost:
    time_s: float
    energy_j: float
    parts_j: dict[str, float]
    instructions: int
    cycles: int  # of all cores, awake


@dataclasses.dataclass(frozen=True)
class Measurement:
    """Costs of one inference, without the start of the cluster."""

    cores: int
    clock_hz: float
    layers: list[Cost]
    total: Cost


def _difference(a: dict, b: dict) -> Cost:
    parts = {name: b["parts_j"][name] - a["parts_j"].get(name, 0.0) for name in b["parts_j"]}
    return Cost(
        b["time_s"] - a["time_s"],
        b["chip_j"] - a["chip_j"],
        parts,
        b["cluster"]["instructions"] - a["cluster"]["instructions"],
        b["cluster"]["cycles"] - a["cluster"]["cycles"],
    )


def measure(elf: pathlib.Path, network: Network, picture: np.ndarray, sizes: list[int], on: chip.Board, cores: int | None = None) -> Measurement:
    cores = cores or on.cores
    reports = [chip.run_on_chip(elf, chip.Request(cores, count, sizes, picture), on)[1] for count in range(len(network.layers) + 1)]
    layers = [_difference(a, b) for a, b in zip(reports, reports[1:], strict=False)]
    return Measurement(cores, chip.CLOCK_HZ, layers, _difference(reports[0], reports[-1]))
