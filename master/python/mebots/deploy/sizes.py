# SPDX-License-Identifier: Apache-2.0
"""Chooses input sizes other than the model's own, for which the deployment also determines accuracy and cost."""

from __future__ import annotations

import math
import pathlib

from mebots.deploy.deployed import Size
from mebots.deploy.graph import Tensor
from mebots.deploy.model_file import SizeFixed
from mebots.errors import InputError

_USUAL = (0.75, 0.5)  # fractions of rows and columns by default


def parse_sizes(text: str | None) -> tuple[Size, ...] | None:
    """Parses --sizes to (rows, columns). Returns None for the default sizes."""
    if text is None:
        return None
    if text == "none":
        return ()
    try:
        sizes = tuple((int(rows), int(columns)) for columns, rows in (one.split("x") for one in text.split(",")))
    except ValueError:
        sizes = ((0, 0),)
    if any(min(one) < 1 for one in sizes):
        raise InputError(f"--sizes is '{text}'; COLUMNSxROWS of one or more inputs is expected, such as 96x96,64x64, or none", "invalid_value")
    return sizes


def chosen(whole: Tensor, sizes: tuple[Size, ...] | None) -> tuple[Size, ...]:
    """Returns the further sizes, without the model's own size."""
    if len(whole.shape) != 3 or whole.rows * whole.columns == 1:
        if sizes:
            raise InputError(f"--sizes: the input {whole.name} has no rows and columns. Leave the option out", "invalid_value")
        return ()
    if sizes is None:
        sizes = tuple((max(1, math.floor(share * whole.rows)), max(1, math.floor(share * whole.columns))) for share in _USUAL)
    larger = next((one for one in sizes if one[0] > whole.rows or one[1] > whole.columns), None)
    if larger is not None:
        raise InputError(f"--sizes: {larger[1]} x {larger[0]} exceeds the network's input, {whole.columns} x {whole.rows}. Name smaller sizes", "invalid_value")
    return tuple(one for one in dict.fromkeys(sizes) if one != (whole.rows, whole.columns))


def reason(error: InputError, size: Size, model: pathlib.Path) -> str:
    """Returns the reason why the model cannot have this input size."""
    text = str(error).removeprefix(f"{model}: ").rstrip(".")
    why = f"with an input of {size[1]} x {size[0]}, {text}"
    if not isinstance(error, SizeFixed):  # the error has another cause
        return why
    return f"{why}. The size can change if the network ends in convolutions or in a global pool, without a dense layer over rows and columns"
