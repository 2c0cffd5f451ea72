# SPDX-License-Identifier: Apache-2.0
"""The types of log variables and parameters, and their representation as bytes."""

from __future__ import annotations

import dataclasses
import math
import struct


@dataclasses.dataclass(frozen=True)
class Scalar:
    """A type with its numbers in the tables of log variables and parameters, and its code in the module struct."""

    log_number: int
    parameter_number: int
    code: str

    @property
    def size(self) -> int:
        return struct.calcsize(self.code)

    @property
    def is_float(self) -> bool:
        return self.code in "ef"

    def pack(self, value: float) -> bytes:
        """Converts a value to bytes. For an integer type, truncates towards zero and wraps, as in C on the drone's processor. A float out
        of range becomes infinite. NaN becomes the integer 0."""
        if self.is_float:
            try:
                return struct.pack("<" + self.code, value)
            except OverflowError:
                return struct.pack("<" + self.code, math.copysign(math.inf, value))
        whole = int(value) if math.isfinite(value) else 0
        return (whole % (1 << 8 * self.size)).to_bytes(self.size, "little")

    def unpack(self, data: bytes) -> float:
        """Returns the value in the first ``size`` bytes."""
        return struct.unpack_from("<" + self.code, data)[0]


UINT8 = Scalar(1, 0x08, "B")
UINT16 = Scalar(2, 0x09, "H")
UINT32 = Scalar(3, 0x0A, "I")
INT8 = Scalar(4, 0x00, "b")
INT16 = Scalar(5, 0x01, "h")
INT32 = Scalar(6, 0x02, "i")
FLOAT = Scalar(7, 0x06, "f")
HALF = Scalar(8, 0x05, "e")

BY_LOG_NUMBER = {one.log_number: one for one in (UINT8, UINT16, UINT32, INT8, INT16, INT32, FLOAT, HALF)}
