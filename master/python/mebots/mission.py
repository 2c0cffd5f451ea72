# SPDX-License-Identifier: Apache-2.0
"""The class Mission."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from mebots import _mebots, frames
from mebots.errors import InputError

if TYPE_CHECKING:  # `mebots sweep` does not need NumPy
    import numpy as np
    import numpy.typing as npt

Path = str | os.PathLike[str]
Scalar = bool | int | float | str


class Mission:
    """A run of an FMU, or of a system of FMUs. The results are those of ``mebots run``.

    Times are in seconds. Values are in the unit of their variable. Methods raise ``InputError`` for errors that the caller can correct,
    and ``Error`` if the run fails. A failed mission has the state "failed" and cannot step.

    If the mission is used as a context manager, it is closed at the end of the block, even after an exception. Use a mission from one
    thread at a time; several missions may run on several threads, because stepping releases the interpreter's lock.

    :param config: config (.json), FMU (.fmu) or SSP (.ssp), or the content of a config as a dict, whose paths are relative
        to the working folder. If the mission is a single FMU, names of variables need no instance.
    :param set: values for parameters and start values, by "instance.variable" (* and ? allowed), in place of the config's.
    :param record: names of variables to record (* and ? allowed), in place of the config's choice.
    :param scenarios: files with overrides, after those of the config.
    :param inputs: CSV files whose columns are signals for the unconnected inputs of the same names.
    :param stop_time: end of the run [s], in place of the config's.
    :param step: communication step [s], for a single FMU or an SSP that defines none. A ratio is a text such as "1/60" or a
        ``Fraction``, or the nearest number.
    :param out: folder for results.csv, summary.json and log.txt; None = no files.
    :param in_memory: whether recorded rows are kept for ``times`` and ``mission[variable]``.
    :param isolate: every instance in a separate process.
    :param statistics: measure calls and wall time of every instance, for the summary.
    :param checkpoint_every: simulated time [s] between checkpoints in ``out``; None = no checkpoints.
    :param uncertainty: "calibration" or "none", in place of the config's: whether ``run()`` adds 19 runs with drawn
        parameters, and intervals in the summary.
    """

    def __init__(
        self,
        config: Path | Mapping[str, Any],
        *,
        set: Mapping[str, Scalar] | None = None,
        record: Iterable[str] | None = None,
        scenarios: Iterable[Path] = (),
        inputs: Iterable[Path] = (),
        stop_time: float | None = None,
        step: float | str | Fraction | None = None,
        out: Path | None = None,
        in_memory: bool = True,
        isolate: bool = False,
        statistics: bool = False,
        checkpoint_every: float | None = None,
        uncertainty: str | None = None,
    ) -> None:
        if isinstance(scenarios, (str, os.PathLike)):
            scenarios = [scenarios]
        if isinstance(inputs, (str, os.PathLike)):
            inputs = [inputs]
        if uncertainty not in (None, "calibration", "none"):
            raise InputError(f"uncertainty={uncertainty!r}: 'calibration' or 'none' is expected", "invalid_value")
        file = _file_of(config, self) if isinstance(config, Mapping) else config
        self._run = _mebots.Mission(
            file,
            out,
            in_memory,
            list(scenarios),
            list(inputs),
            stop_time,
            None if step is None else float(Fraction(step)),
            isolate,
            statistics,
            checkpoint_every,
            None if uncertainty is None else uncertainty == "calibration",
        )
        if set is not None and not isinstance(set, Mapping):
            raise TypeError(f"set must be a dict of variables and their values, not {set!r}")
        for variable, value in (set or {}).items():
            self.set(variable, value)
        if record is not None:
            self.record(record)

    @classmethod
    def resume(cls, folder: Path, *, in_memory: bool = True) -> Mission:
        """Returns a mission that resumes from the last checkpoint in a results folder. The results have the same bits as without
        interruption. Also loads earlier rows into memory."""
        mission = cls.__new__(cls)
        mission._run = _mebots.Mission.resume(folder, in_memory)
        return mission

    def __enter__(self) -> Mission:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<mebots.Mission {self.state} at {self.time:g} of {self.stop_time:g} s>"

    # Before start().

    def on_message(self, listener: Callable[[str, str, str, float], None]) -> None:
        """Calls listener(instance, severity, text, time [s]) for messages of FMUs and of the run (instance ""). severity is "info",
        "warning" or "error". The listener runs during calls to FMUs, so interrupt() is the only method that it may call. Must be called
        before start()."""
        self._run.on_message(listener)

    def on_point(self, listener: Callable[[float], None]) -> None:
        """Calls listener(time [s]) at every communication point, including the start. The listener may read variables, and write them
        except at the start. Must be called before start()."""
        self._run.on_point(listener)

    def set(self, variable: str, value: Scalar) -> None:
        """Sets the parameter or start value "instance.variable", or all that match a pattern (* and ?), in place of the config's. Checks
        name, type and limits immediately. Settings may come in any order: if structural parameters (FMI 3.0) determine the size of an
        array, start() checks whether the element exists. Must be called before start()."""
        self._run.set(variable, value)

    def add_scenario(self, file: Path) -> None:
        """Appends the overrides of a file to those of the config. Must be called before start()."""
        self._run.add_scenario(file)

    def add_inputs(self, file: Path) -> None:
        """Connects the columns of a CSV file to the unconnected inputs with the same names. Must be called before start()."""
        self._run.add_inputs(file)

    def set_stop_time(self, stop_time_s: float) -> None:
        """Sets the end of the run [s], in place of the config's. Must be called before start()."""
        self._run.set_stop_time(stop_time_s)

    def record(self, patterns: Iterable[str]) -> None:
        """Sets the variables to record (* and ? allowed) in place of the config's choice. Must be called before start()."""
        if isinstance(patterns, str):
            patterns = [patterns]
        self._run.record(list(patterns))

    def load(self) -> None:
        """Unpacks and loads the FMUs without instances. Afterwards, a fork of the process (``os.fork``) can start the mission. Must be
        called before start()."""
        self._run.load()

    def start_from(self, state: bytes) -> None:
        """Starts from a state of ``save_state``, which may come from another process. The results have the same bits as without
        interruption. Config, FMUs, settings and recorded variables must be the same. Only for missions without ``out``. Must be called
        before start()."""
        self._run.start_from(state)

    # Running.

    def start(self) -> None:
        """Opens the FMUs, makes all checks, and initialises the run at its start or at the checkpoint. The methods below call start() if
        necessary."""
        self._run.start()

    def step(self) -> bool:
        """Performs one communication step. Returns False if the end was already reached."""
        return self._run.step()

    def run(self) -> None:
        """Runs to the end. Ctrl-C ends the run between two calls to FMUs, writes its reports and raises KeyboardInterrupt.

        If the config or ``uncertainty`` requests "calibration", also runs 19 missions with drawn parameters, without messages and
        listeners. ``summary["uncertainty"]`` contains their intervals. After ``write()`` or ``start_from()``, skips these missions, and
        ``summary["uncertainty"]["skipped"]`` contains the reason."""
        self._run.run()

    def run_until(self, time_s: float) -> None:
        """Steps until ``time_s`` or the end of the run."""
        self._run.run_until(time_s)

    def run_through(self, time_s: float) -> None:
        """Steps like ``run_until``, but SIGINT and SIGTERM take effect only after the return, so that they do not change results."""
        self._run.run_through(time_s)

    def close(self) -> None:
        """Ends the run at the current point and writes its reports. No effect if the run has ended. If a listener calls close(), it acts as
        interrupt()."""
        self._run.close()

    def save_state(self) -> bytes:
        """Returns the state between two steps for ``start_from``. Several missions can continue from it. All FMUs must be able to serialize
        their state. Only for missions without ``out``, and not after the end."""
        return self._run.save_state()

    def reset(self) -> None:
        """Closes the mission and restores its state after the constructor. Drops ``set``, ``record`` and listeners. Clean FMUs stay loaded;
        others are loaded again. The next run has the same bits as ``mebots run``. If this is not possible in this process, start() raises
        an error that names the FMU."""
        self._run.reset()

    def free_instances(self) -> list[tuple[str, bool]]:
        """Closes the mission and frees its instances. Returns the FMUs that are not clean because they left data that could change a later
        mission, and whether they ran in this process. Afterwards, variables cannot be read before reset()."""
        return self._run.free_instances()

    def interrupt(self) -> None:
        """Requests the end of the run with the outcome "interrupted". Takes effect between two calls to FMUs. Thread-safe."""
        self._run.interrupt()

    # Variables.

    def value(self, variable: str) -> float:
        """Returns the current value in the variable's unit. Booleans are 0 and 1, enumerations are numbers."""
        return self._run.value(variable)

    def text(self, variable: str) -> str:
        """Returns the current text of a String."""
        return self._run.text(variable)

    def write(self, variable: str, value: float) -> None:
        """Sets an unconnected input or a tunable parameter."""
        self._run.write(variable, value)

    # Recorded values.

    def __getitem__(self, variable: str) -> npt.NDArray[np.float64]:
        """Returns the recorded values of a variable, one per entry of ``times``. Raises KeyError."""
        return _array(self._series(variable)[1])

    def unit(self, variable: str) -> str:
        """Returns the unit of a recorded variable; "" if it has none. Raises KeyError if it is not recorded."""
        return self._series(variable)[0]

    def _series(self, variable: str) -> tuple[str, bytes]:
        if variable not in self.variables:
            from mebots.results import not_recorded

            raise not_recorded(variable, self.variables)
        return self._run.series(variable)

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """Returns the times of the recorded points [s]."""
        return _array(self._run.times if self.state != "open" else b"")

    @property
    def variables(self) -> list[str]:
        """Returns the names of the recorded variables."""
        return self._run.variables if self.state != "open" else []

    def to_pandas(self):
        """Returns the recorded values as a pandas.DataFrame with the times as index. Needs pandas."""
        return frames.pandas_frame(self._columns(), self.times)

    def to_polars(self):
        """Returns the recorded values as a polars.DataFrame whose first column is the times. Needs polars."""
        return frames.polars_frame(self._columns(), self.times)

    def to_xarray(self):
        """Returns the recorded values as an xarray.Dataset over the times, with units. Needs xarray."""
        return frames.time_series(self._columns(), {name: self.unit(name) for name in self.variables}, self.times)

    def _columns(self) -> dict[str, npt.NDArray[np.float64]]:
        return {name: self[name] for name in self.variables}

    # Properties of the run.

    @property
    def time(self) -> float:
        """The simulated time that the run has reached [s]."""
        return self._run.time

    @property
    def step_size(self) -> float:
        """The communication step [s]."""
        return self._run.step_size

    @property
    def stop_time(self) -> float:
        """The end of the run [s]."""
        return self._run.stop_time

    @property
    def state(self) -> str:
        """The state: "open", "ready" (at t = 0), "running", "ended" or "failed"."""
        return self._run.state

    @property
    def ended(self) -> bool:
        """True if the run has ended or failed."""
        return self._run.ended

    @property
    def outcome(self) -> str:
        """The config's outcome at the last point, or "completed" if no condition is true. After an interrupt, a close or a failure:
        "interrupted", "closed" or "failed". "" before the start."""
        return self._run.outcome

    @property
    def end_reason(self) -> str | None:
        """Why the run ended: "stop_time", "stop_condition", "terminated", "interrupted", "closed" or "failed". None before the end."""
        return self._run.end_reason

    @property
    def end_text(self) -> str:
        """The reason for the end as a sentence; "" before the end."""
        return self._run.end_text

    @property
    def error(self) -> str:
        """The error message of a failed mission, otherwise ""."""
        return self._run.error

    @property
    def summary(self) -> dict[str, Any]:
        """The current content of summary.json; {} before the start."""
        return json.loads(self._run.summary)


def _file_of(config: Mapping[str, Any], mission: Mission) -> str:
    """Writes the config to a temporary file, which exists as long as the mission. Returns its path."""
    base = _mebots.BaseConfig(os.path.join(os.getcwd(), "the config"), json.dumps(config))
    content = json.loads(base.config)
    for name, value in json.loads(base.texts).items():  # texts of parameters, with absolute paths of files
        instance, _, variable = name.partition(".")
        content["instances"][instance]["parameters"][variable] = value
    folder = tempfile.mkdtemp(prefix="mebots-mission-")
    weakref.finalize(mission, shutil.rmtree, folder, ignore_errors=True)
    file = os.path.join(folder, "mission.json")
    with open(file, "w", encoding="utf-8") as stream:
        json.dump(content, stream)
    return file


def _array(values: bytes) -> npt.NDArray[np.float64]:
    import numpy as np

    return np.frombuffer(values, "float64").copy()
