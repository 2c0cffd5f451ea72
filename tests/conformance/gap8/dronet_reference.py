# SPDX-License-Identifier: Apache-2.0
"""Computes PULP-Dronet v1's outputs for a picture with 16-bit integers, from the weights of its repository.

    dronet_reference.py WEIGHTS PICTURE...    prints steering and collision of each picture (a 324 x 244 PGM)

WEIGHTS is pulp-dronet-v1/weights/binary of a checkout of pulp-platform/pulp-dronet. Layers, formats and the checksums of --check
are from the file src/config.h of PULP-Dronet. As in GreenWaves' AutoTiler library, the kernels add the input planes one by one to
16-bit sums. They shift and saturate the sums each time. Needs numpy.
"""
import argparse
import pathlib

import numpy as np

CAMERA_WIDTH, CAMERA_HEIGHT, CROP = 324, 244, 200
# Sums over each layer's outputs as unsigned 16-bit numbers, for Himax_Dataset/test_2/frame_22.pgm (src/config.h, Layer_GT).
PUBLISHED_SUMS = [3583346007, 33640519, 3054757, 969723858, 733574305, 961234035, 5702624, 800684, 568751660, 536587146,
                  562176438, 2426322, 310799, 400248723, 382744684, 34510, 193, 59518]


def saturate(values):
    return np.clip(values, -32768, 32767)


def shifted(values, norm):
    """Shifts right. Rounds half up."""
    return saturate(values + (1 << (norm - 1)) >> norm)


def read_picture(path):
    data = pathlib.Path(path).read_bytes()
    words = data.split(maxsplit=4)
    if words[0] != b"P5" or [int(word) for word in words[1:4]] != [CAMERA_WIDTH, CAMERA_HEIGHT, 255]:
        raise SystemExit(f"{path}: a {CAMERA_WIDTH} x {CAMERA_HEIGHT} PGM with 255 greys is needed")
    pixels = data[-CAMERA_WIDTH * CAMERA_HEIGHT:]
    return np.frombuffer(pixels, np.uint8).reshape(CAMERA_HEIGHT, CAMERA_WIDTH)


class Network:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.sums = []

    def read(self, name):
        return np.frombuffer((self.folder / f"{name}.hex").read_bytes(), "<i2").astype(np.int64)

    def note(self, plane):
        self.sums.append(int((plane & 0xFFFF).sum()) & 0xFFFFFFFF)
        return plane

    def convolve(self, planes, number, size, stride, outputs, norm, padding):
        weights = self.read(f"weights_conv2d_{number}").reshape(outputs, len(planes), size, size)
        padded = np.pad(planes, ((0, 0), padding, padding))
        height = (padded.shape[1] - size) // stride + 1
        width = (padded.shape[2] - size) // stride + 1
        out = np.repeat(self.read(f"bias_conv2d_{number}"), height * width).reshape(outputs, height, width)
        for plane, kernels in zip(padded, weights.transpose(1, 0, 2, 3)):
            windows = np.lib.stride_tricks.sliding_window_view(plane, (size, size))[::stride, ::stride]
            out = shifted((out << norm) + np.einsum("hwij,oij->ohw", windows, kernels), norm)
        return out

    def dense(self, planes, number, norm):
        products = int((planes.ravel() * self.read(f"weights_dense_{number}")).sum())
        bias = int(self.read(f"bias_dense_{number}")[0])
        return np.array([shifted((bias << norm) + products, norm)])

    def infer(self, picture):
        self.sums = []
        left = (CAMERA_WIDTH - CROP) // 2
        image = picture[CAMERA_HEIGHT - CROP:, left:left + CROP].astype(np.int64)[np.newaxis]
        same, half = (1, 1), (1, 0)
        large = self.convolve(image, 1, 5, 2, 32, 9, (2, 1))
        first = self.note(large.reshape(32, 50, 2, 50, 2).max(axis=(2, 4)))
        positive = self.note(np.maximum(first, 0))
        a = self.note(np.maximum(self.convolve(positive, 2, 3, 2, 32, 14, half), 0))
        a = self.note(self.convolve(a, 3, 3, 1, 32, 14, same))
        b = self.note(self.convolve(first, 4, 1, 2, 32, 7, (0, 0)))
        second = self.note(saturate(a + b))
        positive = self.note(np.maximum(second, 0))
        a = self.note(np.maximum(self.convolve(positive, 5, 3, 2, 64, 14, same), 0))
        a = self.note(self.convolve(a, 6, 3, 1, 64, 14, same))
        b = self.note(self.convolve(second, 7, 1, 2, 64, 14, (0, 0)))
        third = self.note(saturate(a + b))
        positive = self.note(np.maximum(third, 0))
        a = self.note(np.maximum(self.convolve(positive, 8, 3, 2, 128, 14, same), 0))
        a = self.note(self.convolve(a, 9, 3, 1, 128, 14, same))
        b = self.note(self.convolve(third, 10, 1, 2, 128, 12, (0, 0)))
        last = self.note(np.maximum(saturate(a + b), 0))
        return [int(self.note(self.dense(last, number, 11))[0]) for number in (1, 2)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("weights")
    parser.add_argument("pictures", nargs="+")
    parser.add_argument("--check", action="store_true",
                        help="hold every layer to the published sums: the picture is frame_22.pgm")
    arguments = parser.parse_args()
    network = Network(arguments.weights)
    for path in arguments.pictures:
        steering, collision = network.infer(read_picture(path))
        print(f"{path}: {steering} {collision}")
        if arguments.check:
            wrong = [i for i, (own, theirs) in enumerate(zip(network.sums, PUBLISHED_SUMS)) if own != theirs]
            if wrong:
                raise SystemExit(f"layers {wrong} differ: {[(network.sums[i], PUBLISHED_SUMS[i]) for i in wrong]}")
            print(f"{len(PUBLISHED_SUMS)} layers have the published sums")


if __name__ == "__main__":
    main()
