# SPDX-License-Identifier: Apache-2.0
"""Computes the influence of factors by SALib: Sobol indices and Morris' elementary effects."""

from __future__ import annotations

import pathlib
from typing import Any

from mebots.exploration import tables
from mebots.exploration.comparison import Evidence
from mebots.extras import extra
from mebots.exploration.files import write_csv
from mebots.exploration.study import Study

_COLUMNS = {"sobol": ("S1", "S1_conf", "ST", "ST_conf"), "morris": ("mu", "mu_star", "mu_star_conf", "sigma")}


def sample(study: Study) -> Any:
    """Returns the samples of the method with a row per design and a column per factor. Each value is a quantile from 0 to 1."""
    method, count, seed = study.design["method"], study.design["points"], study.design.get("seed", 0)
    module = extra(f"SALib.sample.{method}", "a design 'sensitivity'", "SALib")
    more = {"calc_second_order": False} if method == "sobol" else {}
    return module.sample(_problem(study), count, seed=seed, **more)


def write(file: pathlib.Path, study: Study, evidence: Evidence) -> None:
    """Writes the result of ``rows`` as a CSV file."""
    write_csv(file, rows(study, evidence))


def rows(study: Study, evidence: Evidence) -> list[list[str]]:
    """Returns the sensitivity indices as a table: a row of titles, then a row for each pair of an objective and a factor. Omits an
    objective if a design has no value for it."""
    method = study.design["method"]
    found = [["objective", "factor", *_COLUMNS[method]]]
    points = sample(study)
    for objective in study.objectives:
        means = [evidence.shown(design, objective).mean for design in range(len(points))]
        if None in means:
            continue
        indices = _analysed(study, points, means)
        for number, factor in enumerate(study.design["factors"]):
            found.append([objective.label, factor, *(tables.cell(float(indices[column][number])) for column in _COLUMNS[method])])
    return found


def _analysed(study: Study, points: Any, means: list[Any]) -> Any:
    import numpy as np

    method = study.design["method"]
    module = extra(f"SALib.analyze.{method}", "a design 'sensitivity'", "SALib")
    values = np.array(means, dtype=float)
    if method == "sobol":
        return module.analyze(_problem(study), values, calc_second_order=False, seed=0)
    return module.analyze(_problem(study), points, values, seed=0)


def _problem(study: Study) -> dict[str, Any]:
    names = list(study.design["factors"])
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
