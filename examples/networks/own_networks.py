#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes MEbots' networks as ONNX, each with pictures for the calibration (.npy): navigator and sight, which are shipped as
firmware, and the sight network with three quarters and with half of the channels (narrower.py).

Their weights are whole numbers, so the float model has nearly the values of the firmware's kernels."""

import argparse
import pathlib
import typing

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

ROOT = pathlib.Path(__file__).resolve().parents[2]
EDGE = 168
STRIDES = (2, 2, 1, 2, 1, 2, 1)
FIRMWARE = "fmu_soc/firmware/nn"  # contains shape.h with the shapes of the networks
HERE = "examples/networks"


class Known(typing.NamedTuple):
    """A network to write. ``channels`` are the channels of the convolutions. ``pictures`` is the name of the training's golden
    pictures, which are used for the calibration."""

    folder: str
    channels: tuple
    outputs: int
    pictures: str


NETWORKS = {
    "navigator": Known(FIRMWARE, (4, 4, 4, 16, 16, 32, 32), 1, "golden"),
    "sight": Known(FIRMWARE, (8, 8, 8, 16, 16, 32, 32), 4, "sight_golden"),
    "sight_three_quarters": Known(HERE, (6, 6, 6, 12, 12, 24, 24), 4, "sight_golden"),
    "sight_half": Known(HERE, (4, 4, 4, 8, 8, 16, 16), 4, "sight_golden"),
}


def read_layers(name):
    """Reads a file of export.py. Returns weights (out, in, rows, columns), biases and shifts of each layer.
    """
    folder, channels, outputs, _ = NETWORKS[name]
    content = (ROOT / folder / f"{name}.weights").read_bytes()
    at = 0

    def take(count, kind):
        nonlocal at
        values = np.frombuffer(content, kind, count, at)
        at += (values.nbytes + 3) // 4 * 4
        return values

    layers = []
    before = 1
    for number, out in enumerate((*channels, outputs)):
        kernel = 6 if number == len(channels) else 5 if number == 0 else 3
        biases, shifts = take(out, "<i4"), take(out, "u1")
        weights = take(out * kernel * kernel * before, "i1").reshape(out, kernel, kernel, before)
        layers.append((weights.transpose(0, 3, 1, 2), biases, shifts))
        before = out
    return layers


def scaled(layer, step_in, step_out):
    """Returns the layer's weights and bias in float, for these step sizes of input and output. The biases in the file include
    half a unit for rounding. The result does not."""
    weights, biases, shifts = layer
    factor = 2.0 ** -shifts.astype(float) * step_out
    half = 2.0 ** (shifts.astype(float) - 1)
    return (weights * (factor / step_in)[:, None, None, None]).astype(np.float32), ((biases - half) * factor).astype(np.float32)


def model(name):
    """Returns the network as an ONNX model in float. Its input is grey levels / 255 - 128 / 255. Its outputs are in [-1, 1]."""
    layers = read_layers(name)
    nodes = []
    constants = [numpy_helper.from_array(np.float32(value), key) for key, value in (("least", 0), ("most", 1))]
    source, step = "picture", 1 / 255
    for number, layer in enumerate(layers):
        last = number == len(layers) - 1
        weights, bias = scaled(layer, step, 1 / 127 if last else 1 / 255)
        step = 1 / 255
        if last:
            nodes.append(helper.make_node("Flatten", [source], ["flat"], name="flatten"))
            source, weights = "flat", weights.reshape(len(weights), -1)
        constants += [numpy_helper.from_array(weights, f"w{number}"), numpy_helper.from_array(bias, f"b{number}")]
        if last:
            nodes.append(helper.make_node("Gemm", [source, f"w{number}", f"b{number}"], ["outputs"], name="dense", transB=1))
            break
        border = weights.shape[2] // 2
        geometry = {"strides": [STRIDES[number]] * 2, "pads": [border] * 4, "kernel_shape": list(weights.shape[2:])}
        nodes.append(helper.make_node("Conv", [source, f"w{number}", f"b{number}"], [f"c{number}"], name=f"conv{number}", **geometry))
        nodes.append(helper.make_node("Clip", [f"c{number}", "least", "most"], [f"r{number}"], name=f"clip{number}"))
        source = f"r{number}"
        if number == 0:
            nodes.append(helper.make_node("MaxPool", [source], ["pooled"], name="pool", kernel_shape=[2, 2], strides=[2, 2]))
            source = "pooled"
    picture = helper.make_tensor_value_info("picture", TensorProto.FLOAT, [1, 1, EDGE, EDGE])
    outputs = helper.make_tensor_value_info("outputs", TensorProto.FLOAT, [1, NETWORKS[name].outputs])
    made = helper.make_model(helper.make_graph(nodes, name, [picture], [outputs], constants), opset_imports=[helper.make_opsetid("", 17)])
    made.ir_version = 8
    return made


def with_all_levels(pictures):
    """Returns pictures that contain the darkest and the brightest grey level, because `mebots deploy` computes the input's scale from the
    pictures. If a level is missing, adds a copy of the first picture with both levels in its corners."""
    if pictures.min() == -128 and pictures.max() == 127:
        return pictures
    added = pictures[:1].copy()
    added[0, 0, 0, 0], added[0, 0, -1, -1] = -128, 127
    return np.concatenate([pictures, added])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for name, known in NETWORKS.items():
        onnx.save(model(name), folder / f"{name}.onnx")
        pictures = np.fromfile(ROOT / f"examples/paper/training/{known.pictures}.pictures", np.int8).reshape(-1, 1, EDGE, EDGE)
        pictures = with_all_levels(pictures)
        np.save(folder / f"{name}.npy", pictures.astype(np.float32) / 255)
        print(f"{folder / name}.onnx, {folder / name}.npy: {len(pictures)} pictures")


if __name__ == "__main__":
    main()
