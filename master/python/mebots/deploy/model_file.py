# SPDX-License-Identifier: Apache-2.0
"""Reads ONNX files. Checks the model, infers all shapes, and computes all constants."""

from __future__ import annotations

import math
import os
import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np

from mebots.deploy.graph import Tensor
from mebots.errors import InputError
from mebots.extras import extra

OPSETS = range(9, 22)
LARGEST_FILE = 512 << 20
LARGEST_CONSTANT = 1 << 26  # number of elements
_NEVER_CONSTANT = {"RandomNormal", "RandomNormalLike", "RandomUniform", "RandomUniformLike", "Bernoulli", "Multinomial", "If", "Loop", "Scan"}


def onnx_package() -> Any:
    """Imports the package onnx, which only a deployment needs."""
    extra("onnx.reference", "`mebots deploy`", "onnx", "deploy")
    return extra("onnx", "`mebots deploy`", "onnx", "deploy")


class InputTooSmall(InputError):
    """Raised if the input has too few rows or columns for a node."""


class SizeFixed(InputError):
    """Raised if the model permits no other input size than its own."""


class Model:
    """An ONNX model. ``constants`` are the initialisers and all tensors computed from them. ``nodes`` are all other nodes in order."""

    def __init__(self, path: str | os.PathLike[str], rewrite: Callable[[Any], None] | None = None, size: tuple[int, int] | None = None) -> None:
        """Reads and checks a model. First calls ``rewrite`` with the model. ``size`` replaces the rows and columns of the input."""
        self.path = pathlib.Path(path)
        self.proto = _load(self.path)
        if rewrite is not None:
            try:
                rewrite(self.proto)
            except (LookupError, TypeError, ValueError) as error:
                raise self.fail(f"a RequantShift lacks an input or an attribute: {error}") from error
        self.requantising: dict[str, Any] = {}
        self.weight_steps: dict[str, np.ndarray] = {}  # scales of weights that the model stores as bytes
        self.scales: dict[str, Any] = {}  # scales of tensors that the model quantises
        self.quantised: dict[str, tuple[Any, int]] = {}  # scale and zero point of each output of QuantizeLinear
        self.opset = _opset(self.proto, self.path)
        _fix_batch(self.proto, self.path)
        self.whole: Tensor | None = None  # the input with its own size if ``size`` replaced it
        if size is not None:
            self.whole = _resize(self.proto, *size)
        self.proto = _with_shapes(self.proto, self.path)
        self.shapes = _shapes(self.proto.graph)
        self.constants = self._initialisers()
        self.nodes = self._without_constants()

    def fail(self, text: str) -> InputError:
        return InputError(f"{self.path}: {text}", "invalid_model")

    def _initialisers(self) -> dict[str, np.ndarray]:
        onnx = onnx_package()
        constants = {}
        for one in self.proto.graph.initializer:
            if math.prod(one.dims) > LARGEST_CONSTANT:
                raise self.fail(f"initialiser {one.name} has shape {list(one.dims)}: more than {LARGEST_CONSTANT} elements cannot be deployed")
            try:
                value = onnx.numpy_helper.to_array(one, base_dir=str(self.path.parent))
            except KeyError as error:
                raise self.fail(f"initialiser {one.name} has the unknown data type {one.data_type}: export the model again") from error
            except (ValueError, TypeError, OSError) as error:
                raise self.fail(f"initialiser {one.name} cannot be read: {error}") from error
            constants[one.name] = self._finite(one.name, value)
        return constants

    def _finite(self, name: str, value: np.ndarray) -> np.ndarray:
        if value.dtype.kind == "f" and not np.isfinite(value).all():
            place = tuple(int(i) for i in np.argwhere(~np.isfinite(value))[0])
            raise self.fail(f"constant {name} is {value[place]} at {list(place)}: train or export the model again")
        return value

    def _without_constants(self) -> list[Any]:
        """Evaluates all nodes with constant inputs. Returns the other nodes."""
        rest = []
        for node in self.proto.graph.node:
            if node.op_type == "Shape" and self._fold_shape(node):
                continue
            known = all(name == "" or name in self.constants for name in node.input)
            if not known or node.op_type in _NEVER_CONSTANT or node.domain not in ("", "ai.onnx"):
                rest.append(node)
                continue
            if node.op_type == "DequantizeLinear":
                self._dequantise(node)
            else:
                self._evaluate(node)
        return rest

    def _dequantise(self, node: Any) -> None:
        """Computes the real values of a constant that the model stores as integers. If they are int8 with zero point 0, also stores their
        scales. onnx cannot evaluate old versions of this operator."""
        whole = self.constants[node.input[0]]
        step = np.asarray(self.constants[node.input[1]], dtype=np.float64)
        zero = self.constants[node.input[2]].astype(np.float64) if len(node.input) > 2 and node.input[2] else np.zeros_like(step)
        axis = next((one.i for one in node.attribute if one.name == "axis"), 1)
        if step.size > 1:
            if whole.ndim <= axis or whole.shape[axis] != step.size:
                raise self.fail(f"node {_label(node)} (DequantizeLinear): {step.size} scales for shape {list(whole.shape)}; one per channel is possible")
            shape = [step.size if i == axis % whole.ndim else 1 for i in range(whole.ndim)]
            step, zero = step.reshape(shape), np.broadcast_to(zero.ravel(), step.size).reshape(shape)
        if whole.dtype == np.int8 and not zero.any():
            self.weight_steps[node.output[0]] = step.ravel()
        self.constants[node.output[0]] = self._finite(node.output[0], (whole - zero) * step)

    def _fold_shape(self, node: Any) -> bool:
        shape = self.shapes.get(node.input[0])
        if shape is None or any(not isinstance(one, int) for one in shape):
            return False
        given = {one.name: one.i for one in node.attribute}
        self.constants[node.output[0]] = np.array(shape[given.get("start", 0) : given.get("end", len(shape))], dtype=np.int64)
        return True

    def _evaluate(self, node: Any) -> None:
        onnx = onnx_package()
        if node.op_type in ("ConstantOfShape", "Expand", "Tile"):
            size = math.prod(int(one) for one in self.constants[node.input[min(1, len(node.input) - 1)]].ravel())
            if size < 0 or size > LARGEST_CONSTANT:
                raise self.fail(f"node {_label(node)} ({node.op_type}) makes a constant of {size} elements: at most {LARGEST_CONSTANT} are possible")
        names = [name for name in node.input if name]
        graph = onnx.helper.make_graph([node], "constant", [onnx.helper.make_empty_tensor_value_info(n) for n in names],
                                       [onnx.helper.make_empty_tensor_value_info(n) for n in node.output if n])  # fmt: skip
        model = onnx.helper.make_model(graph, opset_imports=[onnx.helper.make_opsetid("", self.opset)])
        try:
            values = onnx.reference.ReferenceEvaluator(model).run(None, {name: self.constants[name] for name in names})
        except Exception as error:  # the evaluator passes on all exceptions of operators
            raise self.fail(f"constant node {_label(node)} ({node.op_type}) cannot be computed: {error}") from error
        for name, value in zip([n for n in node.output if n], values, strict=True):
            self.constants[name] = self._finite(name, np.asarray(value))


