# SPDX-License-Identifier: Apache-2.0
"""The data and helpers of functions that convert ONNX operators to nodes of a graph."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from mebots.deploy.graph import Graph, Node, Tensor
from mebots.deploy.model_file import InputTooSmall, Model, label, onnx_package
from mebots.errors import InputError

MOST_ELEMENTS = 8 << 20


class Importer:
    """Converts a model node by node with one function per operator. ``node`` is the current node."""

    def __init__(self, model: Model, operators: Mapping[str, Callable[[Importer], None]]) -> None:
        self.model = model
        self._operators = operators
        self._tensors: dict[str, Tensor] = {}
        self._nodes: list[Node] = []
        self.attributes: dict[str, Any] = {}
        self.node: Any = None

    def graph(self) -> Graph:
        proto = self.model.proto.graph
        inputs = [self._define(one.name) for one in proto.input if one.name not in self.model.constants]
        if len(inputs) != 1:
            names = ", ".join(one.name for one in inputs) or "none"
            raise self.model.fail(f"the network has {len(inputs)} inputs ({names}); exactly one is possible. Join them, or fold the others into constants")
        for node in self.model.nodes:
            self._import(node)
        outputs = [self._output(one.name) for one in proto.output]
        return Graph(inputs, outputs, self._nodes)

    # --- Helpers for operators ---

    def refuse(self, what: str, way_out: str) -> InputError:
        node = self.node
        return self.model.fail(f"node {label(node)} ({node.op_type}): {what}. {way_out}")

    def attribute(self, name: str, default: Any) -> Any:
        return self.attributes.get(name, default)

    def constant(self, place: int) -> np.ndarray | None:
        """Returns the constant at an input of the node, or None if the node lacks this input."""
        if place >= len(self.node.input) or self.node.input[place] == "":
            return None
        name = self.node.input[place]
        if name not in self.model.constants:
            raise self.refuse(f"input {name} is computed by the network; it must be a constant", "Store it in the model when you export it")
        return self.model.constants[name]

    def needed(self, place: int) -> np.ndarray:
        """Returns the constant at an input of the node. Raises InputError if the node lacks this input."""
        value = self.constant(place)
        if value is None:
            raise self.refuse(f"it has no input {place}", "Export the model again")
        return value

    def is_constant(self, place: int) -> bool:
        return place < len(self.node.input) and self.node.input[place] in self.model.constants

    def input(self, place: int = 0) -> Tensor:
        name = self.node.input[place]
        if name in self._tensors:
            return self._tensors[name]
        raise self.refuse(f"input {name} is a constant; a tensor that the network computes is needed", "Remove the node, or compute it before the export")

    def shape_of(self, name: str) -> tuple[int, ...]:
        shape = self.model.shapes.get(name)
        if shape is None or any(not isinstance(one, int) for one in shape):
            given = "unknown" if shape is None else list(shape)
            raise self.model.fail(
                f"tensor {name} has no fixed shape ({given}). Export with fixed shapes, or fix them by onnxruntime.tools.make_dynamic_shape_fixed"
            )
        if shape in ((), (1,)):  # a scalar, possibly with a batch dimension
            return 1, 1
        if any(one < 1 for one in shape):
            raise self._empty(name, shape)
        if math.prod(shape) > MOST_ELEMENTS:
            raise self.model.fail(f"tensor {name} has shape {list(shape)}: {math.prod(shape)} bytes, but a chip has 8 MiB of memory at most")
        return shape

    def _empty(self, name: str, shape: tuple[int, ...]) -> InputError:
        node = next((one for one in self.model.nodes if name in one.output), None)
        if node is None:
            return self.model.fail(f"tensor {name} has shape {list(shape)}; each size must be at least 1. Export the model again")
        text = f"node {label(node)} ({node.op_type}) has an output of shape {list(shape)}: its input is too small. Use a larger input of the network"
        return InputTooSmall(f"{self.model.path}: {text}", "invalid_model")

    def _define(self, name: str) -> Tensor:
        shape = self.shape_of(name)
        if len(shape) < 2 or len(shape) > 4 or shape[0] != 1:
            raise self.model.fail(
                f"tensor {name} has shape {list(shape)}; possible are [1, channels], [1, channels, columns] and [1, channels, rows, columns]. "
                "Export with a batch of one"
            )
        tensor = Tensor(name, tuple(shape[1:]))
        self._tensors[name] = tensor
        return tensor

    def alias(self, tensor: Tensor) -> None:
        """Makes the input tensor the output of the node, which changes nothing."""
        self._tensors[self.node.output[0]] = tensor

    def add(self, kind: str, inputs: list[Tensor], **fields: Any) -> Node:
        output = self._define(self.node.output[0])
        node = Node(kind, label(self.node), self.node.op_type, inputs, output, **fields)
        self._nodes.append(node)
        return node

    def insert(self, node: Node) -> None:
        """Adds a node for an intermediate result, which is not a tensor of the ONNX model."""
        self._nodes.append(node)

    def _import(self, node: Any) -> None:
        self.node = node
        if node.domain not in ("", "ai.onnx"):
            raise self.refuse(f"operators of domain {node.domain} are not supported", "Export with the operators of ONNX alone")
        if node.op_type not in self._operators:
            raise self.refuse("this operator is not supported", f"Supported are {', '.join(sorted(self._operators))}. Replace it by these, or write a kernel for it")
        self.attributes = {one.name: onnx_package().helper.get_attribute_value(one) for one in node.attribute}
        for name in node.output[1:]:
            if name and any(name in other.input for other in self.model.nodes):
                raise self.refuse(f"its second output {name} is used", "Only the first output can be")
        try:
            self._operators[node.op_type](self)
        except (ArithmeticError, AttributeError, LookupError, MemoryError, TypeError, ValueError) as error:
            # The functions of operators do not check all attributes and constants. In an invalid model, these can cause any of the errors
            # above.
            raise self.refuse(f"its attributes and inputs do not fit each other: {error}", "Export the model again") from error

    def _output(self, name: str) -> Tensor:
        if name in self._tensors:
            return self._tensors[name]
        raise self.model.fail(f"output {name} does not depend on the input. Remove it from the graph's outputs")
