# SPDX-License-Identifier: Apache-2.0
"""Describes a deployed network in network.json and as a table on the terminal."""

from __future__ import annotations

import hashlib
from typing import Any

from mebots.deploy import accuracy, chip
from mebots.deploy.c_files import output_names
from mebots.deploy.deployed import Deployed, Options
from mebots.deploy.measure import Cost, Measurement
from mebots.deploy.plan import traffic
from mebots.deploy.roofline import DMA_BYTES, HYPER_BYTES, bound, peak, total_bound

FORMAT = 1


def _tensor(deployed: Deployed, tensor: Any) -> dict[str, Any]:
    scale = deployed.network.scales[tensor]
    return {"tensor": tensor.name, "shape": list(tensor.stored()), "step": scale.step, "zero": scale.zero}


def contract(deployed: Deployed, options: Options, vectors: list[dict[str, Any]]) -> dict[str, Any]:
    network, planned = deployed.network, deployed.plan
    rows, columns, channels = network.input.stored()
    return {
        "format": FORMAT,
        "model": {"file": deployed.model.path.name, "sha256": hashlib.sha256(deployed.model.path.read_bytes()).hexdigest(), "opset": deployed.model.opset},
        "calibration": {"pictures": min(options.pictures, len(deployed.pictures)), "percentile": options.percentile, "equalised": options.equalise},
        "input": {
            "rows": rows,
            "columns": columns,
            "channels": channels,
            "colour": {1: "grey", 3: "rgb"}.get(channels, "none") if rows * columns > 1 else "none",
            **_tensor(deployed, network.input),
        },
        "outputs": {name: _tensor(deployed, tensor) for name, tensor in zip(output_names(network), network.outputs, strict=True)},
        "memory": {"weights": deployed.sources.weight_bytes, "activations": planned.memory_bytes, "fetched": 0 if planned.stream is None else sum(planned.stream.buffers), "l1": planned.l1_bytes, "picture": network.input.size},
        "layers": [_layer(deployed, number) for number in range(len(network.layers))],
        "vectors": vectors,
    }


def _layer(deployed: Deployed, number: int) -> dict[str, Any]:
    layer, steps = deployed.network.layers[number], deployed.plan.steps[number]
    begin, end = deployed.plan.lifetimes[layer.output]
    return {
        "name": layer.name,
        "op": layer.op,
        "kind": layer.kind,
        "inputs": [one.name for one in layer.inputs],
        "output": layer.output.name,
        "shape": list(layer.output.stored()),
        "macs": layer.macs,
        "weights": layer.weights,
        "l2": {"offset": deployed.plan.offsets[layer.output], "bytes": layer.output.bytes, "from": begin, "to": end},
        "l1": None if steps is None else {"bytes": steps.l1_bytes, "tiles": steps.tiles, "tile_rows": steps.tile_rows, "parts": len(steps.parts), "moved": traffic(layer, steps).total},
    }


def _cost(cost: Cost, macs: int, clock_hz: float, cores: int, bound: float) -> dict[str, Any]:
    cycles = round(cost.time_s * clock_hz)
    return {
        "cycles": cycles,
        "time": cost.time_s,
        "energy": cost.energy_j,
        "macs_per_cycle": macs / cycles if cycles else 0.0,
        "bound": round(bound),
        "roofline": bound / cycles if cycles else 0.0,
        # Sums over all cores: instructions, cycles of waiting for memory, and cycles asleep at barriers and for the DMA.
        "instructions": cost.instructions,
        "stalled": cost.cycles - cost.instructions,
        "asleep": max(cores * cycles - cost.cycles, 0),
        "parts": cost.parts_j,
        "causes": cost.causes,
        "dma": cost.dma_s,
    }


def result_of(deployed: Deployed, measurement: Measurement) -> dict[str, Any]:
    layers = deployed.network.layers
    clock, cores = measurement.clock_hz, measurement.cores
    stream, cluster_per_soc = deployed.plan.stream, clock / chip.SOC_CLOCK_HZ
    hyper = {} if stream is None else {"hyper_bytes_per_cycle": HYPER_BYTES / cluster_per_soc}
    bounds = [bound(layer, steps, cores) for layer, steps in zip(layers, deployed.plan.steps, strict=True)]
    return {
        "board": deployed.board.name,
        "cores": cores,
        "cluster_clock": clock,
        "roof": {"macs_per_cycle": peak(cores), "bytes_per_cycle": DMA_BYTES} | hyper,
        "layers": [_cost(cost, layer.macs, clock, cores, least) for cost, layer, least in zip(measurement.layers, layers, bounds, strict=True)],
        "total": _cost(measurement.total, sum(one.macs for one in layers), clock, cores, total_bound(layers, deployed.plan, cores, cluster_per_soc)),
        "settings": [
            {"cores": one.cores, "cluster_clock": one.clock_hz, "time": one.total.time_s, "energy": one.total.energy_j, "parts": one.total.parts_j}
            for one in measurement.settings
        ],
    }


