# SPDX-License-Identifier: Apache-2.0
"""Pages of one file that need nothing else. Numbers go into them as JSON; ``page_parts.js`` and the scripts of the kind of
page draw them. The palette is that of the page of a run (web/src/theme.ts)."""

from __future__ import annotations

import html
import json
import pathlib
from collections.abc import Sequence
from typing import Any

from mebots import _mebots
from mebots.exploration.files import write_whole

_STYLE = """
:root{color-scheme:light dark;--ink:#1b2530;--soft:#5c6a78;--line:#d5dce3;--back:#fff;--panel:#f5f7f9;
--on:#009e73;--undecided:#0072b2;--off:#9aa5b1;--excluded:#d55e00}
@media(prefers-color-scheme:dark){:root{--ink:#e4e9ee;--soft:#98a5b3;--line:#36414d;--back:#12181e;--panel:#1b232b;
--on:#2fc79a;--undecided:#4ea8de;--off:#727f8c;--excluded:#f0803c}}
body{font:15px/1.45 system-ui,sans-serif;color:var(--ink);background:var(--back);margin:0 auto;max-width:1360px;padding:24px}
h1{font-size:22px;margin:0 0 4px}h2{font-size:16px;margin:28px 0 4px}p{margin:4px 0;color:var(--soft)}
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(480px,100%),1fr));gap:8px 28px}
.answer{font-size:18px;color:var(--ink)}
svg{width:100%;height:auto;display:block}svg text{fill:var(--soft);font:12px system-ui,sans-serif}
svg .lettered{paint-order:stroke;stroke:var(--back);stroke-width:3px}svg .axis{stroke:var(--line)}svg .mark{cursor:pointer}svg .mark:hover,svg .chosen{stroke:var(--ink);stroke-width:2}
select{font:inherit;color:inherit;background:var(--panel);border:1px solid var(--line);border-radius:4px}
table{border-collapse:collapse;font-size:13px;width:100%}td,th{padding:3px 8px;text-align:right;border-bottom:1px solid var(--line)}
td.left{text-align:left}th{color:var(--soft);font-weight:normal;text-align:right;cursor:pointer}tbody tr{cursor:pointer}tbody tr:hover,tr.chosen{background:var(--panel)}
#chosen{background:var(--panel);border-radius:6px;padding:12px 16px;margin-top:12px;position:sticky;bottom:8px;border:1px solid var(--line)}
pre{margin:4px 0;white-space:pre-wrap}a{color:var(--undecided)}code{font:12px ui-monospace,monospace;overflow-wrap:anywhere}.key{display:inline-block;width:10px;height:10px;border-radius:5px;margin:0 4px 0 12px}
.scroll{max-height:420px;overflow:auto}.scroll td,.scroll th{white-space:nowrap}
"""


def write_page(file: pathlib.Path, title: str, scripts: Sequence[pathlib.Path], data: dict[str, Any], provenance: dict[str, str], refresh_s: float | None = None) -> None:
    """``scripts``: what draws ``data``; ``provenance``: what the page was made from; ``refresh_s``: time after which the page
    loads itself again."""
    refresh = "" if refresh_s is None else f'<meta http-equiv="refresh" content="{refresh_s:g}">'
    content = data | {"provenance": provenance | {"MEbots": _mebots.__version__}}
    parts = [pathlib.Path(__file__).parent / "page_parts.js", *scripts]
    texts = "".join(f"<script>{part.read_text(encoding='utf-8')}</script>" for part in parts)
    page = (
        '<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        f"{refresh}"
        f"<title>{html.escape(title)}</title><style>{_STYLE}</style></head><body><h1>{html.escape(title)}</h1>"
        f'<main id="main"></main><script type="application/json" id="data">{_embedded(content)}</script>{texts}</body></html>\n'
    )
    write_whole(file, [page.encode()])


def _embedded(data: Any) -> str:
    """JSON that cannot end the element that it stands in."""
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
