#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Derives narrower networks from the sight network, without training. In each layer, keeps the channels from which the next layer
can be computed best. Then fits the remaining weights to the layers of the whole network by least squares.

Usage: python examples/networks/narrower.py PICTURES TEST...

PICTURES and TEST are sets of pictures of `mebots-dataset --task sight --out`. Writes sight_three_quarters.weights and
sight_half.weights next to this file, in the format of fmu_soc/firmware/nn/sight.weights. Prints the errors of all networks over
the sets TEST."""

import argparse
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
TRAINING = HERE.parent / "paper/training"
sys.path.insert(0, str(TRAINING))

import integer_network  # noqa: E402 - the path has to be known first
from integer_network import EDGE, STRIDES  # noqa: E402

WIDE = (8, 8, 8, 16, 16, 32, 32)
NARROWER = {"sight_three_quarters": (6, 6, 6, 12, 12, 24, 24), "sight_half": (4, 4, 4, 8, 8, 16, 16)}
OUTPUTS = 4
PICTURES = 500
SAMPLES = 20_000  # number of places in all pictures to which a layer is fitted
CHUNK = 50
ROUNDS = 4
RIDGE = 1e-4
PRIOR = 1e-2


def shapes(channels):
    """Returns the shapes of the weights of each layer: output, row, column, input."""
    kernels = (5, 3, 3, 3, 3, 3, 3, 6)
    return [(out, kernel, kernel, into) for out, kernel, into in zip((*channels, OUTPUTS), kernels, (1, *channels), strict=True)]


def in_float(layers):
    """Returns (weights, biases) of each layer in float, in counts of the layer's output."""
    return [(w.astype(np.float32) * 2.0 ** -s.astype(np.float32)[:, None, None, None], b * 2.0 ** -s.astype(np.float32)) for w, b, s in layers]


def in_integers(layers):
    """Converts layers to integer weights, biases and shifts. Each shift is the greatest for which the weights fit into a byte."""
    result = []
    for weights, biases in layers:
        largest = np.abs(weights).max(axis=(1, 2, 3)).clip(1e-6)
        shifts = np.floor(np.log2(127 / largest)).clip(1, 15)
        whole = np.rint(weights * 2.0 ** shifts[:, None, None, None]).clip(-127, 127).astype(np.int8)
        result.append((whole, np.rint(biases * 2.0**shifts).astype(np.int32), shifts.astype(np.uint8)))
    return result


def windows(values, kernel, stride):
    """Converts an array (pictures, rows, columns, channels) to its windows (pictures, rows, columns, window)."""
    border = kernel // 2 if kernel < 6 else 0  # the last layer's kernel covers its whole input, without a border
    padded = np.pad(values, ((0, 0), (border, border), (border, border), (0, 0)))
    seen = np.lib.stride_tricks.sliding_window_view(padded, (kernel, kernel), axis=(1, 2))[:, ::stride, ::stride]
    return seen.transpose(0, 1, 2, 4, 5, 3).reshape(*seen.shape[:3], -1)


