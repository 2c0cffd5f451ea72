# SPDX-License-Identifier: Apache-2.0
"""Reads the labels of pictures from a CSV file with the column ``picture``, and a column per output or the column ``class``."""

from __future__ import annotations

import csv
import dataclasses
import math
import pathlib

import numpy as np

from mebots.deploy.pictures import Pictures
from mebots.errors import InputError

CLASS = "class"
_PICTURE = "picture"


@dataclasses.dataclass(frozen=True)
class Labels:
    """Labels of pictures. ``numbers`` are the numbers of the labelled pictures; each of ``columns`` contains labels in the same order."""

    path: pathlib.Path
    numbers: list[int]
    columns: dict[str, np.ndarray]


def read_labels(path: pathlib.Path, pictures: Pictures, sizes: dict[str, int]) -> Labels:
    """Reads labels. ``sizes`` contains the number of values of each output."""
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"--labels {path}: cannot be read: {error}", "invalid_data") from error
    header = [one.strip() for one in rows[0]] if rows else []
    names = header[1:]
    if header[:1] != [_PICTURE] or not names or len(set(names)) != len(names):
        raise InputError(f"--labels {path}:1: the columns are {', '.join(header) or 'none'}; expected are {_PICTURE}, then {CLASS} or names of outputs", "invalid_data")
    _check_columns(path, names, sizes)
    places = pictures.places()
    found: dict[int, list[float]] = {}
    for line, row in enumerate(rows[1:], 2):
        if not row:
            continue
        where = f"--labels {path}:{line}"
        if len(row) != len(header):
            raise InputError(f"{where}: has {len(row)} values, the header {len(header)}", "invalid_data")
        number = places.get(row[0].strip())
        if number is None:
            raise InputError(f"{where}: {pictures.path} has no picture '{row[0]}'. Name {pictures.naming()}", "invalid_data")
        if number in found:
            raise InputError(f"{where}: picture '{row[0]}' has two rows; remove one", "invalid_data")
        found[number] = [_value(where, name, text, sizes) for name, text in zip(names, row[1:], strict=True)]
    if not found:
        raise InputError(f"--labels {path}: has no rows after the header", "invalid_data")
    numbers = sorted(found)
    table = np.array([found[one] for one in numbers])
    return Labels(path, numbers, dict(zip(names, table.T, strict=True)))


def _check_columns(path: pathlib.Path, names: list[str], sizes: dict[str, int]) -> None:
    has = ", ".join(f"{name} ({size} value{'s' if size > 1 else ''})" for name, size in sizes.items())
    for name in names:
        fits = len(sizes) == 1 and min(sizes.values()) > 1 if name == CLASS else sizes.get(name) == 1
        if not fits:
            need = "one output with a value per class" if name == CLASS else "an output of this name with one value"
            raise InputError(f"--labels {path}:1: column {name} needs {need}; the network's outputs are {has}", "invalid_data")


def _value(where: str, name: str, text: str, sizes: dict[str, int]) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{where}: {name} is '{text}'; a finite number is expected", "invalid_data")
    if name == CLASS and (value != int(value) or not 0 <= value < min(sizes.values())):
        raise InputError(f"{where}: {CLASS} is {text}; a whole number from 0 to {min(sizes.values()) - 1} is expected", "invalid_data")
    return value
