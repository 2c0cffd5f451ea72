# SPDX-License-Identifier: Apache-2.0
"""Runs fmu_motors with one rotor file. The caller provides the duty cycles and voltages."""
import json
import tempfile
from functools import lru_cache
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

COMMAND = [f"rotor[{i}].command" for i in range(1, 5)]
SPEED = [f"rotor[{i}].speed" for i in range(1, 5)]
DUTIES = np.linspace(0, 1, 41)
SETTLED_S = 6.0
SETTLING_STEP_S = 0.5  # long, because the model has a closed form and needs no small steps


class Motors:
    def __init__(self, archive, rotor):
        self.folder = tempfile.TemporaryDirectory()
        fmpy.extract(archive, self.folder.name)
        self.description = fmpy.read_model_description(archive)
        self.at = {v.name: v.valueReference for v in self.description.modelVariables}
        self.rotor = rotor
        self.data = json.loads((Path(self.folder.name) / f"resources/rotors/{rotor}.json").read_text())
        self.thrust_coefficient = self.data["thrust_coefficient"]["value"]

    def _begin(self):
        slave = FMU2Slave(guid=self.description.guid, unzipDirectory=self.folder.name, instanceName="motors",
                          modelIdentifier=self.description.coSimulation.modelIdentifier)
        slave.instantiate()
        slave.setupExperiment(startTime=0.0)
        slave.setString([self.at["rotor_data"]], [self.rotor])
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        return slave

    def fly(self, flight):
        """Returns speed and power of the four rotors at each row of a flight. Duty cycles and voltages are inputs. The flight
        starts in the air, so the first row is applied until the rotors are steady."""
        slave = self._begin()
        inputs = [self.at[n] for n in [*COMMAND, "bus.voltage"]]
        outputs = [self.at[n] for n in [*SPEED, "power"]]
        rows, now = [], 0.0
        steps = np.diff(flight.time_s, prepend=flight.time_s[0] - SETTLED_S)
        for duty, voltage, step in zip(np.roll(flight.duty, 1, axis=1).T, np.roll(flight.voltage_v, 1), steps):
            if not rows:
                duty, voltage = flight.duty[:, 0], flight.voltage_v[0]
            slave.setReal(inputs, [*duty, voltage])
            slave.doStep(now, step)
            now += step
            rows.append(slave.getReal(outputs))
        slave.terminate()
        slave.freeInstance()
        table = np.array(rows).T
        return table[:4], table[4]

    @lru_cache(maxsize=None)
    def settled(self, voltage_v):
        """Returns the steady speed and power of one rotor at each of DUTIES."""
        slave, now, rows = self._begin(), 0.0, []
        for duty in DUTIES:
            slave.setReal([self.at[n] for n in [*COMMAND, "bus.voltage"]], [duty] * 4 + [voltage_v])
            for _ in range(round(SETTLED_S / SETTLING_STEP_S)):
                slave.doStep(now, SETTLING_STEP_S)
                now += SETTLING_STEP_S
            speed, power = slave.getReal([self.at[n] for n in (SPEED[0], "power")])
            rows.append((speed, power / 4))
        slave.terminate()
        slave.freeInstance()
        return np.array(rows).T

    def speed_at(self, duty, voltage_v):
        return np.interp(duty, DUTIES, self.settled(round(voltage_v, 2))[0])

    def power_at_speed(self, speed, voltage_v):
        return np.interp(speed, *self.settled(round(voltage_v, 2)))

    def power_at_thrust(self, thrust_n, voltage_v):
        return self.power_at_speed(np.sqrt(thrust_n / self.thrust_coefficient), voltage_v)