def shown(content: dict[str, Any]) -> str:
    """Returns the table of layers as text."""
    rows = [["layer", "operators", "output", "MACs", "weights", "cycles", "MAC/cycle", "roofline", "energy"]]
    measured = content.get("measured")
    for number, layer in enumerate(content["layers"]):
        shape = " x ".join(str(one) for one in layer["shape"])
        cost = measured["layers"][number] if measured else None
        rows.append([layer["name"], layer["op"], shape, _count(layer["macs"]), _count(layer["weights"]), *_cells(cost)])
    macs, weights = (sum(one[key] for one in content["layers"]) for key in ("macs", "weights"))
    rows.append(["total", "", "", _count(macs), _count(weights), *_cells(measured["total"] if measured else None)])
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = ["  ".join(cell.ljust(w) if i < 2 else cell.rjust(w) for i, (cell, w) in enumerate(zip(row, widths, strict=True))).rstrip() for row in rows]
    memory = content["memory"]
    lines.append("")
    weights = f"buffers for weights in HyperRAM {memory['fetched']} bytes of {memory['weights']}" if memory["fetched"] else f"weights {memory['weights']} bytes"
    lines.append(f"L2: {weights}, activations {memory['activations']}, picture {memory['picture']}; L1: {memory['l1']}")
    if measured:
        total = measured["total"]
        lines.append(
            f"one inference on {measured['cores']} cores at {measured['cluster_clock'] / 1e6:.4g} MHz of board {measured['board']}: "
            f"{1e3 * total['time']:.3f} ms, {1e3 * total['energy']:.4g} mJ"
        )
        largest = sorted(total["parts"].items(), key=lambda one: -one[1])[:4]
        lines.append("of it: " + ", ".join(f"{name} {100 * value / total['energy']:.0f} %" for name, value in largest))
        lines += [
            f"  {one['cores']} core{'s' if one['cores'] > 1 else ' '} at {one['cluster_clock'] / 1e6:5.2f} MHz: {1e3 * one['time']:8.3f} ms, {1e3 * one['energy']:8.4g} mJ"
            for one in measured["settings"]
        ]
    lines += accuracy.shown(content["accuracy"]) + _shown_sizes(content["sizes"])
    flight = content["flight"]
    if "program" in flight:
        lines.append(f"flies in missions with firmware {' or '.join(flight['firmware'])}: --set soc.network=FOLDER")
    else:
        lines.append(f"does not fly: {flight['none']}")
    return "\n".join(lines)


def _shown_sizes(sizes: dict[str, Any]) -> list[str]:
    """Returns lines about smaller inputs, with all cores at the highest clock."""
    rows, reason = sizes["rows"], sizes.get("none")
    lines = []
    for row in rows:
        last = row["settings"][-1]
        lines.append(f"input of {row['columns']} x {row['rows']}: {_count(row['macs'])} MACs, {1e3 * last['time']:.3f} ms, {1e3 * last['energy']:.4g} mJ")
        lines += accuracy.shown(row["accuracy"], "  ")
        lines += [f"  {name}: differs from float at the whole size by {one['error']:.3g}" for name, one in row.get("whole", {}).items()]
    if reason is not None:
        lines.append(f"{'no smaller input' if rows else 'one size of the input only'}: {reason}")
    return lines


def _count(value: int) -> str:
    return "" if value == 0 else f"{value:,}".replace(",", " ")


def _cells(cost: dict[str, Any] | None) -> list[str]:
    if cost is None:
        return [""] * 4
    rate = f"{cost['macs_per_cycle']:.2f}" if cost["macs_per_cycle"] else ""
    return [_count(cost["cycles"]), rate, f"{100 * cost['roofline']:.0f} %", f"{1e6 * cost['energy']:.4g} uJ"]
