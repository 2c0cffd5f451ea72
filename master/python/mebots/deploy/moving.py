# SPDX-License-Identifier: Apache-2.0
"""Converts operators that only move values. A move copies from a view of the input to a view of the output with the same shape. The chip's
kernel uses the strides of these views."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from mebots.deploy.context import Importer
from mebots.deploy.graph import Tensor

MOST_DIMENSIONS = 6


@dataclasses.dataclass(frozen=True)
class Move:
    """Copies values of an input: byte offsets, counts, and steps in input and output. ``source`` is the number of the input."""

    source: int
    start: int
    out_start: int
    counts: tuple[int, ...]
    steps: tuple[int, ...]
    out_steps: tuple[int, ...]

    def places(self) -> list[int]:
        """Returns the indices of the copied values in the input, in the order of the copies."""
        where = np.zeros(self.counts, dtype=np.int64)
        for axis, (count, step) in enumerate(zip(self.counts, self.steps, strict=True)):
            where += np.arange(count).reshape((-1,) + (1,) * (len(self.counts) - axis - 1)) * step
        return [int(one) + self.start for one in where.ravel()]

    def apply(self, values: np.ndarray, out: np.ndarray) -> None:
        """Copies the values. Both arrays must be flat."""
        where = np.zeros(self.counts, dtype=np.int64)
        to = where.copy()
        for axis, (count, step, out_step) in enumerate(zip(self.counts, self.steps, self.out_steps, strict=True)):
            index = np.arange(count).reshape((-1,) + (1,) * (len(self.counts) - axis - 1))
            where += index * step
            to += index * out_step
        out[to + self.out_start] = values[where + self.start]


def _address(array: np.ndarray) -> int:
    return int(array.__array_interface__["data"][0])


def move(number: int, source: np.ndarray, source_view: np.ndarray, out: np.ndarray, out_view: np.ndarray) -> Move:
    """Returns the Move that copies ``source_view``, a view of ``source``, to ``out_view``, a view of ``out`` with the same shape.
    ``number`` is the number of the input."""
    kept = [i for i in range(source_view.ndim) if source_view.shape[i] > 1]
    counts, steps, out_steps = [], [], []
    for i in kept:
        counts.append(source_view.shape[i])
        steps.append(source_view.strides[i])
        out_steps.append(out_view.strides[i])
    order = sorted(range(len(kept)), key=lambda i: -abs(out_steps[i]))
    counts, steps, out_steps = ([one[i] for i in order] for one in (counts, steps, out_steps))
    _join(counts, steps, out_steps)
    missing = MOST_DIMENSIONS - len(counts)
    return Move(
        number,
        _address(source_view) - _address(source),
        _address(out_view) - _address(out),
        (1,) * missing + tuple(counts),
        (0,) * missing + tuple(steps),
        (0,) * missing + tuple(out_steps),
    )


def _join(counts: list[int], steps: list[int], out_steps: list[int]) -> None:
    """Merges two adjacent dimensions that are contiguous in the source and in the output, so that the copy needs fewer loops."""
    i = 0
    while i + 1 < len(counts):
        if steps[i] == counts[i + 1] * steps[i + 1] and out_steps[i] == counts[i + 1] * out_steps[i + 1]:
            counts[i : i + 2] = [counts[i] * counts[i + 1]]
            del steps[i], out_steps[i]
        else:
            i += 1


def _memory(tensor: Tensor) -> np.ndarray:
    return np.empty(tensor.size, dtype=np.uint8)


def _with_batch(tensor: Tensor, memory: np.ndarray) -> np.ndarray:
    return tensor.view(memory)[np.newaxis]


def _add(owner: Importer, source: Tensor, view_of: Callable[[np.ndarray], np.ndarray], out_view_of: Callable[[np.ndarray], np.ndarray], fill: float | None = None) -> None:
    node = owner.add("move", [source], fill=fill)
    memory, out = _memory(source), _memory(node.output)
    node.moves = [move(0, memory, view_of(_with_batch(source, memory)), out, out_view_of(_with_batch(node.output, out)))]


def _reshape(owner: Importer) -> None:
    source = owner.input()
    shape = owner.shape_of(owner.node.output[0])
    if shape[0] != 1:
        raise owner.refuse(f"its output has shape {list(shape)}", "The first dimension is the batch, which must stay 1")
    target = Tensor("", tuple(shape[1:]))
    if len(target.shape) > 3:
        raise owner.refuse(f"its output has shape {list(shape)}", "At most four dimensions are possible")
    ones = [t for t in (source, target) if len(t.shape) == 1 or t.rows * t.columns == 1 or t.channels == 1]
    if len(ones) == 2 or source.shape == target.shape:
        # The values stay in the same order in memory, so the node copies nothing.
        node = owner.add("move", [source])
        node.moves = []
        return
    if len(target.shape) == 1:
        _add(owner, source, lambda view: view, lambda view: view.reshape(1, *source.shape))
    elif len(source.shape) == 1:
        _add(owner, source, lambda view: view.reshape(1, *target.shape), lambda view: view)
    else:
        parts = _common(source.shape, target.shape)
        if parts is None:
            raise owner.refuse(f"from shape {[1, *source.shape]} to {[1, *target.shape]}", "Flatten first, then Reshape")
        _add(owner, source, lambda view: view.reshape(1, *parts), lambda view: view.reshape(1, *parts))


def _common(a: tuple[int, ...], b: tuple[int, ...]) -> tuple[int, ...] | None:
    """Returns dimensions that become either shape if neighbours are merged. Returns None if such dimensions do not exist."""
    edges = sorted({math.prod(shape[i:]) for shape in (a, b) for i in range(len(shape) + 1)}, reverse=True)
    if any(big % small for big, small in zip(edges, edges[1:], strict=False)):
        return None
    return tuple(big // small for big, small in zip(edges, edges[1:], strict=False))


def _transpose(owner: Importer) -> None:
    source = owner.input()
    order = [int(one) for one in owner.attribute("perm", list(reversed(range(len(source.shape) + 1))))]
    if order[0] != 0:
        raise owner.refuse(f"its order is {order}", "The batch must stay first")
    _add(owner, source, lambda view: view.transpose(order), lambda view: view)


def _slices(owner: Importer, rank: int) -> list[slice]:
    if "starts" in owner.attributes:
        starts, ends = owner.attribute("starts", []), owner.attribute("ends", [])
        axes, steps = owner.attribute("axes", list(range(len(starts)))), [1] * len(starts)
    else:
        starts, ends = owner.needed(1), owner.needed(2)
        given_axes, given_steps = owner.constant(3), owner.constant(4)
        axes = list(range(len(starts))) if given_axes is None else [int(one) for one in given_axes]
        steps = [1] * len(starts) if given_steps is None else [int(one) for one in given_steps]
    result = [slice(None)] * rank
    for start, end, axis, step in zip(starts, ends, axes, steps, strict=True):
        # A backward slice up to the first element has an end below -length.
        stop = None if step < 0 and int(end) < -(1 << 30) else int(end)
        result[int(axis) % rank] = slice(int(start), stop, int(step))
    return result


def _slice(owner: Importer) -> None:
    source = owner.input()
    parts = tuple(_slices(owner, len(source.shape) + 1))
    _add(owner, source, lambda view: view[parts], lambda view: view)


def _gather(owner: Importer) -> None:
    source = owner.input()
    rank = len(source.shape) + 1
    axis = int(owner.attribute("axis", 0)) % rank
    indices = np.asarray(owner.constant(1)).astype(np.int64)
    if axis == 0 or indices.ndim > 1 or (indices.size > 1 and len(set(np.diff(indices))) > 1):
        raise owner.refuse(f"axis {axis} with indices {indices.tolist()}", "One index, or equally spaced indices, of an axis other than the batch are possible")
    first = int(indices.ravel()[0]) % source.shape[axis - 1]
    if indices.ndim == 0:
        if rank == 2:
            _scalar(owner, source, first)
            return
        _add(owner, source, lambda view: view[(slice(None),) * axis + (first,)], lambda view: view)
        return
    step = int(indices[1] - indices[0]) if indices.size > 1 else 1
    stop = first + step * indices.size
    part = slice(first, None if stop < 0 else stop, step)
    _add(owner, source, lambda view: view[(slice(None),) * axis + (part,)], lambda view: view)


def _scalar(owner: Importer, source: Tensor, channel: int) -> None:
    """Selects one channel of a vector. The result has length one; ONNX removes the dimension."""
    _add(owner, source, lambda view: view[:, channel : channel + 1], lambda view: view)


def _pad(owner: Importer) -> None:
    source = owner.input()
    if owner.attribute("mode", b"constant") != b"constant":
        raise owner.refuse(f"mode {owner.attribute('mode', b'').decode()}", "Constant pads are possible")
    pads = owner.attribute("pads", None)
    pads = owner.needed(1) if pads is None else pads
    given_value = owner.constant(2)
    value = owner.attribute("value", 0.0) if given_value is None else float(given_value.ravel()[0])
    rank = len(source.shape) + 1
    axes = owner.constant(3)
    pads = [int(one) for one in pads]
    begin, end = [0] * rank, [0] * rank
    listed = range(rank) if axes is None else [int(one) % rank for one in axes]
    for place, axis in enumerate(listed):
        begin[axis], end[axis] = pads[place], pads[len(pads) // 2 + place]
    if min(begin) < 0 or min(end) < 0 or begin[0] or end[0]:
        raise owner.refuse(f"pads {pads}", "Pads must be at least 0, and the batch cannot be padded")
    parts = tuple(slice(b, b + size) for b, size in zip(begin, (1, *source.shape), strict=True))
    _add(owner, source, lambda view: view, lambda view: view[parts], fill=value)


def _concat(owner: Importer) -> None:
    sources = [owner.input(i) for i in range(len(owner.node.input))]
    axis = int(owner.attribute("axis", 1)) % (len(sources[0].shape) + 1)
    if axis == 0:
        raise owner.refuse("it joins batches", "Other axes are possible")
    node = owner.add("move", sources)
    out = _memory(node.output)
    begin = 0
    for number, source in enumerate(sources):
        size = source.shape[axis - 1]
        part = (slice(None),) * axis + (slice(begin, begin + size),)
        memory = _memory(source)
        node.moves.append(move(number, memory, _with_batch(source, memory), out, _with_batch(node.output, out)[part]))
        begin += size


def _resize(owner: Importer) -> None:
    source = owner.input()
    if owner.attribute("mode", b"nearest") != b"nearest":
        raise owner.refuse(f"mode {owner.attribute('mode', b'').decode()}", "Mode nearest is possible")
    target = owner.shape_of(owner.node.output[0])
    factors = [b // a for a, b in zip((1, *source.shape), target, strict=True)]
    if any(a * f != b for a, f, b in zip((1, *source.shape), factors, target, strict=True)) or factors[:2] != [1, 1]:
        raise owner.refuse(f"from shape {[1, *source.shape]} to {list(target)}", "Rows and columns can be multiplied by whole numbers")
    _check_resize(owner, source, factors)

    def repeated(view: np.ndarray) -> np.ndarray:
        shape = [size for pair in zip(view.shape, factors, strict=True) for size in pair]
        strides = [step for one in view.strides for step in (one, 0)]
        return np.lib.stride_tricks.as_strided(view, shape, strides)

    split = [size for pair in zip((1, *source.shape), factors, strict=True) for size in pair]
    _add(owner, source, repeated, lambda view: view.reshape(split))


def _check_resize(owner: Importer, source: Tensor, factors: list[int]) -> None:
    """Rejects attributes of Resize that do not repeat each value as often as ``factors`` require."""
    if owner.node.op_type == "Upsample":
        return
    where = owner.attribute("coordinate_transformation_mode", b"half_pixel").decode()
    nearest = owner.attribute("nearest_mode", b"round_prefer_floor").decode()
    for size, factor in zip(source.shape[1:], factors[2:], strict=True):
        x = np.arange(size * factor)
        if where in ("half_pixel", "pytorch_half_pixel"):
            at = (x + 0.5) / factor - 0.5
        elif where == "asymmetric":
            at = x / factor
        else:
            raise owner.refuse(f"coordinate_transformation_mode {where}", "asymmetric and half_pixel are possible")
        chosen = {"floor": np.floor(at), "ceil": np.ceil(at), "round_prefer_floor": np.ceil(at - 0.5), "round_prefer_ceil": np.floor(at + 0.5)}[nearest]
        if (np.clip(chosen, 0, size - 1) != x // factor).any():
            raise owner.refuse(f"nearest_mode {nearest} with {where} does not repeat each value", "Use asymmetric with floor, as torch does")


OPERATORS: dict[str, Callable[[Any], None]] = {
    "Flatten": _reshape,
    "Reshape": _reshape,
    "Squeeze": _reshape,
    "Unsqueeze": _reshape,
    "Transpose": _transpose,
    "Slice": _slice,
    "Gather": _gather,
    "Pad": _pad,
    "Concat": _concat,
    "Resize": _resize,
    "Upsample": _resize,
}
