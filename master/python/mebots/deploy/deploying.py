# SPDX-License-Identifier: Apache-2.0
"""Deploys a network: from a model and pictures to a folder with a firmware library."""

from __future__ import annotations

import hashlib
import json
import os
import pathlib
import shutil
import tempfile
from typing import Any

import numpy as np

from mebots.deploy import chip, contracts
from mebots.deploy import layers as integers
from mebots.deploy.arithmetic import Scale
from mebots.deploy.calibrate import FloatModel, names_of, ranges_of
from mebots.deploy.checking import compare
from mebots.deploy.deployed import Deployed, Options
from mebots.deploy.emit import L1_RESERVED, Sources, emit
from mebots.deploy.importer import import_graph
from mebots.deploy.integer_layers import IntegerLayers
from mebots.deploy.integer_nodes import collapse, expand_shifts, is_integer
from mebots.deploy.measure import Measurement, measure
from mebots.deploy.model_file import Model
from mebots.deploy.pictures import Pictures
from mebots.deploy.plan import Memory, Plan, plan
from mebots.deploy.quantise import Quantiser
from mebots.deploy.report import contract, result_of
from mebots.deploy.simplify import join_flattened, simplify
from mebots.errors import InputError

CLUSTER_STACKS = 8 * 1024  # link.ld.in
PROGRAM_BYTES = 16 << 10  # code of the runtime and the kernels


def lower(model: str | os.PathLike[str], data: str | os.PathLike[str], options: Options) -> Deployed:
    """Reads, calibrates, quantises and plans. Writes nothing. Raises InputError.

    The numbers of a network in integers are taken as they are.
    """
    read = Model(model, expand_shifts)
    if is_integer(read):
        collapse(read)
    graph = import_graph(read)
    source = graph.inputs[0]
    pictures = Pictures(pathlib.Path(data), source, options.crop)
    if read.requantising:
        join_flattened(graph)
        scale = Scale(1.0, 0)
        network = IntegerLayers(graph, read.requantising, scale.zero).network()
        float_model = None
    else:
        simplify(graph)
        scale = read.scales.get(source.name) or pictures.scale(options.input_scale, options.input_offset)
        float_model = FloatModel(read, names_of([one for one in [node.output for node in graph.nodes] + graph.outputs if one.name in read.shapes]))
        chosen = np.linspace(0, len(pictures) - 1, min(options.pictures, len(pictures))).round().astype(int)
        ranges = ranges_of(float_model, (pictures.real(pictures.one(i, scale), scale) for i in chosen), options.percentile)
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


def deploy(model: str | os.PathLike[str], data: str | os.PathLike[str], out: str | os.PathLike[str], options: Options | None = None) -> dict[str, Any]:
    """Writes the folder ``out``, which must not exist. Returns the content of its network.json.

    The integers are checked in C on this machine, and on the chip with one core and with all, before the folder appears.
    """
    options = options or Options()
    target = pathlib.Path(out)
    if target.exists():
        raise InputError(f"{target}: exists already. Remove it, or choose another folder", "exists")
    if not target.absolute().parent.is_dir():
        raise InputError(f"{target}: the folder {target.absolute().parent} does not exist", "not_found")
    deployed = lower(model, data, options)
    work = pathlib.Path(tempfile.mkdtemp(prefix=f".{target.name}-", dir=target.absolute().parent))
    try:
        content = _fill(work / "folder", deployed, options)
        os.rename(work / "folder", target)
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return content


def _fill(folder: pathlib.Path, deployed: Deployed, options: Options) -> dict[str, Any]:
    folder.mkdir()
    for name, content in deployed.sources.files.items():
        (folder / name).write_bytes(content)
    vectors = _write_vectors(folder, deployed, options.vectors)
    measurement = check_and_measure(folder, folder.parent, deployed, options)
    pilot = _build_pilot(folder, deployed, options)
    content = contract(deployed, options, vectors) | {"flight": pilot, "files": _hashes(folder)}
    if measurement is not None:
        content["measured"] = result_of(deployed, measurement)
    (folder / "network.json").write_text(json.dumps(content, indent=2) + "\n")
    return content


def check_and_measure(
    library: pathlib.Path,
    scratch: pathlib.Path,
    deployed: Deployed,
    options: Options,
    objects: pathlib.Path | None = None,
    with_cost: bool = True,
) -> Measurement | None:
    """Compares C with the reference on this machine. Unless that is switched off, also compares and measures on the
    chip.

    ``objects`` is a folder for the object files of the kernels, which later networks use again.
    """
    network = deployed.network
    build = chip.Build(library, scratch, deployed.board, objects)
    sizes = [layer.output.bytes for layer in network.layers]
    picture = deployed.pictures.one(0, deployed.scale)
    values = integers.run(network, picture)
    host = build.host()
    compare(network, values, chip.run_on_host(host, chip.Request(1, -1, sizes, picture)), "C on this machine")
    if not options.measure:
        return None
    elf = build.chip()
    for cores in (1, deployed.board.cores):
        text, _ = chip.run_on_chip(elf, chip.Request(cores, -1, sizes, picture), deployed.board)
        compare(network, values, text, f"the chip with {cores} core{'s' if cores > 1 else ''}")
    if not with_cost:
        return None
    return measure(elf, network, picture, sizes, deployed.board)


def _build_pilot(folder: pathlib.Path, deployed: Deployed, options: Options) -> dict[str, Any]:
    """Builds the flight's program if the network fits a contract. Otherwise returns the reason why it does not."""
    if not options.measure:
        return {"none": "it was deployed with --no-measure, which builds no program for the chip"}
    if deployed.float_model is None:
        return {"none": "a flight needs outputs with scales, which a network of whole numbers does not have"}
    if not deployed.board.flies:
        return {"none": f"board {deployed.board.name} has no flight link; ai_deck and gap8_drone have one"}
    fitting = contracts.fit(deployed.network, options.input_scale)
    if isinstance(fitting, str):
        return {"none": fitting}
    contract = fitting.contract
    try:
        elf = chip.Build(folder, folder.parent, deployed.board).pilot(contract.name, contract.sources, fitting.order)
    except InputError as error:
        return {"none": str(error)}
    shutil.copy(elf, folder / elf.name)
    return {"program": elf.name, "board": deployed.board.name, "firmware": list(contract.firmware), "outputs": list(contract.outputs)}


def _write_vectors(folder: pathlib.Path, deployed: Deployed, count: int) -> list[dict[str, Any]]:
    """Writes inputs and outputs of pictures. Returns a list of them for network.json."""
    place = folder / "vectors"
    place.mkdir()
    listed = []
    for number in range(min(count, len(deployed.pictures))):
        picture = deployed.pictures.one(number, deployed.scale)
        values = integers.run(deployed.network, picture)
        name = f"{number:03}"
        (place / f"{name}.picture").write_bytes(picture.astype(np.uint8).tobytes())
        (place / f"{name}.outputs").write_bytes(b"".join(values[one].tobytes() for one in deployed.network.outputs))
        listed.append({"picture": f"vectors/{name}.picture", "outputs": f"vectors/{name}.outputs"})
    return listed


def _hashes(folder: pathlib.Path) -> dict[str, str]:
    files = sorted(one for one in folder.rglob("*") if one.is_file())
    return {one.relative_to(folder).as_posix(): hashlib.sha256(one.read_bytes()).hexdigest() for one in files}
