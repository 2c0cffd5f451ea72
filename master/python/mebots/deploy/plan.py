# SPDX-License-Identifier: Apache-2.0
"""Plans the memory: places each tensor in L2 for its lifetime, and divides each layer into steps that fit into L1."""

from __future__ import annotations

import dataclasses
import math

from mebots.deploy.graph import Tensor
from mebots.deploy.layers import Layer, Network
from mebots.errors import InputError

ALIGNMENT = 4
GROUP = 4  # output channels that a kernel computes together
GROUP_HEADER = 60  # size of layer_group_t
CORES = 8
SLACK = 16  # bytes that kernels may read after a buffer
ROWS_KINDS = ("convolution", "max_pool", "average_pool")
FLAT_KINDS = ("add", "multiply", "table")


@dataclasses.dataclass(frozen=True)
class Memory:
    """The bytes of a board's memories that a network may use."""

    l1: int
    l2: int
    board: str


@dataclasses.dataclass
class Part:
    """A part of an output's channels, in groups of four. Each group is (first output channel, count, first input channel)."""

    first: int
    channels: int
    groups: list[tuple[int, int, int]]


@dataclasses.dataclass
class Steps:
    """The division of a layer into steps. Each L1 buffer exists twice and has two offsets."""

    tile_rows: int
    tiles: int
    parts: list[Part]
    sliced: bool
    by_tile: bool
    l1_in: tuple[int, int]
    l1_other: tuple[int, int]
    l1_data: tuple[int, int]
    l1_out: tuple[int, int]
    l1_unpooled: int
    l1_gathered: int
    l1_bytes: int
    early: bool = False  # the first part's data are fetched during the previous layer


@dataclasses.dataclass
class Plan:
    offsets: dict[Tensor, int]  # in the network's memory, except the input
    memory_bytes: int
    lifetimes: dict[Tensor, tuple[int, int]]
    steps: list[Steps | None]
    l1_bytes: int
    stream: Stream | None = None


@dataclasses.dataclass(frozen=True)
class Stream:
    """Weights in L3. While a layer is computed, the next layer's weights are fetched into the other of two L2 buffers."""

    segments: list[tuple[int, int]]  # first byte and size of each layer

    @property
    def buffers(self) -> tuple[int, int]:
        """Returns the sizes [bytes] of the two buffers for fetched weights: one for the layers with even numbers, one for those with odd
        numbers."""
        even, odd = (max((size for _, size in self.segments[start::2]), default=0) for start in (0, 1))
        return align(even + SLACK), align(odd + SLACK)


def align(value: int) -> int:
    return (value + ALIGNMENT - 1) // ALIGNMENT * ALIGNMENT


def plan(network: Network, memory: Memory, l1_reserved: int) -> Plan:
    """Plans the memory. Raises InputError if a layer does not fit."""
    lifetimes = _lifetimes(network)
    offsets, size = _place(lifetimes)
    steps, l1_bytes = _all_steps(network.layers, memory.l1 - l1_reserved, memory.board)
    for one in steps:
        if one is not None:
            _shift(one, l1_reserved)
    return Plan(offsets, size, lifetimes, steps, l1_bytes + l1_reserved)


def _all_steps(layers: list[Layer], available: int, board: str) -> tuple[list[Steps | None], int]:
    """Returns the steps of all layers, and the bytes of L1 that they need.

    While the cores compute a layer, the DMA fetches the data of the next layer's first part, if L1 has space for both. Therefore
    layers with even numbers use the start of L1, and these data are their first buffer. Layers with odd numbers use the end of
    L1, and these data are their last buffer.
    """
    chosen: list[Steps | None] = []
    following = 0  # bytes of the next layer's first data
    for number in reversed(range(len(layers))):
        layer = layers[number]
        spare = available - _least_bytes(layers[number - 1]) if number > 0 else 0
        steps = _steps(layer, available, board, spare, following)
        chosen.insert(0, steps)
        following = 0 if steps is None else _first_bytes(layer, steps.parts)
    end = max((one.l1_bytes for one in chosen if one is not None), default=0)
    before = available
    result: list[Steps | None] = []
    for layer, one in zip(layers, chosen, strict=True):
        if one is not None:
            one = _layout(layer, one.parts, one.tile_rows, len(result) % 2 == 1)
            together = before + _first_bytes(layer, one.parts)
            one.early = before < together <= available
            end = max(end, together if one.early else 0)
        before = 0 if one is None else one.l1_bytes
        result.append(one)
    for one in result[1::2]:
        if one is not None:
            _shift(one, end - one.l1_bytes)
    return result, end


