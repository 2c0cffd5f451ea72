# SPDX-License-Identifier: Apache-2.0
"""Distinguishes outcomes of missions from faults of the machine. An outcome is the same on every machine: an error or crash of an FMU, or a
limit of the study. A full disk, too little memory or a killed process is not an outcome."""

from __future__ import annotations

import errno
import os
import signal

from mebots.errors import Error

_CODES = frozenset(["file_unwritable", "system_failure"])
"""Codes of errors that the system causes, not the FMUs."""
_SIGNALS = frozenset([signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT, signal.SIGXCPU, signal.SIGXFSZ])
"""Signals with which users, schedulers and the system end processes. A crash of an FMU causes other signals."""
_ERRORS = (errno.ENOSPC, errno.EIO, errno.EDQUOT, errno.ENOMEM, errno.EMFILE, errno.ENFILE, errno.EROFS, errno.EFBIG, errno.ESTALE)
_TEXTS = (*(os.strerror(number) for number in _ERRORS), "bad_alloc", "Resource temporarily unavailable", "by SIGKILL", "by SIGTERM")


def is_outside_signal(number: int) -> bool:
    """True for signals with which other programs end a process."""
    return number in _SIGNALS


def describes_system_error(text: str) -> bool:
    """True if the text contains an operating system's message about a full disk, too little memory or a similar fault."""
    return any(words in text for words in _TEXTS)


def is_outside(error: BaseException) -> bool:
    """True if an exception in a mission process is not an outcome of the mission."""
    if isinstance(error, (OSError, MemoryError)):
        return True
    return isinstance(error, Error) and (error.code in _CODES or describes_system_error(str(error)))


def text_of(error: BaseException) -> str:
    """Returns the text of an exception for the user."""
    return str(error) or ("out of memory" if isinstance(error, MemoryError) else type(error).__name__)
