# SPDX-License-Identifier: Apache-2.0
"""The command lines of ``mebots replay``, ``mebots identify`` and ``mebots new-cell``. The program mebots starts a Python interpreter with
this module."""

from __future__ import annotations

import argparse
import sys

from mebots.guarded import guarded


def _decks(text: str | None) -> list[str] | None:
    return None if text is None else [deck for deck in text.split(",") if deck]


def main(words: list[str] | None = None) -> int:
    """Runs the command in the first word. Returns the exit code."""
    command, *rest = sys.argv[1:] if words is None else words
    return _COMMANDS[command](rest)


def _replay(words: list[str]) -> int:
    parser = argparse.ArgumentParser("mebots replay", allow_abbrev=False)
    parser.add_argument("log")
    parser.add_argument("--airframe", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--mapping")
    parser.add_argument("--decks")
    parser.add_argument("--mass", type=float)
    parser.add_argument("--charge", type=float)
    parser.add_argument("--window", type=float, default=1.0)
    parser.add_argument("--hover", action="store_true")
    given = parser.parse_args(words)

    def work() -> None:
        from mebots.flight.replay import replay
        from mebots.flight.result import shown

        result = replay(
            given.log,
            given.airframe,
            out=given.out,
            mapping=given.mapping,
            decks=_decks(given.decks),
            mass=given.mass,
            initial_charge=given.charge,
            window=given.window,
            hover=given.hover,
        )
        print(shown(result))
        print(f"page: {given.out}/replay.html")

    return guarded(work)


def _identify(words: list[str]) -> int:
    parser = argparse.ArgumentParser("mebots identify", allow_abbrev=False)
    parser.add_argument("logs", nargs="+")
    parser.add_argument("--airframe", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--fit", default="thrust,cell")
    parser.add_argument("--mapping")
    parser.add_argument("--decks")
    parser.add_argument("--mass", type=float)
    parser.add_argument("--hover", action="store_true")
    given = parser.parse_args(words)

    def work() -> None:
        from mebots.flight.identify import identify, shown

        fit = [one for one in given.fit.split(",") if one]
        decks = _decks(given.decks)
        result = identify(
            given.logs, given.airframe, given.out, fit=fit, mapping=given.mapping, decks=decks, mass=given.mass, hover=given.hover
        )
        print(shown(result))

    return guarded(work)


def _new_cell(words: list[str]) -> int:
    parser = argparse.ArgumentParser("mebots new-cell", allow_abbrev=False)
    parser.add_argument("out")
    parser.add_argument("--name", required=True)
    parser.add_argument("--capacity", type=float, required=True)
    parser.add_argument("--mass", type=float, required=True)
    parser.add_argument("--c-rate", type=float, required=True)
    parser.add_argument("--resistance", type=float)
    parser.add_argument("--discharge")
    parser.add_argument("--mapping")
    given = parser.parse_args(words)

    def work() -> None:
        from mebots.flight.identify import shown
        from mebots.flight.new_cell import new_cell

        print(shown(new_cell(**vars(given))))

    return guarded(work)


_COMMANDS = {"replay": _replay, "identify": _identify, "new-cell": _new_cell}
