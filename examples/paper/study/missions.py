# SPDX-License-Identifier: Apache-2.0
"""Defines the flights of the study: their differences, and their conversion to configs of `mebots run`."""

import copy
import dataclasses
import functools
import json
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[3]
KM_H = 1.0 / 3.6

BATTERIES = {  # maps a name in fmu_battery/params/cells to (label, capacity mAh, mass g), after the paper
    "bitcraze_250": ("Bitcraze", 250, 7.1),
    "ufx_250": ("UFX", 250, 5.8),
    "cyclone_300": ("Cyclone", 300, 8.1),
    "lipol_350": ("Lipol", 350, 9.2),
}
CELLS = {"bitcraze_250": "bitcraze_250_flights", **{name: f"{name}_scaled" for name in ("ufx_250", "cyclone_300", "lipol_350")}}
"""The cell files of the flights, by battery."""
MODELS = "fitted on flights"
"""The models of rotors, cells and the chip's energies in the experiments. Data without this entry used the models of
2015."""
HEAVIEST_G = max(mass for _, _, mass in BATTERIES.values())

# Maps a chip to the suffix of its shipped missions' names in configs/. These missions contain all changes for the chip.
CHIPS = {"ai_deck": "", "gap8_drone": "_gap8"}
FIRST_CHIP, SECOND_CHIP = CHIPS  # the report is about the first chip and compares it with the second
SHIPPED = ("gate_easy", "gate_hard")
LENS = "world.camera.field_of_view"

# The motor models of the flights. The paper also omits the flight controller's power and the cell's resistance; replay.py
# computes their effects from the loads of a flight.
MOTORS = {"bench": "bench motors", "paper": "paper's motors"}


def merged(value, patch):
    """Applies a patch to a JSON value according to RFC 7396, as `extends` of a config does. Returns the result."""
    if not isinstance(patch, dict):
        return patch
    result = dict(value) if isinstance(value, dict) else {}
    for key, member in patch.items():
        if member is None:
            result.pop(key, None)
        else:
            result[key] = merged(result.get(key), member)
    return result


@functools.cache
def shipped(name, chip):
    """Returns the config of a shipped mission for a chip."""
    mission = json.loads((ROOT / f"configs/{name}{CHIPS[chip]}.json").read_text())
    if "extends" not in mission:
        return mission
    return merged(json.loads((ROOT / "configs" / mission["extends"]).read_text()), mission["changes"])


def lens(field_of_view, chip):
    """Converts the field of view [rad] of a shipped mission with the first chip to that of the same mission with this chip."""
    def of(name, on):
        return shipped(name, on)["instances"]["world"]["parameters"].get(LENS.removeprefix("world."))
    return {of(name, FIRST_CHIP): of(name, chip) for name in SHIPPED}[field_of_view]


def scene(name):
    """Returns the content of a scene file of fmu_world."""
    return json.loads((ROOT / f"fmu_world/params/scenes/{name}.json").read_text())


def scenario(name):
    """Returns the parameters of a scenario in scenarios.json, without their sources."""
    data = json.loads((ROOT / "examples/paper/scenarios.json").read_text())[name]
    return {key: entry["value"] for key, entry in data.items()}


@dataclasses.dataclass(frozen=True)
class Flight:
    """A flight. Speeds are in km/h, as in the paper."""
    name: str
    scenario: str
    speed_km_h: float
    adaptive: bool = False
    battery: str = "bitcraze_250"
    equal_mass: bool = False
    motors: str = "bench"
    extra: tuple = ()       # further (variable, value) pairs
    stop_time: float = 600.0
    stuck_s: float = None   # time until the end after the referee reported a stuck drone; None: no end
    record: tuple = ()      # variables to record; None: the default list
    pictures: bool = False
    replay: bool = False    # if True, records everything that the page of the flight shows

    def parameters(self, chip):
        values = dict(scenario(self.scenario))
        if LENS in values:
            values[LENS] = lens(values[LENS], chip)
        values["soc.mission.navigator"] = "network"
        values["soc.mission.cruise_speed"] = self.speed_km_h * KM_H
        values["soc.mission.initial_speed"] = self.speed_km_h * KM_H
        values["soc.mission.policy"] = "adaptive" if self.adaptive else "constant"
        values["battery.cell.name"] = CELLS[self.battery]
        values["motors.power_model"] = "hover_propel" if self.motors == "paper" else "bench"
        if self.equal_mass:
            _, _, mass = BATTERIES[self.battery]
            values["world.drone.dry_mass"] = DRY_MASS_KG + (HEAVIEST_G - mass) / 1000
        values.update(self.extra)
        return values


DRY_MASS_KG = next(v["start"] for v in json.loads((ROOT / "fmu_world/description.json").read_text())["variables"]
                   if v["name"] == "drone.dry_mass")

RECORDED = ["world.drone.position.x", "world.drone.position.y", "world.drone.position.z", "world.drone.speed",
            "world.drone.yaw", "world.drone.phase", "world.gate.crossed", "world.gate.passed", "world.gate.touched",
            "world.gate.distance", "battery.cell.connected", "battery.cell.state_of_charge", "battery.cell.voltage", "soc.setpoint.yaw_rate",
            "soc.setpoint.velocity.x", "motors.power", "motors.avionics.power", "soc.power", "soc.camera.power",
            "battery.energy.open_circuit", "battery.energy.delivered", "battery.energy.converters",
            "battery.energy.ohmic", "battery.energy.polarisation", "battery.motors.energy", "battery.soc.energy",
            "battery.camera.energy", "battery.avionics.energy"]
CHIP_PARTS = [f"soc.energy.{part}" for part in ("fabric_controller", "cluster_cores", "fc_memory", "l2", "l1",
                                                "interconnect", "dma", "fc_background", "cluster_background", "leakage",
                                                "retention")]


def config(flight, chip):
    """Returns the config of a flight: gate_easy for this chip, with the parameters, stop conditions and recorded variables of the
    flight."""
    system = copy.deepcopy(shipped("gate_easy", chip))
    system["text"] = flight.name
    system["stop_time"] = flight.stop_time
    for variable, value in flight.parameters(chip).items():
        instance, name = variable.split(".", 1)
        system["instances"][instance].setdefault("parameters", {})[name] = value
    system["stop_when"].append({"variable": "world.gate.missed", "equals": True, "for": 2})
    if flight.stuck_s is not None:
        system["stop_when"].append({"variable": "world.gate.stuck", "equals": True, "for": flight.stuck_s})
    system["record"] = {"variables": list(flight.record) or RECORDED, "interval": 0.1}
    if flight.replay:
        system["record"] = {"interval": 0.03}
        system["pictures"][0]["interval"] = 3  # long, because a stuck flight takes long
    elif not flight.pictures:
        del system["pictures"]
    return system
