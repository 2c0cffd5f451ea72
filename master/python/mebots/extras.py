# SPDX-License-Identifier: Apache-2.0
"""Imports packages of the extras ``mebots[sweep]``, ``mebots[flight]``, ``mebots[deploy]`` and ``mebots[gym]`` when they are used."""

from __future__ import annotations

import importlib
from typing import Any

from mebots.errors import InputError


def extra(module: str, what: str, package: str, group: str = "sweep") -> Any:
    """Imports a module of an extra. If it is missing, raises InputError with the command that installs it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise InputError(f"{what} needs {package}: pip install 'mebots[{group}]', or pip install {package}", "not_offered") from error
