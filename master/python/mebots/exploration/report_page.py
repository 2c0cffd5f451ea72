# SPDX-License-Identifier: Apache-2.0
"""Writes report.html of a study: inserts its numbers into the page of web/src/report."""

from __future__ import annotations

import json
import pathlib
from typing import Any

from mebots.exploration.study import Study
from mebots.page import write_page


def write(file: pathlib.Path, study: Study, data: dict[str, Any], provenance: dict[str, str], answer: str) -> None:
    """Writes the page of a study. ``data`` contains the numbers that the page draws. ``provenance`` describes the study's inputs.
    ``answer`` is the result as text."""
    title = json.loads(study.text).get("text") or study.mission.stem
    write_page(file, title, data | {"error": study.error}, provenance, answer)
