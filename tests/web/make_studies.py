#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Usage: make_studies.py CONFIGS OUT [DESIGNS MISSIONS]. Pages of studies and networks for report_test.mjs: statistics, names and
units are those of `mebots sweep` on the shipped mission. Values of missions and costs of layers are computed here, without a simulation."""

import dataclasses
import json
import math
import pathlib
import random
import sys

import numpy as np

from mebots.deploy.deployed import Options
from mebots.deploy.network_page import write_network_page
from mebots.exploration import front, rare_report, report
from mebots.exploration.answer import Judge
from mebots.exploration.comparison import Evidence
from mebots.exploration.figures import Units, design_names
from mebots.exploration.report_missions import Replay
from mebots.exploration.space import Space
from mebots.exploration.study import read_study

CELLS = {"bitcraze_250_flights": 1.0, "ufx_250_scaled": 0.95, "cyclone_300_scaled": 1.07, "lipol_350_scaled": 1.12}
OUTCOMES = ["missing", "passed", "touched_passed", "crashed"]
OBJECTIVES = {
    "success": {"outcome": ["passed", "touched_passed"]},
    "energy": {"summary": "energy.delivered", "unit": "J", "where": "success", "minimize": True},
    "time": {"summary": "simulated_time", "where": "success", "minimize": True},
}
DRAWS = {"world.start.yaw_offset": {"uniform": [-0.3, 0.3]}, "world.sensors.seed": {"integer": [1, 1000000]}}


def grid(configs, replicates=12):
    return {
        "mission": str(configs / "gate_easy.json"), "text": "Which battery, speed and clock need least energy?",
        "design": {"kind": "grid", "factors": {
            "battery.cell.name": list(CELLS), "soc.mission.cruise_speed": [0.3, 0.6, 1.0, 1.5], "soc.core.clock": [102.7e6, 175e6]}},
        "draws": {"replicates": replicates, "seed": 1, "variables": DRAWS}, "objectives": OBJECTIVES, "constraints": {"success": {"above": 0.3}},
    }  # fmt: skip


def large(configs, designs, replicates):
    factors = {
        "battery.cell.name": list(CELLS), "soc.mission.cruise_speed": {"uniform": [0.3, 1.5]}, "soc.core.clock": {"log_uniform": [50e6, 250e6]},
        "soc.temperature": {"uniform": [-10, 40]}, "world.drone.dry_mass": {"uniform": [0.02, 0.025]},
    }
    return grid(configs, replicates) | {"text": f"{designs} designs", "design": {"kind": "latin_hypercube", "points": designs, "seed": 1, "factors": factors}}


def mission(values, lot):
    """Returns success, energy [J] and time [s] of a mission of an invented drone. It crashes more often if it flies fast."""
    speed, clock = values["soc.mission.cruise_speed"], values["soc.core.clock"]
    passed = lot.random() > 0.45 * max(0.0, speed - 0.8) * (1.3 if clock < 120e6 else 0.8)
    time_s = 1.5 + 7 / speed + 0.05 * lot.gauss(0, 1)
    watts = 8 + 2.2 * speed**2 + clock / 4e8 + 900 * (values.get("world.drone.dry_mass", 0.02) - 0.02)
    energy_j = CELLS[values["battery.cell.name"]] * watts * time_s * (1 + 0.01 * lot.gauss(0, 1))
    outcome = (1 if lot.random() > 0.05 else 2) if passed else 3
    return outcome, [float(passed), energy_j if passed else math.nan, time_s if passed else math.nan]


def write_study(file, content, refresh_s=None):
    study = read_study(content)
    space = Space(study)
    evidence = Evidence(study, len(space.designs))
    lot = random.Random(1)
    outcomes = []
    for design, values in enumerate(space.designs):
        found = [mission(values, lot) for _ in range(study.replicates)]
        evidence.put_rows(design, 0, np.array([row for _, row in found]))
        evidence.count_to(design, study.replicates)
        outcomes.append(np.array([outcome for outcome, _ in found]))
    units = Units(study, space.missions.config.get("summary", {}))
    places = front.places(evidence)
    status = ["all flown"] * len(space.designs)
    judge = Judge(evidence, units, design_names(space.factors, space.designs, units), status)
    content = report.Content(
        study=study, factors=space.factors, designs=space.designs, evidence=evidence, answer=judge.answer(places), units=units,
        places=places, status=status, failed=[0] * len(space.designs), provenance={"mission": study.mission.name, "draws": json.dumps(study.draws)},
        replay=Replay(space, file.parent / "replays"), outcomes=(OUTCOMES, outcomes))  # fmt: skip
    if refresh_s is not None:  # as for a running study
        running = dataclasses.replace(judge.standings(), headlines=["96 flown, about 288 left, 2 min"])
        content = dataclasses.replace(content, answer=running, places=[""] * len(space.designs), replay=None, outcomes=None, refresh_s=refresh_s)
    report.write(file, content)


def write_rare(file, configs):
    content = grid(configs) | {"design": {"kind": "grid", "factors": {"soc.mission.cruise_speed": [0.3, 0.6]}}, "text": "How likely is a turn?"}
    del content["objectives"], content["constraints"]
    content["draws"] |= {"replicates": 4}
    content["splitting"] = {"score": "world.drone.yaw", "levels": [0.05, 0.1, 0.14], "missions": 50, "reseed": ["world.sensors.seed"]}
    study = read_study(content)
    designs = []
    for speed, counts in ((0.3, (6, 9, 12, 8)), (0.6, (1, 0, 2, 1))):
        reached = [[13, 11, count] for count in counts]
        p = sum(math.prod(one) for one in reached) / len(reached) / 50**3
        designs.append(rare_report.Design([speed], 600, 0, 7200.0, [p, p / 3, 2 * p, 0.3], [0.05, 0.1, 0.14], reached, "mebots run mission.json"))
    rare_report.write(file, study, ["soc.mission.cruise_speed"], designs, {"mission": study.mission.name}, Units(study, {}))


def cost(macs, cycles, clock=87e6, cores=8):
    """Returns the costs of a layer of an invented network, at 30 pJ per cycle of a core. The energies in `parts` add up to
    `energy`. The cycles in `causes` and `asleep` add up to the cycles of all cores."""
    causes = {"base": 5 * cycles, "cache": cycles // 2, "bank_conflict": cycles // 4, "far_memory": cycles // 8, "load_use": 0, "other": 0}
    energy_j = 30e-12 * cores * cycles
    return {
        "cycles": cycles, "time": cycles / clock, "energy": energy_j, "macs_per_cycle": macs / cycles, "bound": cycles // 3, "roofline": 1 / 3,
        "instructions": causes["base"], "stalled": sum(causes.values()) - causes["base"], "asleep": cores * cycles - sum(causes.values()),
        "parts": {"cluster_cores": 0.6 * energy_j, "fc_background": 0.3 * energy_j, "leakage": 0.1 * energy_j, "retention": 0.0}, "causes": causes, "dma": 0.05 * cycles / clock,
    }  # fmt: skip


def judged(error):
    """Returns the accuracy of an invented network. Each interval is the error plus and minus a
    fifth of it."""
    return {"pictures": 64, "data": "pictures", "float": {"outputs": {"error": error, "interval": [0.8 * error, 1.2 * error], "deviation": 0.3}}}


def network(is_measured):
    """Returns the content of network.json for an invented network of 24 layers."""
    layers, costs, offset = [], [], 0
    for i in range(24):
        size, channels = 80 >> (i // 8), 8 << (i // 8)
        macs = 9 * size * size * channels * channels if i % 5 else 0
        layers.append({
            "name": f"features.{i}.convolution", "op": "Conv+Clip" if macs else "Add", "kind": "convolution", "inputs": [], "output": f"tensor_{i}", "shape": [size, size, channels],
            "macs": macs, "weights": 9 * channels * channels if macs else 0, "l2": {"offset": offset, "bytes": size * size * channels, "from": i, "to": i + 1},
            "l1": {"bytes": 9000 + 300 * i, "tiles": 4, "tile_rows": 4, "parts": 1, "moved": 2 * size * size * channels} if macs else None,
        })  # fmt: skip
        costs.append(cost(macs, max(2000, macs // (4 + i % 3))))
        offset = 0 if offset else size * size * channels
    total = cost(sum(one["macs"] for one in layers), sum(one["cycles"] for one in costs))
    settings = [{"cores": cores, "cluster_clock": clock, "time": total["time"] * 8 / cores * 87e6 / clock, "energy": total["energy"] * (1 + 1 / cores), "parts": {}}
                for clock in (21.75e6, 43.5e6, 87e6) for cores in (1, 2, 4, 8)]  # fmt: skip
    measured = {"board": "ai_deck", "cores": 8, "cluster_clock": 87e6, "roof": {"macs_per_cycle": 8 * 32 / 14, "bytes_per_cycle": 8}, "layers": costs, "total": total, "settings": settings}
    return {
        "format": 1, "model": {"file": "invented.onnx", "sha256": "0" * 64, "opset": 17}, "calibration": {"pictures": 12, "percentile": None},
        "input": {"rows": 160, "columns": 160, "channels": 1, "tensor": "picture"}, "outputs": {"outputs": {"shape": [1, 1, 4]}},
        "accuracy": judged(0.01), "sizes": {"rows": [{"rows": size, "columns": size, "macs": size * size * 400, "accuracy": judged(0.01 * 160 / size), "settings": [
            one | {"time": one["time"] * (size / 160) ** 2, "energy": one["energy"] * (size / 160) ** 2} for one in settings]} for size in (120, 80)]},
        "memory": {"weights": 60000, "fetched": 0, "activations": 102400, "l1": 16000, "picture": 25600}, "layers": layers, "flight": {"none": "it has other outputs"},
    } | ({"measured": measured} if is_measured else {})  # fmt: skip


def main():
    configs, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    out.mkdir(parents=True, exist_ok=True)
    designs, missions = map(int, sys.argv[3:] or ("1000", "10000"))
    write_study(out / "study.html", grid(configs))
    write_study(out / "large.html", large(configs, designs, max(1, missions // designs)))
    write_study(out / "live.html", grid(configs, 3), refresh_s=1)
    write_rare(out / "rare.html", configs)
    for name, is_measured in (("network", True), ("unmeasured", False)):
        write_network_page(out / f"{name}.html", "invented.onnx", Options(), network(is_measured))


if __name__ == "__main__":
    main()
