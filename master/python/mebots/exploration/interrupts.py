# SPDX-License-Identifier: Apache-2.0
"""Delivers Ctrl-C only between two steps of a study.

Python raises KeyboardInterrupt between any two instructions. An exception in ``Thread.start`` leaves a thread that is missing in its pool.
An exception inside a lock's ``with`` leaves the lock locked."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator

_holds = 0
_pending = False


@contextlib.contextmanager
def held() -> Iterator[None]:
    """Delays interrupts until the end of the block. No effect outside the main thread, because Python interrupts only the main thread."""
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
        _holds = before  # an interrupt may have ended ``allowed`` early
        _raise_pending_interrupt()


@contextlib.contextmanager
def allowed() -> Iterator[None]:
    """Permits interrupts in this block, which must be inside a block of ``held``. Pending interrupts are raised immediately."""
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
    """Signal handler. Raises KeyboardInterrupt, or stores the interrupt while interrupts are held."""
    global _pending
    if _holds:
        _pending = True
    else:
        raise KeyboardInterrupt


@contextlib.contextmanager
def _handled() -> Iterator[None]:
    """Replaces Python's handler of Ctrl-C, which raises KeyboardInterrupt between any two instructions. If the embedding program has set
    another handler, keeps it."""
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
