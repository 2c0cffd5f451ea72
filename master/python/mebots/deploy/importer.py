# SPDX-License-Identifier: Apache-2.0
"""Converts the nodes of an ONNX model to a float graph, with one function per operator."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from mebots.deploy import functions, moving, transposed
from mebots.deploy.arithmetic import Scale
from mebots.deploy.context import Importer
from mebots.deploy.graph import Graph, Tensor
from mebots.deploy.model_file import Model


def import_graph(model: Model) -> Graph:
    return Importer(model, _OPERATORS).graph()


# --- Operators with weights ---


def _two(values: Any, what: str, owner: Importer) -> tuple[int, int]:
    """Returns the numbers for rows and columns. If the list has only a number for columns, uses 1 for rows."""
    values = [int(one) for one in values]
    if any(one < 0 for one in values):
        raise owner.refuse(f"{what} {values} has negative numbers", "Use a Slice instead")
    if len(values) == 1:
        return 1, values[0]
    if len(values) != 2:
        raise owner.refuse(f"{what} {values} has {len(values)} dimensions", "One and two are possible")
    return values[0], values[1]


def _pads(owner: Importer, kernel: tuple[int, int], strides: tuple[int, int], dilations: tuple[int, int], shape: tuple[int, int]) -> tuple[int, int, int, int]:
    mode = owner.attribute("auto_pad", b"NOTSET").decode()
    if mode in ("NOTSET", ""):
        given = [int(one) for one in owner.attribute("pads", [0] * 4)]
        if any(one < 0 for one in given):
            raise owner.refuse(f"pads {given} has negative numbers", "Use a Slice instead")
        return (given[0], given[1], given[2], given[3]) if len(given) == 4 else (0, given[0], 0, given[1])
    if mode == "VALID":
        return 0, 0, 0, 0
    total = [max((-(-size // s) - 1) * s + (k - 1) * d + 1 - size, 0) for size, s, k, d in zip(shape, strides, kernel, dilations, strict=True)]
    less = [one // 2 for one in total]
    more = [one - half for one, half in zip(total, less, strict=True)]
    begin, end = (less, more) if mode == "SAME_UPPER" else (more, less)
    return begin[0], begin[1], end[0], end[1]


def _geometry(owner: Importer, kernel: Any) -> dict[str, Any]:
    kernel = _two(kernel, "kernel_shape", owner)
    strides = _two(owner.attribute("strides", [1] * 2), "strides", owner)
    dilations = _two(owner.attribute("dilations", [1] * 2), "dilations", owner)
    source = owner.input()
    pads = _pads(owner, kernel, strides, dilations, (source.rows, source.columns))
    return {"kernel": kernel, "strides": strides, "dilations": dilations, "pads": pads}


def _conv(owner: Importer) -> None:
    weight = owner.needed(1)
    source = owner.input()
    if weight.ndim == 3:
        weight = weight[:, :, np.newaxis, :]
    if weight.ndim != 4:
        raise owner.refuse(f"its weights have shape {list(weight.shape)}", "One and two dimensions are possible")
    bias = owner.constant(2)
    groups = int(owner.attribute("group", 1))
    if source.channels != weight.shape[1] * groups or weight.shape[0] % groups != 0:
        raise owner.refuse(f"weights {list(weight.shape)} with {groups} groups do not fit {source.channels} channels", "Export the model again")
    bias = np.zeros(weight.shape[0]) if bias is None else bias
    steps = owner.model.weight_steps.get(owner.node.input[1])
    fields = _geometry(owner, weight.shape[2:])
    owner.add("conv", [source], weight=weight.astype(np.float64), bias=bias.astype(np.float64), groups=groups, weight_steps=steps, **fields)


def _dense(owner: Importer, weight: np.ndarray, bias: np.ndarray | None, steps: np.ndarray | None) -> None:
    """Adds a dense layer. ``weight`` must have the dimensions (outputs, inputs)."""
    source = owner.input()
    if len(source.shape) != 1:
        raise owner.refuse(f"its input {source.name} has shape {[1, *source.shape]}", "Use Flatten before it")
    if weight.shape[1] != source.size:
        raise owner.refuse(f"weights for {weight.shape[1]} inputs do not fit the {source.size} of {source.name}", "Export the model again")
    bias = np.zeros(weight.shape[0]) if bias is None else np.broadcast_to(np.asarray(bias, dtype=np.float64).ravel(), weight.shape[:1])
    owner.add("conv", [source], weight=weight[:, :, np.newaxis, np.newaxis].astype(np.float64), bias=bias.astype(np.float64), weight_steps=steps)


def _gemm(owner: Importer) -> None:
    if owner.attribute("transA", 0):
        raise owner.refuse("transA is set", "Transpose the input before the export")
    weight = owner.needed(1) * owner.attribute("alpha", 1.0)
    bias = owner.constant(2)
    weight = weight if owner.attribute("transB", 0) else weight.T
    steps = owner.model.weight_steps.get(owner.node.input[1]) if owner.attribute("alpha", 1.0) == 1 else None
    _dense(owner, weight, None if bias is None else bias * owner.attribute("beta", 1.0), steps)


def _matmul(owner: Importer) -> None:
    if not owner.is_constant(1):
        raise owner.refuse("it multiplies two tensors that the network computes", "One must be a constant")
    weight = owner.needed(1)
    if weight.ndim != 2:
        raise owner.refuse(f"its constant has shape {list(weight.shape)}", "Two dimensions are possible")
    _dense(owner, weight.T, None, owner.model.weight_steps.get(owner.node.input[1]))


def affine(owner: Importer, source: Tensor, factor: np.ndarray, offset: np.ndarray) -> None:
    """Multiplies each channel by a constant and adds another constant. Adds a 1 x 1 convolution with one group per channel."""
    weight = np.asarray(factor, dtype=np.float64).reshape(-1, 1, 1, 1)
    owner.add("conv", [source], weight=weight, bias=np.asarray(offset, dtype=np.float64), groups=source.channels)


def _batch_norm(owner: Importer) -> None:
    scale, bias, mean, variance = (owner.needed(i).astype(np.float64) for i in range(1, 5))
    factor = scale / np.sqrt(variance + owner.attribute("epsilon", 1e-5))
    affine(owner, owner.input(), factor, bias - mean * factor)


# --- Arithmetic ---


def _per_channel(owner: Importer, value: np.ndarray, source: Tensor) -> np.ndarray:
    """Returns a constant as one number per channel."""
    value = np.asarray(value, dtype=np.float64)
    rank = len(source.shape) + 1
    wide = value.reshape((1,) * (rank - value.ndim) + value.shape) if value.ndim <= rank else value
    if value.ndim > rank or wide.shape[0] != 1 or any(one != 1 for one in wide.shape[2:]) or wide.shape[1] not in (1, source.channels):
        raise owner.refuse(f"a constant of shape {list(value.shape)} with a tensor of shape {[1, *source.shape]}", "One number, or one per channel, is possible")
    return np.broadcast_to(wide.reshape(wide.shape[1]), (source.channels,)).copy()


def _arithmetic(sign: float, multiplies: bool, inverts: bool) -> Callable[[Importer], None]:
    def work(owner: Importer) -> None:
        constant = next((i for i in (0, 1) if owner.is_constant(i)), None)
        if constant is None:
            a, b = owner.input(0), owner.input(1)
            if a.shape != b.shape:
                raise owner.refuse(f"tensors of shapes {[1, *a.shape]} and {[1, *b.shape]}", "Two tensors of the same shape are possible")
            if inverts or sign < 0:
                raise owner.refuse("its operands are both computed by the network", "Add and Mul of two tensors are possible")
            owner.add("multiply" if multiplies else "add", [a, b])
            return
        source = owner.input(1 - constant)
        value = _per_channel(owner, owner.needed(constant), source)
        ones = np.ones(source.channels)
        if multiplies:
            if inverts and constant == 0:
                raise owner.refuse("it divides a constant by a tensor", "A tensor divided by a constant is possible")
            if inverts and (value == 0).any():
                raise owner.refuse("it divides by 0", "Export the model again")
            affine(owner, source, 1 / value if inverts else value, 0 * ones)
        elif sign < 0 and constant == 0:
            affine(owner, source, -ones, value)
        else:
            affine(owner, source, ones, sign * value)

    return work


# --- Pools and functions ---


def _pool(kind: str) -> Callable[[Importer], None]:
    def work(owner: Importer) -> None:
        if owner.attribute("ceil_mode", 0):
            raise owner.refuse("ceil_mode is set", "Export with ceil_mode=False")
        geometry = _geometry(owner, owner.attribute("kernel_shape", []))
        if geometry["dilations"] != (1, 1):
            raise owner.refuse("its window has dilations", "Windows without dilations are possible")
        owner.add(kind, [owner.input()], counts_pads=bool(owner.attribute("count_include_pad", 0)), **geometry)

    return work


def _global_pool(kind: str) -> Callable[[Importer], None]:
    def work(owner: Importer) -> None:
        source = owner.input()
        owner.add(kind, [source], kernel=(source.rows, source.columns))

    return work


def _reduce_mean(owner: Importer) -> None:
    source = owner.input()
    axes = owner.constant(1)
    axes = owner.attribute("axes", None) if axes is None else axes
    rank = len(source.shape) + 1
    wanted = sorted(int(one) % rank for one in (range(rank) if axes is None else axes))
    if wanted != list(range(2, rank)):
        raise owner.refuse(f"it reduces axes {wanted}", "Only the mean over all rows and columns is supported")
    owner.add("mean_pool", [source], kernel=(source.rows, source.columns))


def _limits(owner: Importer) -> None:
    op = owner.node.op_type
    low, high = 0.0, math.inf
    if op == "Clip":
        low, high = owner.attribute("min", -math.inf), owner.attribute("max", math.inf)
        least, most = owner.constant(1), owner.constant(2)
        low = low if least is None else float(least)
        high = high if most is None else float(most)
        low, high = _real_limits(owner, low, high)
    owner.add("table", [owner.input()], function=lambda x: np.clip(x, low, high), limits=(low, high))


def _real_limits(owner: Importer, low: float, high: float) -> tuple[float, float]:
    """Returns the limits of a Clip as real numbers. Between QuantizeLinear and DequantizeLinear (QCDQ of Brevitas), the limits in the model
    are integers; the output of the Clip then gets the scale of its input."""
    source, output = owner.node.input[0], owner.node.output[0]
    if source not in owner.model.quantised:
        return low, high
    scale, zero = owner.model.quantised[output] = owner.model.quantised[source]
    owner.model.scales[output] = scale
    return (low - zero) * scale.step, (high - zero) * scale.step


def _function(owner: Importer) -> None:
    function, limits = functions.of(owner.node.op_type, owner.attribute)
    owner.add("table", [owner.input()], function=function, range=limits)


def _prelu(owner: Importer) -> None:
    slope = owner.needed(1)
    if slope.size != 1:
        raise owner.refuse(f"it has {slope.size} slopes", "One slope for all channels is possible")
    owner.add("table", [owner.input()], function=functions.leaky(float(slope.ravel()[0])))


def _softmax(owner: Importer) -> None:
    source = owner.input()
    axis = int(owner.attribute("axis", -1 if owner.model.opset >= 13 else 1)) % (len(source.shape) + 1)
    if axis != 1 or (owner.model.opset < 13 and len(source.shape) > 1):
        raise owner.refuse(f"its axis is {axis} of {len(source.shape) + 1}", "Axis 1, the channels, is possible")
    owner.add("softmax", [source], range=(0.0, 255 / 256))


def _quantise_linear(owner: Importer) -> None:
    """Stores the scale of QuantizeLinear's input. The DequantizeLinear that follows then changes nothing."""
    source, step = owner.input(), owner.needed(1)
    zero = owner.constant(2)
    zero = np.zeros(1, dtype=np.uint8) if zero is None else zero
    if step.size != 1 or zero.dtype not in (np.uint8, np.int8):
        raise owner.refuse(f"it quantises to {zero.dtype} with {step.size} scales", "Activations of 8 bits with one scale are possible")
    scale = Scale(float(step.ravel()[0]), int(zero.ravel()[0]) + (128 if zero.dtype == np.int8 else 0))
    owner.model.scales.setdefault(source.name, scale)
    owner.model.quantised[owner.node.output[0]] = scale, int(zero.ravel()[0])
    owner.alias(source)


