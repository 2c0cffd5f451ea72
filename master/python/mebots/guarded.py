# SPDX-License-Identifier: Apache-2.0
"""Prints errors and returns exit codes for commands in Python."""

from __future__ import annotations

import sys
from collections.abc import Callable

from mebots.errors import Error, InputError

DONE, FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130


def guarded(work: Callable[[], None]) -> int:
    """Calls ``work``, prints its errors, and returns the exit code."""
    try:
        work()
    except InputError as error:
        code = BAD_INPUT
        text = str(error)
    except ModuleNotFoundError as error:
        code = BAD_INPUT
        text = f"Python at {sys.executable} has no package {error.name}: pip install {error.name}, or set MEBOTS_PYTHON to another Python"
    except KeyboardInterrupt:
        code = INTERRUPTED
        text = "stopped by Ctrl-C; no result was written"
    except (Error, OSError) as error:
        code = FAILED
        text = str(error)
    else:
        return DONE
    for line in text.splitlines():
        print(f"mebots: error: {line}", file=sys.stderr)
    return code
