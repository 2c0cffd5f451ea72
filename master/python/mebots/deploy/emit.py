# SPDX-License-Identifier: Apache-2.0
"""Writes a network as C: a table of layers and a binary file of weights."""

from __future__ import annotations

import dataclasses
import math
import pathlib
from typing import Any

import numpy as np

from mebots.deploy import c_files
from mebots.deploy import plan as planning
from mebots.deploy.graph import Tensor
from mebots.deploy.layers import Layer, Network
from mebots.deploy.plan import Part, Plan, Steps, Stream

L1_RESERVED = 640  # LAYER_L1_RESERVED in fmu_soc/firmware/kernels/layer.h
_PICTURE = 0xFFFFFFFF
_KERNELS = {"max_pool": "layer_max_pool", "average_pool": "layer_average_pool", "add": "layer_add", "multiply": "layer_multiply", "table": "layer_table"}


def _kernel(layer: Layer) -> dict[str, str]:
    """Returns the layer's kind and kernel."""
    if layer.kind in ("move", "softmax"):
        return {"kind": f"LAYER_{layer.kind.upper()}"}
    if layer.kind in _KERNELS:
        return {"kind": "LAYER_TILED", "kernel": _KERNELS[layer.kind]}
    scaling = "none" if layer.requantise is None else layer.requantise.scaling
    if planning.is_depthwise(layer):
        size = "_3x3" if planning.is_depthwise_3x3(layer) else ""
        return {"kind": "LAYER_TILED", "kernel": f"layer_depthwise{size}_{scaling}"}
    if planning.is_dense(layer):
        return {"kind": "LAYER_TILED", "kernel": f"layer_dense_{scaling}"}
    blocks = "_blocks" if planning.is_in_blocks(layer) else ""
    if planning.pools_sums(layer):
        return {"kind": "LAYER_TILED", "kernel": f"layer_convolve{blocks}_pooled_{scaling}"}
    then = {"then": "layer_max_pool"} if layer.pool > 1 else {}
    return {"kind": "LAYER_TILED", "kernel": f"layer_convolve{blocks}_{scaling}"} | then


class Weights:
    """The binary file of weights. Each part starts at a multiple of four bytes."""

    def __init__(self) -> None:
        self._bytes = bytearray()

    def add(self, content: bytes) -> int:
        at = len(self._bytes)
        self._bytes += content + bytes(-len(content) % 4)
        return at

    @property
    def size(self) -> int:
        return len(self._bytes)

    def content(self) -> bytes:
        # Adds zeros, because a copy of the last weights may read one word after them.
        return bytes(self._bytes) + bytes(8)


def _words(*values: Any) -> bytes:
    return np.array([int(one) for one in values], dtype=np.int64).astype(np.uint32).astype("<u4").tobytes()


def _group(layer: Layer, part: Part, group: tuple[int, int, int], sliced: bool) -> bytes:
    """Returns the data of up to four output channels: a header, the numbers of the requantisation, and the weights in the order of the
    contiguous runs of a patch."""
    first, count, source = group
    if sliced:
        source -= part.first
    runs_y, runs_x, run = planning.run_geometry(layer)
    r = layer.requantise
    rows = [np.zeros(4, dtype=np.int64) for _ in range(4)]
    given = (layer.bias,) if r is None else (layer.bias, r.multiplier, r.addend, r.shift)
    for row, values in zip(rows, given, strict=False):
        row[:count] = values[first : first + count]
    lower = np.zeros(0, dtype=np.int64)
    if r is not None and r.lower is not None:
        lower = np.zeros(4, dtype=np.int64)
        lower[:count] = r.lower[first : first + count]
    if planning.is_depthwise(layer):
        weights = _depthwise_weights(layer, first, count)
    else:
        weights = np.zeros((4, runs_y * runs_x, planning.align(run)), dtype=np.int8)
        # Reorders weights to the order of a patch in memory: rows, columns, input channels.
        weights[:count, :, :run] = layer.weight[first : first + count].transpose(0, 2, 3, 1).reshape(count, runs_y * runs_x, run)
        if planning.is_in_blocks(layer):
            weights = weights.reshape(4, -1, 4).transpose(1, 0, 2).copy()
    shifts = rows[3].astype(np.uint8).tobytes()
    return _words(source | (first - part.first) << 16) + shifts + _words(count, *rows[0], *rows[1], *rows[2], *lower) + weights.tobytes()


