# SPDX-License-Identifier: Apache-2.0
"""What mebots raises."""


class Error(RuntimeError):
    """A run went wrong. The text names instance, time, call and what the FMU said.

    ``code`` is a short name of the kind of error ("fmu_failed", "not_finite"); it keeps its meaning from version to
    version, where texts may change.
    """

    def __init__(self, text: str, code: str = "unspecified") -> None:
        super().__init__(text)
        self.code = code

    def __reduce__(self):
        return type(self), (str(self), self.code)


class InputError(Error):
    """Something handed in cannot be used; the text says what, and what to do instead."""
