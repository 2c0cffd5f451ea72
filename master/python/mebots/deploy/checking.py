# SPDX-License-Identifier: Apache-2.0
"""Compares the output of each layer with the NumPy reference, by hashes."""

from __future__ import annotations

import pathlib
import re

import numpy as np

from mebots.deploy import chip
from mebots.deploy import layers as integers
from mebots.deploy.c_files import kernels
from mebots.deploy.deployed import Deployed
from mebots.deploy.graph import Tensor
from mebots.deploy.layers import Network
from mebots.errors import Error

_LINE = re.compile(r"^layer (\d+) ([0-9a-f]+)$|^result (-?\d+)$")


def check(library: pathlib.Path, scratch: pathlib.Path, deployed: Deployed, on_chip: bool, objects: pathlib.Path | None = None) -> chip.Program | None:
    """Compares the layers that the network's C code computes with the NumPy reference: on this machine, and on the chip with one core and
    all cores. Returns the chip's program.

    ``library`` contains the network's sources. ``objects`` is a folder for object files of kernels, which later networks reuse.
    """
    network, board = deployed.network, deployed.board
    build = chip.Build(library, scratch, board, kernels(deployed.plan), objects)
    sizes = [layer.output.bytes for layer in network.layers]
    picture = deployed.pictures.one(0, deployed.scale)
    values = integers.run(network, picture)
    compare(network, values, chip.run_on_host(build.host(), chip.Request(1, -1, sizes, picture)), "C on this machine")
    if not on_chip:
        return None
    program = chip.Program(build.chip(), sizes, picture, board, None if deployed.plan.stream is None else library / "network.weights")
    for cores in (1, board.cores):
        compare(network, values, program.check(cores), f"the chip with {cores} core{'s' if cores > 1 else ''}")
    return program


def hash_of(values: np.ndarray) -> int:
    """Returns the FNV-1a hash (32 bits) of an array's bytes."""
    result = 2166136261
    for one in np.ascontiguousarray(values).tobytes():
        result = ((result ^ one) * 16777619) & 0xFFFFFFFF
    return result


def results_of(network: Network, values: dict[Tensor, np.ndarray]) -> list[int]:
    return [int(one) - network.scales[tensor].zero for tensor in network.outputs for one in values[tensor].ravel()]


def compare(network: Network, values: dict[Tensor, np.ndarray], printed: str, where: str) -> None:
    """Raises Error with the name of the first layer whose hash differs."""
    hashes: dict[int, int] = {}
    results = []
    for line in printed.splitlines():
        match = _LINE.match(line)
        if match and match[1]:
            hashes[int(match[1])] = int(match[2], 16)
        elif match:
            results.append(int(match[3]))
    for number, layer in enumerate(network.layers):
        expected = hash_of(values[layer.output])
        if hashes.get(number) != expected:
            got = "nothing" if number not in hashes else f"{hashes[number]:08x}"
            raise Error(f"{where}: layer {number} ({layer.name}, {layer.op}) gives {got}, the reference {expected:08x}", "different_integers")
    if results != results_of(network, values):
        raise Error(f"{where}: the results are {results[:8]}, the reference {results_of(network, values)[:8]}", "different_integers")
