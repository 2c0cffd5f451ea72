# SPDX-License-Identifier: Apache-2.0
"""Converts a model with pictures for calibration to a deployed network in memory."""

from __future__ import annotations

import os
import pathlib

from mebots.deploy import chip
from mebots.deploy import layers as integers
from mebots.deploy.arithmetic import Scale
from mebots.deploy.calibrate import FloatModel, names_of, ranges_of
from mebots.deploy.deployed import Deployed, Options, Size
from mebots.deploy.emit import L1_RESERVED, Sources, emit
from mebots.deploy.equalise import equalise
from mebots.deploy.graph import Graph
from mebots.deploy.importer import import_graph
from mebots.deploy.integer_layers import IntegerLayers
from mebots.deploy.integer_nodes import collapse, is_integer, to_onnx
from mebots.deploy.model_file import InputTooSmall, Model, SizeFixed
from mebots.deploy.pictures import Pictures
from mebots.deploy.plan import Memory, Plan, plan
from mebots.deploy.quantise import Quantiser
from mebots.deploy.simplify import join_flattened, simplify
from mebots.errors import InputError

CLUSTER_STACKS = 8 * 1024  # same as in link.ld.in
GAP8_L1 = 8  # bytes of L1 that GAP8's runtime needs (gap8/runtime/cluster.c)
PROGRAM_BYTES = 16 << 10  # code of the runtime and the kernels
L3_BYTES = 8 << 20  # size of HyperRAM


def lower(model: str | os.PathLike[str], data: str | os.PathLike[str], options: Options, size: Size | None = None) -> Deployed:
    """Reads, calibrates, quantises and plans a network. Writes nothing. Does not change networks with integer weights. ``size`` replaces
    the size of the input. Raises InputError if this fails.
    """
    read, graph = _read(model, size)
    source = graph.inputs[0]
    pictures = Pictures(pathlib.Path(data), source, options.crop, read.whole)
    if read.requantising:
        if options.equalise:
            raise read.fail("--equalise: the network is in integers already. Leave the option out, or deploy the model in float")
        join_flattened(graph)
        scale = Scale(1.0, 0)
        network = IntegerLayers(graph, read.requantising, scale.zero).network()
        float_model = None
    else:
        simplify(graph)
        scale = read.scales.get(source.name) or pictures.scale(options.input_scale, options.input_offset)
        float_model = FloatModel(read, names_of([one for one in [node.output for node in graph.nodes] + graph.outputs if one.name in read.shapes]))
        divisors = equalise(graph, set(read.scales)) if options.equalise else {}
        if options.equalise and not divisors:
            raise read.fail(
                "--equalise: no two layers can be equalised. Only Relu or pools may be between them, not Clip (Relu6), and "
                "nothing else may use the tensors between them. Leave the option out, or train with Relu"
            )
        chosen = (pictures.real(pictures.one(i, scale), scale) for i in pictures.chosen(options.pictures))
        ranges = ranges_of(float_model, chosen, options.percentile, divisors)
        network = Quantiser(graph, scale, ranges.range_of, read.scales).network()
    board = chip.board(options.board)
    l1 = board.l1 - CLUSTER_STACKS - (GAP8_L1 if board.is_gap8 else 0)
    planned = plan(network, Memory(l1, board.l2, board.name), L1_RESERVED)
    sources = _in_memory(network, planned, board)
    return Deployed(read, graph, network, planned, sources, pictures, scale, float_model, board)


def _read(path: str | os.PathLike[str], size: Size | None) -> tuple[Model, Graph]:
    """Reads a model with the input size ``size``. Raises SizeFixed if the model cannot have this size. Before, the caller must have read
    the model with its own size."""
    try:
        model = Model(path, to_onnx, size)
        if is_integer(model):
            collapse(model)
        return model, import_graph(model)
    except InputTooSmall:
        raise
    except InputError as error:
        if size is None:
            raise
        raise SizeFixed(str(error), error.code) from error


def _in_memory(network: integers.Network, planned: Plan, board: chip.Board) -> Sources:
    """Returns the network's sources. Places the weights in L2, or in L3 if they do not fit and the board has L3."""
    sources = emit(network, planned)
    free = board.l2 - planned.memory_bytes - network.input.size - PROGRAM_BYTES
    if sources.weight_bytes <= free:
        return sources
    if free <= 0 or not board.has_l3:
        raise _too_large(network, planned, sources.weight_bytes, board)
    if sources.weight_bytes > L3_BYTES:
        raise InputError(f"the weights have {sources.weight_bytes} bytes, but the HyperRAM of board {board.name} has {L3_BYTES}. Use fewer channels", "does_not_fit")
    sources = emit(network, planned, in_l3=True)
    stream = planned.stream
    if stream is not None and sum(stream.buffers) > free:
        sizes = [size for _, size in stream.segments]
        largest = network.layers[sizes.index(max(sizes))]
        raise InputError(
            f"the weights of two successive layers do not fit into L2 of board {board.name}: they need {sum(stream.buffers)} bytes, {free} are free. "
            f"The most are those of layer {largest.name} ({largest.op}): {max(sizes)} bytes. Use fewer channels, or two layers in place of this one",
            "does_not_fit",
        )
    return sources


def _too_large(network: integers.Network, planned: Plan, weights: int, board: chip.Board) -> InputError:
    picture = network.input.size
    number, most = max(
        ((i, sum(t.bytes for t, (a, b) in planned.lifetimes.items() if a <= i <= b)) for i in range(len(network.layers))), key=lambda one: one[1]
    )
    layer = network.layers[number]
    needed_but_weights = planned.memory_bytes + picture + PROGRAM_BYTES
    other_board = ", or board gap8, whose HyperRAM can hold the weights" if needed_but_weights < board.l2 else ""
    return InputError(
        f"the network does not fit into L2 of board {board.name}: it needs {weights + needed_but_weights} bytes (weights {weights}, "
        f"activations {planned.memory_bytes}, picture {picture}, program about {PROGRAM_BYTES}), {board.l2} are available. Most activations are alive at layer "
        f"{layer.name} ({layer.op}): {most} bytes. Use fewer channels or a smaller picture{other_board}",
        "does_not_fit",
    )