def _requantise(owner: Importer) -> None:
    owner.add("requantise", [owner.input()])


def _same(owner: Importer) -> None:
    owner.alias(owner.input())


_OPERATORS: dict[str, Callable[[Importer], None]] = {
    "Conv": _conv,
    "ConvTranspose": transposed.conv_transpose,
    "Gemm": _gemm,
    "MatMul": _matmul,
    "BatchNormalization": _batch_norm,
    "Add": _arithmetic(1, False, False),
    "Sub": _arithmetic(-1, False, False),
    "Mul": _arithmetic(1, True, False),
    "Div": _arithmetic(1, True, True),
    "MaxPool": _pool("max_pool"),
    "AveragePool": _pool("mean_pool"),
    "GlobalAveragePool": _global_pool("mean_pool"),
    "GlobalMaxPool": _global_pool("max_pool"),
    "ReduceMean": _reduce_mean,
    "Relu": _limits,
    "Clip": _limits,
    "PRelu": _prelu,
    "Softmax": _softmax,
    "QuantizeLinear": _quantise_linear,
    "DequantizeLinear": _same,
    "Requantise": _requantise,
    "Identity": _same,
    "Dropout": _same,
    "Cast": _same,
    **{name: _function for name in functions.NAMES},
    **moving.OPERATORS,
}
