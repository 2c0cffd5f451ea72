# SPDX-License-Identifier: Apache-2.0
"""Reads networks with integer weights. Replaces each chain of nodes that requantises sums by one node. NEMO writes the chain Mul, Add, Mul,
Div, Floor, Clip; PLiNIO writes Mul, Add, Div, Floor, Clip; QuantLab writes RequantShift."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from mebots.deploy.model_file import Model, label, onnx_package

OP = "Requantise"
_CHAIN = ("Mul", "Add", "Cast", "Div", "Floor", "Clip")
_BITS = {"weight_bits", "bias_bits", "mult_bits", "add_bits", "out_bits"}  # attributes of PLiNIO that repeat what the graph states
_SMALLEST_OF_NEMO = 1 << 16  # a divisor 2^n - 1 of at least this size is NEMO's form of 2^n; in DORY's examples, n is 18 to 24


@dataclasses.dataclass
class Requantising:
    """Computes clip(floor((sum x multiplier + addend) / 2^shift), low, high), with one number for all channels or one per channel."""

    multiplier: np.ndarray
    addend: np.ndarray
    divisor: int = 0
    low: float = -np.inf
    high: float = np.inf

    @property
    def shift(self) -> int:
        return int(self.divisor).bit_length() - 1


def to_onnx(model: Any) -> None:
    """Converts a quantiser's model to plain ONNX. Deletes attributes with numbers of bits, and replaces RequantShift."""
    for node in model.graph.node:
        kept = [one for one in node.attribute if node.domain not in ("", "ai.onnx") or one.name not in _BITS]
        if len(kept) != len(node.attribute):
            del node.attribute[:]
            node.attribute.extend(kept)
    _expand_shifts(model)


def _expand_shifts(model: Any) -> None:
    """Replaces RequantShift, which is not an ONNX operator and rounds, by Mul, Add, Div, Floor and Clip."""
    helper, numpy_helper = onnx_package().helper, onnx_package().numpy_helper
    nodes = []
    for node in model.graph.node:
        if node.op_type != "RequantShift":
            nodes.append(node)
            continue
        given = {one.name: _number(one) for one in node.attribute}
        levels, signed = given["n_levels_out"], bool(given.get("signed", 1))
        low, high = (-levels / 2, levels / 2 - 1) if signed else (0, levels - 1)
        name = label(node)
        model.graph.initializer.append(numpy_helper.from_array(np.float32(given["div"]), f"{name} div"))
        model.graph.initializer.append(numpy_helper.from_array(np.float32(given["div"] / 2), f"{name} half"))
        model.graph.initializer.append(numpy_helper.from_array(np.float32(low), f"{name} low"))
        model.graph.initializer.append(numpy_helper.from_array(np.float32(high), f"{name} high"))
        limits = {"min": float(low), "max": float(high)} if _opset(model) < 11 else {}
        more = [] if limits else [f"{name} low", f"{name} high"]
        source, result = node.input[0], node.output[0]
        nodes += [
            helper.make_node("Mul", [source, node.input[1]], [f"{result} product"], name=f"{name} mul"),
            helper.make_node("Add", [f"{result} product", node.input[2]], [f"{result} sum"], name=f"{name} add"),
            helper.make_node("Add", [f"{result} sum", f"{name} half"], [f"{result} rounded"], name=f"{name} round"),
            helper.make_node("Div", [f"{result} rounded", f"{name} div"], [f"{result} quotient"], name=f"{name} div"),
            helper.make_node("Floor", [f"{result} quotient"], [f"{result} floor"], name=f"{name} floor"),
            helper.make_node("Clip", [f"{result} floor", *more], [result], name=name, **limits),
        ]
    if len(nodes) != len(model.graph.node):
        del model.graph.node[:]
        model.graph.node.extend(nodes)
        del model.graph.value_info[:]


def _number(attribute: Any) -> float:
    onnx = onnx_package()
    value = onnx.helper.get_attribute_value(attribute)
    return float(onnx.numpy_helper.to_array(value).ravel()[0] if isinstance(value, onnx.TensorProto) else np.ravel(value)[0])


