# SPDX-License-Identifier: Apache-2.0
"""report.html: one file that needs nothing else. The numbers go into it as JSON; ``report.js`` beside this module draws
them."""

from __future__ import annotations

import html
import json
import math
import os
import pathlib
from collections.abc import Sequence
from typing import Any

from mebots import _mebots
from mebots.exploration.comparison import Estimate, Evidence
from mebots.exploration.study import Study, Values

MOST_MISSIONS = 50_000
"""Of more missions the report shows the designs alone."""

_STYLE = """
:root{color-scheme:light dark;--ink:#1b2530;--soft:#5c6a78;--line:#d5dce3;--back:#fff;--panel:#f5f7f9;
--on:#0a7d53;--undecided:#2f6fc4;--off:#a3adb8;--excluded:#c4473a}
@media(prefers-color-scheme:dark){:root{--ink:#e4e9ee;--soft:#98a5b3;--line:#36414d;--back:#12181e;--panel:#1b232b;
--on:#3ecf97;--undecided:#6aa8f7;--off:#66727f;--excluded:#f0776a}}
body{font:15px/1.45 system-ui,sans-serif;color:var(--ink);background:var(--back);margin:0 auto;max-width:1120px;padding:24px}
h1{font-size:22px;margin:0 0 4px}h2{font-size:16px;margin:28px 0 4px}p{margin:4px 0;color:var(--soft)}
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(480px,1fr));gap:8px 28px}
svg{width:100%;height:auto;display:block}svg text{fill:var(--soft);font:12px system-ui,sans-serif}
svg .axis{stroke:var(--line)}svg .mark{cursor:pointer}svg .mark:hover,svg .chosen{stroke:var(--ink);stroke-width:2}
select{font:inherit;color:inherit;background:var(--panel);border:1px solid var(--line);border-radius:4px}
table{border-collapse:collapse;font-size:13px;width:100%}td,th{padding:3px 8px;text-align:right;border-bottom:1px solid var(--line)}
td.left{text-align:left}th{color:var(--soft);font-weight:normal;text-align:right;cursor:pointer}tbody tr{cursor:pointer}tbody tr:hover,tr.chosen{background:var(--panel)}
#chosen{background:var(--panel);border-radius:6px;padding:12px 16px;margin-top:12px;position:sticky;bottom:8px;border:1px solid var(--line)}
code{font:12px ui-monospace,monospace;overflow-wrap:anywhere}.key{display:inline-block;width:10px;height:10px;border-radius:5px;margin:0 4px 0 12px}
.scroll{max-height:420px;overflow:auto}
"""


def write(
    file: pathlib.Path,
    study: Study,
    factors: Sequence[str],
    designs: Sequence[Values],
    evidence: Evidence,
    rows: Sequence[dict[str, Any]],
    commands: Sequence[str],
    provenance: dict[str, Any],
) -> None:
    """``rows``: status, place on the front and failed missions of each design; ``commands``: the line that flies its
    first mission again, into ``replay_folder``; ``provenance``: what was flown."""
    title = json.loads(study.text).get("text") or study.mission.stem
    data = {
        "factors": list(factors),
        "objectives": [
            {"label": one.label, "unit": one.unit, "sense": one.sense, "share": one.is_share} for one in study.objectives
        ],
        "constraints": [{"label": one.label, "above": one.above, "bound": one.bound} for one in study.constraints],
        "sequence": study.looks,
        "error": study.error,
        "provenance": provenance | {"MEbots": _mebots.__version__},
        "designs": [
            {
                "values": [values[name] for name in factors],
                "missions": len(evidence.measures[number]),
                "estimates": [_numbers(evidence.shown(number, one)) for one in study.objectives],
                "command": commands[number],
                "replay": _replay(file.parent, number),
                "flights": _flights(evidence, number),
            }
            | rows[number]
            for number, values in enumerate(designs)
        ],
    }
    script = (pathlib.Path(__file__).parent / "report.js").read_text(encoding="utf-8")
    page = (
        '<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
        f"<title>{html.escape(title)}</title><style>{_STYLE}</style></head><body><h1>{html.escape(title)}</h1>"
        f'<main id="main"></main><script type="application/json" id="data">{_embedded(data)}</script>'
        f"<script>{script}</script></body></html>\n"
    )
    beside = file.with_name(file.name + ".part")
    beside.write_text(page, encoding="utf-8")
    os.replace(beside, file)


def replay_folder(study: pathlib.Path, design: int) -> pathlib.Path:
    """Where the first mission of a design goes when somebody flies it again to see it."""
    return study / "replays" / f"design_{design}"


def _replay(study: pathlib.Path, design: int) -> str | None:
    """The page of that mission, once it is there: an address relative to the report."""
    page = replay_folder(study, design) / "flight.html"
    return page.relative_to(study).as_posix() if page.exists() else None


def _numbers(estimate: Estimate) -> list[float | None]:
    low, high = (None if math.isinf(one) else one for one in estimate.interval)
    return [estimate.mean, low, high, estimate.count]


def _flights(evidence: Evidence, design: int) -> list[list[float | None]]:
    """For each objective the values of all missions."""
    if sum(len(rows) for rows in evidence.measures) > MOST_MISSIONS:
        return []
    return [list(column) for column in zip(*evidence.measures[design], strict=True)]


def _embedded(data: Any) -> str:
    """JSON that cannot end the element that it stands in."""
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
