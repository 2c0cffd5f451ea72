# SPDX-License-Identifier: Apache-2.0
"""Delivers Ctrl-C only between two steps of a study, never during a step.

Python raises KeyboardInterrupt between any two of its instructions. An exception in ``Thread.start`` leaves a thread of
which its pool has no record. An exception inside a lock's ``with`` leaves the lock taken."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator

_holds = 0
_pending = False


@contextlib.contextmanager
def held() -> Iterator[None]:
    """Delays interrupts until the end of the block. Has no effect outside of the main thread, because Python interrupts only the main
    thread."""
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
        _holds = before  # needed because an interrupt may have ended ``allowed`` early
        _raise_pending_interrupt()


@contextlib.contextmanager
def allowed() -> Iterator[None]:
    """Permits interrupts again until the end of this block, which must be inside a block of ``held``. They are then raised immediately."""
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
    """Handles the signal: raises KeyboardInterrupt, or stores it while interrupts are held."""
    global _pending
    if _holds:
        _pending = True
    else:
        raise KeyboardInterrupt


@contextlib.contextmanager
def _handled() -> Iterator[None]:
    """Replaces Python's own handler of Ctrl-C, which raises at any place. Does not replace a handler that another program has installed."""
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