def _depthwise_weights(layer: Layer, first: int, count: int) -> np.ndarray:
    """Returns the weights of four channels: the first four positions of the kernel for each channel, then the next four positions. In a 3 x
    3 kernel, each column takes four positions: its three weights and a zero."""
    if planning.is_depthwise_3x3(layer):
        columns = np.zeros((4, 3, 4), dtype=np.int8)
        columns[:count, :, :3] = layer.weight[first : first + count].reshape(count, 3, 3).transpose(0, 2, 1)
        return columns.transpose(1, 0, 2).copy()
    places = math.prod(layer.kernel)
    weights = np.zeros((4, 4 * planning.fours(layer)), dtype=np.int8)
    weights[:count, :places] = layer.weight[first : first + count].reshape(count, places)
    return weights.reshape(4, -1, 4).transpose(1, 0, 2).copy()


def _move(layer: Layer, number: int, sources: dict[Tensor, int]) -> bytes:
    move, table = layer.moves[number]
    fill = -1 if layer.fill is None or number > 0 else layer.fill
    words = _words(sources[layer.inputs[move.source]], fill, layer.output.size, table is not None, move.start, move.out_start, *move.counts, *move.steps, *move.out_steps)
    return words + (b"" if table is None else table.tobytes())


def _data(layer: Layer, part: Part, sliced: bool = False) -> bytes:
    if layer.kind == "convolution":
        return b"".join(_group(layer, part, one, sliced) for one in part.groups)
    if layer.kind == "average_pool":
        r = layer.requantisation
        return b"".join(_words(*one) for one in zip(r.multiplier, r.addend, r.shift, strict=True))
    return layer.table.tobytes()


def _block_table(layer: Layer, steps: Steps | None, weights: Weights, sources: dict[Tensor, int]) -> tuple[int, int]:
    """Adds the data of all parts of a layer to ``weights``, and a table of their offsets. Returns the offset of this table and its number
    of rows."""
    rows = []
    if layer.kind == "move":
        for number in range(len(layer.moves)):
            rows.append((weights.add(_move(layer, number, sources)), 0, 0, layer.output.channels, 0))
    elif steps is None:
        rows.append((weights.add(_data(layer, Part(0, layer.output.channels, []))), 0, 0, layer.output.channels, 0))
    else:
        shared = None
        for part in steps.parts:
            content = _data(layer, part, steps.sliced)
            if layer.kind == "average_pool":
                shared = weights.add(content) if shared is None else shared
                at = shared
            else:
                at = weights.add(content)
            channels = 1 if layer.kind in planning.FLAT_KINDS else part.channels
            rows.append((at, planning.align(len(content)), part.first, channels, len(part.groups)))
    return weights.add(b"".join(_words(*row) for row in rows)), len(rows)


def _fields(layer: Layer, steps: Steps | None, offsets: dict[Tensor, int]) -> dict[str, Any]:
    source, out = layer.inputs[0], layer.output
    flat = layer.kind in planning.FLAT_KINDS
    fields: dict[str, Any] = {
        **_kernel(layer),
        "operands": 2 if layer.kind in ("add", "multiply") else 1,
        "low": layer.low,
        "high": layer.high,
        "outside": layer.outside,
        "scaling": "SCALING_NONE" if layer.requantise is None else f"SCALING_{layer.requantise.scaling.upper()}",
        "element": out.element,
        "pool": layer.pool,
        "in": offsets[source],
        "other": offsets[layer.inputs[-1]],
        "out": offsets[out],
        "in_rows": out.size if flat else source.rows,
        "in_columns": 1 if flat else source.columns,
        "in_channels": 1 if flat else source.channels,
        "out_rows": out.size if flat else out.rows,
        "out_columns": 1 if flat else out.columns,
        "out_channels": 1 if flat else out.channels,
        "kernel_rows": layer.extent()[0],
        "kernel_columns": layer.extent()[1],
        "stride_rows": layer.strides[0],
        "stride_columns": layer.strides[1],
        "pad_top": layer.pads[0],
        **_side_fields(layer),
    }
    if steps is not None:
        fields |= {
            "by_tile": int(steps.by_tile),
            "sliced": int(steps.sliced),
            "early": int(steps.early),
            "tile_rows": steps.tile_rows,
            "tiles": steps.tiles,
            **{name: f"{{{getattr(steps, name)[0]}, {getattr(steps, name)[1]}}}" for name in ("l1_in", "l1_other", "l1_data", "l1_out")},
            "l1_unpooled": steps.l1_unpooled,
            "l1_gathered": steps.l1_gathered,
        }
        if planning.is_depthwise_3x3(layer):
            fields["strip"] = planning.strip_passes(layer, steps.tile_rows, len(steps.parts[0].groups))
    return fields | _own_fields(layer)


