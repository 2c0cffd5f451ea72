# SPDX-License-Identifier: Apache-2.0
"""Cross-layer equalisation (Nagel et al. 2019, Data-Free Quantization Through Weight Equalization and Bias Correction, equations 7 to 9).

If f(s x) = s f(x) for s > 0, channel i between two layers may be divided by any s_i:

    W2 f(W1 x + b1) = (W2 S) f(S^-1 W1 x + S^-1 b1),  S = diag(s)

With the ranges r1_i of row i of W1 and r2_i of column i of W2, s_i = sqrt(r1_i / r2_i) gives both the range sqrt(r1_i r2_i).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator

import numpy as np

from mebots.deploy.graph import Graph, Node, Tensor

_LINEAR_POOLS = ("max_pool", "mean_pool")
_HOMOGENEOUS = ((-math.inf, math.inf), (0.0, math.inf))  # limits of outputs without limits and of Relu
_ROUNDS = 50
_CONVERGED = 1e-3
_NEGLIGIBLE = 1e-6  # relative to the layer's largest weight


@dataclasses.dataclass(frozen=True)
class _Pair:
    """A layer and all layers that read its output. If several layers read it, a column's range is the largest range in these layers."""

    first: Node
    between: list[Tensor]
    seconds: list[Node]


def equalise(graph: Graph, fixed: set[str]) -> dict[str, np.ndarray]:
    """Changes weights and biases in place. Returns the divisors of the channels of equalised tensors, by tensor name. Tensors in ``fixed``
    stay unchanged."""
    pairs = [one for one in _pairs(graph) if not any(tensor.name in fixed for tensor in one.between)]
    divisors = {tensor.name: np.ones(tensor.channels) for one in pairs for tensor in one.between}
    for _ in range(_ROUNDS):
        largest = 0.0
        for pair in pairs:
            factors = _equalise_pair(pair)
            for tensor in pair.between:
                divisors[tensor.name] *= factors
            largest = max(largest, float(np.abs(np.log(factors)).max()))
        if largest < _CONVERGED:
            break
    return divisors


def _pairs(graph: Graph) -> Iterator[_Pair]:
    for first in graph.nodes:
        if first.kind != "conv" or first.weight_steps is not None or first.limits not in _HOMOGENEOUS:
            continue
        pair = _Pair(first, [], [])
        if _collect(graph, first.output, pair) and pair.seconds:
            yield pair


def _collect(graph: Graph, tensor: Tensor, pair: _Pair) -> bool:
    """Adds ``tensor`` and the convolutions and dense layers that read it to ``pair``. If a Relu or pool reads it, continues with that
    node's output. Returns False if a tensor is an output of the graph, or if any other node reads it."""
    pair.between.append(tensor)
    if any(one is tensor for one in graph.outputs):
        return False
    for user in graph.users(tensor):
        if user.kind == "conv" and user.weight_steps is None and _columns(user) is not None:
            pair.seconds.append(user)
        elif not _is_homogeneous(user) or not _collect(graph, user.output, pair):
            return False
    return True


def _is_homogeneous(node: Node) -> bool:
    is_relu = node.kind == "table" and node.is_limited()
    return (is_relu or node.kind in _LINEAR_POOLS) and node.limits in _HOMOGENEOUS


def _columns(node: Node) -> np.ndarray | None:
    """Returns a view of the weights whose first index is the input channel. Returns None if the convolution has groups of several
    channels."""
    channels = node.inputs[0].channels
    if node.groups == 1:
        return np.moveaxis(node.weight, 1, 0)
    if node.groups == channels and node.weight.shape[1] == 1:
        return node.weight.reshape(channels, -1)
    return None


def _equalise_pair(pair: _Pair) -> np.ndarray:
    first = pair.first
    channels = first.weight.shape[0]
    rows = np.abs(first.weight).reshape(channels, -1).max(axis=1)
    views = [view for view in map(_columns, pair.seconds) if view is not None]
    columns = np.max([np.abs(one).reshape(channels, -1).max(axis=1) for one in views], axis=0)
    # If the weights of a channel are negligible, its output is only its bias, and a tiny divisor would make this bias huge. Therefore its factor is
    # 1.
    used = (rows > _NEGLIGIBLE * rows.max()) & (columns > _NEGLIGIBLE * columns.max())
    factors = np.where(used, np.sqrt(np.where(used, rows, 1.0) / np.where(used, columns, 1.0)), 1.0)
    first.weight = first.weight / factors.reshape(-1, 1, 1, 1)
    first.bias = first.bias / factors
    for second in pair.seconds:
        if second.groups == 1:
            second.weight = second.weight * factors.reshape(1, -1, 1, 1)
        else:
            second.weight = second.weight * np.repeat(factors, second.weight.shape[0] // channels).reshape(-1, 1, 1, 1)
    return factors