def _opset(model: Any) -> int:
    return next((one.version for one in model.opset_import if one.domain in ("", "ai.onnx")), 0)


def is_integer(model: Model) -> bool:
    """True if all weights of convolutions and dense layers are integers that fit into a byte."""
    found = False
    for node in model.nodes:
        if node.op_type not in ("Conv", "Gemm", "MatMul") or len(node.input) < 2 or node.input[1] not in model.constants:
            continue
        weight = model.constants[node.input[1]]
        if not (np.rint(weight) == weight).all() or np.abs(weight).max() > 128 or np.abs(weight).max() < 2:
            return False
        found = True
    return found


def collapse(model: Model) -> None:
    """Replaces each chain of nodes that requantises a sum by one node. Stores the numbers of the requantisation in ``model.requantising``
    by the name of the node's output."""
    users: dict[str, list[Any]] = {}
    for node in model.nodes:
        for name in node.input:
            users.setdefault(name, []).append(node)
    done: set[int] = set()
    nodes = []
    for node in model.nodes:
        if id(node) in done:
            continue
        chain = _chain(model, node, users)
        if chain is None:
            nodes.append(node)
            continue
        done.update(id(one) for one in chain)
        source = next(name for name in chain[0].input if name not in model.constants)
        result = chain[-1].output[0]
        model.requantising[result] = _numbers(model, chain)
        nodes.append(onnx_package().helper.make_node(OP, [source], [result], name=label(chain[-1])))
    model.nodes = nodes


def _chain(model: Model, first: Any, users: dict[str, list[Any]]) -> list[Any] | None:
    """Returns the nodes from ``first`` to a Clip if they requantise a sum, otherwise None."""
    chain: list[Any] = []
    node = first
    while node.op_type in _CHAIN and (node.op_type in ("Cast", "Floor", "Clip") or any(name in model.constants for name in node.input)):
        chain.append(node)
        after = users.get(node.output[0], [])
        if node.op_type == "Clip" or len(after) != 1:
            break
        node = after[0]
    return chain if chain and chain[-1].op_type == "Clip" and any(one.op_type == "Div" for one in chain) else None


def _numbers(model: Model, chain: list[Any]) -> Requantising:
    result = Requantising(np.ones(1, dtype=np.int64), np.zeros(1, dtype=np.int64))
    for node in chain:
        value = next((model.constants[name] for name in node.input if name in model.constants), None)
        if node.op_type == "Clip":
            result.low, result.high = _limits(model, node)
        elif node.op_type in ("Mul", "Add", "Div"):
            whole = np.rint(np.asarray(value, dtype=np.float64).ravel()).astype(np.int64)
            if (whole != np.asarray(value, dtype=np.float64).ravel()).any():
                raise model.fail(f"node {label(node)} ({node.op_type}): its constant is not a whole number, but the weights are whole numbers. Export it again")
            _apply(model, node, result, whole)
    return result


def _apply(model: Model, node: Any, result: Requantising, value: np.ndarray) -> None:
    if node.op_type == "Mul":
        result.multiplier = result.multiplier * value
        result.addend = result.addend * value
    elif node.op_type == "Add":
        result.addend = result.addend + value
    else:
        divisor = int(value[0])
        if divisor >= _SMALLEST_OF_NEMO and divisor & (divisor + 1) == 0:
            divisor += 1
        if value.size != 1 or divisor < 1 or divisor & (divisor - 1):
            raise model.fail(f"node {label(node)} (Div): divides by {value.tolist()[:4]}; one power of two is possible")
        result.divisor = divisor


def _limits(model: Model, node: Any) -> tuple[float, float]:
    given = {one.name: one.f for one in node.attribute}
    constants = [float(model.constants[name]) if name in model.constants else None for name in node.input[1:]] + [None, None]
    low = given.get("min", -np.inf) if constants[0] is None else constants[0]
    high = given.get("max", np.inf) if constants[1] is None else constants[1]
    return low, high
