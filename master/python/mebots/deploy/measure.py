# SPDX-License-Identifier: Apache-2.0
"""Measures time and energy of each layer on the chip, as differences between runs of the first 0, 1, 2 ... layers."""

from __future__ import annotations

import dataclasses

from mebots.deploy import chip


@dataclasses.dataclass(frozen=True)
class Cost:
    time_s: float
    energy_j: float
    parts_j: dict[str, float]
    instructions: int
    cycles: int  # active cycles of all cores
    causes: dict[str, int]  # the same cycles by cause; empty if causes were not counted
    dma_s: float  # time that the copying core waited for copies


@dataclasses.dataclass(frozen=True)
class Setting:
    """Number of cores and clock of the cluster in a measurement."""

    cores: int
    clock_hz: float
    total: Cost


@dataclasses.dataclass(frozen=True)
class Measurement:
    """The costs of one inference, without the start of the cluster."""

    cores: int
    clock_hz: float
    layers: list[Cost]
    total: Cost
    settings: list[Setting]


CLOCKS_HZ = (chip.CLOCK_HZ // 4, chip.CLOCK_HZ // 2)
"""Further clocks at 1.0 V."""


def _causes(report: dict) -> dict[str, int]:
    """Returns the active cycles of the cluster's cores by cause. Omits hart 0, the fabric controller."""
    causes: dict[str, int] = {}
    for hart in report.get("harts", [])[1:]:
        for name, cycles in hart["causes"].items():
            causes[name] = causes.get(name, 0) + cycles
    return causes


def _dma_s(report: dict, clock_hz: float) -> float:
    functions = [one for hart in report.get("harts", [])[1:] for one in hart["functions"] if one["name"] in ("dma_wait", "layer_l3_wait")]
    return sum(one["cycles"] / clock_hz + one["asleep_s"] for one in functions)


def _difference(a: dict, b: dict, clock_hz: float) -> Cost:
    parts = {name: b["parts_j"][name] - a["parts_j"].get(name, 0.0) for name in b["parts_j"]}
    before = _causes(a)
    return Cost(
        b["time_s"] - a["time_s"],
        b["chip_j"] - a["chip_j"],
        parts,
        b["cluster"]["instructions"] - a["cluster"]["instructions"],
        b["cluster"]["cycles"] - a["cluster"]["cycles"],
        {name: cycles - before.get(name, 0) for name, cycles in _causes(b).items()},
        _dma_s(b, clock_hz) - _dma_s(a, clock_hz),
    )


def measure(program: chip.Program) -> Measurement:
    """Measures each layer with all cores at the highest clock, and the whole inference in all settings."""
    cores = program.board.cores
    reports = [program.report(cores, count, by_cause=True) for count in range(len(program.bytes) + 1)]
    costs = [_difference(a, b, chip.CLOCK_HZ) for a, b in zip(reports, reports[1:], strict=False)]
    total = _difference(reports[0], reports[-1], chip.CLOCK_HZ)
    return Measurement(cores, chip.CLOCK_HZ, costs, total, measure_settings(program, (reports[0], total)))


def measure_settings(program: chip.Program, usual: tuple[dict, Cost] | None = None) -> list[Setting]:
    """Measures an inference for each clock and number of cores. ``usual`` contains results for all cores at the highest clock, if known:
    the report of a run without layers, and the cost of the inference."""
    most = program.board.cores
    settings = []
    for clock in (*CLOCKS_HZ, chip.CLOCK_HZ):
        known = usual if clock == chip.CLOCK_HZ else None
        start = known[0] if known else program.report(most, 0, clock)  # without layers, the number of cores has no effect
        for cores in [*(2**i for i in range(most.bit_length()) if 2**i < most), most]:
            cost = known[1] if known and cores == most else _difference(start, program.report(cores, len(program.bytes), clock), clock)
            settings.append(Setting(cores, clock, cost))
    return settings
