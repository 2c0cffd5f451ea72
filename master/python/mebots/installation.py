# SPDX-License-Identifier: Apache-2.0
"""Finds the files that are installed together with MEbots."""

import pathlib

from mebots.errors import InputError


def data_folder() -> pathlib.Path:
    """Returns the folder of this installation that contains configs and fmu_soc."""
    here = pathlib.Path(__file__).resolve().parent
    for place in (here / "share/mebots", here.parents[1], here.parents[3] / "share/mebots"):
        if (place / "configs/boards").is_dir():
            return (place / "configs").resolve().parent
    raise InputError(f"the boards of MEbots are at none of the places that belong to {here}. Install MEbots again", "not_offered")
