# SPDX-License-Identifier: Apache-2.0
"""Runs systems of FMUs from Python, and reads their results.

    import mebots

    with mebots.Mission("configs/gate_easy.json", set={"soc.core.clock": 150e6}) as mission:
        mission.run()
        print(mission.outcome, mission["battery.cell.voltage"].min(), mission.unit("battery.cell.voltage"))

    replayed = mebots.replay("log00", "configs/airframes/crazyflie_21.json")  # a recorded flight on the models
    mebots.sweep("study.json", "results/study")  # as `mebots sweep` does
    mebots.sweep({"mission": "configs/hover.json", ...}).to_pandas()

    results = mebots.read("results/gate_easy")
    print(results.summary["outcome"], results["world.drone.speed"].max())

``mebots.configs`` is the folder of the shipped missions, ``mebots.gym`` has environments of Gymnasium, and
``mebots.testing`` runs firmware in tests.
"""

from typing import TYPE_CHECKING

from mebots._mebots import __version__
from mebots.errors import Error, InputError
from mebots.mission import Mission
from mebots.notebook import show
from mebots.results import Results, read
from mebots.system import System

if TYPE_CHECKING:
    import pathlib

    from mebots import gym, testing
    from mebots.exploration.command import sweep
    from mebots.flight.identify import identify
    from mebots.flight.new_cell import new_cell
    from mebots.flight.replay import replay

    configs: pathlib.Path

_FLIGHT = ("identify", "new_cell", "replay")
_MODULES = ("gym", "testing")  # imported on first use: gym needs a package of an extra

__all__ = ["Error", "InputError", "Mission", "Results", "System", "configs", "identify", "new_cell", "read", "replay", "show", "sweep", "__version__"]


def __dir__() -> list[str]:
    return sorted({*__all__, *_MODULES, "__all__", "__doc__", "__file__", "__name__", "__path__"})


def __getattr__(name: str):
    if name == "sweep":  # a single mission does not need its modules
        from mebots.exploration.command import sweep

        return sweep
    if name == "configs":
        from mebots.installation import data_folder

        return data_folder() / "configs"
    import importlib

    if name in _FLIGHT:
        return getattr(importlib.import_module(f"mebots.flight.{name}"), name)
    if name in _MODULES:
        try:
            return importlib.import_module(f"mebots.{name}")
        except InputError as error:
            raise AttributeError(str(error)) from error  # makes help(mebots) and hasattr() work without the extra
    raise AttributeError(f"module 'mebots' has no attribute '{name}'")
