#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the chip's energy model with published values of GAP8 (points.json). Prints a table in Markdown.

Usage: power.py BUILD [--dronet FOLDER] [--calibrate]

BUILD is a build folder. --dronet runs PULP-Dronet v1 from the checkouts in FOLDER, which scripts/gap8_programs.sh lists.
--calibrate rewrites fmu_soc/params/gap8_silicon.json from gap8.json and the points for calibration. Build again afterwards.
"""
import argparse
import json
import pathlib
import shutil
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).parent
MODELS = ("gap8", "gap8_silicon")
TOP = (1.2, 250, 175)
CAMERA_W = 1.75e-3 * 2.8  # power of the camera in configs/boards/gap8.json
# The numbers of pictures in two runs of PULP-Dronet. The difference of the runs excludes one-time costs.
FEW, MANY = 2, 6


def phases(build, model, at):
    voltage, clock, cluster = at
    done = subprocess.run(
        [build / "bin/mebots-silicon-phases", "--board", ROOT / "configs/boards/gap8_bare.json", "--energy", model,
         "--voltage", str(voltage), "--clock", str(clock * 1e6), "--cluster-clock", str(cluster * 1e6),
         build / "firmware/silicon_phases.elf"], text=True, capture_output=True, check=True)
    found = json.loads(done.stdout)
    checks = {}
    for name, value in found.items():
        if not name.startswith("checksum "):
            continue
        kernel = name.split()[1].split("_")[0]
        if checks.setdefault(kernel, value) != value:
            raise SystemExit(f"{name} {value}: another form of {kernel} has {checks[kernel]}")
    return found


PARTS = ("fabric_controller", "cluster_cores", "fc_memory", "l2", "l1", "interconnect", "dma", "fc_background",
         "cluster_background", "leakage", "retention")


def joules(phase):
    return sum(phase[part] for part in PARTS)


class Model:
    """Measures a chip with the set of energies `name`. When a phase is first needed at an operating point, measures all phases at
    this point."""

    def __init__(self, build, name):
        self.build, self.name, self.at = build, name, {}

    def phase(self, name, at=TOP):
        at = tuple(at)
        if at not in self.at:
            self.at[at] = phases(self.build, self.name, at)
        found = [key for key in self.at[at] if key == name or key.startswith(name + " ")]
        return self.at[at][found[0]], int(found[0].split()[-1])

    def power_w(self, name, at=TOP):
        phase, _ = self.phase(name, at)
        return joules(phase) / phase["seconds"]

    def leakage_w(self):
        phase, _ = self.phase("fc_asleep 0 1")
        return phase["leakage"] / phase["seconds"]

    def gain(self, over, name, cycles):
        """Returns the energy of phase `over` in cycles[0] cycles, divided by the energy of phase `name` in cycles[1] cycles."""
        return self.power_w(over) * cycles[0] / (self.power_w(name) * cycles[1])


def of_dronet(build, model, folder):
    """Returns the time per picture of PULP-Dronet, and the energy of the chip and of the devices per picture."""
    dronet = folder / "pulp-dronet/pulp-dronet-v1"
    frames = sorted((folder / "Himax_Dataset/test_2").glob("frame_2[2-9].pgm"))
    found = []
    with tempfile.TemporaryDirectory() as out:
        board = json.loads((ROOT / "configs/boards/gap8.json").read_text())
        board["energy"] = model
        (pathlib.Path(out) / "board.json").write_text(json.dumps(board))
        for count in FEW, MANY:
            pictures = pathlib.Path(out) / str(count)
            pictures.mkdir()
            for frame in frames[:count]:
                shutil.copy(frame, pictures)
            subprocess.run([build / "bin/mebots-soc", "run", dronet / "bin/PULPDroNet_GAPuino", "--board",
                                   pathlib.Path(out) / "board.json", "--flash",
                                   dronet / "weights/WeightsPULPDroNet.raw", "--pictures", pictures, "--json",
                                   pathlib.Path(out) / "report.json"], capture_output=True, check=True)
            report = json.loads((pathlib.Path(out) / "report.json").read_text())
            found.append({"time": report["time_s"], "energy": report["chip_j"]} | report["devices_j"])
    return {name: (found[1][name] - found[0][name]) / (MANY - FEW) for name in found[0]}


def figure(model, point, rail_v, dronet):
    """Returns the model's value for a published point, in the point's unit. If the model has no such value, returns None."""
    kind = point.get("figure")
    extra_w = CAMERA_W if "camera" in point.get("plus", ()) else 0
    if kind in ("power", "leakage"):
        if kind == "leakage":
            power_w = model.leakage_w()
        else:
            power_w = model.power_w(point["phase"], point.get("at", TOP)) + extra_w
        return power_w / rail_v * 1e3 if point["unit"] == "mA" else power_w * 1e3
    if kind == "gain":
        return model.gain(point["over"], point["phase"], point["cycles"])
    if kind in ("dronet_power", "dronet_energy") and dronet:
        of_picture = dronet[model.name]
        return of_picture["board"] * 1e3 / (of_picture["time"] if kind == "dronet_power" else 1)
    return None


def extremes(model, points, rail_v, dronet):
    """Returns a text with the least and the greatest ratio of silicon to model. It covers all currents and energies that were not
    used for the calibration and whose program was run, except the leakage of a chip in reset. These values are few, so the result
    is not a confidence interval.
    """
    fixed = {"gap8": (), "gap8_silicon": ("calibration",)}[model.name]
    ratios = {}
    for point in points:
        ran = point["source"] != "board" or point.get("figure") == "dronet_energy"
        if point["unit"] not in ("mA", "mJ") or not ran or point["use"] in fixed or point.get("figure") == "leakage":
            continue
        says = figure(model, point, rail_v, dronet)
        if says is not None:
            ratios[point["name"]] = point["value"] / says
    low, high = min(ratios, key=ratios.get), max(ratios, key=ratios.get)
    if dronet:
        found = {"least": round(ratios[low], 2), "most": round(ratios[high], 2), "count": len(ratios)}
        checks = json.loads((ROOT / f"fmu_soc/params/{model.name}.json").read_text())["checks"]
        if said := {key: check["value"] for key, check in checks.items() if check["value"] != found[key]}:
            raise SystemExit(f"fmu_soc/params/{model.name}.json: checks has {said}; here they are {found}")
    which = f"{len(ratios)} checks" + ("" if dronet else " (without PULP-Dronet)")
    return f"in {which} silicon took {ratios[low]:.2f} ({low}) to {ratios[high]:.2f} times ({high}) as much"


def scaled(table, factor, source):
    def deep(value):
        return {key: deep(each) for key, each in value.items()} if isinstance(value, dict) else \
            float(f"{value * factor:.4g}")
    return {"unit": table["unit"], "source": source, "values": deep(table["values"])}


def calibrate(model, points, rail_v):
    """Computes four factors for values of gap8.json from four measured currents. The `source` of each changed value states its
    factor."""
    chip = json.loads((ROOT / "fmu_soc/params/gap8.json").read_text())
    wanted_w = {point["name"]: point["value"] * 1e-3 * rail_v for point in points if point["use"] == "calibration"}
    reset_w, fabric_w, idle_w, eight_w = wanted_w.values()

    def watts(phase, *parts):
        found, _ = model.phase(phase)
        return sum(found[part] for part in parts) / found["seconds"]

    leakage = reset_w / watts("fc_asleep 0 1", "leakage")
    fabric = (fabric_w - reset_w) / watts("fc_asleep 0 1", "fc_background")
    # The leakage of the cluster's cores and banks has the same factor as that of the fabric controller. The chip's value
    # `cluster_leakage` has no factor.
    own_w = chip["energy"]["cluster_leakage"]["values"]["25"]["1.2"]["any"]
    others_w = watts("cluster_idle 0 1", "leakage") - watts("fc_asleep 0 1", "leakage") - own_w
    clocked_w = watts("cluster_idle 0 1", "cluster_background", "dma", "cluster_cores")
    cluster = (idle_w - fabric_w - own_w - leakage * others_w) / clocked_w
    busy = ("cluster_cores", "l1", "l2", "interconnect", "dma")
    background_w = watts("cluster_idle 0 1", *busy)
    core = (eight_w - idle_w) / (watts("convolution_scalar 8", *busy) - background_w)

    say = "{:.4g} x gap8.json's, so that a GAPuino's current {} comes out (docs/soc-energy.md); {}"
    rules = {"core_leakage": leakage, "memory_leakage": leakage, "fc_background": fabric,
             "cluster_background": cluster, "dma_background": cluster, "core_clock_gated": cluster,
             "instruction": core, "l1_access": core, "memory_access": core, "interconnect_word": core,
             "dma_active": core}
    why = {leakage: "in reset", fabric: "with the cluster off", cluster: "with the cluster idle",
           core: "with eight cores in a scalar convolution"}
    energy = {key: value for key, value in chip["energy"].items()}
    path = ROOT / "fmu_soc/params/gap8_silicon.json"
    checks = json.loads(path.read_text())["checks"]  # the checks must be repeated after the next build
    for key, factor in rules.items():
        energy[key] = scaled(energy[key], factor, say.format(factor, why[factor], energy[key]["source"]))
    text = json.dumps({"name": "gap8_silicon",
                       "text": "Energies of GAP8, calibrated on four currents of a GAPuino; written by "
                               "bench/silicon/power.py --calibrate (docs/soc-energy.md)",
                       "checks": {}, "instruction_weight": chip["instruction_weight"], "energy": {}}, indent=2)
    for part, figures in (("checks", checks), ("energy", energy)):
        rows = ",\n".join(f"    {json.dumps(key)}: {json.dumps(value)}" for key, value in figures.items())
        text = text.replace(f'"{part}": {{}}', f'"{part}": {{\n{rows}\n  }}')
    path.write_text(text + "\n")
    for factor, where in why.items():
        print(f"{factor:8.4f}  {where}")


def shown(value):
    return f"{value:.3g}" if value < 100 else f"{value:.0f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--dronet", type=pathlib.Path)
    parser.add_argument("--calibrate", action="store_true")
    arguments = parser.parse_args()
    data = json.loads((HERE / "points.json").read_text())
    rail_v = data["rail"]["value"]
    models = {name: Model(arguments.build, name) for name in MODELS}
    if arguments.calibrate:
        calibrate(models["gap8"], data["points"], rail_v)
        return
    dronet = arguments.dronet and {name: of_dronet(arguments.build, name, arguments.dronet) for name in MODELS}
    print("| published | value | gap8 | difference | gap8_silicon | difference | use |\n|---|---|---|---|---|---|---|")
    for point in data["points"]:
        values = point["value"] if isinstance(point["value"], list) else [point["value"]]
        cells = [point["name"], ", ".join(map(str, values)) + " " + point["unit"]]
        for model in models.values():
            says = figure(model, point, rail_v, dronet)
            cells += ["", ""] if says is None else [shown(says), f"{(says / point['value'] - 1) * 100:+.0f} %"]
        print("| " + " | ".join([*cells, point["use"]]) + " |")
    for model in models.values():
        print(f"\n{model.name}: " + extremes(model, data["points"], rail_v, dronet))
    if dronet:
        for name, parts in dronet.items():
            print(f"\nPULP-Dronet v1, a picture, {name}: " +
                  ", ".join(f"{part} {value * 1e3:.3g} m{'s' if part == 'time' else 'J'}" for part, value in parts.items()))


if __name__ == "__main__":
    main()
