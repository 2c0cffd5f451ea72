# SPDX-License-Identifier: Apache-2.0
"""Contracts between a network and the firmware that flies with it: the required input and outputs (fmu_soc/firmware/app)."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

from mebots.deploy import layers as integers
from mebots.deploy.c_files import identifier, output_names
from mebots.installation import data_folder

_SUFFIX = ".contract.json"
_COLOURS = {1: "grey", 3: "rgb"}


@dataclasses.dataclass(frozen=True)
class Contract:
    """The network that a flight's firmware requires. ``firmware`` names the programs whose network can be replaced. ``rows`` and
    ``columns`` are the least and greatest size of the input."""

    name: str
    firmware: tuple[str, ...]
    colour: str
    rows: tuple[int, int]
    columns: tuple[int, int]
    outputs: tuple[str, ...]
    sources: tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class Fit:
    """How a network matches a contract. For each output of the contract, ``order`` contains the index of the value in the network's
    result."""

    contract: Contract
    order: tuple[int, ...]


def contracts() -> list[Contract]:
    """Reads the contracts in fmu_soc/firmware/app of this installation."""
    files = sorted((data_folder() / "fmu_soc/firmware/app").glob(f"*{_SUFFIX}"))
    return [_read(one.name.removesuffix(_SUFFIX), json.loads(one.read_text())) for one in files]


def _read(name: str, content: dict[str, Any]) -> Contract:
    given = content["input"]
    rows, columns = _range(given["rows"]), _range(given["columns"])
    return Contract(name, tuple(content["firmware"]), given["colour"], rows, columns, tuple(content["outputs"]), tuple(content["sources"]))


def _range(values: list[int]) -> tuple[int, int]:
    least, most = values
    return least, most


def fit(network: integers.Network, grey_step: float) -> Fit | str:
    """Returns the contract that the network matches and the order of its outputs, or the reason why it matches none. ``grey_step`` is the
    change of the network's input if a pixel changes by one grey level."""
    known = contracts()
    choice = next((fitting for one in known if (fitting := _order(network, one)) is not None), None)
    if choice is None:
        needed = "; ".join(f"{one.name}: {', '.join(one.outputs)}" for one in known)
        has = ", ".join(f"{name} ({tensor.size} value{'s' if tensor.size > 1 else ''})" for name, tensor in zip(output_names(network), network.outputs, strict=True))
        return f"its outputs are {has}. A flight needs one output with these values in this order, or one output of each name ({needed})"
    return _problem(network, choice.contract, grey_step) or choice


def _order(network: integers.Network, contract: Contract) -> Fit | None:
    """Returns how the outputs match the contract, or None if they do not."""
    names = [identifier(one.name) for one in network.outputs]
    if len(network.outputs) == 1 and network.outputs[0].size == len(contract.outputs):
        return Fit(contract, tuple(range(len(contract.outputs))))
    if sorted(names) == sorted(contract.outputs) and all(one.size == 1 for one in network.outputs):
        return Fit(contract, tuple(names.index(one) for one in contract.outputs))
    return None


def _problem(network: integers.Network, contract: Contract, grey_step: float) -> str:
    """Returns the reason why the network's input does not match the contract, or an empty text."""
    rows, columns, channels = network.input.stored()
    has = f"{columns} x {rows} pixels, {_COLOURS.get(channels, f'{channels} channels')}"
    if _COLOURS.get(channels) != contract.colour or not (contract.rows[0] <= rows <= contract.rows[1] and contract.columns[0] <= columns <= contract.columns[1]):
        return (
            f"its input has {has}. A flight needs a {contract.colour} picture of {contract.columns[0]} x {contract.rows[0]} to "
            f"{contract.columns[1]} x {contract.rows[1]} pixels"
        )
    step = network.scales[network.input].step
    if abs(step / grey_step - 1) > 1e-3:
        return (
            f"a step of its input is {step:.6g}, but a grey level of the camera is {grey_step:.6g} (--input-scale). Give --input-scale as the network was trained; "
            "pictures in a .npy file must contain the darkest and the brightest grey level"
        )
    return ""
