# SPDX-License-Identifier: Apache-2.0
"""The tables for programs: tables.h5, and missions.parquet and designs.parquet where pyarrow is installed. They are made of
the CSV files, which are what counts."""

from __future__ import annotations

import importlib.util
import pathlib
import re
from collections.abc import Sequence
from typing import Any

from mebots import _mebots

NAMES = ("tables.h5", "missions.parquet", "designs.parquet")
_TABLES = ("missions", "designs")
_UNIT = re.compile(r" \[([^]]+)\]")


def write(folder: pathlib.Path) -> None:
    """Beside the CSV files of this folder."""
    tables = {name: read(folder / f"{name}.csv") for name in _TABLES if (folder / f"{name}.csv").exists()}
    if tables:
        _write_hdf5(folder / "tables.h5", tables)
    for name, table in tables.items() if importlib.util.find_spec("pyarrow") else ():
        _write_parquet(folder / f"{name}.parquet", table)


def read(file: pathlib.Path) -> dict[str, list[Any]]:
    """Columns by their titles: whole numbers, numbers with NaN for what is not there, or texts."""
    titles, *rows = _mebots.read_csv(file)
    columns = list(zip(*rows, strict=True)) or [() for _ in titles]
    return {title: _typed(column) for title, column in zip(titles, columns, strict=True)}


def _typed(cells: Sequence[str]) -> list[Any]:
    for kind in (int, lambda cell: float(cell) if cell else float("nan")):
        try:
            values = [kind(cell) for cell in cells]
        except ValueError:
            continue
        if any(cells) and not (kind is int and any(abs(value) >= 1 << 63 for value in values)):
            return values
    return list(cells)


def _write_hdf5(file: pathlib.Path, tables: dict[str, dict[str, list[Any]]]) -> None:
    beside = file.with_name(file.name + ".part")
    _mebots.write_hdf5([_mebots.Table(name, _columns(table)) for name, table in tables.items()], beside)
    beside.replace(file)


def _columns(table: dict[str, list[Any]]) -> list[_mebots.TableColumn]:
    columns = []
    for title, values in table.items():
        unit = _UNIT.search(title)
        columns.append(_mebots.TableColumn(_UNIT.sub("", title), unit[1] if unit else "", values))
    return columns


def _write_parquet(file: pathlib.Path, table: dict[str, list[Any]]) -> None:
    import pyarrow
    import pyarrow.parquet

    beside = file.with_name(file.name + ".part")
    pyarrow.parquet.write_table(pyarrow.table(table), beside)
    beside.replace(file)
