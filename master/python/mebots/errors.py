# SPDX-License-Identifier: Apache-2.0
"""Defines the exceptions that mebots raises."""


class Error(RuntimeError):
    """A run failed. The message contains instance, time, call and the FMU's log.

    ``code`` is a short name of the kind of error ("fmu_failed", "not_finite"). It is stable across versions; messages
    are not.
    """

    def __init__(self, text: str, code: str = "unspecified") -> None:
        super().__init__(text)
        self.code = code

    def __reduce__(self):
        return type(self), (str(self), self.code)


class InputError(Error):
    """Raised for an invalid argument or file. The message names the argument or file and the remedy."""
