# SPDX-License-Identifier: Apache-2.0
"""Measures time and energy of each layer on the chip, as differences between runs of the first 0, 1, 2 ... layers."""

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
class Setting:
    """Cost of an inference with a number of cores at a clock of the cluster."""

    cores: int
    clock_hz: float
    total: Cost


@dataclasses.dataclass(frozen=True)
class Measurement:
    """Costs of one inference, without the start of the cluster."""

    cores: int
    clock_hz: float
    layers: list[Cost]
    total: Cost
    settings: list[Setting]


CLOCKS_HZ = (chip.CLOCK_HZ // 4, chip.CLOCK_HZ // 2)
"""Further clocks at 1.0 V, with all cores."""


def _difference(a: dict, b: dict) -> Cost:
    parts = {name: b["parts_j"][name] - a["parts_j"].get(name, 0.0) for name in b["parts_j"]}
    return Cost(
        b["time_s"] - a["time_s"],
        b["chip_j"] - a["chip_j"],
        parts,
        b["cluster"]["instructions"] - a["cluster"]["instructions"],
        b["cluster"]["cycles"] - a["cluster"]["cycles"],
    )


def measure(elf: pathlib.Path, network: Network, picture: np.ndarray, sizes: list[int], on: chip.Board) -> Measurement:
    def report(cores: int, count: int, clock_hz: int = chip.CLOCK_HZ) -> dict:
        return chip.run_on_chip(elf, chip.Request(cores, count, sizes, picture, clock_hz), on)[1]

    def setting(cores: int, clock_hz: int) -> Setting:
        return Setting(cores, clock_hz, _difference(report(cores, 0, clock_hz), report(cores, len(network.layers), clock_hz)))

    reports = [report(on.cores, count) for count in range(len(network.layers) + 1)]
    layers = [_difference(a, b) for a, b in zip(reports, reports[1:], strict=False)]
    total = _difference(reports[0], reports[-1])
    fewer = [2**i for i in range(on.cores.bit_length()) if 2**i < on.cores]
    settings = [setting(cores, chip.CLOCK_HZ) for cores in fewer]
    settings.append(Setting(on.cores, chip.CLOCK_HZ, total))
    settings += [setting(on.cores, clock) for clock in CLOCKS_HZ]
    return Measurement(on.cores, chip.CLOCK_HZ, layers, total, settings)
