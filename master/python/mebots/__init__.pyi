# SPDX-License-Identifier: Apache-2.0
"""Drives MEbots missions from Python.

    import mebots
    mission = mebots.Mission("configs/gate_easy.json")
    mission.set("soc.core.clock", 150e6)      # [Hz]
    mission.run()
    print(mission.outcome, mission["battery.cell.voltage"].min(), mission.unit("battery.cell.voltage"))
"""

import os
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

__version__: str

class Error(RuntimeError):
    """A run went wrong. The text names instance, time, call and what the FMU said."""

class InputError(Error):
    """Something handed in cannot be used; the text says what and the way out."""

class Mission:
    """One mission in memory. Times are in seconds, values in the unit of their variable. Writes no files."""

    def __init__(self, config: str | os.PathLike[str]) -> None:
        """Reads and checks a config file. Raises InputError."""

    def on_message(self, listener: Callable[[str, str, str, float], None]) -> None:
        """Calls listener(instance, severity, text, time [s]) for what FMUs say; severity is info, warning or error.
        Before start()."""

    def set(self, variable: str, value: bool | int | float | str) -> None:
        """A parameter or start value for "instance.variable", instead of the config's. Before start()."""

    def set_stop_time(self, stop_time_s: float) -> None:
        """The end of the run [s], instead of the config's. Before start()."""

    def record(self, patterns: list[str]) -> None:
        """Records these variables (* and ? allowed) instead of the config's choice. Before start()."""

    def start(self) -> None:
        """Opens the FMUs and goes to t = 0. The calls below do it when it was not done."""

    def step(self) -> bool:
        """One communication step; False when the end was reached before."""

    def run(self) -> None:
        """Steps to the end. Ctrl-C interrupts."""

    def run_until(self, time_s: float) -> None:
        """Steps until `time_s`, or to the end when that comes first."""

    def value(self, variable: str) -> float:
        """The value now, in the variable's unit; Booleans as 0 and 1, enumerations as numbers."""

    def text(self, variable: str) -> str:
        """The text of a String variable now."""

    def write(self, variable: str, value: float) -> None:
        """Sets an input that nothing is connected to, or a tunable parameter, from now on."""

    def unit(self, variable: str) -> str:
        """The unit of a recorded variable; empty = none. Raises KeyError when it is not recorded."""

    def __getitem__(self, variable: str) -> npt.NDArray[np.float64]:
        """What was recorded of a variable so far, one value per entry of `times`. Raises KeyError."""

    @property
    def time(self) -> float:
        """The simulated time reached [s]."""
    @property
    def step_size(self) -> float:
        """The communication step [s]."""
    @property
    def stop_time(self) -> float:
        """The end of the run [s]."""
    @property
    def ended(self) -> bool: ...
    @property
    def outcome(self) -> str:
        """The config's outcome at the point reached last; "completed" when none of its conditions hold."""
    @property
    def end_text(self) -> str:
        """One sentence on why the run ended; empty before."""
    @property
    def times(self) -> npt.NDArray[np.float64]:
        """The times of the recorded points [s]."""
    @property
    def variables(self) -> list[str]:
        """The names of the recorded variables."""
