# SPDX-License-Identifier: Apache-2.0
"""Converts tables to objects of pandas, polars and xarray, if installed."""

from __future__ import annotations

import importlib
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from mebots.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

_UNIT = re.compile(r" \[([^]]+)\]")


def pandas_frame(columns: Mapping[str, Any], times: npt.NDArray[np.float64] | None = None) -> Any:
    """Returns a pandas.DataFrame. Its index contains the times, if given."""
    pandas = _package("pandas", "to_pandas()")
    return pandas.DataFrame(dict(columns), index=None if times is None else pandas.Index(times, name="time [s]"))


def polars_frame(columns: Mapping[str, Any], times: npt.NDArray[np.float64] | None = None) -> Any:
    """Returns a polars.DataFrame. Its first column contains the times, if given."""
    first = {} if times is None else {"time [s]": times}
    return _package("polars", "to_polars()").DataFrame(first | dict(columns))


def time_series(columns: Mapping[str, Any], units: Mapping[str, str], times: npt.NDArray[np.float64]) -> Any:
    """Returns an xarray.Dataset over the times. Its attributes contain the units."""
    xarray = _package("xarray", "to_xarray()")
    variables = {name: ("time", values, _units(units.get(name, ""))) for name, values in columns.items()}
    return xarray.Dataset(variables, coords={"time": ("time", times, {"units": "s"})})


def mission_cube(missions: Mapping[str, Sequence[Any]], designs: Mapping[str, Sequence[Any]], factors: Sequence[str], draws: Sequence[str]) -> Any:
    """Returns an xarray.Dataset over design and replicate, with factors and draws as coordinates. NaN marks missing missions. ``missions``
    and ``designs`` are the columns of missions.csv and designs.csv."""
    import numpy as np

    xarray = _package("xarray", "to_xarray()")
    rows, replicates = np.array(missions["design"]), np.array(missions["replicate"])
    shape = (len(designs["design"]), int(replicates.max(initial=-1)) + 1)

    def grid(values: Sequence[Any]) -> np.ndarray:
        is_number = all(isinstance(value, (int, float)) for value in values)
        result = np.full(shape, np.nan) if is_number else np.full(shape, "", object)
        result[rows, replicates] = values
        return result

    own = ("design", "replicate", "mission", *factors, *draws)
    variables = {_UNIT.sub("", title): (("design", "replicate"), grid(values), _units_of(title)) for title, values in missions.items() if title not in own}
    coords = {"design": list(designs["design"]), "replicate": range(shape[1])}
    coords |= {name: ("design", list(designs[name])) for name in factors}
    for name in draws:
        drawn = dict(zip(replicates.tolist(), missions[name], strict=True))
        coords[name] = ("replicate", [drawn[one] for one in range(shape[1])])
    return xarray.Dataset(variables, coords=coords)


def _units_of(title: str) -> dict[str, str]:
    found = _UNIT.search(title)
    return _units(found[1] if found else "")


def _units(unit: str) -> dict[str, str]:
    return {"units": unit} if unit else {}


def _package(name: str, what: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise InputError(f"{what} needs {name}: pip install {name}", "not_offered") from error
