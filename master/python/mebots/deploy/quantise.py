# SPDX-License-Identifier: Apache-2.0
"""Converts a float graph to an integer network, using the ranges of its tensors.

Activations are bytes with one scale per tensor. Weights are signed bytes with one scale per output channel.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mebots.deploy.arithmetic import LARGEST_SUM, Scale, requantisation
from mebots.deploy.graph import Graph, Node, Tensor
from mebots.deploy.layers import Layer, Network
from mebots.errors import InputError

_ADD_SHIFT = 20
POWER_BITS = 16


class Quantiser:
    def __init__(self, graph: Graph, input_scale: Scale, range_of: Callable[[str], tuple[float, float]], given: Mapping[str, Scale]) -> None:
        """``given`` maps tensor names to scales that the model states."""
        self._given = given
        self._graph = graph
        self._range_of = range_of
        self._scales: dict[Tensor, Scale] = {graph.inputs[0]: input_scale}
        self._same: dict[Tensor, Tensor] = {}  # tensors within the memory of another tensor
        self._channel_scales: dict[Tensor, dict[int, Scale]] = {}
        self._layers: list[Layer] = []

    def network(self) -> Network:
        for node in self._graph.nodes:
            if node.kind == "move" and not node.moves:
                self._same[node.output] = self._tensor(node.inputs[0])
                self._scales[node.output] = self._scale(node.inputs[0])
                continue
            self._layers.append(_LOWER[node.kind](self, node))
        outputs = []
        for one in self._graph.outputs:
            outputs.append(self._output(one))
        return Network(self._graph.inputs[0], outputs, self._layers, self._scales)

    def _output(self, tensor: Tensor) -> Tensor:
        stored = self._tensor(tensor)
        if stored is self._graph.inputs[0]:
            raise InputError(f"output {tensor.name} is the input itself; there is nothing to compute", "invalid_model")
        self._scales.setdefault(stored, self._scale(tensor))
        return stored

    def _tensor(self, tensor: Tensor) -> Tensor:
        while tensor in self._same:
            tensor = self._same[tensor]
        return tensor

    def _scale(self, tensor: Tensor) -> Scale:
        return self._scales[tensor]

    def _out_scale(self, node: Node) -> Scale:
        if node.output.name in self._given:
            self._scales[node.output] = self._given[node.output.name]
            return self._given[node.output.name]
        low, high = self._range_of(node.output.name) if node.range is None else node.range
        low, high = (float(np.clip(one, *node.limits)) for one in (low, high))
        scale = Scale.of_range(low, high)
        if node.range is not None and node.range == (0.0, 255 / 256):
            scale = Scale(1 / 256, 0)
        self._scales[node.output] = scale
        return scale

    def _limits(self, node: Node, scale: Scale) -> dict[str, int]:
        return {"low": scale.byte(node.limits[0]), "high": scale.byte(node.limits[1])}

    def layer(self, kind: str, node: Node, **fields: Any) -> Layer:
        inputs = [self._tensor(one) for one in node.inputs]
        return Layer(kind, node.name, node.op, inputs, node.output, **fields)

    # --- Kinds ---

    def convolution(self, node: Node) -> Layer:
        source, scale = self._scale(node.inputs[0]), self._out_scale(node)
        channels = node.weight.shape[0]
        scales = self._scales_by_channel(node) or [scale] * channels
        steps = _weight_steps(node, source)
        weight = np.clip(np.floor(node.weight / steps.reshape(-1, 1, 1, 1) + 0.5), -128, 127).astype(np.int64)
        sums = weight.reshape(channels, -1).sum(axis=1)
        bias = np.floor(node.bias / (steps * source.step) + 0.5).astype(np.int64) - source.zero * sums
        bounds = np.abs(weight).reshape(channels, -1).sum(axis=1) * 255 + np.abs(bias)
        if (bounds > LARGEST_SUM).any():
            raise InputError(
                f"node {node.name} ({node.op}): a sum may reach {int(bounds.max())}, which 32 bits do not hold. Reduce the number of its inputs or its bias",
                "invalid_model",
            )
        factors, zeros = steps * source.step / np.array([one.step for one in scales]), np.array([one.zero for one in scales])
        try:
            scaling = requantisation(factors, zeros, bounds)
        except OverflowError as error:
            raise InputError(
                f"node {node.name} ({node.op}): {error}, because its outputs in the pictures are much smaller than its weights. Use other pictures for the calibration",
                "invalid_model",
            ) from error
        return self.layer(
            "convolution",
            node,
            weight=weight.astype(np.int8),
            bias=bias,
            requantise=scaling,
            outside=source.zero,
            kernel=node.kernel,
            strides=node.strides,
            pads=node.pads,
            dilations=node.dilations,
            groups=node.groups,
            pool=node.pool,
            **self._limits(node, scale),
        )

    def _scales_by_channel(self, node: Node) -> list[Scale] | None:
        """If each user of a dense layer's output selects some of its channels, returns one scale per channel: that of the output of the
        user that selects the channel. Otherwise, or if two users need different scales for a channel, returns None."""
        users = self._graph.users(node.output)
        is_output = any(one is node.output for one in self._graph.outputs)
        if len(node.output.shape) > 1 or node.is_limited() or is_output or not users or node.output.name in self._given:
            return None
        scales: dict[int, Scale] = {}
        for user in users:
            if user.kind != "move" or user.fill is not None or len(user.inputs) != 1 or len(user.moves) != 1:
                return None
            scale = Scale.of_range(*self._range_of(user.output.name))
            for channel in user.moves[0].places():
                if scales.setdefault(channel, scale) != scale:
                    return None
        self._channel_scales[node.output] = scales
        return [scales.get(channel, Scale(1.0, 0)) for channel in range(node.output.channels)]

    def max_pool(self, node: Node) -> Layer:
        self._scales[node.output] = self._scale(node.inputs[0])
        return self.layer("max_pool", node, kernel=node.kernel, strides=node.strides, pads=node.pads)

    def average_pool(self, node: Node) -> Layer:
        source, scale = self._scale(node.inputs[0]), self._out_scale(node)
        area = node.kernel[0] * node.kernel[1]
        includes = node.counts_pads or not any(node.pads)
        counts = np.array([area]) if includes else np.arange(1, area + 1)
        factors = source.step / scale.step / counts
        return self.layer(
            "average_pool",
            node,
            requantise=requantisation(factors, scale.zero, counts * 255),
            outside=source.zero,
            kernel=node.kernel,
            strides=node.strides,
            pads=node.pads,
            counts_pads=includes,
            **self._limits(node, scale),
        )

    def add(self, node: Node) -> Layer:
        scale = self._out_scale(node)
        sources = [self._scale(one) for one in node.inputs]
        ratios = [one.step / scale.step for one in sources]
        # The sum of three terms must fit into 31 bits: 255 times both factors, the output's zero point, and one half for rounding.
        shift = int(np.clip(np.floor(np.log2((1 << 30) / (255 * 2 * sum(ratios) + 2 * scale.zero + 1))), 0, _ADD_SHIFT))
        factors = [int(np.floor(one * 2.0**shift + 0.5)) for one in ratios]
        addend = (scale.zero << shift) + ((1 << shift) >> 1) - sum(f * one.zero for f, one in zip(factors, sources, strict=True))
        return self.layer("add", node, factors=tuple(factors), addend=addend, shift=shift, **self._limits(node, scale))

    def multiply(self, node: Node) -> Layer:
        scale = self._out_scale(node)
        a, b = (self._scale(one) for one in node.inputs)
        return self.layer(
            "multiply",
            node,
            zeros=(a.zero, b.zero),
            requantise=requantisation(np.array([a.step * b.step / scale.step]), scale.zero, np.array([255 * 255])),
            **self._limits(node, scale),
        )

    def table(self, node: Node) -> Layer:
        source, scale = self._scale(node.inputs[0]), self._out_scale(node)
        assert node.function is not None
        return self.layer("table", node, table=scale.bytes(node.function(source.real(np.arange(256)))))

    def softmax(self, node: Node) -> Layer:
        source, _ = self._scale(node.inputs[0]), self._out_scale(node)
        powers = np.floor(np.exp(-np.arange(256) * source.step) * (1 << POWER_BITS) + 0.5)
        return self.layer("softmax", node, table=powers.astype(np.uint32))

    def move(self, node: Node) -> Layer:
        sources = [self._scale(one) for one in node.inputs]
        if node.inputs[0] in self._channel_scales:
            sources = [self._channel_scales[node.inputs[0]][node.moves[0].start]]
        if all(one == sources[0] for one in sources):
            scale = sources[0]
            if node.fill is not None and abs(scale.real(np.array(scale.byte(node.fill))) - node.fill) > scale.step / 2:
                scale = self._out_scale(node)
            self._scales[node.output] = scale
        else:
            scale = self._out_scale(node)
        tables = [None if one == scale else scale.bytes(one.real(np.arange(256))) for one in sources]
        fill = None if node.fill is None else scale.byte(node.fill)
        return self.layer("move", node, moves=[(one, tables[one.source]) for one in node.moves], fill=fill)


def _weight_steps(node: Node, source: Scale) -> np.ndarray:
    """Returns the weight step of each output channel: the model's step, otherwise 1/127 of the largest magnitude or of ``_least_step``,
    whichever is greater."""
    channels = node.weight.shape[0]
    if node.weight_steps is not None and node.weight_steps.size in (1, channels):
        return np.broadcast_to(node.weight_steps.ravel(), (channels,))
    magnitude = np.abs(node.weight).reshape(channels, -1).max(axis=1)
    return np.maximum(magnitude, _least_step(node, source)) / 127


def _least_step(node: Node, source: Scale) -> np.ndarray:
    """Returns for each channel 127 times the smallest weight step at which the bias fits into 30 bits. Small weights with a large bias need
    this limit."""
    return np.maximum(np.abs(node.bias) * 127 / (source.step * (1 << 30)), 1e-12)


_LOWER: dict[str, Callable[[Quantiser, Node], Layer]] = {
    "conv": Quantiser.convolution,
    "max_pool": Quantiser.max_pool,
    "mean_pool": Quantiser.average_pool,
    "add": Quantiser.add,
    "multiply": Quantiser.multiply,
    "table": Quantiser.table,
    "softmax": Quantiser.softmax,
    "move": Quantiser.move,
}
