# SPDX-License-Identifier: Apache-2.0
"""Writes pages as single files. A page contains its numbers as JSON, which web/src/report draws."""

from __future__ import annotations

import html
import json
import pathlib
from typing import Any

from mebots import _mebots
from mebots.errors import Error
from mebots.exploration.files import write_whole


def write_page(file: pathlib.Path, title: str, data: dict[str, Any], provenance: dict[str, str], answer: str) -> None:
    """Writes a page. ``provenance`` describes the inputs. ``answer`` is the result as text. If MEbots was built without web pages, the page
    contains only this text."""
    content = data | {"title": title, "provenance": provenance | {"MEbots": _mebots.__version__}}
    try:
        page = _mebots.data_page(title, json.dumps(content, separators=(",", ":"), allow_nan=False))
    except Error as error:
        if error.code != "not_offered":
            raise
        page = _plain_page(title, answer).encode()
    write_whole(file, [page])


def _plain_page(title: str, answer: str) -> str:
    note = "This MEbots was built without pages (MEBOTS_PAGES=OFF), so this page has no pictures."
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title></head>'
        f"<body><h1>{html.escape(title)}</h1><pre>{html.escape(answer)}</pre><p>{note}</p></body></html>\n"
    )
