# SPDX-License-Identifier: Apache-2.0
"""Writes the tables for programs: tables.h5, and missions.parquet and designs.parquet if pyarrow is installed. The CSV files have the same
content and are authoritative."""

from __future__ import annotations

import contextlib
import importlib.util
import pathlib
import re
from collections.abc import Sequence
from typing import Any

from mebots import _mebots
from mebots.exploration.files import count_lines, replace_with

NAMES = ("tables.h5", "missions.parquet", "designs.parquet")
_TABLES = ("missions", "designs")
_UNIT = re.compile(r" \[([^]]+)\]")


MOST_ROWS = 250_000
"""A table with more rows is written as CSV only, because the other formats are built in memory."""


def write(folder: pathlib.Path) -> None:
    """Writes the tables as HDF5, and as Parquet if pyarrow is installed, into the folder of the CSV files. Skips large tables."""
    tables = {name: read(folder / f"{name}.csv") for name in _TABLES if _is_small(folder / f"{name}.csv")}
    if tables:
        _write_hdf5(folder / "tables.h5", tables)
    for name, table in tables.items() if importlib.util.find_spec("pyarrow") else ():
        _write_parquet(folder / f"{name}.parquet", table)


def _is_small(file: pathlib.Path) -> bool:
    return file.exists() and count_lines(file) <= MOST_ROWS + 1


def read(file: pathlib.Path) -> dict[str, list[Any]]:
    """Returns the columns of a table by title. A column contains integers, numbers (NaN for missing values), or texts."""
    titles, *rows = _mebots.read_csv(file)
    columns = list(zip(*rows, strict=True)) or [() for _ in titles]
    return {title: _typed(column) for title, column in zip(titles, columns, strict=True)}


def _typed(cells: Sequence[str]) -> list[Any]:
    if not any(cells):
        return list(cells)
    with contextlib.suppress(ValueError):
        whole = list(map(int, cells))
        if max(whole) < 1 << 63 and min(whole) > -(1 << 63):
            return whole
    with contextlib.suppress(ValueError):
        return list(map(float, cells if "" not in cells else [cell or "nan" for cell in cells]))
    return list(cells)


def _write_hdf5(file: pathlib.Path, tables: dict[str, dict[str, list[Any]]]) -> None:
    content = [_mebots.Table(name, _columns(table)) for name, table in tables.items()]
    replace_with(file, lambda unfinished: _mebots.write_hdf5(content, unfinished))


def _columns(table: dict[str, list[Any]]) -> list[_mebots.TableColumn]:
    columns = []
    for title, values in table.items():
        unit = _UNIT.search(title)
        columns.append(_mebots.TableColumn(_UNIT.sub("", title), unit[1] if unit else "", values))
    return columns


def _write_parquet(file: pathlib.Path, table: dict[str, list[Any]]) -> None:
    import pyarrow
    import pyarrow.parquet

    replace_with(file, lambda unfinished: pyarrow.parquet.write_table(pyarrow.table(table), unfinished))
