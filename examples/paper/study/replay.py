# SPDX-License-Identifier: Apache-2.0
"""Replays a flight's loads with another cell. Computes the results of the battery's FMU for the recorded powers of a flight with
the paper's motors, with or without the flight controller's power and the cell's resistance. The flight path does not change."""

import functools
import json
import pathlib
import tempfile

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

from missions import CELLS, ROOT
from results import CRUISE

# The columns in addition to the column of the bench's motors. Each column omits one more effect. An entry contains its label, and
# whether it includes the flight controller's power and the cell's resistance.
READINGS = {"paper": ("paper's motors", True, True), "no_avionics": ("without flight controller", False, True),
            "no_losses": ("nor cell resistance", False, False)}
LOADS = {"motors.power": "motors.power", "soc.power": "soc.power", "camera.power": "soc.camera.power",
         "avionics.power": "motors.avionics.power"}  # maps inputs of the battery to recorded variables of a flight
RESISTANCE = 1e-3  # factor of the cell's resistance if it must have no effect; the time constants stay the same
TEN = 0.10
LONGEST_S = 1800.0


@functools.cache
def cell(name, resistance):
    """Returns the cell parameter for a battery: the name of its file, or the path of a copy with almost no resistance."""
    name = CELLS[name]
    if resistance:
        return name
    data = json.loads((ROOT / f"fmu_battery/params/cells/{name}.json").read_text())
    for key, factor in (("resistance_factor", RESISTANCE), ("capacitance_factor", 1 / RESISTANCE)):
        data[key]["value"] *= factor
        data[key].pop("interval", None)
    path = pathlib.Path(tempfile.mkdtemp(prefix="mebots-cell-")) / f"{name}.json"
    path.write_text(json.dumps(data))
    return str(path)


def paper_power(trace, hover, cruise):
    """Returns the motors' power over time by the paper's model [W], for a flight that was simulated with the bench's motors. It
    consists of a part for hovering, which two flights determine, and a part proportional to speed. It is 0 while the motors are
    off."""
    def settled(flight):
        chosen = flight["world.drone.phase"] == CRUISE
        half = chosen & (np.cumsum(chosen) > chosen.sum() / 2)
        return flight["motors.power"][half].mean(), flight["world.drone.speed"][half].mean()
    (hover_w, still), (cruise_w, fast) = settled(hover), settled(cruise)
    per_speed = (cruise_w - hover_w) / (fast - still)
    on = trace["motors.power"] > 0
    return on * (hover_w + per_speed * (trace["world.drone.speed"] - still))


class Battery:
    """Runs the battery's FMU. Only one instance exists at a time."""

    def __init__(self, fmu):
        self.folder = fmpy.extract(str(fmu))
        description = fmpy.read_model_description(str(fmu))
        self.guid, self.model = description.guid, description.coSimulation.modelIdentifier
        self.references = {v.name: v.valueReference for v in description.modelVariables}

    def charges(self, name, loads, steps, enough):
        """Returns the charge at the start and after each step. `steps` contains the lengths of the steps [s]. `loads` is {input:
        array of W}. Ends when `enough(charge)` is true.
        """
        fmu = FMU2Slave(guid=self.guid, unzipDirectory=self.folder, instanceName="replay", modelIdentifier=self.model)
        fmu.instantiate()
        fmu.setupExperiment(startTime=0.0)
        fmu.setString([self.references["cell.name"]], [name])
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        inputs = [self.references[load] for load in loads]
        charge = [self.references["cell.state_of_charge"]]
        found, time = [fmu.getReal(charge)[0]], 0.0
        for i, step in enumerate(steps):
            fmu.setReal(inputs, [float(values[i]) for values in loads.values()])
            fmu.doStep(time, float(step))
            time += step
            found.append(fmu.getReal(charge)[0])
            if enough(found[-1]):
                break
        fmu.terminate()
        fmu.freeInstance()
        return np.array(found)

    def of_flight(self, trace, motors_w, name, avionics, resistance):
        """Returns the charge at the samples of the flight for the power `motors_w` of the motors."""
        loads = {load: trace[column] * (avionics or load != "avionics.power") for load, column in LOADS.items()}
        loads["motors.power"] = motors_w
        means = {load: (values[1:] + values[:-1]) / 2 for load, values in loads.items()}
        return self.charges(cell(name, resistance), means, np.diff(trace.time), lambda charge: False)

    def to_ten_s(self, trace, name, avionics, resistance):
        """Returns the time after leaving the ground at which 10 % of the charge would be left [s], if the loads of the cruise
        continued."""
        cruise = np.flatnonzero(trace["world.drone.phase"] == CRUISE)
        settled = cruise[len(cruise) // 2]
        step = float(np.median(np.diff(trace.time)))
        more = int(LONGEST_S / step)
        loads = {load: np.concatenate([trace[column][1:settled], np.full(more, trace[column][cruise].mean())]) *
                 (avionics or load != "avionics.power") for load, column in LOADS.items()}
        steps = np.concatenate([np.diff(trace.time[:settled]), np.full(more, step)])
        charges = self.charges(cell(name, resistance), loads, steps, lambda charge: charge <= TEN)
        return float(steps[:len(charges) - 1].sum() - trace.flown()[0])
