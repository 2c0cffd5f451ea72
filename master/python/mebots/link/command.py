# SPDX-License-Identifier: Apache-2.0
"""The command line of ``mebots link``. The program mebots starts a Python interpreter with this module."""

from __future__ import annotations

import argparse
import json
import pathlib
import signal
import sys

from mebots.errors import Error, InputError
from mebots.guarded import guarded
from mebots.link.recording import FILE, Recorder, Recording, read_recording
from mebots.link.server import Server
from mebots.link.session import Session, Settings
from mebots.mission import Scalar


def main(words: list[str] | None = None) -> int:
    given = _parser().parse_args(sys.argv[1:] if words is None else words)
    return guarded(lambda: _replay(given) if given.replay is not None else _serve(given))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("mebots link", allow_abbrev=False)
    parser.add_argument("config")
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--set", nargs="+", action="extend", default=[])
    parser.add_argument("--drones", type=int)
    parser.add_argument("--spacing", type=float)
    parser.add_argument("--decks")
    parser.add_argument("--stop-time", type=float)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=19850)
    parser.add_argument("--idle", type=float)
    parser.add_argument("--replay", type=pathlib.Path)
    return parser


def _settings(given: argparse.Namespace) -> Settings:
    options = {
        "drones": given.drones,
        "spacing": given.spacing,
        "decks": None if given.decks is None else tuple(deck for deck in given.decks.split(",") if deck),
        "set": dict(_assignment(word) for word in given.set) or None,
        "stop_time": given.stop_time,
    }
    return Settings(**{name: value for name, value in options.items() if value is not None})


def _assignment(word: str) -> tuple[str, Scalar]:
    name, equals, text = word.partition("=")
    if not name or not equals:
        raise InputError(f"--set {word}: INSTANCE.VARIABLE=VALUE is expected", "invalid_argument")
    try:
        value = json.loads(text)
    except ValueError:
        value = text
    return name, value if isinstance(value, (bool, int, float, str)) else text


def _serve(given: argparse.Namespace) -> None:
    settings = _settings(given)
    session = Session(given.config, settings, given.out)
    try:
        recorder = None if given.out is None else Recorder(given.out / FILE, settings)
        is_stopped = _stop_requests()
        server = Server(session, given.host, given.port, recorder)
        for index in range(len(session.drones)):
            print(f"drone {index + 1}: udp://{given.host}:{given.port + index}", flush=True)
        server.serve(given.idle, is_stopped)
        server.close()
        if recorder is not None:
            recorder.close(session.time_ms, session.fingerprint)
            print(f"recording: {given.out / FILE}")
    finally:
        session.close()
    _print_end(session)


def _replay(given: argparse.Namespace) -> None:
    if given.set or any(one is not None for one in (given.drones, given.spacing, given.decks, given.stop_time)):
        raise InputError(
            "--replay: the recording has the settings; leave out --set, --drones, --spacing, --decks and --stop-time", "invalid_argument"
        )
    recording = read_recording(given.replay)
    session = Session(given.config, recording.settings, given.out)
    try:
        repeat(session, recording, given.replay)
    finally:
        session.close()
    _print_end(session)
    if recording.bits is None:
        print("the recording has no end: its run was killed, and the bits cannot be compared")
    elif recording.bits != session.fingerprint:
        raise Error(f"the recorded run had the bits {recording.bits}: config, models or MEbots have changed since", "not_repeatable")


def repeat(session: Session, recording: Recording, file: pathlib.Path) -> None:
    """Passes recorded packets to a session at their recorded times. Raises InputError if the config lacks the drone of a packet."""
    for event in recording.events:
        if event.drone >= len(session.drones):
            raise InputError(f"{file}: a packet is for drone {event.drone + 1}, and the config has {len(session.drones)}", "invalid_value")
        _advance_to(session, event.time_ms)
        session.handle(event.drone, event.packet)
    if recording.end_ms is not None:
        _advance_to(session, recording.end_ms)


def _advance_to(session: Session, time_ms: int) -> None:
    while session.time_ms < time_ms and not session.ended:
        session.advance()


def _stop_requests():
    """Returns a function that returns True after SIGINT, SIGTERM or SIGHUP. Ignored signals (nohup) stay ignored."""
    requests = []
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, lambda *_: requests.append(True))
    return lambda: bool(requests)


def _print_end(session: Session) -> None:
    print(f"simulated {session.time_ms / 1000.0:g} s, bits {session.fingerprint}" + (f": {session.end_text}" if session.ended else ""))
