# SPDX-License-Identifier: Apache-2.0
"""The result of ``mebots.sweep``: tables as data frames, the answer as text, and the HTML report."""

from __future__ import annotations

import dataclasses
import html
import pathlib
from typing import Any

from mebots import _mebots, frames, notebook
from mebots.errors import InputError
from mebots.exploration import columns
from mebots.exploration.answer import Answer


@dataclasses.dataclass(frozen=True)
class Sweep:
    """The result of a study: numbers of counted and failed missions, and the folder of the tables."""

    folder: pathlib.Path
    missions: int
    failed: int
    without_value: list[str] = dataclasses.field(default_factory=list)
    """Messages about objectives whose expression had no value in any mission."""
    notices: list[str] = dataclasses.field(default_factory=list)
    """Warnings of the journals: damaged lines, file systems without locks."""
    answer: Answer | None = None
    """The best design and how certain it is; None for a rare event."""
    factors: list[str] = dataclasses.field(default_factory=list)
    draws: list[str] = dataclasses.field(default_factory=list)

    def designs(self) -> list[dict[str, str]]:
        """Returns the rows of designs.csv."""
        titles, *rows = _mebots.read_csv(self.folder / "designs.csv")
        return [dict(zip(titles, row, strict=True)) for row in rows]

    def to_pandas(self, table: str = "designs") -> Any:
        """Returns designs.csv ("designs") or missions.csv ("missions") as a pandas.DataFrame. Requires pandas."""
        return frames.pandas_frame(self._columns(table))

    def to_polars(self, table: str = "designs") -> Any:
        """Returns designs.csv ("designs") or missions.csv ("missions") as a polars.DataFrame. Requires polars."""
        return frames.polars_frame(self._columns(table))

    def to_xarray(self) -> Any:
        """Returns the missions as an xarray.Dataset over design and replicate. Factors and draws are coordinates. Requires xarray."""
        return frames.mission_cube(self._columns("missions"), self._columns("designs"), self.factors, self.draws)

    def show(self, height: int = 800) -> Any:
        """Shows report.html inside a notebook. Requires IPython."""
        return notebook.show(self.folder / "report.html", height)

    def _repr_html_(self) -> str:
        """Returns the answer as HTML for a notebook."""
        return f"<pre>{html.escape(str(self.answer or self))}</pre>"

    def _columns(self, table: str) -> dict[str, list[Any]]:
        if table not in ("designs", "missions"):
            raise InputError(f"there is no table '{table}'; the tables are 'designs' and 'missions'", "unknown_name")
        file = self.folder / f"{table}.csv"
        if not file.exists():
            raise InputError(f"{file}: there is no such file; a study of a rare event has designs.csv and levels.csv", "file_not_found")
        return columns.read(file)
