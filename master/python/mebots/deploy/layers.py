# SPDX-License-Identifier: Apache-2.0
"""A network in integers, with the layers of the chip. Computes each layer in NumPy as a reference."""

from __future__ import annotations

import dataclasses

import numpy as np

from mebots.deploy.arithmetic import Requantisation, Scale
from mebots.deploy.graph import Tensor, no_values
from mebots.deploy.moving import Move


@dataclasses.dataclass(eq=False)
class Layer:
    """A layer. ``kind`` is convolution, max_pool, average_pool, add, multiply, table, move or softmax."""

    kind: str
    name: str
    op: str
    inputs: list[Tensor]
    output: Tensor
    low: int = 0
    high: int = 255
    outside: int = 0  # value of positions outside the input
    kernel: tuple[int, int] = (1, 1)
    strides: tuple[int, int] = (1, 1)
    pads: tuple[int, int, int, int] = (0, 0, 0, 0)
    dilations: tuple[int, int] = (1, 1)
    groups: int = 1
    pool: int = 1
    weight: np.ndarray = dataclasses.field(default_factory=no_values)  # int8; dimensions: out, in / groups, rows, columns
    bias: np.ndarray = dataclasses.field(default_factory=no_values)  # int32; includes the zero of the input
    requantise: Requantisation | None = None  # None: the output contains the sums, or the layer computes no sums
    counts_pads: bool = True
    factors: tuple[int, int] = (0, 0)
    zeros: tuple[int, int] = (0, 0)
    addend: int = 0
    shift: int = 0
    table: np.ndarray = dataclasses.field(default_factory=no_values)
    moves: list[tuple[Move, np.ndarray | None]] = dataclasses.field(default_factory=list)
    fill: int | None = None

    @property
    def macs(self) -> int:
        """Returns the number of multiplications, including those with positions outside the input."""
        if self.weight.size == 0:
            return 0
        return int(self.weight.size // self.weight.shape[0]) * self.output.size * self.pool**2

    @property
    def weights(self) -> int:
        return int(self.weight.size)

    @property
    def requantisation(self) -> Requantisation:
        """Returns the conversion of sums to bytes. The layer must have one."""
        assert self.requantise is not None
        return self.requantise

    def extent(self) -> tuple[int, int]:
        """Returns the rows and columns that the dilated kernel covers."""
        rows, columns = ((k - 1) * d + 1 for k, d in zip(self.kernel, self.dilations, strict=True))
        return rows, columns


@dataclasses.dataclass
class Network:
    input: Tensor
    outputs: list[Tensor]
    layers: list[Layer]
    scales: dict[Tensor, Scale]


def _padded(layer: Layer, values: np.ndarray) -> np.ndarray:
    top, left, bottom, right = layer.pads
    return np.pad(values, ((top, bottom), (left, right), (0, 0)), constant_values=layer.outside)


def _windows(layer: Layer, values: np.ndarray) -> np.ndarray:
    """Returns the windows of all positions with the dimensions rows, columns, kernel rows, kernel columns and channels."""
    rows, columns = layer.extent()
    padded = _padded(layer, values)
    windows = np.lib.stride_tricks.sliding_window_view(padded, (rows, columns), axis=(0, 1))
    windows = windows[:: layer.strides[0], :: layer.strides[1], :, :: layer.dilations[0], :: layer.dilations[1]]
    return np.moveaxis(windows, 2, 4)


def _convolution(layer: Layer, values: np.ndarray) -> np.ndarray:
    windows = _windows(layer, values)
    each = windows.shape[4] // layer.groups
    out = layer.weight.shape[0] // layer.groups
    sums = []
    for group in range(layer.groups):
        part = windows[..., group * each : (group + 1) * each].reshape(*windows.shape[:2], -1)
        weight = layer.weight[group * out : (group + 1) * out].transpose(2, 3, 1, 0).reshape(-1, out)
        sums.append(part.astype(np.float64) @ weight.astype(np.float64))  # exact, because all numbers are integers below 2^53
    total = np.concatenate(sums, axis=2).astype(np.int64) + layer.bias
    if layer.requantise is None:
        return total.astype(np.int32)
    result = layer.requantise.apply(total, layer.low, layer.high)
    return _pooled(result, layer.pool)


def _pooled(values: np.ndarray, pool: int) -> np.ndarray:
    if pool == 1:
        return values
    rows, columns, channels = values.shape[0] // pool, values.shape[1] // pool, values.shape[2]
    cut = values[: rows * pool, : columns * pool]
    return cut.reshape(rows, pool, columns, pool, channels).max(axis=(1, 3))


def _average(layer: Layer, values: np.ndarray) -> np.ndarray:
    windows = _windows(layer, values).astype(np.int64) - layer.outside
    sums = windows.sum(axis=(2, 3))
    count = 0
    if not layer.counts_pads:
        inside = dataclasses.replace(layer, outside=0)
        count = _windows(inside, np.ones((*values.shape[:2], 1), dtype=np.int64)).sum(axis=(2, 3)) - 1
    r = layer.requantisation
    chosen = Requantisation(r.multiplier[count], r.addend[count], r.shift[count], r.scaling)
    return chosen.apply(sums, layer.low, layer.high)


def _move(layer: Layer, values: list[np.ndarray]) -> np.ndarray:
    out = np.full(layer.output.size, layer.fill or 0, dtype=np.uint8)
    for move, table in layer.moves:
        source = values[move.source].ravel()
        move.apply(source if table is None else table[source], out)
    return out.reshape(layer.output.stored())


def _softmax(layer: Layer, values: np.ndarray) -> np.ndarray:
    powers = layer.table[values.max(axis=2, keepdims=True) - values].astype(np.int64)
    sums = powers.sum(axis=2, keepdims=True)
    return np.minimum((powers * 256 + sums // 2) // sums, 255).astype(np.uint8)


def compute(layer: Layer, values: list[np.ndarray]) -> np.ndarray:
    """Computes a layer. Inputs and output are stored bytes (rows, columns, channels)."""
    if layer.kind == "convolution":
        return _convolution(layer, values[0])
    if layer.kind == "max_pool":
        return _windows(layer, values[0]).max(axis=(2, 3))
    if layer.kind == "average_pool":
        return _average(layer, values[0])
    if layer.kind == "add":
        a, b = (one.astype(np.int64) for one in values)
        sums = a * layer.factors[0] + b * layer.factors[1] + layer.addend
        return np.clip(sums >> layer.shift, layer.low, layer.high).astype(np.uint8)
    if layer.kind == "multiply":
        a, b = (one.astype(np.int64) - zero for one, zero in zip(values, layer.zeros, strict=True))
        return layer.requantisation.apply(a * b, layer.low, layer.high)
    if layer.kind == "table":
        return layer.table[values[0]]
    if layer.kind == "softmax":
        return _softmax(layer, values[0])
    return _move(layer, values)


def run(network: Network, picture: np.ndarray) -> dict[Tensor, np.ndarray]:
    """Computes all layers. Returns the stored bytes of all tensors."""
    values = {network.input: picture.reshape(network.input.stored())}
    for layer in network.layers:
        out = compute(layer, [values[one] for one in layer.inputs])
        values[layer.output] = out.reshape(layer.output.stored())
    return values
