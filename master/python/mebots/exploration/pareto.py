# SPDX-License-Identifier: Apache-2.0
"""Finds the points that no other point dominates."""

from __future__ import annotations

import numpy as np

try:  # from the extra mebots[sweep]: O(n log n) in two and three dimensions (Fonseca, Lopez-Ibanez and others)
    import moocore
except ImportError:
    moocore = None

_BLOCK = 256


def front(points: np.ndarray) -> list[int]:
    """Returns the indices of rows that no other row dominates. A row dominates another if it is greater or equal in all columns, and
    greater in one. Rows may contain infinities, but no NaN."""
    points = points + 0.0  # converts -0.0 to 0.0
    if points.shape[1] == 1:
        return np.flatnonzero(points[:, 0] == points[:, 0].max()).tolist()
    if moocore is not None and np.isfinite(points).all():
        return np.flatnonzero(moocore.is_nondominated(points, maximise=True, keep_weakly=True)).tolist()
    return _front_by_blocks(points)


def _front_by_blocks(points: np.ndarray) -> list[int]:
    """Compares blocks of points with the front so far. No point dominates an earlier one, because points are sorted by their sums."""
    distinct, origin = np.unique(points, axis=0, return_inverse=True)
    order = np.lexsort(distinct.T)[::-1]
    order = order[np.argsort(-distinct[order].sum(axis=1), kind="stable")]
    kept = np.empty((0, points.shape[1]))
    on_front = np.zeros(len(distinct), bool)
    for begin in range(0, len(order), _BLOCK):
        block = distinct[order[begin : begin + _BLOCK]]
        free = ~_dominated(block, kept)
        inside = block[free]
        free[free] = ~_dominated(inside, inside)
        on_front[order[begin : begin + _BLOCK][free]] = True
        kept = np.concatenate([kept, block[free]])
    return np.flatnonzero(on_front[origin.ravel()]).tolist()


def _dominated(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Returns for each point whether another point is at least as great in all columns. All points must differ."""
    result = np.zeros(len(points), bool)
    for at, point in enumerate(points):
        better = (others >= point).all(axis=1)
        result[at] = better.sum() > (1 if others is points else 0)
    return result