def _side_fields(layer: Layer) -> dict[str, int]:
    left, right = layer.pads[1], layer.pads[3]
    rows = {"outer_rows": int(planning.has_outer_rows(layer))}
    if planning.has_outer_columns(layer):
        return rows | {"pad_left": left, "pad_right": right}
    return rows | {"outside_left": left, "outside_right": right}


def _own_fields(layer: Layer) -> dict[str, Any]:
    """Returns the fields in the layer's row of network.c that only this kind of layer has."""
    if layer.kind == "convolution":
        return _run_fields(layer) | _gather_fields(layer) | {"gathered_stride": planning.core_bytes(layer)}
    if layer.kind == "average_pool":
        return {"zeros": f"{{{int(not layer.counts_pads)}, 0}}"}
    if layer.kind == "add":
        return {"factors": f"{{{layer.factors[0]}, {layer.factors[1]}}}", "addend": layer.addend, "shift": layer.shift}
    if layer.kind == "multiply":
        r = layer.requantisation
        zeros = f"{{{layer.zeros[0]}, {layer.zeros[1]}}}"
        return {"factors": f"{{{r.multiplier[0]}, 0}}", "zeros": zeros, "addend": r.addend[0], "shift": r.shift[0]}
    return {}


def _run_fields(layer: Layer) -> dict[str, int]:
    if planning.is_depthwise(layer):
        return {
            "runs_y": layer.kernel[0],
            "runs_x": layer.kernel[1],
            "run_words": planning.fours(layer),
            "step_y": layer.dilations[0],
            "step_x": layer.dilations[1],
            "group_bytes": planning.group_bytes(layer),
        }
    runs_y, runs_x, run = planning.run_geometry(layer)
    length = planning.align(run)
    channels = layer.inputs[0].channels
    pitch = planning.columns_in_l1(layer) * channels
    # step_x leads from the end of a run to the start of the next run in the same row of the patch. After the last run of a row, step_y is
    # added to it.
    if runs_y * runs_x == 1:
        return {"runs_y": 1, "runs_x": 1, "run_words": length // 4, "group_bytes": planning.group_bytes(layer)}
    step_x = layer.dilations[1] * channels - length if runs_x > 1 else 0
    step_y = layer.dilations[0] * pitch - runs_x * (length + step_x)
    return {
        "runs_y": runs_y,
        "runs_x": runs_x,
        "run_words": length // 4,
        "step_x": step_x,
        "step_y": step_y,
        "group_bytes": planning.group_bytes(layer),
    }


def _gather_fields(layer: Layer) -> dict[str, int]:
    if not planning.gathers(layer):
        return {}
    rows, runs, run = planning.gather_geometry(layer)
    channels = layer.inputs[0].channels
    pitch = planning.columns_in_l1(layer) * channels
    return {
        "gather_rows": rows,
        "gather_runs": runs,
        "gather_bytes": run,
        "gather_step": layer.dilations[1] * channels,
        "gather_row_step": layer.dilations[0] * pitch,
        "gathered_bytes": planning.patch_copy_bytes(layer),
    }


@dataclasses.dataclass
class Sources:
    files: dict[str, bytes]
    weight_bytes: int

    def write(self, folder: pathlib.Path) -> None:
        """Writes the files into a folder. Creates the folder if necessary."""
        folder.mkdir(exist_ok=True)
        for name, content in self.files.items():
            (folder / name).write_bytes(content)


def emit(network: Network, plan: Plan, in_l3: bool = False) -> Sources:
    """Returns the content of the library's files by file name. If ``in_l3`` is true, the weights are in HyperRAM, and ``plan.stream``
    stores their addresses."""
    offsets = {**plan.offsets, network.input: _PICTURE}
    weights = Weights()
    rows, segments = [], []
    for layer, steps in zip(network.layers, plan.steps, strict=True):
        begin = weights.size
        fields = _fields(layer, steps, offsets)
        fields["blocks"], fields["block_count"] = _block_table(layer, steps, weights, offsets)
        segments.append((begin, weights.size - begin))
        text = ", ".join(f".{key} = {value}" for key, value in fields.items())
        rows.append(f"    // {layer.name}: {layer.op}\n    {{{text}}},\n")
    content = weights.content()
    plan.stream = Stream(segments) if in_l3 else None
    files = {
        "network.h": c_files.header(network, plan).encode(),
        "network.c": c_files.source(network, plan, rows, len(content)).encode(),
        "network_weights.S": c_files.assembler(plan).encode(),
        "network.weights": content,
        "network.cmake": c_files.cmake(plan).encode(),
    }
    return Sources(files, len(content))
