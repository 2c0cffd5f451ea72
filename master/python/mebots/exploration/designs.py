# SPDX-License-Identifier: Apache-2.0
"""The designs that a study compares. A table contains a function for each kind of design."""

from __future__ import annotations

import itertools
import json
import math
import pathlib
from collections.abc import Callable
from typing import Any

from mebots import _mebots
from mebots.errors import InputError
from mebots.exploration import chance, sensitivity
from mebots.extras import extra
from mebots.exploration.study import Study, Values

MOST = 10_000_000


def designs_of(study: Study) -> list[Values]:
    """Returns all designs in order. Raises InputError if there are none or too many."""
    kind = study.design["kind"]
    found = KINDS[kind](study)
    conditions = study.design.get("conditions", [])
    kept = [design for design in found if all(_fits(one, design) for one in conditions)]
    if not kept and kind != "search":
        raise InputError(f"{study.place}: the conditions exclude every design", "invalid_value")
    return kept


def levels(spread: Any) -> list[Any]:
    """Returns the values of a grid's factor: those of its list, or the names of its options."""
    return list(spread["options"]) if isinstance(spread, dict) else list(spread)


def _grid(study: Study) -> list[Values]:
    factors = study.design["factors"]
    choices = [levels(spread) for spread in factors.values()]
    count = math.prod(len(choice) for choice in choices)
    if count > MOST:
        raise InputError(f"{study.place}: the grid has {count} designs; at most {MOST} are possible", "value_out_of_range")
    return [dict(zip(factors, values, strict=True)) for values in itertools.product(*choices)]


def _list(study: Study) -> list[Values]:
    file = pathlib.Path(study.design["file"])
    try:
        names, *rows = _mebots.read_csv(file)
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: this is not a CSV file in UTF-8: {error}. Save it as one", "syntax_error") from None
    if not rows:
        raise InputError(f"{file}: a row of names and at least one design are needed", "syntax_error")
    return [{name: _cell(text) for name, text in zip(names, row, strict=True)} for row in rows]


def _cell(text: str) -> Any:
    """Returns the number or Boolean in a text, or the text itself."""
    try:
        value = json.loads(text)
    except ValueError:
        return text
    return value if isinstance(value, (bool, int, float)) and math.isfinite(value) else text


def _random(study: Study) -> list[Values]:
    return _from_units(study, lambda name, i, count, seed: chance.unit(seed, "design/" + name, i))


def _latin_hypercube(study: Study) -> list[Values]:
    """Divides each factor's range into as many equally likely strata as designs. Each stratum has one value."""
    orders: dict[str, list[int]] = {}

    def unit(name: str, i: int, count: int, seed: int) -> float:
        if name not in orders:
            orders[name] = sorted(range(count), key=lambda j: chance.unit(seed, "order/" + name, j))
        return (orders[name][i] + chance.unit(seed, "design/" + name, i)) / count

    return _from_units(study, unit)


def _sobol(study: Study) -> list[Values]:
    """Returns designs from Sobol's sequence (SciPy), scrambled by the seed."""
    qmc = extra("scipy.stats.qmc", "a design 'sobol'", "scipy")
    factors = study.design["factors"]
    count = study.design["points"]
    sampler = qmc.Sobol(len(factors), scramble=True, seed=study.design.get("seed", 0))
    points = sampler.random_base2(max(0, math.ceil(math.log2(count))))[:count]
    columns = {name: index for index, name in enumerate(factors)}
    return _from_units(study, lambda name, i, count, seed: float(points[i][columns[name]]))


def _sensitivity(study: Study) -> list[Values]:
    """Returns designs for a method of SALib. Converts its samples in the unit cube to quantiles of the factors."""
    factors = study.design["factors"]
    return [
        {name: chance.value(spread, float(u)) for (name, spread), u in zip(factors.items(), point, strict=True)}
        for point in sensitivity.sample(study)
    ]


def _from_units(study: Study, unit: Callable[[str, int, int, int], float]) -> list[Values]:
    factors = study.design["factors"]
    count, seed = study.design["points"], study.design.get("seed", 0)
    if count > MOST:
        raise InputError(f"{count} designs; at most {MOST} are possible", "value_out_of_range")
    return [
        {name: chance.value(spread, unit(name, i, count, seed)) for name, spread in factors.items()}
        for i in range(count)
    ]


KINDS: dict[str, Callable[[Study], list[Values]]] = {
    "grid": _grid,
    "list": _list,
    "latin_hypercube": _latin_hypercube,
    "sobol": _sobol,
    "random": _random,
    "sensitivity": _sensitivity,
    "search": lambda study: [],  # a search creates designs round by round
}


def _fits(condition: dict[str, Any], design: Values) -> bool:
    """True unless the condition excludes the design: a design that matches ``when`` must also match ``only``."""
    return not _in(condition["when"], design) or _in(condition["only"], design)


def _in(subset: dict[str, Any], design: Values) -> bool:
    return all(_allows(allowed, design[name]) for name, allowed in subset.items())


def _allows(allowed: Any, value: Any) -> bool:
    if isinstance(allowed, list):
        return any(value == one and isinstance(value, bool) == isinstance(one, bool) for one in allowed)
    return allowed.get("min", -math.inf) <= value <= allowed.get("max", math.inf)
