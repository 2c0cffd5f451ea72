# SPDX-License-Identifier: Apache-2.0
"""Writes the page of a deployed network, which draws network.json (web/src/network)."""

from __future__ import annotations

import os
import pathlib
from typing import Any

from mebots.deploy import chip
from mebots.deploy.deployed import Options
from mebots.deploy.report import shown
from mebots.errors import InputError
from mebots.page import write_page


def check_place(file: str | os.PathLike[str], out: str | os.PathLike[str]) -> None:
    """Raises InputError if the page cannot be written, or if it would be in the network's folder, whose files are all part of a mission's
    hash."""
    page = pathlib.Path(file).absolute()
    if page.is_dir():
        raise InputError(f"--page {file}: this is a folder; name a file", "invalid_value")
    if page.is_relative_to(pathlib.Path(out).absolute()):
        raise InputError(f"--page {file}: a page in the network's folder would change the hash of missions; choose a place outside of {out}", "invalid_value")
    if not page.parent.is_dir():
        raise InputError(f"--page {file}: the folder {page.parent} does not exist", "not_found")


def write_network_page(file: str | os.PathLike[str], model: str | os.PathLike[str], options: Options, content: dict[str, Any]) -> None:
    board = chip.board(options.board)
    name = pathlib.Path(model).stem
    data = {
        "kind": "network",
        "network": {key: value for key, value in content.items() if key not in ("files", "vectors")},
        "board": {"name": board.name, "cores": board.cores, "l1": board.l1, "l2": board.l2},
    }
    provenance = {
        "model": f"{content['model']['file']}, opset {content['model']['opset']}",
        "SHA-256 of the model": content["model"]["sha256"],
        "board": board.name,
        "calibration": _calibration(content),
        "format of network.json": str(content["format"]),
    }
    write_page(pathlib.Path(file), f"Network {name} on board {board.name}", data, provenance, shown(content))


def _calibration(content: dict[str, Any]) -> str:
    pictures, percentile = content["calibration"]["pictures"], content["calibration"]["percentile"]
    ranges = "least and greatest values" if percentile is None else f"{percentile:g} % of the values"
    return f"{pictures} pictures, {ranges}"
