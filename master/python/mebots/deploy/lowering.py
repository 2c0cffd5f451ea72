# SPDX-License-Identifier: Apache-2.0
"""From a model and pictures to a deployed network in memory."""

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
from mebots.deploy.importer import import_graph
from mebots.deploy.integer_layers import IntegerLayers
from mebots.deploy.integer_nodes import collapse, expand_shifts, is_integer
from mebots.deploy.model_file import Model
from mebots.deploy.pictures import Pictures
from mebots.deploy.plan import Memory, Plan, plan
from mebots.deploy.quantise import Quantiser
from mebots.deploy.simplify import join_flattened, simplify
from mebots.errors import InputError

CLUSTER_STACKS = 8 * 1024  # link.ld.in
PROGRAM_BYTES = 16 << 10  # code of the runtime and the kernels


def lower(model: str | os.PathLike[str], data: str | os.PathLike[str], options: Options, size: Size | None = None) -> Deployed:
    """Reads, calibrates, quantises and plans. Writes nothing. Raises InputError.

    The numbers of a network in integers are taken as they are. ``size`` replaces the size of the input.
    """
    read = Model(model, expand_shifts, size)
    if is_integer(read):
        collapse(read)
    graph = import_graph(read)
    source = graph.inputs[0]
    pictures = Pictures(pathlib.Path(data), source, options.crop, read.whole)
    if read.requantising:
        join_flattened(graph)
        scale = Scale(1.0, 0)
        network = IntegerLayers(graph, read.requantising, scale.zero).network()
        float_model = None
    else:
        simplify(graph)
        scale = read.scales.get(source.name) or pictures.scale(options.input_scale, options.input_offset)
        float_model = FloatModel(read, names_of([one for one in [node.output for node in graph.nodes] + graph.outputs if one.name in read.shapes]))
        divisors = equalise(graph, set(read.scales)) if options.equalise else {}
        chosen = (pictures.real(pictures.one(i, scale), scale) for i in pictures.chosen(options.pictures))
        ranges = ranges_of(float_model, chosen, options.percentile, divisors)
        network = Quantiser(graph, scale, ranges.range_of, read.scales).network()
    board = chip.board(options.board)
    planned = plan(network, Memory(board.l1 - CLUSTER_STACKS, board.l2, board.name), L1_RESERVED)
    sources = emit(network, planned)
    _check_l2(network, planned, sources, board)
    return Deployed(read, graph, network, planned, sources, pictures, scale, float_model, board)


def _check_l2(network: integers.Network, planned: Plan, sources: Sources, board: chip.Board) -> None:
    picture = network.input.size
    need = sources.weight_bytes + planned.memory_bytes + picture + PROGRAM_BYTES
    if need <= board.l2:
        return
    number, most = max(
        ((i, sum(t.bytes for t, (a, b) in planned.lifetimes.items() if a <= i <= b)) for i in range(len(network.layers))), key=lambda one: one[1]
    )
    layer = network.layers[number]
    raise InputError(
        f"the network does not fit into L2 of board {board.name}: it needs {need} bytes (weights {sources.weight_bytes}, activations {planned.memory_bytes}, "
        f"picture {picture}, program about {PROGRAM_BYTES}), {board.l2} are available. Most activations are alive at layer {layer.name} ({layer.op}): "
        f"{most} bytes. Use fewer channels or a smaller picture",
        "does_not_fit",
    )
