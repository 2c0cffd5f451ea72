# SPDX-License-Identifier: Apache-2.0
"""Computes effects of factors: the mean of the designs at each level of a factor or pair of factors, and the shares of variance that
factors and pairs explain."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np

from mebots.exploration.figures import Units, number, quantity, scale_of
from mebots.exploration.study import Study, Values

_MOST_VALUES = 12
"""A factor with more values is divided into parts with equal numbers of designs."""
_PARTS = 5
_MOST_CELLS = 40_000
"""The maximum number of cells of all tables of pairs of factors. If there are more, pairs are left out, the last pairs
first."""
_GENERAL = ("file", "kind", "mode", "name", "seed", "value")
_SAMPLED = ("latin_hypercube", "random", "sobol", "sensitivity", "search")
"""Kinds of designs that do not contain each combination of levels: part of the effect of a factor may be due to
chance."""


@dataclasses.dataclass(frozen=True)
class Factor:
    """A factor. ``levels`` are texts for readers, and ``level`` contains for each design the index of its level. ``scale`` converts values
    to the displayed unit."""

    name: str
    label: str
    unit: str
    scale: float
    values: list[Any]
    levels: list[str]
    level: np.ndarray

    @property
    def is_number(self) -> bool:
        return all(_is_number(value) for value in self.values)


def factors_of(names: Sequence[str], designs: Sequence[Values], units: Units) -> list[Factor]:
    """Returns the factors with the values that occur in the designs as their levels."""
    labels = short_names(names)
    return [_factor(name, label, [design[name] for design in designs], units.of_factor(name)) for name, label in zip(names, labels, strict=True)]


def short_names(names: Sequence[str]) -> list[str]:
    """Returns the last part of each name, with as many preceding parts as make it unique. If the last part is a general word such as
    "name", adds at least one preceding part."""

    def ending(name: str, parts: int) -> str:
        return name.removeprefix("/") if name.startswith("/") else ".".join(name.split(".")[-parts:])

    result = []
    for name in names:
        parts = 2 if name.rpartition(".")[2] in _GENERAL else 1
        while parts < name.count(".") + 1 and sum(ending(other, parts) == ending(name, parts) for other in names) > 1:
            parts += 1
        result.append(ending(name, parts))
    return result


def _factor(name: str, label: str, values: list[Any], unit: str) -> Factor:
    distinct = list(dict.fromkeys(values))
    if all(_is_number(value) for value in values):
        scale, shown = scale_of(unit, distinct)
        distinct.sort()
        if len(distinct) > _MOST_VALUES:
            return Factor(name, label, shown, scale, values, *_parts(np.array(values, float), scale, shown))
        names = [" ".join(filter(None, (number(value * scale), shown))) for value in distinct]
    else:
        scale, shown = 1.0, ""
        names = [quantity(value) for value in distinct]
    place = {repr(value): at for at, value in enumerate(distinct)}
    return Factor(name, label, shown, scale, values, names, np.array([place[repr(value)] for value in values]))


def _parts(values: np.ndarray, scale: float, unit: str) -> tuple[list[str], np.ndarray]:
    """Divides values into parts with equal numbers of values. Returns the names of the parts, and the part of each value."""
    edges = np.unique(np.quantile(values, np.linspace(0, 1, _PARTS + 1)))
    names = [" ".join(filter(None, (f"{number(low * scale, 3)} to {number(high * scale, 3)}", unit))) for low, high in itertools.pairwise(edges)]
    return names, np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(names) - 1)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def level_means(factor: Factor, values: np.ndarray) -> list[float | None]:
    """Returns the mean of the designs at each level, or None for a level without values. All designs have the same weight."""
    return _means(factor.level, len(factor.levels), values)


def pair_means(pair: tuple[Factor, Factor], values: np.ndarray) -> list[float | None]:
    """Returns the mean of the designs at each combination of levels. The second factor varies fastest."""
    first, second = pair
    return _means(first.level * len(second.levels) + second.level, len(first.levels) * len(second.levels), values)


def _means(cells: np.ndarray, count: int, values: np.ndarray) -> list[float | None]:
    known = ~np.isnan(values)
    sums = np.bincount(cells[known], values[known], count)
    counts = np.bincount(cells[known], minlength=count)
    return [float(total / each) if each else None for total, each in zip(sums, counts, strict=True)]


def pairs_of(factors: Sequence[Factor]) -> list[tuple[int, int]]:
    """Returns the pairs of factors with more than one level, as indices. Stops before the pairs together have more than ``_MOST_CELLS``
    combinations of levels."""
    varied = [at for at, factor in enumerate(factors) if len(factor.levels) > 1]
    result, cells = [], 0
    for first, second in itertools.combinations(varied, 2):
        cells += len(factors[first].levels) * len(factors[second].levels)
        if cells > _MOST_CELLS:
            break
        result.append((first, second))
    return result


@dataclasses.dataclass(frozen=True)
class Importances:
    """Shares of the variance of the designs' values. The share of a factor is the variance that it explains in addition to all other
    factors. The share of a pair is the variance that it explains in addition to all factors. The common effect of factors that change
    together is in no share."""

    factors: list[float]
    pairs: list[float]


def importances(study: Study, factors: Sequence[Factor], pairs: Sequence[tuple[int, int]], values: np.ndarray) -> Importances | None:
    """Returns the importances, or None if all designs have the same value. If designs are a sample of their space, subtracts the share due
    to chance, estimated from the variance that all factors together do not explain."""
    known = ~np.isnan(values)
    own = values[known] - values[known].mean() if known.any() else values[known]
    total = float(own @ own)
    if total <= 1e-18 * max(1.0, float(values[known] @ values[known])):
        return None
    levels = [_indicators(factor.level[known]) for factor in factors]
    every = _basis(levels)
    rest = own - every @ (every.T @ own)
    freedom = len(own) - 1 - every.shape[1]
    noise = float(rest @ rest) / freedom if study.design["kind"] in _SAMPLED and freedom > 0 else 0.0

    def share(squares: float, freedom: int) -> float:
        return min(1.0, max(0.0, (squares - freedom * noise) / total))

    def of_factor(at: int) -> float:
        others = _basis(levels[:at] + levels[at + 1 :])
        return share(_squares(every, own) - _squares(others, own), every.shape[1] - others.shape[1])

    def of_pair(first: int, second: int) -> float:
        cells = factors[first].level[known] * len(factors[second].levels) + factors[second].level[known]
        beyond = _indicators(cells)
        beyond = _basis([beyond - every @ (every.T @ beyond)])
        return share(_squares(beyond, rest), beyond.shape[1])

    return Importances([of_factor(at) for at in range(len(factors))], [of_pair(*pair) for pair in pairs])


def _indicators(cells: np.ndarray) -> np.ndarray:
    """Returns a column for each distinct value of ``cells``: 1 for designs with this value and 0 for others, shifted to the mean zero."""
    columns = (cells[:, None] == np.unique(cells)[None, :]).astype(float)
    return columns - columns.mean(axis=0)


def _basis(parts: Sequence[np.ndarray]) -> np.ndarray:
    """Returns an orthonormal basis of the space that all columns in ``parts`` span."""
    matrix = np.concatenate(parts, axis=1) if parts else np.empty((0, 0))
    if matrix.size == 0:
        return np.zeros((len(matrix), 0))
    vectors, sizes, _ = np.linalg.svd(matrix, full_matrices=False)
    return vectors[:, sizes > 1e-9 * max(1.0, float(sizes[0]))]


def _squares(basis: np.ndarray, values: np.ndarray) -> float:
    """Returns the part of the sum of squares of ``values`` that an orthonormal basis explains."""
    found = basis.T @ values if basis.shape[1] else np.zeros(0)
    return float(found @ found)
