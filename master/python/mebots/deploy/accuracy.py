# SPDX-License-Identifier: Apache-2.0
"""Compares a deployed network with the model in float, and both with labels. All intervals have the confidence level 95 %. Intervals of
shares are Wilson's, intervals of errors are bootstrap percentiles over the pictures."""

from __future__ import annotations

import dataclasses
import pathlib
from typing import Any

import numpy as np

from mebots.deploy import layers as integers
from mebots.deploy.c_files import output_names
from mebots.deploy.deployed import Deployed, Options
from mebots.deploy.labels import CLASS, Labels, read_labels
from mebots.deploy.pictures import Pictures
from mebots.exploration.answers import wilson

_ERROR = 0.05  # 1 - level
_REPETITIONS = 2000

Values = dict[str, np.ndarray]
"""The values of each output: an array of shape [pictures, values]."""


@dataclasses.dataclass(frozen=True)
class Outputs:
    floats: Values | None  # None if the model is an integer network
    integers: Values


@dataclasses.dataclass(frozen=True)
class Comparison:
    """The pictures on which a network is judged."""

    pictures: Pictures
    numbers: list[int]
    labels: Labels | None


def comparison(deployed: Deployed, options: Options) -> Comparison:
    """Returns the pictures of ``options.validate``, or the pictures of the calibration without this option. If there are labels, the
    result contains only the labelled pictures."""
    pictures = deployed.pictures
    if options.validate is not None:
        pictures = Pictures(pathlib.Path(options.validate), deployed.graph.inputs[0], options.crop, deployed.model.whole)
    labels = None
    if options.labels is not None:
        sizes = {name: tensor.size for name, tensor in zip(output_names(deployed.network), deployed.network.outputs, strict=True)}
        labels = read_labels(pathlib.Path(options.labels), pictures, sizes)
    return Comparison(pictures, pictures.chosen(options.pictures) if labels is None else labels.numbers, labels)


def outputs_of(deployed: Deployed, compared: Comparison) -> Outputs:
    names = output_names(deployed.network)
    rows: list[list[np.ndarray]] = []
    real: list[list[np.ndarray]] = []
    for number in compared.numbers:
        stored = compared.pictures.one(number, deployed.scale)
        values = integers.run(deployed.network, stored)
        rows.append([deployed.network.scales[one].real(one.view(values[one])).ravel() for one in deployed.network.outputs])
        if deployed.float_model is not None:
            floats = deployed.float_model.run(compared.pictures.real(stored, deployed.scale))
            real.append([floats[one.name].ravel().astype(np.float64) for one in deployed.graph.outputs])
    return Outputs(_by_name(names, real) if real else None, _by_name(names, rows))


def _by_name(names: list[str], rows: list[list[np.ndarray]]) -> Values:
    return {name: np.stack([row[i] for row in rows]) for i, name in enumerate(names)}


def difference(of: Values, to: Values) -> dict[str, Any]:
    """Returns for each output the root mean square difference with its interval, and the standard deviation of ``to``."""
    return {name: {**_root_mean_square(of[name] - values), "deviation": float(values.std())} for name, values in to.items()}


def _root_mean_square(errors: np.ndarray) -> dict[str, Any]:
    squares = np.square(errors).reshape(len(errors), -1).mean(axis=1)
    low, high = _resampled(squares)
    return {"error": float(np.sqrt(squares.mean())), "interval": [float(np.sqrt(low)), float(np.sqrt(high))]}


def _resampled(*rows: np.ndarray) -> tuple[float, ...]:
    """Returns the bootstrap interval of the mean of a row. For two rows, returns the interval of the difference of the roots of their
    means."""
    random = np.random.default_rng(1)
    means = []
    for _ in range(_REPETITIONS):
        chosen = random.integers(0, len(rows[0]), len(rows[0]))
        each = [row[chosen].mean() for row in rows]
        means.append(each[0] if len(each) == 1 else np.sqrt(each[0]) - np.sqrt(each[1]))
    return tuple(float(one) for one in np.percentile(means, [50 * _ERROR, 100 - 50 * _ERROR]))


