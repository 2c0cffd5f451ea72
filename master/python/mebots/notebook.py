# SPDX-License-Identifier: Apache-2.0
"""Shows pages and progress in Jupyter notebooks."""

from __future__ import annotations

import html
import os
import pathlib
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING, Any

from mebots.errors import Error, InputError

if TYPE_CHECKING:
    from mebots.exploration.progress import Progress

_PAGES = ("report.html", "flight.html", "replay.html")


def is_notebook() -> bool:
    """True in a notebook that shows HTML. Does not import IPython, because a notebook has already done so."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return type(shell).__name__ == "ZMQInteractiveShell"


def show(page: str | os.PathLike[str], height: int = 800) -> Any:
    """Shows a page in a notebook. ``page`` is a file, or a results folder of ``mebots run``, ``sweep`` or ``replay``. Writes the page of a
    run if it is missing. Requires IPython."""
    file = _page_of(pathlib.Path(page))
    try:
        from IPython.display import HTML
    except ImportError as error:
        raise InputError(f"show() needs IPython: pip install jupyter. The page is {file}", "not_offered") from error
    text = html.escape(file.read_text(encoding="utf-8"), quote=True)
    frame = f'<iframe srcdoc="{text}" style="width:100%;height:{height}px;border:1px solid #8884;border-radius:8px"></iframe>'
    return HTML(f"<div>{frame}</div>")  # prevents a warning of IPython about frames


def _page_of(page: pathlib.Path) -> pathlib.Path:
    if page.is_file():
        return page
    for name in _PAGES:
        if (page / name).is_file():
            return page / name
    if not (page / "system.json").is_file():
        raise InputError(f"{page}: there is neither a page nor the results of a run. A page is one of {', '.join(_PAGES)}", "file_not_found")
    program = _program()
    done = subprocess.run([program, "report", str(page)], capture_output=True, text=True)
    if done.returncode != 0:
        raise Error(f"`mebots report {page}` failed: {done.stderr.strip()}", "file_unwritable")
    return page / "flight.html"


def _program() -> str:
    """Returns the path of `mebots`: in the wheel, otherwise in the build or installation, otherwise in PATH."""
    here = pathlib.Path(__file__).resolve().parent
    places = [here / "bin" / "mebots", here.parents[1] / "bin" / "mebots", here.parents[3] / "bin" / "mebots"]
    found = next((str(place) for place in places if place.is_file()), None) or shutil.which("mebots")
    if found is None:
        raise InputError("the program mebots is neither next to the package nor in PATH, so no page can be written", "file_not_found")
    return found


class ProgressBar:
    """A progress bar under the notebook cell of a study: finished missions, failed missions, and the remaining time."""

    def __init__(self) -> None:
        from IPython.display import HTML, display

        self._html = HTML
        self._display = display(HTML(""), display_id=True)

    def __call__(self, now: Progress) -> None:
        done = now.flown + now.taken
        self._display.update(self._html(
            f'<progress value="{done}" max="{done + round(now.likely_left)}" style="width:min(100%,480px)"></progress><br>{html.escape(now.line())}'))  # fmt: skip
