# SPDX-License-Identifier: Apache-2.0
"""The command line of ``mebots report --mcap`` and ``--video``. The program mebots writes the page, and then starts a Python interpreter
with this module.
"""

from __future__ import annotations

import argparse
import pathlib
import sys

from mebots.errors import Error, InputError

DONE, FAILED, BAD_INPUT = 0, 1, 2


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="mebots report", add_help=False)
    parser.add_argument("run", type=pathlib.Path)
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("--mcap", type=pathlib.Path)
    parser.add_argument("--video", type=pathlib.Path)
    parser.add_argument("--frames-per-second", type=int, default=15)
    parser.add_argument("--speed", type=float, default=1.0)
    given = parser.parse_args(arguments)
    try:
        if given.mcap:
            from mebots.export.mcap_file import write_mcap

            write_mcap(given.run, given.mcap)
            print(f"mcap: {given.mcap}", flush=True)
        if given.video:
            from mebots.export.film import write_film

            frames = write_film(given.page, given.video, given.frames_per_second, given.speed)
            print(f"video: {given.video} ({frames} frames)")
    except InputError as error:
        print(f"mebots: error: {error}", file=sys.stderr)
        return BAD_INPUT
    except (Error, OSError) as error:
        print(f"mebots: error: {error}", file=sys.stderr)
        return FAILED
    return DONE
