# SPDX-License-Identifier: Apache-2.0
"""Starts the programs in a wheel, which are in the package's folder."""

import os
import pathlib
import sys


def _become(name: str) -> None:
    program = pathlib.Path(__file__).with_name("bin") / name
    # Programs written in Python use the interpreter of this environment, even if it is not activated.
    os.environ.setdefault("MEBOTS_PYTHON", sys.executable)
    try:
        os.execv(program, [name, *sys.argv[1:]])
    except OSError as error:
        sys.exit(f"{name}: error: {program} cannot be started: {error.strerror}. Install MEbots again: pip install --force-reinstall mebots")


def mebots() -> None:
    _become("mebots")


def mebots_boardgen() -> None:
    _become("mebots-boardgen")


def mebots_modeldesc() -> None:
    _become("mebots-modeldesc")


def mebots_soc() -> None:
    _become("mebots-soc")
