# SPDX-License-Identifier: Apache-2.0
"""Reads flight logs of all supported formats."""

from __future__ import annotations

import json
import os
import pathlib
from typing import Any

from mebots import _mebots
from mebots.errors import InputError
from mebots.flight.log import FlightLog
from mebots.flight.names import Meaning
from mebots.flight.tables import read_table
from mebots.flight.ulog import MAGIC as ULOG_MAGIC
from mebots.flight.ulog import read_ulog
from mebots.flight.usd import MAGIC as USD_MAGIC
from mebots.flight.usd import read_usd


def read_log(file: str | os.PathLike[str], mapping: str | os.PathLike[str] | None = None) -> FlightLog:
    """Reads a Crazyflie's uSD log, PX4's ULog, or CSV. Recognises the kind by its content.

    :param mapping: file (.json) that maps columns to signals. Required for CSV; optional for other logs.
    """
    path = pathlib.Path(file)
    given = {} if mapping is None else json.loads(_mebots.read_log_mapping(pathlib.Path(mapping)))
    meanings = _meanings(given)
    start = _start(path)
    if start.startswith(ULOG_MAGIC[:4]):
        return read_ulog(path, meanings)
    if start[:1] == bytes([USD_MAGIC]):
        return read_usd(path, meanings)
    if not start:
        raise InputError(f"{path}: the file is empty", "syntax_error")
    if b"\0" in start:
        raise InputError(
            f"{path}: byte 0: this is not a flight log: a Crazyflie's log starts with 0xBC, a ULog with 'ULog', and CSV is text",
            "syntax_error",
        )
    if "time" not in given:
        raise InputError(
            f"{path}: a CSV table needs --mapping with 'time' and 'columns', which define the columns; "
            "`mebots schema log-mapping` prints its keys",
            "missing_key",
        )
    return read_table(path, given, meanings)


def _start(path: pathlib.Path) -> bytes:
    try:
        with path.open("rb") as stream:
            return stream.read(4096)
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file", "file_not_found") from None
    except OSError as error:
        raise InputError(f"{path}: the file cannot be read: {error.strerror}", "file_not_found") from None


def _meanings(mapping: dict[str, Any]) -> dict[str, Meaning]:
    return {
        column: Meaning(one["signal"], one["unit"], one.get("scale", 1.0)) for column, one in mapping.get("columns", {}).items()
    }
