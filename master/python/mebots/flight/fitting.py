# SPDX-License-Identifier: Apache-2.0
"""Fits parameters by least squares, with intervals that are valid for correlated residuals."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from mebots.extras import extra
from mebots.flight.log import Array

CONFIDENCE = 0.95


@dataclasses.dataclass(frozen=True)
class Fit:
    """Fitted parameters and the covariance of their errors. ``degrees`` is the number of clusters of residuals minus one."""

    values: Array
    covariance: Array
    residuals: Array
    degrees: int

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean(self.residuals**2)))

    def deviation(self, place: int) -> float:
        """Returns the standard error of a parameter."""
        return float(np.sqrt(self.covariance[place, place]))

    def interval(self, place: int) -> tuple[float, float]:
        """Returns the ``CONFIDENCE`` interval of a parameter."""
        half = self.deviation(place) * quantile(self.degrees)
        return float(self.values[place]) - half, float(self.values[place]) + half


def quantile(degrees: int) -> float:
    """Returns the two-sided quantile of Student's distribution."""
    stats = extra("scipy.stats", "`mebots identify`", "scipy", "flight")
    return float(stats.t.ppf((1 + CONFIDENCE) / 2, max(degrees, 1)))


def solve(
    residuals: Callable[[Array], Array],
    jacobian: Callable[[Array], Array],
    start: Array,
    low: Array,
    high: Array,
    clusters: np.ndarray,
) -> Fit:
    """Minimises the sum of squares within bounds. ``clusters`` contains the cluster number of each residual; residuals of a cluster, such
    as errors of one flight, may be correlated. The covariance is White's sandwich estimator over clusters."""
    optimize = extra("scipy.optimize", "`mebots identify`", "scipy", "flight")
    found = optimize.least_squares(residuals, start, jac=jacobian, bounds=(low, high), x_scale="jac", xtol=1e-5, ftol=1e-6)
    slopes, errors = found.jac, found.fun
    names, place = np.unique(clusters, return_inverse=True)
    scores = np.zeros((len(names), slopes.shape[1]))
    np.add.at(scores, place, slopes * errors[:, None])
    inverse = np.linalg.pinv(slopes.T @ slopes)
    count = len(names)
    covariance = inverse @ (scores.T @ scores) @ inverse * count / max(count - 1, 1)
    return Fit(found.x, covariance, errors, max(count - 1, 1))


def clusters_of(logs: np.ndarray, blocks: np.ndarray) -> np.ndarray:
    """Assigns residuals to clusters: one cluster per log for four logs or more, otherwise one per block of a log."""
    if len(np.unique(logs)) >= 4:
        return logs
    return np.unique(np.column_stack([logs, blocks]), axis=0, return_inverse=True)[1].reshape(-1)
