# SPDX-License-Identifier: Apache-2.0
"""Reads the results folder of a run."""

from __future__ import annotations

import difflib
import json
import os
import pathlib
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from mebots import _mebots, frames, notebook
from mebots.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


class Results:
    """The results in a run's folder. ``results[variable]`` has the recorded values of a variable.

    Numbers are float64 arrays with one value per entry of ``times``. Values of Strings are lists of str, and values of
    Binaries are lists of str with pairs of hexadecimal digits.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        """Reads summary.json and results.csv. Raises InputError if a file is missing or invalid."""
        self.folder = pathlib.Path(folder)
        if not self.folder.is_dir():
            raise InputError(f"{folder}: there is no such folder", "file_not_found")
        self.summary: dict[str, Any] = _summary(self.folder)
        self._units, self._columns = _columns(self.folder)
        self.times: npt.NDArray[np.float64] = self._columns.pop("time")
        """The times of the rows [s]."""
        self._units.pop("time")

    def __repr__(self) -> str:
        return f"<mebots.Results of {self.folder}: {len(self._columns)} variables, {len(self.times)} rows>"

    def __getitem__(self, variable: str) -> npt.NDArray[np.float64] | list[str]:
        """Returns the recorded values of a variable. Raises KeyError with similar names if the variable is not recorded."""
        self._require(variable)
        return self._columns[variable]

    def __contains__(self, variable: str) -> bool:
        return variable in self._columns

    def unit(self, variable: str) -> str:
        """Returns the unit of a variable, or "" if it has none."""
        self._require(variable)
        return self._units[variable]

    @property
    def variables(self) -> list[str]:
        """Returns the names of the recorded variables, in the order of the file."""
        return list(self._columns)

    @property
    def outcome(self) -> str:
        """Returns the outcome of the run."""
        return self.summary.get("outcome", "")

    def to_pandas(self):
        """Returns all columns as a pandas.DataFrame. The times are the index. Requires pandas."""
        return frames.pandas_frame(self._columns, self.times)

    def to_polars(self):
        """Returns all columns as a polars.DataFrame. The times are the first column. Requires polars."""
        return frames.polars_frame(self._columns, self.times)

    def to_xarray(self):
        """Returns all columns and their units as an xarray.Dataset over the times. Requires xarray."""
        return frames.time_series(self._columns, self._units, self.times)

    def show(self, height: int = 800):
        """Shows the page of the run inside a notebook."""
        return notebook.show(self.folder, height)

    def _require(self, variable: str) -> None:
        if variable not in self._columns:
            raise not_recorded(variable, self._columns)


def read(folder: str | os.PathLike[str]) -> Results:
    """Reads the results of a run from the folder that ``mebots run --out`` or ``Mission(..., out=...)`` wrote."""
    return Results(folder)


def not_recorded(variable: str, recorded: Iterable[str]) -> KeyError:
    """Returns the error for a variable that is not recorded, with the most similar names."""
    nearest = difflib.get_close_matches(variable, list(recorded), n=3, cutoff=0.4)
    hint = f"; nearest: {', '.join(nearest)}" if nearest else ""
    return KeyError(f"'{variable}' is not recorded{hint}")


def _summary(folder: pathlib.Path) -> dict[str, Any]:
    file = folder / "summary.json"
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{file}: there is no such file; is this the folder of a run?", "file_not_found") from None
    except ValueError as error:
        raise InputError(f"{file}: this is not a summary of a run: {error}", "syntax_error") from None


def _texts(folder: pathlib.Path) -> set[str]:
    """Returns the names of the recorded Strings and Binaries."""
    try:
        system = json.loads((folder / "system.json").read_text(encoding="utf-8"))
    except (FileNotFoundError, ValueError):
        return set()
    variables = system.get("variables", {}) if isinstance(system, dict) else {}
    return {name for name, one in variables.items() if one.get("type") in ("String", "Binary")}


def _columns(folder: pathlib.Path) -> tuple[dict[str, str], dict[str, Any]]:
    """Returns units and values by name. Columns of Strings and Binaries are lists of texts, even if all texts are numbers. system.json
    contains the types. Without it, a column is a list of texts unless all cells are numbers."""
    import numpy as np

    file = folder / "results.csv"
    if not file.exists():
        raise InputError(f"{file}: there is no such file; did the run record as \"hdf5\" only?", "file_not_found")
    header, *rows = _mebots.read_csv(file, "surrogateescape")
    cells = list(zip(*rows, strict=True)) or [() for _ in header]
    texts = _texts(folder)
    units: dict[str, str] = {}
    columns: dict[str, np.ndarray | list[str]] = {}
    for title, values in zip(header, cells, strict=True):
        name, _, unit = title.rpartition(" [")
        units[name] = "" if unit == "-]" else unit.removesuffix("]")
        try:
            columns[name] = list(values) if name in texts else np.array(values, dtype="float64")
        except ValueError:
            columns[name] = list(values)
    if "time" not in columns:
        raise InputError(f"{file}: there is no column of times; this is not a file of mebots", "syntax_error")
    return units, columns
