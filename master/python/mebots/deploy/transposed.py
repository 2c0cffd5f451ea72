# SPDX-License-Identifier: Apache-2.0
"""Converts transposed convolutions: inserts zeros between the input's values according to the strides, and convolves with the reversed
kernel."""

from __future__ import annotations

import numpy as np

from mebots.deploy import moving
from mebots.deploy.context import MOST_ELEMENTS, Importer
from mebots.deploy.graph import Node, Tensor
from mebots.deploy.model_file import label


def conv_transpose(owner: Importer) -> None:
    source, weight = owner.input(), owner.needed(1)
    if weight.ndim == 3:
        weight = weight[:, :, np.newaxis, :]
    if weight.ndim != 4 or "output_shape" in owner.attributes or owner.attribute("auto_pad", b"NOTSET") != b"NOTSET":
        raise owner.refuse("it has more than two dimensions, output_shape or auto_pad", "Export it with pads and output_padding")
    groups = int(owner.attribute("group", 1))
    one_row = len(source.shape) == 2

    def two(name: str, default: int) -> tuple[int, int]:
        given = [int(one) for one in owner.attribute(name, [default] * (1 if one_row else 2))]
        return (default, given[0]) if len(given) == 1 else (given[0], given[1])

    strides, dilations, extra = two("strides", 1), two("dilations", 1), two("output_padding", 0)
    given = [int(one) for one in owner.attribute("pads", [0] * (2 if one_row else 4))]
    begin, end = ((0, given[0]), (0, given[1])) if len(given) == 2 else (tuple(given[:2]), tuple(given[2:]))
    reach = [(k - 1) * d for k, d in zip(weight.shape[2:], dilations, strict=True)]
    top, left = (r - b for r, b in zip(reach, begin, strict=True))
    bottom, right = (r - e + x for r, e, x in zip(reach, end, extra, strict=True))
    if min(top, left, bottom, right) < 0:
        raise owner.refuse(f"its pads {given} exceed its kernel", "Use Slice after a ConvTranspose with fewer pads")
    each = weight.shape[0] // groups
    out = weight.shape[1]
    # Transposes each group's weights from (in, out / groups) to (out, in / groups), and reverses the kernel.
    turned = weight.reshape(groups, each, out, *weight.shape[2:]).transpose(0, 2, 1, 3, 4)[..., ::-1, ::-1]
    bias = owner.constant(2)
    owner.add(
        "conv",
        [_spread(owner, source, strides)],
        weight=turned.reshape(groups * out, each, *weight.shape[2:]).astype(np.float64),
        bias=np.zeros(groups * out) if bias is None else bias.astype(np.float64),
        groups=groups,
        kernel=(weight.shape[2], weight.shape[3]),
        pads=(top, left, bottom, right),
        dilations=dilations,
    )


def _spread(owner: Importer, source: Tensor, strides: tuple[int, int]) -> Tensor:
    """Adds a node that inserts zeros between a tensor's values."""
    if strides == (1, 1):
        return source
    rows, columns = ((size - 1) * step + 1 for size, step in zip((source.rows, source.columns), strides, strict=True))
    if source.channels * rows * columns > MOST_ELEMENTS:
        raise owner.refuse(f"its strides {list(strides)} spread the input to {rows} x {columns} places", "Use smaller strides")
    spread = Tensor(f"{source.name} spread for {label(owner.node)}", (source.channels, rows, columns))
    memory, out = np.empty(source.size, dtype=np.uint8), np.empty(spread.size, dtype=np.uint8)
    view = memory.reshape(source.stored())
    out_view = out.reshape(spread.stored())[:: strides[0], :: strides[1]]
    one = moving.move(0, memory, view, out, out_view)
    owner.insert(Node("move", f"{label(owner.node)} spread", "ConvTranspose", [source], spread, moves=[one], fill=0.0))
    return spread
