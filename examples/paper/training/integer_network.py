# SPDX-License-Identifier: Apache-2.0
"""Computes the network in whole numbers with NumPy alone. Every kernel of the firmware must give the same results.

Layers are (weights[out][row][column][in] int8, biases[out] int32, shifts[out] uint8). An output is
clip((sum of weight x input + bias + half) >> shift): [0, 255] after a convolution, [-127, 127] after the dense layer.
"""

import numpy as np

STRIDES = [2, 2, 1, 2, 1, 2, 1]
EDGE = 168


def shrink(picture):
    """Reduces a camera picture to the network's picture (168 x 168, grey level minus 128). A pixel is the rounded mean of 2 x 2
    pixels. These are evenly spaced from edge to edge. fmu_soc/firmware/nn/shrink.c computes the same."""
    picture = np.asarray(picture).astype(np.int32)
    rows, columns = (np.arange(EDGE) * (length - 2) // (EDGE - 1) for length in picture.shape)
    total = sum(picture[np.ix_(rows + i, columns + j)] for i in (0, 1) for j in (0, 1))
    return ((total + 2) >> 2).astype(np.int16) - 128


def convolution(values, weights, stride):
    """Computes values[row][column][in] -> sums[row][column][out], with zero padding."""
    kernel = weights.shape[1]
    padded = np.pad(values.astype(np.int64), ((kernel // 2,) * 2, (kernel // 2,) * 2, (0, 0)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, (kernel, kernel), axis=(0, 1))[::stride, ::stride]
    return np.einsum("yxcij,oijc->yxo", windows, weights.astype(np.int64))


def requantise(sums, biases, shifts, low, high):
    half = np.int64(1) << (shifts.astype(np.int64) - 1)
    return np.clip((sums + biases.astype(np.int64) + half) >> shifts.astype(np.int64), low, high)


def infer(layers, picture):
    """Returns the network's outputs for a picture (168 x 168, grey level minus 128), and the outputs of all convolutions. The
    output of the first convolution is pooled."""
    values = np.asarray(picture).reshape(EDGE, EDGE, 1)
    activations = []
    for i, stride in enumerate(STRIDES):
        weights, biases, shifts = layers[i]
        values = requantise(convolution(values, weights, stride), biases, shifts, 0, 255)
        if i == 0:
            edge, _, channels = values.shape
            values = values.reshape(edge // 2, 2, edge // 2, 2, channels).max(axis=(1, 3))
        activations.append(values.astype(np.uint8))
    weights, biases, shifts = layers[-1]
    total = np.array([np.sum(values * w.astype(np.int64)) for w in weights])
    return [int(output) for output in requantise(total, biases, shifts, -127, 127)], activations


def checksum(array, start=2166136261):
    """Returns the 32-bit FNV-1a hash of the array's bytes."""
    value = start
    for byte in np.ascontiguousarray(array).tobytes():
        value = ((value ^ byte) * 16777619) & 0xFFFFFFFF
    return value


def load(path):
    """Reads the layers from a .npz file of train.py."""
    with np.load(path) as file:
        return [tuple(file[f"{what}{i}"] for what in ("weights", "biases", "shifts")) for i in range(len(STRIDES) + 1)]


def to_bytes(layers):
    """Returns the content of the file that the firmware links. Each layer consists of biases (rounding half included), shifts,
    and weights. Zeros pad each part to whole words."""
    out = bytearray()
    for weights, biases, shifts in layers:
        rounded = biases.astype(np.int64) + (np.int64(1) << (shifts.astype(np.int64) - 1))
        for part in (rounded.astype("<i4"), shifts.astype(np.uint8), weights.astype(np.int8)):
            out += part.tobytes()
            out += bytes(-len(out) % 4)
    return bytes(out)


def from_bytes(packed, like):
    """Converts the bytes of to_bytes() to layers. `like` contains the shapes of the layers' weights."""
    layers, at = [], 0

    def take(kind, count):
        nonlocal at
        part = np.frombuffer(packed, kind, count, at)
        at += part.nbytes + -part.nbytes % 4
        return part

    for shape in like:
        rounded, shifts = take("<i4", shape[0]), take(np.uint8, shape[0])
        weights = take(np.int8, int(np.prod(shape))).reshape(shape)
        layers.append((weights, (rounded - (1 << (shifts.astype(np.int32) - 1))).astype(np.int32), shifts))
    if at != len(packed):
        raise ValueError(f"{len(packed)} bytes of weights where the network has {at}")
    return layers
