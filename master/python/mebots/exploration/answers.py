# SPDX-License-Identifier: Apache-2.0
"""Computes intervals of shares and means from counts and sums.

There are two kinds. A *fixed* interval has its confidence level if the number of missions was chosen beforehand:
Wilson's for a share (Clopper and Pearson's if a decision depends on it), Student's for a mean. A *sequence* has its
level at all numbers of missions at once, so that a study may look at the results after every round and stop at any
time. It is a mixture martingale, which by Ville's inequality exceeds 1/alpha with a probability of at most alpha
(Robbins 1970; Howard et al. 2021).

- Share: the likelihood ratio of a beta-binomial mixture against p (uniform prior),
  B(1 + s, 1 + f) / (p^s (1 - p)^f). The interval contains all p for which it is below 1/alpha. Exact for any p.
- Mean: the likelihood ratio of Student's t with an effect of distribution N(0, g) against none (Lai 1976),
  with x = t^2/(n - 1): (1 + n g)^(-1/2) ((1 + x)/(1 + x/(1 + n g)))^(n/2). Solved for x in closed form. Exact for
  normal values, a good approximation for other means of at least ten missions.
- Percentile: the number of values at or below the true percentile is a count with a known share. The interval extends
  between the order statistics that the share's interval permits. Exact for any distribution.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import statistics
from collections.abc import Callable, Iterable, Sequence

Interval = tuple[float, float]

_EFFECT = 1.0
"""g: variance of the effect, in standard deviations. Large differences are detected after few missions."""


def wilson(successes: int, count: int, error: float) -> Interval:
    """Returns Wilson's score interval of a share at the level 1 - error, for a count that was chosen beforehand."""
    if count == 0:
        return 0.0, 1.0
    z = statistics.NormalDist().inv_cdf(1 - error / 2)
    share = successes / count
    centre = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    low = 0.0 if successes == 0 else max(0.0, centre - half)
    return low, 1.0 if successes == count else min(1.0, centre + half)


def exact_share(successes: int, count: int, error: float) -> Interval:
    """Returns Clopper and Pearson's interval of a share, for a count that was chosen beforehand. For any true share, each end is wrong with
    a probability of at most half of ``error``."""
    middle = successes / count if count else 0.0
    low = high = None
    if successes > 0:
        low = _edge(lambda p: _incomplete_beta(successes, count - successes + 1, p) <= error / 2, 0.0, middle)
    if successes < count:
        high = _edge(lambda p: 1 - _incomplete_beta(successes + 1, count - successes, p) <= error / 2, 1.0, middle)
    return low or 0.0, 1.0 if high is None else high


def share_evidence(successes: int, count: int, share: float) -> float:
    """Returns the logarithm of the evidence against the hypothesis that the true share is ``share``: the likelihood of the beta-binomial
    mixture divided by that of ``share``."""
    failures = count - successes
    mixture = math.lgamma(1 + successes) + math.lgamma(1 + failures) - math.lgamma(2 + count)
    return mixture - _times_log(successes, share) - _times_log(failures, 1 - share)


def share_sequence(successes: int, count: int, error: float) -> Interval:
    """Returns an interval for a share. With a probability of at least 1 - error, the intervals for all counts contain the share."""
    if count == 0:
        return 0.0, 1.0
    bound = -math.log(error)
    middle = successes / count
    low = 0.0 if successes == 0 else _edge(lambda p: share_evidence(successes, count, p) >= bound, 0.0, middle)
    high = 1.0 if successes == count else _edge(lambda p: share_evidence(successes, count, p) >= bound, 1.0, middle)
    return low, high


def _times_log(count: int, p: float) -> float:
    if count == 0:
        return 0.0
    return count * math.log(p) if p > 0 else -math.inf


def _edge(outside: Callable[[float], bool], far: float, near: float) -> float:
    """Searches between ``far``, which is outside, and ``near``, which is inside. Returns the outside point that is nearest to ``near``."""
    for _ in range(60):
        middle = (far + near) / 2
        if outside(middle):
            far = middle
        else:
            near = middle
    return far


@dataclasses.dataclass
class Moments:
    """Count, mean and sum of squared deviations, updated value by value (Welford)."""

    count: int = 0
    mean: float = 0.0
    squares: float = 0.0

    def add(self, values: Iterable[float]) -> Moments:
        """Adds values in order. Returns this object."""
        count, mean, squares = self.count, self.mean, self.squares
        for value in values:
            count += 1
            step = value - mean
            mean += step / count
            squares += step * (value - mean)
        self.count, self.mean, self.squares = count, mean, squares
        return self

    @property
    def deviation(self) -> float:
        """Returns the standard deviation. Returns 0 for fewer than two values."""
        return math.sqrt(self.squares / (self.count - 1)) if self.count > 1 else 0.0


