# SPDX-License-Identifier: Apache-2.0
"""Defines a network in floating point. It consists of tensors, and of nodes of a few kinds in the order of computation. The batch size
is always one.

    conv     weight (out, in / groups, rows, columns), bias, strides, pads, dilations; the kernel of a dense layer is
             its whole input; with ``pool`` > 1, the maximum of pool x pool places follows
    max_pool, mean_pool
    add, multiply   two tensors of one shape
    table    a function of each value
    move     values at other places: pads, slices, concatenations, transpositions, nearest neighbours
    softmax  over the channels
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np

Shape = tuple[int, ...]


@dataclasses.dataclass(eq=False)
class Tensor:
    """The values of one batch. ``shape`` is the ONNX shape without the batch: (channels, rows, columns), (channels, columns) or
    (channels,)."""

    name: str
    shape: Shape
    element: int = 1  # bytes per value on the chip

    @property
    def bytes(self) -> int:
        return self.size * self.element

    @property
    def size(self) -> int:
        return math.prod(self.shape)

    @property
    def channels(self) -> int:
        return self.shape[0]

    @property
    def rows(self) -> int:
        return self.shape[1] if len(self.shape) == 3 else 1

    @property
    def columns(self) -> int:
        return self.shape[-1] if len(self.shape) > 1 else 1

    def stored(self) -> Shape:
        """Returns the shape in memory: (rows, columns, channels)."""
        return self.rows, self.columns, self.channels

    def view(self, memory: np.ndarray) -> np.ndarray:
        """Returns a view of stored values with the dimensions of ``shape``."""
        return np.moveaxis(memory.reshape(self.stored()), 2, 0).reshape(self.shape)


def no_values() -> np.ndarray:
    """Returns an empty array, the default of fields that only some kinds of nodes and layers use."""
    return np.empty(0)


@dataclasses.dataclass(eq=False)
class Node:
    kind: str
    name: str
    op: str  # replaced ONNX operators, for reports
    inputs: list[Tensor]
    output: Tensor
    weight: np.ndarray = dataclasses.field(default_factory=no_values)
    bias: np.ndarray = dataclasses.field(default_factory=no_values)
    weight_steps: np.ndarray | None = None  # scales of weights that the model stores as bytes: one for all, or one per output channel
    kernel: tuple[int, int] = (1, 1)
    strides: tuple[int, int] = (1, 1)
    pads: tuple[int, int, int, int] = (0, 0, 0, 0)  # top, left, bottom, right
    dilations: tuple[int, int] = (1, 1)
    groups: int = 1
    pool: int = 1
    counts_pads: bool = True
    limits: tuple[float, float] = (-math.inf, math.inf)
    function: Callable[[np.ndarray], np.ndarray] | None = None
    range: tuple[float, float] | None = None  # known range of a function
    moves: list[Any] = dataclasses.field(default_factory=list)
    fill: float | None = None

    def is_limited(self) -> bool:
        return self.limits != (-math.inf, math.inf)


@dataclasses.dataclass
class Graph:
    inputs: list[Tensor]
    outputs: list[Tensor]
    nodes: list[Node]

    def users(self, tensor: Tensor) -> list[Node]:
        return [node for node in self.nodes if any(one is tensor for one in node.inputs)]

    def producer(self, tensor: Tensor) -> Node | None:
        return next((node for node in self.nodes if node.output is tensor), None)

    def has_one_user(self, tensor: Tensor) -> bool:
        return len(self.users(tensor)) == 1 and not any(one is tensor for one in self.outputs)
