# SPDX-License-Identifier: Apache-2.0
"""Merges nodes, so that the chip computes fewer layers: normalisations into weights; pads, functions and pools into convolutions."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from mebots.deploy.graph import Graph, Node, Tensor

_LIMITED_KINDS = ("conv", "add", "multiply", "mean_pool")


def simplify(graph: Graph) -> None:
    """Simplifies the graph in place without changing the values of its outputs."""
    _drop_unused(graph)
    changed = True
    while changed:
        changed = any(step(graph) for step in (_join_scales, _join_pads, _join_flatten, _swap_limits, _join_limits))
    _join_pools(graph)
    _drop_unused(graph)


def join_flattened(graph: Graph) -> None:
    """Merges pads, flattened inputs and added integers into the layers that use or compute them. Integer weights stay integers."""
    _drop_unused(graph)
    while _join_pads(graph) or _join_flatten(graph) or _join_addends(graph):
        pass


def _drop_unused(graph: Graph) -> None:
    needed = {id(one) for one in graph.outputs}
    for node in reversed(graph.nodes):
        if id(node.output) in needed:
            needed.update(id(one) for one in node.inputs)
    graph.nodes[:] = [node for node in graph.nodes if id(node.output) in needed]


def _is_affine(node: Node) -> bool:
    """True if the node multiplies each channel by a constant and adds another constant."""
    return (
        node.kind == "conv"
        and node.weight.shape[1:] == (1, 1, 1)
        and node.groups == node.output.channels == node.inputs[0].channels
        and node.strides == (1, 1)
        and not any(node.pads)
        and node.pool == 1
    )


def _pairs(graph: Graph) -> list[tuple[Node, Node]]:
    """Returns consecutive nodes in which the second is the only user of the first's output."""
    found = []
    for node in graph.nodes:
        before = graph.producer(node.inputs[0])
        if before is not None and graph.has_one_user(before.output):
            found.append((before, node))
    return found


def _replace(graph: Graph, first: Node, second: Node, joined: Node) -> None:
    graph.nodes[graph.nodes.index(second)] = joined
    graph.nodes.remove(first)


def _join(first: Node, second: Node, **fields: Any) -> Node:
    return dataclasses.replace(first, op=f"{first.op}+{second.op}", output=second.output, **fields)


def _join_scales(graph: Graph) -> bool:
    for first, second in _pairs(graph):
        if first.kind == "conv" and _is_affine(second) and not first.is_limited() and first.pool == 1:
            factor = second.weight.reshape(-1)
            weight = first.weight * factor.reshape(-1, 1, 1, 1)
            joined = _join(first, second, weight=weight, bias=first.bias * factor + second.bias, limits=second.limits, weight_steps=None)
            _replace(graph, first, second, joined)
            return True
    return False


def _join_addends(graph: Graph) -> bool:
    """If integers are added to the sums of a convolution or dense layer, adds them to the layer's bias and removes the node. PLiNIO ends
    networks with such an addition."""
    for first, second in _pairs(graph):
        if first.kind != "conv" or not _is_affine(second):
            continue
        if (second.weight != 1).any() or (np.rint(second.bias) != second.bias).any():
            continue
        _replace(graph, first, second, _join(first, second, bias=first.bias + second.bias))
        return True
    return False


def _join_pads(graph: Graph) -> bool:
    for first, second in _pairs(graph):
        if first.op != "Pad" or first.fill != 0 or second.kind != "conv" or first.moves[0].source != 0:
            continue
        pads = _pads_of(first)
        if pads is None:
            continue
        top, left, bottom, right = (a + b for a, b in zip(pads, second.pads, strict=True))
        joined = dataclasses.replace(second, op=f"{first.op}+{second.op}", inputs=first.inputs, pads=(top, left, bottom, right))
        _replace(graph, first, second, joined)
        return True
    return False


def _pads_of(node: Node) -> tuple[int, int, int, int] | None:
    """Returns the pads of rows and columns, or None if channels are padded."""
    source, out = node.inputs[0], node.output
    if source.channels != out.channels or len(source.shape) != 3:
        return None
    top, rest = divmod(node.moves[0].out_start, out.columns * out.channels)
    left = rest // out.channels
    return top, left, out.rows - source.rows - top, out.columns - source.columns - left


def _join_flatten(graph: Graph) -> bool:
    """Merges a flattened tensor into the dense layer that follows. The result is a convolution with a kernel of the tensor's size."""
    for node in graph.nodes:
        before = graph.producer(node.inputs[0])
        if before is None or before.kind != "move" or before.fill is not None or len(before.inputs) != 1:
            continue
        source = before.inputs[0]
        flat = len(before.output.shape) == 1 and source.size == before.output.size and before.op in ("Flatten", "Reshape", "Squeeze")
        if not flat or node.kind != "conv" or node.groups != 1 or node.weight.shape[1:] != (source.size, 1, 1):
            continue
        weight = node.weight.reshape(-1, source.channels, source.rows, source.columns)
        joined = dataclasses.replace(node, inputs=[source], weight=weight, kernel=(source.rows, source.columns))
        graph.nodes[graph.nodes.index(node)] = joined
        _drop_unused(graph)
        return True
    return False


def _swap_limits(graph: Graph) -> bool:
    """If a limit, such as Relu, follows a maximum pool, moves it before the pool, where a convolution can include it. The result stays the
    same."""
    for first, second in _pairs(graph):
        source = first.inputs[0]
        before = graph.producer(source)
        if first.kind != "max_pool" or not _is_limit(second) or before is None or before.kind not in _LIMITED_KINDS or not graph.has_one_user(source):
            continue
        between = Tensor(source.name, source.shape)  # range of the source within the limits
        limit = dataclasses.replace(second, inputs=first.inputs, output=between)
        pool = dataclasses.replace(first, inputs=[between], output=second.output)
        graph.nodes[graph.nodes.index(first)] = limit
        graph.nodes[graph.nodes.index(second)] = pool
        return True
    return False


def _is_limit(node: Node) -> bool:
    return node.kind == "table" and node.is_limited()


def _join_limits(graph: Graph) -> bool:
    for first, second in _pairs(graph):
        if _is_limit(second) and (first.kind in _LIMITED_KINDS or _is_limit(first)):
            low = np.clip(first.limits[0], *second.limits)
            high = np.clip(first.limits[1], *second.limits)
            limits = float(low), float(high)
            function = None
            if first.kind == "table":
                function = _clip(limits)
            _replace(graph, first, second, _join(first, second, limits=limits, function=function))
            return True
    return False


def _clip(limits: tuple[float, float]):
    return lambda x: np.clip(x, *limits)


def _join_pools(graph: Graph) -> None:
    """Merges a maximum pool without overlapping windows into the convolution before it."""
    for first, second in _pairs(graph):
        fits = (
            first.kind == "conv"
            and second.kind == "max_pool"
            and first.pool == 1
            and second.kernel == second.strides
            and second.kernel[0] == second.kernel[1] <= 4
            and not any(second.pads)
        )
        if fits and first in graph.nodes:
            _replace(graph, first, second, _join(first, second, pool=second.kernel[0]))
