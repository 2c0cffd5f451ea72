# SPDX-License-Identifier: Apache-2.0
"""Packages of the extras ``mebots[sweep]``, ``mebots[flight]``, ``mebots[deploy]`` and ``mebots[gym]``, which are
imported where they are needed."""

from __future__ import annotations

import importlib
from typing import Any

from mebots.errors import InputError


def extra(module: str, what: str, package: str, group: str = "sweep") -> Any:
    """Returns a module of an extra. Raises InputError with the line that installs it."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise InputError(f"{what} needs {package}: pip install 'mebots[{group}]', or pip install {package}", "not_offered") from error
