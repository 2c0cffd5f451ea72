# SPDX-License-Identifier: Apache-2.0
"""Drives MEbots missions from Python. The types and texts of everything here are in __init__.pyi."""

from ._mebots import Error, InputError, Mission, __version__

__all__ = ["Error", "InputError", "Mission", "__version__"]
