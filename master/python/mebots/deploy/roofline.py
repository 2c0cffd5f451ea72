# SPDX-License-Identifier: Apache-2.0
"""Lower bounds of the cycles of layers: the roofline. docs/chip/networks.md derives the numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mebots.deploy.layers import Layer
from mebots.deploy.plan import Plan, Steps, Stream, early_bytes, is_depthwise, pools_sums, traffic

DOT = 4
"""Products of a dot product, which takes one cycle."""

REGISTERS = 24
"""Registers of a core for sums and operands. The other seven are the stack pointer, and pointers to weights and inputs."""

DMA_BYTES = 8
"""Bytes per cycle of the cluster that the DMA moves at most."""

HYPER_BYTES = 1
"""Bytes per cycle of the SoC that the HyperBus moves at most: one byte at each edge of the bus's clock, which is half the SoC's clock."""

_CONVERSION = {"narrow": 3.75, "wide": 7.75, "exact": 11.75}
"""Cycles that convert a sum to a byte. Multiplication (mul 1, mulh 5 cycles), sum and shift 1, limit 1, packing 0.5, store 0.25.
"exact" needs both words of the product, and the carry of a sum (mul, add, sltu, add)."""


def loads_per_dot(channels: int, places: int, words: int) -> float:
    """Returns the minimum number of loads per dot product in the inner loop of a convolution.

    The loop computes ``a`` output channels at ``b`` output positions. If registers keep a x b sums, a x b dot products need a + b loads.
    Registers may also keep the patches of b positions (one load per b dot products), or the weights of a channels (one load per a dot
    products).
    """
    most_a, most_b = min(channels, REGISTERS), min(places, REGISTERS)
    blocks = [(a, b) for a in range(1, most_a + 1) for b in range(1, most_b + 1) if a * b + a + b <= REGISTERS]
    kept = min(max(places, channels if places > 1 else 1), (REGISTERS - 1) // (words + 1))
    least = min((a + b) / (a * b) for a, b in blocks)
    return min(least, 1 / kept) if kept > 0 else least


def peak(cores: int) -> float:
    """Returns the products per cycle of the convolution's loop over four channels and four output positions: 16 dot products and 8
    loads."""
    return cores * DOT / (1 + loads_per_dot(4, 4, REGISTERS))


def compute_cycles(layer: Layer) -> float:
    """Returns a lower bound of the cycles that one core takes for a layer with weights."""
    assert layer.weight.size > 0
    values = layer.output.size * layer.pool**2
    places = values // layer.output.channels
    words = math.ceil(math.prod(layer.weight.shape[1:]) / DOT)
    if is_depthwise(layer):
        loads = min(layer.inputs[0].size, values * math.prod(layer.kernel)) / 4  # each word that a kernel covers is loaded at least once
    else:
        loads = values * words * loads_per_dot(layer.weight.shape[0] // layer.groups, places, words)
    if layer.requantise is None:
        return values * (words + 1) + loads
    converted = layer.output.size if pools_sums(layer) else values
    compared = (values - layer.output.size) * (1 if pools_sums(layer) else 0.25)  # for the maximum of a pool
    return values * words + loads + converted * _CONVERSION[layer.requantise.scaling] + compared


def _computed(layer: Layer, cores: int) -> float:
    return compute_cycles(layer) / cores if layer.kind == "convolution" else 0.0


def bound(layer: Layer, steps: Steps | None, cores: int) -> float:
    """Returns a lower bound of a layer's cycles: those in which the cores compute, or those in which the DMA moves data, whichever
    are more. Data that are fetched during the previous layer do not count."""
    moved = 0 if steps is None else traffic(layer, steps).total - early_bytes(layer, steps)
    return max(_computed(layer, cores), moved / DMA_BYTES)


def total_bound(layers: Sequence[Layer], plan: Plan, cores: int, cluster_per_soc: float) -> float:
    """Returns a lower bound of the cycles of all layers. While the cores compute a layer, the DMA can fetch the first data of the next
    layer, if the plan permits it. If weights are in HyperRAM, the bound contains their transfer from there instead.

    ``cluster_per_soc``: cycles of the cluster for each cycle of the SoC.
    """
    bounds = []
    spare = 0.0  # bytes that the DMA can move while the cores compute the previous layer
    for layer, steps in zip(layers, plan.steps, strict=True):
        computed = DMA_BYTES * _computed(layer, cores)
        moved = float(0 if steps is None else traffic(layer, steps).total)
        if steps is not None and plan.stream is None:
            moved -= min(early_bytes(layer, steps), spare, max(moved - computed, 0.0))
        bounds.append(max(computed, moved) / DMA_BYTES)
        spare = max(computed - moved, 0.0)
    return sum(bounds) if plan.stream is None else with_hyperram(bounds, plan.stream, cluster_per_soc)


def with_hyperram(bounds: Sequence[float], stream: Stream, cluster_per_soc: float) -> float:
    """Returns a lower bound of the cycles of all layers with weights in HyperRAM. ``bounds`` are those of the layers."""
    fetches = [size / HYPER_BYTES * cluster_per_soc for _, size in stream.segments]
    return fetches[0] + sum(max(layer, fetch) for layer, fetch in zip(bounds, [*fetches[1:], 0.0], strict=True))
