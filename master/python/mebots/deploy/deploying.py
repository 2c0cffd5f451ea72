# SPDX-License-Identifier: Apache-2.0
"""Deploys a network: converts a model with pictures for calibration to a folder with a firmware library."""

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
from mebots.deploy.c_files import kernels
from mebots.deploy.checking import check
from mebots.deploy.deployed import Deployed, Options
from mebots.deploy.judging import Judgement
from mebots.deploy.lowering import lower
from mebots.deploy.measure import measure
from mebots.deploy.report import contract, result_of
from mebots.errors import InputError


def deploy(model: str | os.PathLike[str], data: str | os.PathLike[str], out: str | os.PathLike[str], options: Options | None = None) -> dict[str, Any]:
    """Writes the folder ``out``, which must not exist. Returns the content of network.json. Before writing, checks the integer network in C
    on this machine, and on the chip with one core and all cores.
    """
    options = options or Options()
    target = pathlib.Path(out)
    if target.exists():
        raise InputError(f"{target}: exists already. Remove it, or choose another folder", "exists")
    if not target.absolute().parent.is_dir():
        raise InputError(f"{target}: the folder {target.absolute().parent} does not exist", "not_found")
    deployed = lower(model, data, options)
    judgement = Judgement(model, data, deployed, options)
    work = pathlib.Path(tempfile.mkdtemp(prefix=f".{target.name}-", dir=target.absolute().parent))
    try:
        content = _fill(work / "folder", deployed, options, judgement)
        os.rename(work / "folder", target)
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return content


def _fill(folder: pathlib.Path, deployed: Deployed, options: Options, judgement: Judgement) -> dict[str, Any]:
    deployed.sources.write(folder)
    vectors = _write_vectors(folder, deployed, options.vectors)
    program = check(folder, folder.parent, deployed, options.measure)
    measurement = None if program is None else measure(program)
    judged = judgement.result(folder.parent)
    pilot = _build_pilot(folder, deployed, options)
    content = contract(deployed, options, vectors) | judged | {"flight": pilot, "files": _hashes(folder)}
    if measurement is not None:
        content["measured"] = result_of(deployed, measurement)
    (folder / "network.json").write_text(json.dumps(content, indent=2) + "\n")
    return content


def _build_pilot(folder: pathlib.Path, deployed: Deployed, options: Options) -> dict[str, Any]:
    """If the network matches a contract of flight firmware (contracts.py), builds the program for a flight. Otherwise, returns the reason
    under the key "none"."""
    if not options.measure:
        return {"none": "it was deployed with --no-measure, which builds no program for the chip"}
    if deployed.float_model is None:
        return {"none": "a flight needs outputs with scales, which a network of whole numbers does not have"}
    if not deployed.board.flies:
        return {"none": f"board {deployed.board.name} has no flight link; ai_deck and gap8_drone have one"}
    if deployed.plan.stream is not None:
        return {"none": "its weights are in HyperRAM, and a mission sets no content of the flash, from which they come. Use fewer channels, so that the weights fit into L2"}
    fitting = contracts.fit(deployed.network, options.input_scale)
    if isinstance(fitting, str):
        return {"none": fitting}
    contract = fitting.contract
    try:
        elf = chip.Build(folder, folder.parent, deployed.board, kernels(deployed.plan)).pilot(contract.name, contract.sources, fitting.order)
    except InputError as error:
        return {"none": str(error)}
    shutil.copy(elf, folder / elf.name)
    return {"program": elf.name, "board": deployed.board.name, "firmware": list(contract.firmware), "outputs": list(contract.outputs)}


def _write_vectors(folder: pathlib.Path, deployed: Deployed, count: int) -> list[dict[str, Any]]:
    """Writes inputs and outputs of some pictures. Returns the list of files for network.json."""
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
