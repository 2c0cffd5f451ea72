# SPDX-License-Identifier: Apache-2.0
"""Computes the scales of tensors, and the integers that convert a sum to a byte (fmu_soc/firmware/kernels/layer.h)."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

_LEAST_SHIFT, _MOST_SHIFT = 1, 22  # limits of the shift of the upper word; the output's zero must fit above it
LARGEST_SUM = (1 << 31) - 1
LEAST_NARROW = 1024  # smallest multiplier of 32-bit products: its rounding changes the largest byte by at most an eighth


@dataclasses.dataclass(frozen=True)
class Scale:
    """The scale of a tensor's bytes. A byte represents the real value (byte - zero) x step."""

    step: float
    zero: int

    @staticmethod
    def of_range(low: float, high: float) -> Scale:
        """Returns a scale for the range from ``low`` to ``high``. One byte represents zero exactly."""
        low, high = min(low, 0.0), max(high, 0.0)
        if high - low < 1e-12:
            high = low + 1.0
        step = (high - low) / 255
        return Scale(step, int(round(-low / step)))

    def byte(self, value: float) -> int:
        """Returns the byte nearest to a real value. Clips values outside the range."""
        if math.isinf(value):
            return 255 if value > 0 else 0
        return int(np.clip(np.floor(value / self.step + 0.5) + self.zero, 0, 255))

    def bytes(self, values: np.ndarray) -> np.ndarray:
        return np.clip(np.floor(np.asarray(values, dtype=np.float64) / self.step + 0.5) + self.zero, 0, 255).astype(np.uint8)

    def real(self, values: np.ndarray) -> np.ndarray:
        return (np.asarray(values, dtype=np.float64) - self.zero) * self.step


@dataclasses.dataclass(frozen=True)
class Requantisation:
    """clip((sum x multiplier + addend) >> shift, low, high), per channel.

    ``scaling``: how the chip computes the product. "narrow": in 32 bits. "wide": in 64 bits, of which only the upper word is used;
    ``addend`` and ``shift`` are for this word. "exact": like "wide", but the addend also has 64 bits, with ``lower`` as its lower word.
    """

    multiplier: np.ndarray
    addend: np.ndarray
    shift: np.ndarray
    scaling: str
    lower: np.ndarray | None = None

    def apply(self, sums: np.ndarray, low: int, high: int) -> np.ndarray:
        """Converts sums to bytes. The last dimension of ``sums`` must be the channel."""
        product = sums.astype(np.int64) * self.multiplier
        if self.lower is not None:
            product += self.lower
        if self.scaling != "narrow":
            product >>= 32
        return np.clip((product + self.addend) >> self.shift, low, high).astype(np.uint8)


def requantisation(factors: np.ndarray, zero: int | np.ndarray, bounds: np.ndarray) -> Requantisation:
    """Returns the integers that convert sums to bytes: sum x factor + ``zero``. ``factors`` has one real factor per channel. ``zero`` is
    one number for all channels, or one per channel. ``bounds`` contains the largest magnitude of each channel's sums."""
    factors = np.asarray(factors, dtype=np.float64)
    bounds = np.asarray(bounds, dtype=np.float64)
    if (factors < 0.25).all() and (_narrow_multipliers(factors, zero, bounds)[0] < LEAST_NARROW).any():
        return _wide(factors, zero)
    return _narrow(factors, zero, bounds)


def _wide(factors: np.ndarray, zero: int | np.ndarray) -> Requantisation:
    exponents = np.frexp(np.maximum(factors, 2.0**-60))[1]
    shifts = np.clip(-1 - exponents, _LEAST_SHIFT, _MOST_SHIFT).astype(np.int64)
    multipliers = np.floor(np.ldexp(factors, shifts + 32) + 0.5).astype(np.int64)
    over = multipliers > LARGEST_SUM
    multipliers = np.where(over, LARGEST_SUM, multipliers)
    addends = (zero << shifts) + (np.int64(1) << (shifts - 1))
    return Requantisation(multipliers, addends, shifts, "wide")


def _narrow_multipliers(factors: np.ndarray, zero: int | np.ndarray, bounds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the largest multipliers for which sums up to ``bounds`` stay within 32 bits, and their shifts."""
    most = bounds * factors + zero + 1
    shifts = np.clip(np.floor(np.log2(LARGEST_SUM / np.maximum(most, 1e-9))) - 1, 1, _MOST_SHIFT).astype(np.int64)
    return np.floor(np.ldexp(factors, shifts) + 0.5).astype(np.int64), shifts


def _narrow(factors: np.ndarray, zero: int | np.ndarray, bounds: np.ndarray) -> Requantisation:
    multipliers, shifts = _narrow_multipliers(factors, zero, bounds)
    addends = (zero << shifts) + (np.int64(1) << (shifts - 1))
    if (bounds * multipliers + np.abs(addends) > LARGEST_SUM).any():
        raise OverflowError("the sums of a layer do not fit into 32 bits")
    return Requantisation(multipliers, addends, shifts, "narrow")


def exact_requantisation(multipliers: np.ndarray, addends: np.ndarray, shift: int, bounds: np.ndarray) -> Requantisation:
    """Returns integers that compute exactly (sum x multiplier + addend) >> shift. Raises OverflowError if a multiplier needs more than 30
    bits, or a product more than 63 bits."""
    m, a = (np.asarray(one, dtype=np.int64) for one in (multipliers, addends))
    if shift < 31 and (bounds * np.abs(m) + np.abs(a) <= LARGEST_SUM).all():
        return Requantisation(m, a, np.full_like(m, shift), "narrow")
    more = 30 - int(np.abs(m).max()).bit_length()
    more = min(more, 62 - int(np.abs(a).max()).bit_length())
    if more < 0 or shift + more < 32 or (bounds > LARGEST_SUM).any():
        raise OverflowError(f"multipliers up to {int(np.abs(m).max())} with a shift of {shift} do not fit into 64 bits")
    m, a = m << more, a << more
    upper, lower = a >> 32, a & 0xFFFFFFFF
    shifts = np.full_like(m, shift + more - 32)
    if not lower.any():
        return Requantisation(m, upper, shifts, "wide")
    return Requantisation(m, upper, shifts, "exact", lower)