def _shift(steps: Steps, by: int) -> None:
    for name in ("l1_in", "l1_other", "l1_data", "l1_out"):
        a, b = getattr(steps, name)
        setattr(steps, name, (a + by, b + by))
    steps.l1_unpooled += by
    steps.l1_gathered += by


def _lifetimes(network: Network) -> dict[Tensor, tuple[int, int]]:
    """Returns for each tensor the layer that computes it and the last layer that reads it."""
    last = len(network.layers)
    result: dict[Tensor, tuple[int, int]] = {}
    for number, layer in enumerate(network.layers):
        result[layer.output] = (number, number)
        for one in layer.inputs:
            if one in result:
                result[one] = (result[one][0], number)
    for one in network.outputs:
        result[one] = (result[one][0], last)
    return result


def _place(lifetimes: dict[Tensor, tuple[int, int]]) -> tuple[dict[Tensor, int], int]:
    """Places each tensor at the lowest address that is free during its lifetime. Starts with the largest tensor."""
    offsets: dict[Tensor, int] = {}
    size = 0
    for tensor in sorted(lifetimes, key=lambda one: (-one.bytes, lifetimes[one])):
        begin, end = lifetimes[tensor]
        taken = sorted(
            (offsets[other], offsets[other] + align(other.bytes + SLACK))
            for other in offsets
            if lifetimes[other][0] <= end and begin <= lifetimes[other][1]
        )
        at = 0
        for low, high in taken:
            if low - at >= align(tensor.bytes + SLACK):
                break
            at = max(at, high)
        offsets[tensor] = at
        size = max(size, at + align(tensor.bytes + SLACK))
    return offsets, size


def is_depthwise(layer: Layer) -> bool:
    return layer.kind == "convolution" and layer.groups > 1 and layer.groups == layer.weight.shape[0] == layer.inputs[0].channels and layer.pool == 1 and layer.requantise is not None


def is_depthwise_3x3(layer: Layer) -> bool:
    """True if depthwise_3x3.c computes the layer. Each core copies columns of the input to its buffer, so a row must fit into the buffer."""
    return is_depthwise(layer) and layer.kernel == (3, 3) and layer.dilations[1] == 1 and _turned_columns(layer) <= _MOST_TURNED_COLUMNS


_MOST_TURNED_COLUMNS = 200  # about 3 KiB in the buffer of each core
_STRIP_COLUMNS = 64  # about 1 KiB in the buffer of each core, if it contains several passes


def _turned_columns(layer: Layer) -> int:
    return layer.inputs[0].columns + layer.pads[1] + layer.pads[3]


def rows_per_pass(layer: Layer) -> int:
    """Returns the number of output rows that depthwise_3x3.c computes together, in a pass."""
    return 2 if layer.strides[0] == layer.dilations[0] == 1 else 1


