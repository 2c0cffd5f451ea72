# SPDX-License-Identifier: Apache-2.0
"""Layers of a network with integer weights. Rounds nothing, so the outputs have the same bits as in ONNX.

The bytes of a signed tensor are the network's numbers plus 128. Without requantisation, the outputs of a layer are sums.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from mebots.deploy.arithmetic import LARGEST_SUM, Scale, exact_requantisation
from mebots.deploy.graph import Graph, Node, Tensor
from mebots.deploy.integer_nodes import Requantising
from mebots.deploy.layers import Layer, Network
from mebots.errors import InputError

SIGNED_ZERO = 128


class IntegerLayers:
    def __init__(self, graph: Graph, requantising: dict[str, Requantising], input_zero: int) -> None:
        self._graph = graph
        self._requantising = requantising
        self._zeros: dict[Tensor, int] = {graph.inputs[0]: input_zero}
        self._same: dict[Tensor, Tensor] = {}
        self._layers: list[Layer] = []
        self._joined: set[int] = set()

    def network(self) -> Network:
        _outputs_of_sums(self._graph)
        for node in self._graph.nodes:
            if id(node) in self._joined:
                continue
            if node.kind == "move" and not node.moves:
                self._same[node.output] = self._tensor(node.inputs[0])
                self._zeros[node.output] = self._zeros[node.inputs[0]]
                continue
            if node.kind not in _LOWER:
                raise self._refuse(node, "is not possible in a network of whole numbers", "Deploy the float model instead")
            self._layers.append(_LOWER[node.kind](self, node))
        outputs = [self._tensor(one) for one in self._graph.outputs]
        scales = {tensor: Scale(1.0, zero) for tensor, zero in self._zeros.items()}
        return Network(self._graph.inputs[0], outputs, self._layers, scales)

    def _refuse(self, node: Node, what: str, way_out: str) -> InputError:
        return InputError(f"node {node.name} ({node.op}): {what}. {way_out}", "invalid_model")

    def _tensor(self, tensor: Tensor) -> Tensor:
        while tensor in self._same:
            tensor = self._same[tensor]
        return tensor

    def _next(self, node: Node, kind: str) -> Node | None:
        """Returns the only user of the node's output if it is of this kind, otherwise None."""
        users = self._graph.users(node.output)
        if len(users) == 1 and users[0].kind == kind and self._graph.has_one_user(node.output):
            return users[0]
        return None

    def _requantised(self, node: Node) -> tuple[Tensor, str, Requantising | None]:
        """Merges the node that requantises the output. Returns the new output, the merged operators, and the numbers of the
        requantisation."""
        user = self._next(node, "requantise")
        if user is None:
            return node.output, node.op, None
        self._joined.add(id(user))
        return user.output, f"{node.op}+{user.op}", self._requantising[user.output.name]

    def _limits(self, node: Node, numbers: Requantising, out: Tensor) -> tuple[int, int, int]:
        """Returns the zero point and the limits of the output's bytes."""
        zero = SIGNED_ZERO if numbers.low < 0 else 0
        low, high = numbers.low + zero, numbers.high + zero
        if low < 0 or high > 255:
            raise self._refuse(node, f"its values from {numbers.low:g} to {numbers.high:g} do not fit into a byte", "Quantise activations to 8 bits")
        self._zeros[out] = zero
        return zero, int(low), int(high)

    def layer(self, kind: str, node: Node, op: str, output: Tensor, **fields: Any) -> Layer:
        return Layer(kind, node.name, op, [self._tensor(one) for one in node.inputs], output, **fields)

    def convolution(self, node: Node) -> Layer:
        output, op, numbers = self._requantised(node)
        source = self._zeros[node.inputs[0]]
        weight = np.rint(node.weight).astype(np.int64)
        if np.abs(weight).max() > 128 or weight.max() > 127 or (weight != node.weight).any():
            raise self._refuse(node, "its weights are no whole numbers from -128 to 127", "Quantise weights to 8 bits")
        bias = np.asarray(node.bias, dtype=np.float64)
        broken = bias[np.rint(bias) != bias]
        if broken.size:
            what = f"its bias contains {broken[0]:g}, which is no whole number"
            raise self._refuse(node, what, "Round it in the model, or deploy the float model")
        flat = weight.reshape(weight.shape[0], -1)
        bias = bias.astype(np.int64) - source * flat.sum(axis=1)
        bounds = np.abs(flat).sum(axis=1) * 255 + np.abs(bias)
        if (bounds > LARGEST_SUM).any():
            raise self._refuse(node, f"a sum may reach {int(bounds.max())}, which 32 bits do not hold", "Use fewer inputs")
        fields: dict[str, Any] = {
            "weight": weight.astype(np.int8),
            "bias": bias,
            "outside": source,
            "kernel": node.kernel,
            "strides": node.strides,
            "pads": node.pads,
            "dilations": node.dilations,
            "groups": node.groups,
        }
        if numbers is None:
            if self._graph.users(node.output):
                raise self._refuse(node, "its sums are used without requantising", "Export with integer activations")
            output.element = 4
            self._zeros[output] = 0
            return self.layer("convolution", node, op, output, **fields)
        zero, low, high = self._limits(node, numbers, output)
        if any(one.size not in (1, bias.size) for one in (numbers.multiplier, numbers.addend)):
            raise self._refuse(node, f"it has {bias.size} channels, and is requantised by {numbers.multiplier.size} and {numbers.addend.size} numbers", "Export it again")
        multiplier, addend = (np.broadcast_to(one, bias.shape) for one in (numbers.multiplier, numbers.addend))
        try:
            scaling = exact_requantisation(multiplier, addend + (zero << numbers.shift), numbers.shift, bounds)
        except OverflowError as error:
            raise self._refuse(node, str(error), "Use smaller multipliers") from error
        output, op, pool = self._pooled(output, op)
        return self.layer("convolution", node, op, output, requantise=scaling, low=low, high=high, pool=pool, **fields)

    def _pooled(self, output: Tensor, op: str) -> tuple[Tensor, str, int]:
        """If only a maximum pool reads ``output``, and its windows are squares of at most 4 x 4 without pads that do not overlap, merges it
        into the layer that computes ``output``. Returns the layer's output, its operators, and the size of the pool (1 without a pool)."""
        users = self._graph.users(output)
        if len(users) != 1 or users[0].kind != "max_pool" or not self._graph.has_one_user(output):
            return output, op, 1
        pool = users[0]
        if pool.kernel != pool.strides or pool.kernel[0] != pool.kernel[1] or pool.kernel[0] > 4 or any(pool.pads):
            return output, op, 1
        self._joined.add(id(pool))
        self._zeros[pool.output] = self._zeros[output]
        return pool.output, f"{op}+{pool.op}", pool.kernel[0]

    def max_pool(self, node: Node) -> Layer:
        self._zeros[node.output] = self._zeros[node.inputs[0]]
        return self.layer("max_pool", node, node.op, node.output, kernel=node.kernel, strides=node.strides, pads=node.pads)

    def add(self, node: Node) -> Layer:
        output, op, numbers = self._requantised(node)
        a, b = (self._zeros[one] for one in node.inputs)
        if numbers is None or numbers.multiplier.size + numbers.addend.size > 2:
            raise self._refuse(node, "its sum is not requantised by one number for all channels", "Requantise it by one number")
        zero, low, high = self._limits(node, numbers, output)
        factor, shift = int(numbers.multiplier[0]), numbers.shift
        while factor % 2 == 0 and int(numbers.addend[0]) % 2 == 0 and shift > 0:
            factor, shift = factor // 2, shift - 1
            numbers.addend = numbers.addend // 2
        addend = int(numbers.addend[0]) - factor * (a + b) + (zero << shift)
        if 510 * abs(factor) + abs(addend) > LARGEST_SUM:
            raise self._refuse(node, f"its multiplier {factor} with a shift of {shift} exceeds 32 bits", "Use smaller multipliers")
        return self.layer("add", node, op, output, factors=(factor, factor), addend=addend, shift=shift, low=low, high=high)

    def requantise(self, node: Node) -> Layer:
        """Requantises bytes by a table."""
        numbers = self._requantising[node.output.name]
        if numbers.multiplier.size + numbers.addend.size > 2:
            raise self._refuse(node, "it requantises bytes by a number per channel", "One number for all is possible")
        source = self._zeros[node.inputs[0]]
        zero, low, high = self._limits(node, numbers, node.output)
        values = (np.arange(256, dtype=np.int64) - source) * int(numbers.multiplier[0]) + int(numbers.addend[0])
        table = np.clip((values >> numbers.shift) + zero, low, high).astype(np.uint8)
        return self.layer("table", node, node.op, node.output, table=table)

    def move(self, node: Node) -> Layer:
        zeros = {self._zeros[one] for one in node.inputs}
        if len(zeros) > 1:
            raise self._refuse(node, "it joins tensors with and without signs", "Requantise before it")
        zero = zeros.pop()
        self._zeros[node.output] = zero
        fill = None if node.fill is None else self._fill(node, node.fill, zero)
        return self.layer("move", node, node.op, node.output, moves=[(one, None) for one in node.moves], fill=fill)

    def _fill(self, node: Node, value: float, zero: int) -> int:
        """Returns the byte for ``value``, with which the node fills positions without input, such as pads."""
        byte = int(value) + zero if math.isfinite(value) else -1
        if byte - zero != value or not 0 <= byte <= 255:
            raise self._refuse(node, f"it fills with {value:g}; whole numbers from {-zero} to {255 - zero} are possible", "Pad with one of these")
        return byte


def _outputs_of_sums(graph: Graph) -> None:
    """If an output of the network only selects or moves the sums of a dense layer, replaces it by the whole output of this layer."""
    outputs: list[Tensor] = []
    for one in graph.outputs:
        node = graph.producer(one)
        while node is not None and node.kind == "move" and len(node.inputs) == 1:
            before = graph.producer(node.inputs[0])
            if before is None or before.kind not in ("move", "conv"):
                break
            node = before
        chosen = node.output if node is not None and node.kind == "conv" and node.output is not one else one
        if not any(other is chosen for other in outputs):
            outputs.append(chosen)
    graph.outputs[:] = outputs
    needed = {id(one) for one in outputs}
    for node in reversed(graph.nodes):
        if id(node.output) in needed:
            needed.update(id(one) for one in node.inputs)
    graph.nodes[:] = [node for node in graph.nodes if id(node.output) in needed]


_LOWER: dict[str, Callable[[IntegerLayers, Node], Layer]] = {
    "conv": IntegerLayers.convolution,
    "max_pool": IntegerLayers.max_pool,
    "add": IntegerLayers.add,
    "requantise": IntegerLayers.requantise,
    "move": IntegerLayers.move,
}
