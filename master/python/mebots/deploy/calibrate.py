# SPDX-License-Identifier: Apache-2.0
"""Runs a float model on pictures, and collects the ranges of its tensors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from mebots.deploy.model_file import Model
from mebots.errors import InputError
from mebots.extras import extra

_BINS = 2048


class FloatModel:
    """Runs a model in onnxruntime. All tensors in ``names`` become outputs."""

    def __init__(self, model: Model, names: Iterable[str]) -> None:
        onnx = extra("onnx", "`mebots deploy`", "onnx", "deploy")
        runtime = extra("onnxruntime", "`mebots deploy`", "onnxruntime", "deploy")
        self._input = next(one.name for one in model.proto.graph.input if one.name not in model.constants)
        self.names = list(dict.fromkeys(names))
        proto = onnx.ModelProto()
        proto.CopyFrom(model.proto)
        del proto.graph.output[:]
        proto.graph.output.extend(onnx.helper.make_empty_tensor_value_info(name) for name in self.names)
        options = runtime.SessionOptions()
        options.intra_op_num_threads = 1
        options.log_severity_level = 4  # onnxruntime also raises its errors as exceptions
        runtime.set_default_logger_severity(4)
        self._path = model.path
        options.graph_optimization_level = runtime.GraphOptimizationLevel.ORT_DISABLE_ALL
        try:
            self._session = runtime.InferenceSession(proto.SerializeToString(), options, providers=["CPUExecutionProvider"])
        except Exception as error:  # onnxruntime raises its own classes
            raise InputError(f"{model.path}: onnxruntime cannot run it: {_one_line(error)}", "invalid_model") from error

    def run(self, values: np.ndarray) -> dict[str, np.ndarray]:
        """Computes the tensors. ``values`` must have the shape in ONNX, including the batch."""
        try:
            results = self._session.run(self.names, {self._input: values.astype(np.float32)})
        except Exception as error:  # onnxruntime raises its own classes
            raise InputError(f"{self._path}: onnxruntime cannot run it: {_one_line(error)}", "invalid_model") from error
        return dict(zip(self.names, results, strict=True))


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())[:300]


class Ranges:
    """Collects the minimum and maximum of tensors. With a percentile, also collects histograms of their magnitudes."""

    def __init__(self, percentile: float | None, divisors: Mapping[str, np.ndarray]) -> None:
        """``divisors`` maps tensors to the numbers by which their channels are divided."""
        self._percentile = percentile
        self._divisors = divisors
        self._least: dict[str, float] = {}
        self._greatest: dict[str, float] = {}
        self._samples: dict[str, list[np.ndarray]] = {}

    def add(self, values: dict[str, np.ndarray]) -> None:
        for name, array in values.items():
            if not np.isfinite(array).all():
                raise InputError(f"tensor {name} has a value that is not finite for a calibration picture. Check the scale of the input", "invalid_model")
            if name in self._divisors:
                array = array / self._divisors[name].reshape(1, -1, *[1] * (array.ndim - 2))
            self._least[name] = min(self._least.get(name, np.inf), float(array.min()))
            self._greatest[name] = max(self._greatest.get(name, -np.inf), float(array.max()))
            if self._percentile is not None:
                self._samples.setdefault(name, []).append(_quantiles(array))

    def range_of(self, name: str) -> tuple[float, float]:
        if self._percentile is None:
            return self._least[name], self._greatest[name]
        merged = np.concatenate(self._samples[name])
        rest = (100 - self._percentile) / 2
        low, high = np.percentile(merged, [rest, 100 - rest])
        return float(low), float(high)


def _quantiles(array: np.ndarray) -> np.ndarray:
    """Returns at most _BINS values that represent the distribution of a tensor's values."""
    flat = array.ravel()
    return flat if flat.size <= _BINS else np.quantile(flat, np.linspace(0, 1, _BINS))


def ranges_of(model: FloatModel, pictures: Iterator[np.ndarray], percentile: float | None, divisors: Mapping[str, np.ndarray]) -> Ranges:
    ranges = Ranges(percentile, divisors)
    for values in pictures:
        ranges.add(model.run(values))
    return ranges


def names_of(tensors: Iterable[Any]) -> list[str]:
    return [one.name for one in tensors]
