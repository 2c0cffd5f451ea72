# SPDX-License-Identifier: Apache-2.0
"""report.html of a study: a page whose parts ``report_parts.js`` beside this module, and the script of the kind of study,
draw."""

from __future__ import annotations

import json
import pathlib
from typing import Any

from mebots.exploration.study import Study
from mebots.page import write_page


def write(file: pathlib.Path, study: Study, script: str, data: dict[str, Any], provenance: dict[str, str], refresh_s: float | None = None) -> None:
    """``script``: file name of what draws ``data``; ``provenance``: what was flown; ``refresh_s``: see ``write_page``."""
    title = json.loads(study.text).get("text") or study.mission.stem
    here = pathlib.Path(__file__).parent
    write_page(file, title, [here / "report_parts.js", here / script], data | {"error": study.error}, provenance, refresh_s)