def sums(number, layer, values):
    """Returns the values of layer `number` before they are limited. The first layer is pooled here, before its values are
    limited: the order does not change the result of a maximum."""
    weights, biases = layer
    stride = STRIDES[number] if number < len(STRIDES) else 1
    result = windows(values, weights.shape[1], stride) @ weights.reshape(len(weights), -1).T + biases
    if number == 0:
        count, rows, columns, channels = result.shape
        result = result.reshape(count, rows // 2, 2, columns // 2, 2, channels).max(axis=(2, 4))
    return result


def limited(number, values):
    return np.clip(values, 0, 255) if number < len(STRIDES) else np.clip(values, -127, 127)


def next_values(number, layer, values):
    """Returns the limited values of layer `number` for all pictures."""
    parts = [values[begin : begin + CHUNK] for begin in range(0, len(values), CHUNK)]
    return np.concatenate([limited(number, sums(number, layer, part)) for part in parts])


def pictures_of(pixels):
    return pixels.astype(np.float32)[..., np.newaxis]


def drawn(values, number, kernel, random):
    """Returns the inputs of layer `number` in windows of the kernel's size at random places, and the indices of these places."""
    stride = STRIDES[number] if number < len(STRIDES) else 1
    seen = windows(values, kernel, stride)
    places = random.integers(0, np.prod(seen.shape[:3]), min(SAMPLES, np.prod(seen.shape[:3])))
    return seen.reshape(-1, seen.shape[-1])[places].astype(np.float64), places


def solved(gram, product, prior=0.0, ridge=RIDGE):
    """Solves a least-squares problem. A ridge, relative to the scale of the values, keeps the solution close to `prior`."""
    inner = gram + ridge * np.trace(gram) / len(gram) * np.eye(len(gram))
    return prior + np.linalg.solve(inner, product - gram @ prior if np.ndim(prior) else product)


def chosen(seen, weights, keep):
    """Returns the channels of the input that are kept. Removes one channel per round: the channel whose removal impairs the fit
    of the layer least."""
    outputs, window, channels = len(weights), weights.shape[1] * weights.shape[2], weights.shape[3]
    if window > 9:  # too many unknowns for a fit, so keeps the channels that contribute most to the sums
        part = weights.reshape(outputs, window, channels) ** 2 * seen.var(axis=0).reshape(window, channels)
        return sorted(np.argsort(part.sum(axis=(0, 1)))[-keep:].tolist())
    wanted = seen @ weights.reshape(outputs, -1).T
    seen = np.column_stack([seen, np.ones(len(seen))])
    gram, product = seen.T @ seen, seen.T @ wanted
    left = list(range(channels))

    def gain(kept):
        columns = [place * channels + one for place in range(window) for one in kept] + [window * channels]
        return np.sum(product[columns] * solved(gram[np.ix_(columns, columns)], product[columns]))

    while len(left) > keep:
        left.remove(max(left, key=lambda one: gain([other for other in left if other != one])))
    return left


def fitted(seen, wanted, weights, limits):
    """Fits weights and biases, starting from `weights`. If an output and its wanted value are beyond the same limit, they count
    as equal, because the layer limits its outputs."""
    seen = np.column_stack([seen, np.ones(len(seen))])
    prior = np.vstack([weights.reshape(len(weights), -1).T, (wanted - seen[:, :-1] @ weights.reshape(len(weights), -1).T).mean(axis=0)])
    gram = seen.T @ seen
    target = wanted
    for _ in range(ROUNDS):
        result = solved(gram, seen.T @ target, prior, PRIOR)
        found = seen @ result
        same = ((found < limits[0]) & (wanted < limits[0])) | ((found > limits[1]) & (wanted > limits[1]))
        target = np.where(same, found, wanted)
    return result[:-1].T, result[-1]


def narrowed(whole, channels, pixels):
    """Returns the layers of a narrower network. `channels` contains the numbers of channels."""
    random = np.random.default_rng(1)
    narrow = []
    wide = mine = pictures_of(pixels)  # inputs of the present layer in the whole and in the narrower network
    kept = [0]
    for number, shape in enumerate(shapes(channels)):
        after = next_values(number, whole[number], wide)
        keep = list(range(OUTPUTS))
        if number < len(STRIDES):
            following = whole[number + 1][0]
            keep = chosen(drawn(after, number + 1, following.shape[1], random)[0], following, channels[number])
        weights, biases = (one[keep] for one in whole[number])
        if number > 0:
            seen, places = drawn(wide, number, shape[1], random)
            wanted = seen @ weights.reshape(len(weights), -1).T + biases
            seen = windows(mine, shape[1], STRIDES[number] if number < len(STRIDES) else 1)
            seen = seen.reshape(-1, seen.shape[-1])[places].astype(np.float64)
            weights, biases = fitted(seen, wanted, weights[..., kept], (0, 255) if number < len(STRIDES) else (-127, 127))
        narrow.append((weights.reshape(shape).astype(np.float32), biases.astype(np.float32)))
        wide, mine, kept = after, next_values(number, narrow[-1], mine), keep
    return narrow


def read(path):
    pixels = np.fromfile(f"{path}.pictures", np.int8).reshape(-1, EDGE, EDGE)
    return pixels, np.genfromtxt(f"{path}.labels.csv", delimiter=",", names=True)


def errors(layers, path):
    """Returns the median errors over pictures with a gate, in units of the outputs, and the shares of missed and of false
    gates."""
    pixels, labels = read(path)
    values = pictures_of(pixels)
    for number, layer in enumerate(layers):
        values = next_values(number, layer, values)
    found = values.reshape(-1, OUTPUTS) / 127
    there = labels["visible"] > 0
    wanted = np.stack([labels["yaw"], labels["rise"], np.minimum(labels["size"], 2) / 2], 1)
    medians = np.median(np.abs(found[there, :3] - wanted[there]), axis=0)
    false = f"{100 * (found[~there, 3] > 0).mean():.0f} %" if (~there).any() else "-"
    return f"yaw {medians[0]:.3f}, rise {medians[1]:.3f}, size {medians[2]:.3f}, missed {100 * (found[there, 3] <= 0).mean():.0f} %, false {false}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pictures")
    parser.add_argument("test", nargs="*")
    given = parser.parse_args()
    pixels = read(given.pictures)[0]
    pixels = pixels[np.linspace(0, len(pixels) - 1, PICTURES).astype(int)]
    whole = in_float(integer_network.from_bytes((HERE.parents[1] / "fmu_soc/firmware/nn/sight.weights").read_bytes(), shapes(WIDE)))
    networks = {"sight": whole}
    for name, channels in NARROWER.items():
        layers = in_integers(narrowed(whole, channels, pixels))
        (HERE / f"{name}.weights").write_bytes(integer_network.to_bytes(layers))
        networks[name] = in_float(layers)
    for name, layers in networks.items():
        for test in given.test:
            print(f"{name}, {pathlib.Path(test).name}: {errors(layers, test)}", flush=True)


if __name__ == "__main__":
    main()
