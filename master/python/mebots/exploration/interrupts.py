# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C between two steps, and never in the middle of one.

Python raises KeyboardInterrupt between any two of its instructions. Inside ``Thread.start`` that leaves a thread which
its pool does not know, inside a lock's ``with`` a lock that stays taken."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator

_holds = 0
_pending = False


@contextlib.contextmanager
def held() -> Iterator[None]:
    """What the block does is done whole: an interrupt that comes meanwhile is raised at the block's end. In a thread
    other than the main one it does nothing: Python interrupts only that."""
    global _holds
    if not _can_come():
        yield
        return
    before = _holds
    _holds = before + 1
    try:
        with _handled():
            yield
    finally:
        _holds = before  # an interrupt may have cut ``allowed`` short
        _raise_pending_interrupt()


@contextlib.contextmanager
def allowed() -> Iterator[None]:
    """Within ``held``: here an interrupt is raised at once, as everywhere else."""
    global _holds
    if not _can_come():
        yield
        return
    holds, _holds = _holds, 0
    try:
        _raise_pending_interrupt()
        yield
    finally:
        _holds = holds


def _can_come() -> bool:
    return threading.current_thread() is threading.main_thread()


def interrupt(number: int, frame: object) -> None:
    """A handler of signals."""
    global _pending
    if _holds:
        _pending = True
    else:
        raise KeyboardInterrupt


@contextlib.contextmanager
def _handled() -> Iterator[None]:
    """Python's own handler of Ctrl-C raises wherever it is: this one stands in for it. Somebody else's stays."""
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _raise_pending_interrupt() -> None:
    global _pending
    if _pending and not _holds:
        _pending = False
        raise KeyboardInterrupt
