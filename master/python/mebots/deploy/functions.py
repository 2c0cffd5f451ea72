# SPDX-License-Identifier: Apache-2.0
"""Functions of single values, which the chip evaluates by a table."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

Function = Callable[[np.ndarray], np.ndarray]
Limits = tuple[float, float] | None


def _sigmoid(x: np.ndarray) -> np.ndarray:
    return 1 / (1 + np.exp(-x))


def leaky(slope: float) -> Function:
    return lambda x: np.where(x < 0, slope * x, x)


def _hard_sigmoid(alpha: float, beta: float) -> Function:
    return lambda x: np.clip(alpha * x + beta, 0, 1)


def _elu(alpha: float) -> Function:
    return lambda x: np.where(x < 0, alpha * (np.exp(np.minimum(x, 0)) - 1), x)


def _gelu(x: np.ndarray) -> np.ndarray:
    return 0.5 * x * (1 + np.vectorize(math.erf)(x / math.sqrt(2)))


NAMES = ("LeakyRelu", "Sigmoid", "HardSigmoid", "HardSwish", "Tanh", "Elu", "Softplus", "Abs", "Neg", "Exp", "Gelu")


def of(op: str, attribute: Callable[[str, Any], Any]) -> tuple[Function, Limits]:
    """Returns the function of an operator, with its minimum and maximum if known."""
    if op == "LeakyRelu":
        return leaky(attribute("alpha", 0.01)), None
    if op == "Sigmoid":
        return _sigmoid, (0.0, 255 / 256)
    if op == "HardSigmoid":
        return _hard_sigmoid(attribute("alpha", 0.2), attribute("beta", 0.5)), (0.0, 1.0)
    if op == "HardSwish":
        return lambda x: x * np.clip(x / 6 + 0.5, 0, 1), None
    if op == "Tanh":
        return np.tanh, (-1.0, 127 / 128)
    if op == "Elu":
        return _elu(attribute("alpha", 1.0)), None
    if op == "Softplus":
        return lambda x: np.logaddexp(0, x), None
    if op == "Gelu":
        return _gelu, None
    return {"Abs": np.abs, "Neg": np.negative, "Exp": np.exp}[op], None