def _most_passes(layer: Layer) -> int:
    """Returns the number of passes whose columns fit into a core's buffer, at least 1."""
    return max(1, min(_STRIP_COLUMNS // _turned_columns(layer), math.ceil(layer.output.rows / rows_per_pass(layer))))


def strip_passes(layer: Layer, rows: int, groups: int) -> int:
    """Returns the number of passes per unit of work with which a tile of ``rows`` rows and ``groups`` groups of channels takes the fewest cycles."""
    passes = math.ceil(rows / rows_per_pass(layer))
    return min(range(1, _most_passes(layer) + 1), key=lambda strip: (_strip_cycles(layer, passes, groups, strip), -strip))


def _strip_cycles(layer: Layer, passes: int, groups: int, strip: int) -> float:
    """Returns the estimated cycles of a tile, if a unit of work has ``strip`` passes."""
    filtered = (17 if rows_per_pass(layer) == 2 else 10) * layer.output.columns + 10
    each = 18 * layer.inputs[0].columns + 70 + GROUP * filtered
    units = groups * math.ceil(passes / strip)
    return math.ceil(units / CORES) * (min(strip, passes) * each + GROUP * 50 + 60)


def has_outer_rows(layer: Layer) -> bool:
    """True if the input in L1 includes the rows of the padding. Otherwise, the kernel provides the padding's values."""
    return not is_depthwise_3x3(layer)


def has_outer_columns(layer: Layer) -> bool:
    """True if the input in L1 includes the columns of the padding, for which each row is copied separately. Otherwise, the kernel provides
    the padding's values."""
    if is_depthwise_3x3(layer):
        return False
    most = max(layer.pads[1], layer.pads[3]) * layer.inputs[0].channels
    return not (gathers(layer) and _patch_runs(layer)[1] == 1 and most <= SLACK)


def columns_in_l1(layer: Layer) -> int:
    return layer.inputs[0].columns + (layer.pads[1] + layer.pads[3] if has_outer_columns(layer) else 0)


def fours(layer: Layer) -> int:
    """Returns the number of groups of four positions in the kernel of a depthwise convolution."""
    return math.ceil(math.prod(layer.kernel) / 4)


def pools_sums(layer: Layer) -> bool:
    """True if the layer requantises the maximum of 2 x 2 sums, which requires positive multipliers."""
    return is_in_blocks(layer) and layer.pool == 2 and layer.requantise is not None and bool((layer.requantise.multiplier > 0).all())


def core_bytes(layer: Layer) -> int:
    """Returns the bytes of each core's own buffer."""
    if is_depthwise_3x3(layer):  # a constant word, and a word of each channel and column
        return 4 + 4 * GROUP * _turned_columns(layer) * _most_passes(layer)
    if is_depthwise(layer):  # the offsets of the kernel's places
        return 16 * fours(layer)
    if is_dense(layer):  # four partial sums
        return 4 * GROUP
    return 4 * patch_copy_bytes(layer) + 8 if gathers(layer) else 0  # four patches; a copy may write past the end of its patch


def gathers(layer: Layer) -> bool:
    """True if the cores copy each patch (the input values under the kernel) to a buffer before they multiply. This is faster if the
    contiguous runs of a patch are short and many output channels share the copy, or if a row of the patch has several runs."""
    if not is_in_blocks(layer):
        return False
    rows, columns, run = _patch_runs(layer)
    runs, words = rows * columns, math.ceil(run / 4)
    if runs == 1:
        return False
    in_place = runs * (_CYCLES_PER_WORD * words + _CYCLES_PER_RUN)
    copied = 4 * runs * (2 * words if run <= 16 else 3 * words + 12)  # cycles to copy four patches
    gathered = _CYCLES_PER_WORD * math.ceil(patch_bytes(layer) / 4) + _CYCLES_PER_RUN
    return columns > 1 or gathered + copied / math.ceil(layer.weight.shape[0] / GROUP) < in_place


_CYCLES_PER_WORD = 24  # of the inner loop for four places and four channels
_CYCLES_PER_RUN = 9
_CYCLES_PER_DENSE_WORD = 9  # of the inner loop for one output position and four channels


def is_in_blocks(layer: Layer) -> bool:
    """True if the layer's kernel computes four output positions and four output channels at a time."""
    return layer.kind == "convolution" and layer.groups == 1


def is_dense(layer: Layer) -> bool:
    """True if dense.c computes the layer: it has a single output position, whose patch is contiguous. The cores share all products evenly."""
    one_place = layer.output.rows == layer.output.columns == layer.pool == 1
    return is_in_blocks(layer) and one_place and _patch_runs(layer)[:2] == (1, 1)


def _patch_runs(layer: Layer) -> tuple[int, int, int]:
    each = layer.weight.shape[1]
    rows, columns = layer.kernel
    if layer.groups > 1 or layer.dilations[1] > 1:
        return rows, columns, each
    if layer.dilations[0] == 1 and columns == layer.inputs[0].columns and not (layer.pads[1] or layer.pads[3]):
        return 1, 1, rows * columns * each
    return rows, 1, columns * each


def patch_bytes(layer: Layer) -> int:
    return math.prod(layer.weight.shape[1:])


def run_geometry(layer: Layer) -> tuple[int, int, int]:
    """Returns how many rows of contiguous runs a patch has, how many runs each row has, and the bytes of each run. A copied patch is one
    run."""
    return (1, 1, patch_bytes(layer)) if gathers(layer) else _patch_runs(layer)


def patch_copy_bytes(layer: Layer) -> int:
    """Returns the size of a copied patch in bytes. Its last run is copied in units of eight bytes."""
    last = _patch_runs(layer)[2]
    return align(patch_bytes(layer) + -last % 8)


def gather_geometry(layer: Layer) -> tuple[int, int, int]:
    """Returns the same numbers as run_geometry(), but for a patch in the input, before it is copied."""
    return _patch_runs(layer)


def group_bytes(layer: Layer) -> int:
    header = group_header(layer)
    if is_depthwise(layer):
        return header + GROUP * GROUP * fours(layer)
    runs_y, runs_x, run = run_geometry(layer)
    return header + GROUP * runs_y * runs_x * align(run)


def group_header(layer: Layer) -> int:
    return GROUP_HEADER + (16 if layer.requantise is not None and layer.requantise.scaling == "exact" else 0)


def _all_groups(layer: Layer) -> list[tuple[int, int, int]]:
    out = layer.weight.shape[0] // layer.groups
    each = layer.weight.shape[1]
    if is_depthwise(layer):
        return [(first, min(GROUP, layer.groups - first), first) for first in range(0, layer.groups, GROUP)]
    return [
        (group * out + first, min(GROUP, out - first), group * each) for group in range(layer.groups) for first in range(0, out, GROUP)
    ]


def _parts(layer: Layer, count: int) -> list[Part]:
    """Divides the output channels into ``count`` parts of nearly equal size."""
    if layer.kind == "convolution":
        groups = _all_groups(layer)
        size = math.ceil(len(groups) / count)
        pieces = [groups[i : i + size] for i in range(0, len(groups), size)]
        return [Part(one[0][0], sum(g[1] for g in one), one) for one in pieces]
    size = layer.output.channels // count
    return [Part(first, size, []) for first in range(0, layer.output.channels, size)]


def _counts(layer: Layer) -> list[int]:
    if is_depthwise(layer):  # equal parts, so that all have the same pitch
        groups = len(_all_groups(layer))
        return [one for one in range(1, groups + 1) if groups % one == 0 and (one == 1 or layer.groups % GROUP == 0)]
    if layer.kind == "convolution":
        groups = len(_all_groups(layer))
        return sorted({math.ceil(groups / size) for size in range(1, groups + 1)})
    if layer.kind in FLAT_KINDS:
        return [1]
    return [one for one in range(1, layer.output.channels + 1) if layer.output.channels % one == 0]


def data_bytes(layer: Layer, part: Part) -> int:
    """Returns the size in bytes of the weights or tables for one part of the output channels."""
    if layer.kind == "convolution":
        return len(part.groups) * group_bytes(layer)
    if layer.kind == "average_pool":
        return 12 * len(layer.requantisation.multiplier)
    return 256 if layer.kind == "table" else 0


def flat_rows(layer: Layer) -> int:
    return layer.output.size


def _is_tiled(layer: Layer) -> bool:
    return layer.kind in ROWS_KINDS or layer.kind in FLAT_KINDS


def _first_bytes(layer: Layer, parts: list[Part]) -> int:
    """Returns the bytes of L1 that the weights or tables of a part need. No part is larger than the first one."""
    data = data_bytes(layer, parts[0])
    return align(data + SLACK) if data else 0


def _least_bytes(layer: Layer) -> int:
    """Returns the bytes of L1 that a layer's smallest step needs."""
    return min(_layout(layer, _parts(layer, count), 1).l1_bytes for count in _counts(layer)) if _is_tiled(layer) else 0


def _steps(layer: Layer, available: int, board: str, spare: int, following: int) -> Steps | None:
    """Returns the division of the layer into steps that is estimated to take the fewest cycles. Returns None if this kind of layer is not
    divided.

    ``spare``: bytes of L1 that the previous layer leaves free if it uses its smallest steps. ``following``: bytes of the next layer's first data.
    """
    if not _is_tiled(layer):
        return None
    best: tuple[float, Steps] | None = None
    for count in _counts(layer):
        parts = _parts(layer, count)
        is_early = _first_bytes(layer, parts) <= spare
        choices = {*_row_choices(layer, parts, available), *_row_choices(layer, parts, available - following)}
        for rows in sorted(choices):
            steps = _layout(layer, parts, rows)
            cost = estimate(layer, steps, is_early, following if steps.l1_bytes + following <= available else 0)
            if best is None or cost < best[0]:
                best = (cost, steps)
    if best is None:
        raise InputError(
            f"layer {layer.name} ({layer.op}) does not fit into L1 of board {board}: its smallest step needs {_least_bytes(layer)} bytes, {available} are available. "
            "Use fewer channels, a smaller picture or a smaller kernel",
            "does_not_fit",
        )
    return best[1]


def _row_choices(layer: Layer, parts: list[Part], available: int) -> list[int]:
    """Returns the numbers of rows per tile to try: those with the fewest tiles that fit into L1, and with up to seven more tiles."""
    out_rows = flat_rows(layer) if layer.kind in FLAT_KINDS else layer.output.rows
    low, high = 0, out_rows
    while low < high:
        middle = (low + high + 1) // 2
        if _layout(layer, parts, middle).l1_bytes <= available:
            low = middle
        else:
            high = middle - 1
    if low == 0:
        return [out_rows] if _layout(layer, parts, out_rows).l1_bytes <= available else []
    tiles = math.ceil(out_rows / low)
    rows = {math.ceil(out_rows / (tiles + more)) for more in range(8) if tiles + more <= out_rows}
    if _layout(layer, parts, out_rows).l1_bytes <= available:  # one tile needs no second buffer
        rows.add(out_rows)
    return sorted(rows)


def _layout(layer: Layer, parts: list[Part], rows: int, is_data_last: bool = False) -> Steps:
    """Returns the steps for tiles of ``rows`` rows. The data of the first part are before all other buffers, or if ``is_data_last``, after them."""
    flat = layer.kind in FLAT_KINDS
    out_rows = flat_rows(layer) if flat else layer.output.rows
    tiles = math.ceil(out_rows / rows)
    sliced = len(parts) > 1 and (layer.kind in ("max_pool", "average_pool") or is_depthwise(layer))
    if flat:
        in_size, out_size = rows, rows
    else:
        channels = parts[0].channels if sliced else layer.inputs[0].channels
        in_rows = (rows * layer.pool - 1) * layer.strides[0] + layer.extent()[0]
        in_size = in_rows * columns_in_l1(layer) * channels
        out_rows_in_l1 = rows if not is_depthwise_3x3(layer) else math.ceil(rows / rows_per_pass(layer)) * rows_per_pass(layer)
        out_size = out_rows_in_l1 * layer.output.columns * max(one.channels for one in parts) * layer.output.element
    unpooled = out_size * layer.pool**2 if layer.pool > 1 and not pools_sums(layer) else 0
    data = data_bytes(layer, parts[0])  # no part is larger
    several = tiles > 1 or (sliced and len(parts) > 1)
    at = _first_bytes(layer, parts) if not is_data_last else 0
    first_data = 0

    def two(size: int, double: bool) -> tuple[int, int]:
        nonlocal at
        first = at
        at += align(size + SLACK)
        second = first
        if double:
            second = at
            at += align(size + SLACK)
        return first, second

    l1_in = two(in_size, several)
    l1_other = two(in_size, several) if layer.kind in ("add", "multiply") else l1_in
    second_data = two(data, False)[0] if len(parts) > 1 and data else None
    l1_out = two(out_size, tiles * len(parts) > 1)
    l1_unpooled = two(unpooled, False)[0] if unpooled else at
    l1_gathered = two(CORES * core_bytes(layer), False)[0] if core_bytes(layer) else at
    if is_data_last and data:
        first_data = two(data, False)[0]
    l1_data = first_data, first_data if second_data is None else second_data
    return Steps(rows, tiles, parts, sliced, _by_tile(layer, parts, tiles, sliced), l1_in, l1_other, l1_data, l1_out, l1_unpooled, l1_gathered, at)


def _by_tile(layer: Layer, parts: list[Part], tiles: int, sliced: bool) -> bool:
    """True if fetching all weights for each tile moves fewer bytes than fetching the whole input for each part. A tile is a number of rows
    of the output, and a part is a number of its channels. A layer with several of both must fetch its weights or its input repeatedly."""
    if sliced or len(parts) == 1 or tiles == 1:
        return False
    weights = sum(data_bytes(layer, one) for one in parts)
    return tiles * weights + layer.inputs[0].size < weights + len(parts) * layer.inputs[0].size


@dataclasses.dataclass(frozen=True)
class Traffic:
    """The bytes that the DMA moves for a layer."""

    fetched: int
    weights: int
    stored: int

    @property
    def total(self) -> int:
        return self.fetched + self.weights + self.stored


def _fetched_rows(layer: Layer, steps: Steps) -> int:
    """Returns the number of input rows that tiles need. If the stride is larger than the kernel, no tile needs the rows between two tiles."""
    stride = layer.strides[0]
    needed: set[int] = set()
    for begin in range(0, layer.output.rows, steps.tile_rows):
        rows = min(steps.tile_rows, layer.output.rows - begin) * layer.pool
        first = begin * layer.pool * stride - layer.pads[0]
        needed.update(range(max(first, 0), min(first + (rows - 1) * stride + layer.extent()[0], layer.inputs[0].rows)))
    return len(needed)


def traffic(layer: Layer, steps: Steps) -> Traffic:
    weights = sum(data_bytes(layer, one) for one in steps.parts)
    fetched = sum(one.bytes for one in layer.inputs)
    if layer.kind in ROWS_KINDS:
        fetched = fetched // layer.inputs[0].rows * _fetched_rows(layer, steps)
    if steps.by_tile:
        weights *= steps.tiles
    elif steps.tiles > 1 and not steps.sliced:
        fetched *= len(steps.parts)
    return Traffic(fetched, weights, layer.output.bytes)


def early_bytes(layer: Layer, steps: Steps) -> int:
    """Returns the bytes of this layer's weights or tables that the DMA fetches during the previous layer."""
    return data_bytes(layer, steps.parts[0]) if steps.early else 0


def estimate(layer: Layer, steps: Steps, is_early: bool, following: int) -> float:
    """Returns the estimated cycles of a layer: those of the cores or those of the DMA, whichever are more, plus those in which only one of
    them works.

    ``is_early``: the first data are fetched during the previous layer. ``following``: bytes of the next layer that are
    fetched during the last step.
    """
    count = steps.tiles * len(steps.parts)
    moved = traffic(layer, steps)
    in_rows = min(layer.inputs[0].rows, (steps.tile_rows * layer.pool - 1) * layer.strides[0] + layer.extent()[0])
    # The cycles in which one core starts the copies of a step.
    started = _CYCLES_PER_COPY * (2 + (in_rows if columns_in_l1(layer) > layer.inputs[0].columns else 1))
    weights = 0 if is_early else moved.weights / len(steps.parts)
    first = (moved.fetched / (count if steps.by_tile or steps.tiles > 1 else 1) + weights) / _BYTES_PER_CYCLE
    work = sum(_step_cycles(layer, steps, one) for one in steps.parts) * steps.tiles
    last = moved.stored / count / _BYTES_PER_CYCLE
    saved = min(following / _BYTES_PER_CYCLE, work / count)
    return max(work + count * started, moved.total / _BYTES_PER_CYCLE) + first + last + count * _CYCLES_PER_STEP - saved


_BYTES_PER_CYCLE = 7.0
_CYCLES_PER_COPY = 85
_CYCLES_PER_STEP = 250


def _block_cycles(layer: Layer) -> int:
    """Returns the estimated cycles of a block: four output positions and four output channels."""
    runs_y, runs_x, run = run_geometry(layer)
    return runs_y * runs_x * (_CYCLES_PER_WORD * math.ceil(run / 4) + _CYCLES_PER_RUN) + (80 if pools_sums(layer) else 130)


def _step_cycles(layer: Layer, steps: Steps, part: Part) -> float:
    """Returns the estimated cycles in which the cores compute one part of the output channels in one tile, including waits for other
    cores."""
    if layer.kind in FLAT_KINDS:
        return steps.tile_rows * 12 / CORES
    rows, columns = steps.tile_rows * layer.pool, layer.output.columns * layer.pool
    if layer.kind != "convolution":
        area = layer.kernel[0] * layer.kernel[1]
        return rows * columns * part.channels * area * 4 / CORES
    if is_depthwise_3x3(layer):
        passes, groups = math.ceil(rows / rows_per_pass(layer)), len(part.groups)
        return _strip_cycles(layer, passes, groups, strip_passes(layer, rows, groups))
    if is_depthwise(layer):
        return math.ceil(rows * len(part.groups) / CORES) * (columns * (32 * fours(layer) + 60) + 60)
    runs_y, runs_x, run = run_geometry(layer)
    words, groups = math.ceil(run / 4), len(part.groups)
    if is_dense(layer):
        return groups * (_CYCLES_PER_DENSE_WORD * words + 60) / CORES + 100
    if is_in_blocks(layer):
        blocks = math.ceil(rows * columns / 4)
        copied = 6 * patch_bytes(layer) if gathers(layer) else 0
        return math.ceil(blocks * groups / CORES) * _block_cycles(layer) + math.ceil(blocks / CORES) * (60 + copied)
    pair = runs_y * runs_x * (14 * words + 8) + 110
    return math.ceil(rows * groups / CORES) * (math.ceil(columns / 2) * pair + 60)