def student(moments: Moments, error: float) -> Interval:
    """Returns Student's interval of a mean at the level 1 - error, for a count that was chosen beforehand."""
    if moments.count < 2:
        return -math.inf, math.inf
    half = t_quantile(1 - error / 2, moments.count - 1) * moments.deviation / math.sqrt(moments.count)
    return moments.mean - half, moments.mean + half


def mean_sequence(moments: Moments, error: float) -> Interval:
    """Returns an interval for a mean. With a probability of at least 1 - error, the intervals for all counts contain
    the mean."""
    n = moments.count
    if n < 2:
        return -math.inf, math.inf
    spread = 1 + n * _EFFECT
    # With x = t^2/(n - 1), the likelihood ratio at the top of this file is 1/error if (1 + x) = k (1 + x/spread).
    log_k = (math.log(spread) - 2 * math.log(error)) / n
    if log_k >= math.log(spread):
        return -math.inf, math.inf
    k = math.exp(log_k)
    x = (k - 1) / (1 - k / spread)
    half = moments.deviation * math.sqrt((n - 1) * x / n)
    return moments.mean - half, moments.mean + half


def percentile_of(ordered: Sequence[float], percentile: float) -> float:
    """Returns the percentile by the nearest rank: the smallest value that at least this share of the values does not exceed."""
    return ordered[max(math.ceil(percentile / 100 * len(ordered)), 1) - 1]


def percentile_interval(ordered: Sequence[float], percentile: float, error: float) -> Interval:
    """Returns the interval of a percentile at the level 1 - error. The number of values must have been chosen beforehand. By the binomial
    distribution, each end is wrong with a probability of at most half of ``error``."""
    count, share = len(ordered), percentile / 100
    below, chance = 0, _binomial(0, count, share)
    while chance <= error / 2 and below < count:
        below += 1
        chance += _binomial(below, count, share)
    above, chance = count, _binomial(count, count, share)
    while chance <= error / 2 and above > 0:
        above -= 1
        chance += _binomial(above, count, share)
    return _between_ranks(ordered, below, above)


def percentile_sequence(ordered: Sequence[float], percentile: float, error: float) -> Interval:
    """Returns an interval for a percentile. With a probability of at least 1 - error, the intervals for all counts
    contain the percentile."""
    count, share, bound = len(ordered), percentile / 100, -math.log(error)
    possible = [at for at in range(count + 1) if share_evidence(at, count, share) < bound]
    return _between_ranks(ordered, possible[0], possible[-1])


def _between_ranks(ordered: Sequence[float], fewest: int, most: int) -> Interval:
    """Returns the interval of the percentile if between ``fewest`` and ``most`` of the ordered values are at or below the true
    percentile."""
    low = ordered[fewest - 1] if fewest > 0 else -math.inf
    return low, ordered[most] if most < len(ordered) else math.inf


def _binomial(successes: int, count: int, share: float) -> float:
    """Returns the probability of exactly this number of successes."""
    ways = math.lgamma(count + 1) - math.lgamma(successes + 1) - math.lgamma(count - successes + 1)
    return math.exp(ways + _times_log(successes, share) + _times_log(count - successes, 1 - share))


@functools.lru_cache(4096)
def t_quantile(p: float, freedom: int) -> float:
    """Returns the quantile of Student's t distribution. ``p`` must be above one half."""
    low, high = 0.0, 1.0
    while _t_distribution(high, freedom) < p:
        high *= 2
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if _t_distribution(middle, freedom) < p else (low, middle)
    return (low + high) / 2


def _t_distribution(t: float, freedom: int) -> float:
    return 1 - 0.5 * _incomplete_beta(freedom / 2, 0.5, freedom / (freedom + t * t))


def _incomplete_beta(a: float, b: float, x: float) -> float:
    """Returns the regularised incomplete beta function by its continued fraction (Lentz)."""
    if x <= 0 or x >= 1:
        return float(x >= 1)
    if x > (a + 1) / (a + b + 2):
        return 1 - _incomplete_beta(b, a, 1 - x)
    front = math.exp(
        math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)
    ) / a
    c, d = 1.0, 1 / (1 - (a + b) * x / (a + 1))
    fraction = d
    for m in range(1, 300):
        for numerator in (
            m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)),
        ):
            d = 1 / (1 + numerator * d)
            c = 1 + numerator / c
            fraction *= d * c
        if abs(d * c - 1) < 1e-15:
            break
    return front * fraction
