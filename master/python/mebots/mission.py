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

if TYPE_CHECKING:  # NumPy is imported where an array is asked for: `mebots sweep` asks for none
    import numpy as np
    import numpy.typing as npt

Path = str | os.PathLike[str]
Scalar = bool | int | float | str


class Mission:
    """A run of an FMU, or of an ensemble of FMUs: the same run as ``mebots run`` makes, step by step.

    Times are in seconds, values in the unit of their variable. ``InputError`` is raised for what the caller can mend,
    ``Error`` for a run that went wrong; after that the mission has ``failed`` and steps no more.

    As a context manager it is closed at the end of the block, also when that is left early. One thread at a time per
    mission; several missions may run on several threads, since stepping releases the interpreter's lock.

    :param config: config (.json), FMU (.fmu) or SSP 1.0 (.ssp), or the content of a config as a dict, whose paths are relative
        to the working folder. The names of an FMU's variables need no instance in front.
    :param set: values for parameters and start values, by "instance.variable", in place of the config's.
    :param record: names of variables to record (* and ? allowed), in place of the config's choice.
    :param scenarios: files with overrides, after those of the config.
    :param inputs: CSV files whose columns are signals for the free inputs that they are named after.
    :param stop_time: end of the run [s], in place of the config's.
    :param step: communication step [s], for an FMU alone or an SSP that has none. A ratio is a text such as "1/60" or a
        ``Fraction``, or the number next to it.
    :param out: folder for results.csv, summary.json and log.txt; None = no files.
    :param in_memory: whether recorded rows are kept for ``times`` and ``mission[variable]``.
    :param isolate: every instance in a process of its own.
    :param statistics: measure calls and wall time of every instance, for the summary.
    :param checkpoint_every: simulated time [s] from checkpoint to checkpoint in ``out``; None = no checkpoints.
    :param uncertainty: "calibration" or "none", in place of the config's: whether ``run()`` makes 19 more flights with drawn
        parameters, and adds intervals to the summary.
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
            raise TypeError(f"set is a dict of variables and their values, not {set!r}")
        for variable, value in (set or {}).items():
            self.set(variable, value)
        if record is not None:
            self.record(record)

    @classmethod
    def resume(cls, folder: Path, *, in_memory: bool = True) -> Mission:
        """A mission that goes on from the last checkpoint in a results folder, to the same bits as one that nobody
        disturbed. Rows from before the checkpoint come into memory, too."""
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
        """Calls listener(instance, severity, text, time [s]) for what FMUs say, and for the run's own notices
        (instance ""); severity is "info", "warning" or "error". It is called from within the calls to FMUs: it must not
        call the mission back, except for interrupt(). Before start()."""
        self._run.on_message(listener)

    def on_point(self, listener: Callable[[float], None]) -> None:
        """Calls listener(time [s]) at every communication point, t = 0 included. It may read and write variables, but
        for t = 0. Before start()."""
        self._run.on_point(listener)

    def set(self, variable: str, value: Scalar) -> None:
        """A parameter or start value for "instance.variable", in place of the config's. Name, type and limits are
        checked at once. Before start()."""
        self._run.set(variable, value)

    def add_scenario(self, file: Path) -> None:
        """Overrides from a file, after those of the config. Before start()."""
        self._run.add_scenario(file)

    def add_inputs(self, file: Path) -> None:
        """Takes the columns of a CSV file as sources of the free inputs that they are named after, after those of the
        config. Before start()."""
        self._run.add_inputs(file)

    def set_stop_time(self, stop_time_s: float) -> None:
        """The end of the run [s], in place of the config's. Before start()."""
        self._run.set_stop_time(stop_time_s)

    def record(self, patterns: Iterable[str]) -> None:
        """Records these variables (* and ? allowed) in place of the config's choice. Before start()."""
        if isinstance(patterns, str):
            patterns = [patterns]
        self._run.record(list(patterns))

    def load(self) -> None:
        """Unpacks and loads the FMUs, and makes no instance. A process that is forked from here (``os.fork``) begins the
        mission as a fresh one. Before start()."""
        self._run.load()

    def start_from(self, state: bytes) -> None:
        """Begins where ``save_state`` of a mission with the same config, FMUs, settings and choice of what is recorded was
        called, in this process or another, in place of t = 0. It goes on to the same bits. Missions without ``out``
        only. Before start()."""
        self._run.start_from(state)

    # The run.

    def start(self) -> None:
        """Opens the FMUs, checks everything that can be checked, and goes to t = 0 (or to the checkpoint). The calls
        below do it when it was not done."""
        self._run.start()

    def step(self) -> bool:
        """One communication step; False when none was taken, because the end was reached."""
        return self._run.step()

    def run(self) -> None:
        """Steps to the end. Ctrl-C ends the run between two calls to FMUs, writes its reports and raises
        KeyboardInterrupt.

        If the config or ``uncertainty`` asks for "calibration", 19 flights with drawn parameters follow, without messages
        and listeners; ``summary["uncertainty"]`` has their intervals. There are none after ``write()`` or
        ``start_from()``, which the draws would lack: ``summary["uncertainty"]["skipped"]`` has the reason."""
        self._run.run()

    def run_until(self, time_s: float) -> None:
        """Steps until ``time_s``, or to the end when that comes first."""
        self._run.run_until(time_s)

    def close(self) -> None:
        """Ends the run where it stands and writes its reports. Nothing, when it is over. From a listener: as
        interrupt()."""
        self._run.close()

    def save_state(self) -> bytes:
        """The mission as it stands between two steps, for ``start_from``: many futures of one past. All its FMUs must be
        able to write their state as bytes; missions without ``out`` only, and not after the end."""
        return self._run.save_state()

    def reset(self) -> None:
        """Closes the mission and makes it one that was just opened, with ``set``, ``record`` and listeners forgotten. FMUs
        stay loaded if they are clean; others are loaded again. The next run is that of ``mebots run``, to the last bit.
        If that is not possible in this process, start() refuses it and names the FMU."""
        self._run.reset()

    def free_instances(self) -> list[tuple[str, bool]]:
        """Closes the mission and frees its instances. Lists the FMUs that are not clean, and whether they ran in this
        process: a mission after it might find what they left. Only reset() makes variables readable again."""
        return self._run.free_instances()

    def interrupt(self) -> None:
        """Asks for the end, from any thread: the run ends between two calls to FMUs, with outcome "interrupted"."""
        self._run.interrupt()

    # Variables.

    def value(self, variable: str) -> float:
        """The value now, in the variable's unit; Booleans as 0 and 1, enumerations as numbers."""
        return self._run.value(variable)

    def text(self, variable: str) -> str:
        """The text of a String variable now."""
        return self._run.text(variable)

    def write(self, variable: str, value: float) -> None:
        """Sets an input that nothing is connected to, or a tunable parameter, from now on."""
        self._run.write(variable, value)

    # What was recorded.

    def __getitem__(self, variable: str) -> npt.NDArray[np.float64]:
        """What was recorded of a variable so far, one value per entry of ``times``. Raises KeyError."""
        return _array(self._series(variable)[1])

    def unit(self, variable: str) -> str:
        """The unit of a recorded variable; "" = none. Raises KeyError when it is not recorded."""
        return self._series(variable)[0]

    def _series(self, variable: str) -> tuple[str, bytes]:
        if variable not in self.variables:
            from mebots.results import not_recorded

            raise not_recorded(variable, self.variables)
        return self._run.series(variable)

    @property
    def times(self) -> npt.NDArray[np.float64]:
        """The times of the recorded points [s]."""
        return _array(self._run.times if self.state != "open" else b"")

    @property
    def variables(self) -> list[str]:
        """The names of the recorded variables."""
        return self._run.variables if self.state != "open" else []

    def to_pandas(self):
        """What was recorded, as a pandas.DataFrame with the times as index. Needs pandas."""
        return frames.pandas_frame(self._columns(), self.times)

    def to_polars(self):
        """What was recorded, as a polars.DataFrame whose first column is the times. Needs polars."""
        return frames.polars_frame(self._columns(), self.times)

    def to_xarray(self):
        """What was recorded, as an xarray.Dataset over the times, with units. Needs xarray."""
        return frames.time_series(self._columns(), {name: self.unit(name) for name in self.variables}, self.times)

    def _columns(self) -> dict[str, npt.NDArray[np.float64]]:
        return {name: self[name] for name in self.variables}

    # Where it stands.

    @property
    def time(self) -> float:
        """The simulated time reached [s]."""
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
        """ "open", "ready" (at t = 0), "running", "ended" or "failed"."""
        return self._run.state

    @property
    def ended(self) -> bool:
        """Whether the run is over, well or not."""
        return self._run.ended

    @property
    def outcome(self) -> str:
        """The config's outcome at the point reached last, "completed" when none of its conditions hold; "interrupted",
        "closed" or "failed" for a run that was. "" before the start."""
        return self._run.outcome

    @property
    def end_reason(self) -> str | None:
        """ "stop_time", "stop_condition", "terminated", "interrupted", "closed" or "failed"; None before the end."""
        return self._run.end_reason

    @property
    def end_text(self) -> str:
        """One sentence on why the run ended; "" before."""
        return self._run.end_text

    @property
    def error(self) -> str:
        """What went wrong; "" unless the mission has failed."""
        return self._run.error

    @property
    def summary(self) -> dict[str, Any]:
        """The content of summary.json, as far as it is known; {} before the start."""
        return json.loads(self._run.summary)


def _file_of(config: Mapping[str, Any], mission: Mission) -> str:
    """Returns a temporary file with the config, which lasts as long as the mission."""
    base = _mebots.BaseConfig(os.path.join(os.getcwd(), "the config"), json.dumps(config))
    content = json.loads(base.config)
    for name, value in json.loads(base.texts).items():  # of parameters, with absolute paths of files
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