def accuracy_of(outputs: Outputs, compared: Comparison) -> dict[str, Any]:
    """Returns the member "accuracy" of network.json."""
    result: dict[str, Any] = {"pictures": len(compared.numbers), "data": compared.pictures.path.name}
    if outputs.floats is not None:
        result["float"] = difference(outputs.integers, outputs.floats)
    if compared.labels is not None:
        result["labels"] = {"file": compared.labels.path.name, "outputs": {name: _against(name, outputs, labels) for name, labels in compared.labels.columns.items()}}
    return result


def _against(name: str, outputs: Outputs, labels: np.ndarray) -> dict[str, Any]:
    """Compares outputs with labels. For classes, counts correct pictures. If all labels are 0 or 1, compares with the threshold 1/2."""
    both = {"int8": outputs.integers} | ({} if outputs.floats is None else {"float": outputs.floats})
    if name == CLASS:
        right = {kind: next(iter(values.values())).argmax(axis=1) == labels for kind, values in both.items()}
    elif np.isin(labels, (0, 1)).all():
        right = {kind: (values[name][:, 0] > 0.5) == (labels > 0.5) for kind, values in both.items()}
    else:
        squares = {kind: np.square(values[name][:, 0] - labels) for kind, values in both.items()}
        result: dict[str, Any] = {kind: _root_mean_square(values[name][:, 0] - labels) for kind, values in both.items()}
        if "float" in both:
            loss = result["int8"]["error"] - result["float"]["error"]
            result["loss"] = {"error": loss, "interval": list(_resampled(squares["int8"], squares["float"]))}
        return result
    result = {kind: {"share": float(one.mean()), "interval": list(wilson(int(one.sum()), len(one), _ERROR))} for kind, one in right.items()}
    if "float" in both:
        result["loss"] = _loss(right["float"], right["int8"])
    return result


def _loss(before: np.ndarray, after: np.ndarray) -> dict[str, Any]:
    """Returns the decrease of the share of correct pictures from ``before`` to ``after``. Its interval combines the intervals of two
    shares, each with half of the error probability: pictures that are correct only before, and pictures that are correct only after. It may
    be too wide, but not too narrow."""
    lost, gained = (int((a & ~b).sum()) for a, b in ((before, after), (after, before)))
    (least_lost, most_lost), (least_gained, most_gained) = (wilson(one, len(before), _ERROR / 2) for one in (lost, gained))
    return {"share": (lost - gained) / len(before), "interval": [least_lost - most_gained, most_lost - least_gained]}


def shown(accuracy: dict[str, Any], indent: str = "") -> list[str]:
    """Returns the accuracy as lines for the terminal."""
    lines = []
    if "without_equalisation" in accuracy:
        lines = [f"{indent}without equalisation:", *shown(accuracy["without_equalisation"], f"{indent}  ")]
    for name, one in accuracy.get("float", {}).items():
        low, high = one["interval"]
        lines.append(f"{indent}{name}: differs from float by {one['error']:.3g} (root mean square; 95 %: {low:.3g} to {high:.3g}), standard deviation {one['deviation']:.3g}")
    for name, kinds in accuracy.get("labels", {}).get("outputs", {}).items():
        lines.append(f"{indent}{name}: " + "; ".join(f"{kind} {_shown(kinds[kind])}" for kind in ("float", "int8", "loss") if kind in kinds))
    return lines


def _shown(value: dict[str, Any]) -> str:
    low, high = value["interval"]
    if "share" in value:
        return f"{100 * value['share']:.1f} % (95 %: {100 * low:.1f} to {100 * high:.1f})"
    return f"error {value['error']:.3g} (95 %: {low:.3g} to {high:.3g})"
