# SPDX-License-Identifier: Apache-2.0
"""The command line of ``mebots deploy``. The program mebots starts a Python interpreter with this module."""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

from mebots.errors import InputError
from mebots.guarded import guarded


def main(words: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser("mebots deploy", allow_abbrev=False)
    parser.add_argument("model")
    parser.add_argument("--data", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--board", default="ai_deck")
    parser.add_argument("--percentile", type=float)
    parser.add_argument("--equalise", action="store_true")
    parser.add_argument("--input-scale", type=float, default=1 / 255)
    parser.add_argument("--input-offset", type=float, default=0.0)
    parser.add_argument("--crop")
    parser.add_argument("--pictures", type=int, default=256)
    parser.add_argument("--vectors", type=int, default=4)
    parser.add_argument("--validate")
    parser.add_argument("--labels")
    parser.add_argument("--sizes")
    parser.add_argument("--no-measure", action="store_true")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--page")
    given = parser.parse_args(sys.argv[1:] if words is None else words)

    def work() -> None:
        from mebots.deploy.deployed import Options
        from mebots.deploy.deploying import deploy
        from mebots.deploy.network_page import check_place, write_network_page
        from mebots.deploy.report import shown
        from mebots.deploy.sizes import parse_sizes

        if given.percentile is not None and not 50 < given.percentile <= 100:
            raise InputError(f"--percentile is {given.percentile:g}; above 50 and up to 100 are possible", "invalid_value")
        options = Options(
            board=given.board,
            percentile=given.percentile,
            equalise=given.equalise,
            input_scale=given.input_scale,
            input_offset=given.input_offset,
            crop=_crop(given.crop),
            vectors=given.vectors,
            pictures=given.pictures,
            measure=not given.no_measure,
            validate=given.validate,
            labels=given.labels,
            sizes=parse_sizes(given.sizes),
        )
        if given.page is not None:
            check_place(given.page, given.out)
        content = deploy(given.model, given.data, given.out, options)
        print(json.dumps(content, indent=2) if given.json else shown(content))
        if given.page is not None:
            write_network_page(given.page, given.model, options, content)

    return guarded(work)


def _crop(text: str | None) -> Any:
    from mebots.deploy.pictures import Crop

    if text is None:
        return None
    try:
        left, top = (int(one) for one in text.split(","))
    except ValueError:
        raise InputError(f"--crop is '{text}'; LEFT,TOP in pixels is expected, such as 62,44", "invalid_value") from None
    return Crop(left, top)