def _label(node: Any) -> str:
    """Returns the name of the node, or of its output if the node has none."""
    return node.name or node.output[0]


label = _label


def _load(path: pathlib.Path) -> Any:
    onnx = onnx_package()
    try:
        size = path.stat().st_size
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}", "not_found") from error
    if not path.is_file():
        raise InputError(f"{path}: is not a file; an ONNX model is expected", "invalid_model")
    if size == 0:
        raise InputError(f"{path}: is empty; export the model again", "invalid_model")
    if size > LARGEST_FILE:
        raise InputError(f"{path}: has {size} bytes; a chip with 8 MiB of HyperRAM cannot hold it, and at most {LARGEST_FILE} bytes are read", "invalid_model")
    try:
        model = onnx.load(str(path))
    except Exception as error:  # protobuf raises its own classes
        raise InputError(f"{path}: is not a whole ONNX file: {_one_line(error)}", "invalid_model") from error
    if not model.graph.node:
        raise InputError(f"{path}: is not an ONNX model, or one without nodes", "invalid_model")
    return model


def _opset(model: Any, path: pathlib.Path) -> int:
    versions = [one.version for one in model.opset_import if one.domain in ("", "ai.onnx")]
    if not versions or versions[0] not in OPSETS:
        given = versions[0] if versions else "none"
        raise InputError(
            f"{path}: has opset {given}; opsets {OPSETS.start} to {OPSETS.stop - 1} are read. Export with opset_version=17, or use onnx.version_converter",
            "invalid_model",
        )
    return versions[0]


def _fix_batch(model: Any, path: pathlib.Path) -> None:
    """Sets an undefined batch size of inputs to 1. Rejects other undefined dimensions."""
    constants = {one.name for one in model.graph.initializer}
    for one in model.graph.input:
        if one.name in constants:
            continue
        dimensions = one.type.tensor_type.shape.dim
        for place, dimension in enumerate(dimensions):
            if dimension.HasField("dim_value") and dimension.dim_value > 0:
                continue
            if place > 0:
                given = dimension.dim_param or "unknown"
                raise InputError(
                    f"{path}: dimension {place} of input {one.name} is {given}, which is not a fixed number. Export without dynamic_axes, "
                    "or fix it by onnxruntime.tools.make_dynamic_shape_fixed",
                    "invalid_model",
                )
            dimension.Clear()
            dimension.dim_value = 1


def _resize(model: Any, rows: int, columns: int) -> Tensor:
    """Changes the size of the input and deletes all shapes that depend on it. Returns the previous input."""
    constants = {one.name for one in model.graph.initializer}
    source = next(one for one in model.graph.input if one.name not in constants)
    dimensions = source.type.tensor_type.shape.dim
    whole = Tensor(source.name, tuple(one.dim_value for one in dimensions[1:]))
    for dimension, value in zip(dimensions[2:], (rows, columns), strict=True):
        dimension.dim_value = value
    del model.graph.value_info[:]
    for one in model.graph.output:
        for dimension in one.type.tensor_type.shape.dim:
            dimension.Clear()
    return whole


def _with_shapes(model: Any, path: pathlib.Path) -> Any:
    onnx = onnx_package()
    try:
        onnx.checker.check_model(model)
        return onnx.shape_inference.infer_shapes(model, strict_mode=True, data_prop=True)
    except Exception as error:  # several exception classes of the C++ library
        raise InputError(f"{path}: the model is not a valid ONNX model: {_one_line(error)}", "invalid_model") from error


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())[:400]


def _shapes(graph: Any) -> dict[str, tuple[Any, ...]]:
    shapes = {}
    for one in [*graph.input, *graph.value_info, *graph.output]:
        kind = one.type.tensor_type
        if kind.HasField("shape"):
            shapes[one.name] = tuple(d.dim_value if d.HasField("dim_value") else d.dim_param for d in kind.shape.dim)
    return shapes
