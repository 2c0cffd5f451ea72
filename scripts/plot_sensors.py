#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/img/sensors.png with the built fmu_world: a picture with boxes, its depth picture, and a map of the multi-ranger.

    .venv/bin/python scripts/plot_sensors.py build/release/fmus/fmu_world.fmu
"""
import base64
import json
import math
import shutil
import sys
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

import figure_style as style
from figure_style import plt

ROOT = Path(__file__).resolve().parent.parent
SIZE = 320
TURNS = 90
LIMIT = 3.95  # a ray that meets nothing reads 4 m and noise


class World:
    """An unpacked fmu_world of FMI 2.0."""

    def __init__(self, archive):
        self.folder = fmpy.extract(str(archive))
        self.description = fmpy.read_model_description(self.folder)
        self.variables = {v.name: v for v in self.description.modelVariables}

    def step(self, start, outputs):
        """Returns outputs after a step of 2 ms from these start values."""
        model = FMU2Slave(guid=self.description.guid, unzipDirectory=self.folder,
                          modelIdentifier=self.description.coSimulation.modelIdentifier, instanceName="world")
        model.instantiate()
        model.setupExperiment(startTime=0)
        for name, value in start.items():
            variable = self.variables[name]
            kind = "Integer" if variable.type in ("Integer", "Enumeration") else variable.type
            getattr(model, f"set{kind}")([variable.valueReference], [value])
        model.enterInitializationMode()
        model.exitInitializationMode()
        model.doStep(0, 0.002)
        values = [getattr(model, f"get{self.variables[n].type}")([self.variables[n].valueReference])[0] for n in outputs]
        model.terminate()
        model.freeInstance()
        return values


def pictures(world, left, middle):
    """Draws a camera's picture with the boxes of the gates, and its depth picture."""
    frame, depth, objects = world.step(
        {"scene.name": "warehouse", "start.offset.x": 3.0, "start.offset.z": 1.2, "camera.trigger": 1, "camera.labels": True, "camera.depth_enabled": True},
        ["camera.frame.base64", "camera.depth.base64", "camera.objects"])
    left.imshow(np.frombuffer(base64.b64decode(frame), "u1").reshape(SIZE, SIZE), cmap="gray", vmin=0, vmax=255)
    for found in json.loads(objects)["objects"]:
        x, y, right, bottom = found["box"]
        left.add_patch(plt.Rectangle((x - 0.5, y - 0.5), right - x, bottom - y, fill=False, color=style.VERMILION, lw=1.2))
    texts = [f"{found['name']}: {100 * found['visible']:.0f} % visible, {found['distance']:.1f} m" for found in json.loads(objects)["objects"]]
    left.set_xlabel("\n".join(texts), fontsize=8)
    left.set_title("camera.frame and camera.objects")
    metres = np.frombuffer(base64.b64decode(depth), "<u2").reshape(SIZE, SIZE) / 1000
    shown = middle.imshow(np.where(metres > 0, metres, np.nan), vmax=14)
    plt.colorbar(shown, ax=middle, fraction=0.046, label="depth [m]")
    middle.set_title("camera.depth")
    for axis in (left, middle):
        axis.set(xticks=[], yticks=[])


def ranger_map(world, axis):
    """Turns a drone by a quarter turn in front of the gate, so that its four rangers cover all directions. Draws their readings."""
    names = [f"multiranger.{word}" for word in ("front", "left", "back", "right")]
    place = 3.0
    points = [[] for _ in names]
    for turn in range(TURNS):
        yaw = math.pi / 2 * turn / TURNS
        readings = world.step({"scene.name": "warehouse", "start.offset.x": place, "start.offset.z": 1.2, "start.yaw_offset": yaw,
                               "multiranger.enabled": True}, names)
        for k, reading in enumerate(readings):
            angle = yaw + k * math.pi / 2
            if reading < LIMIT:
                points[k].append((place + (reading + 0.0175) * math.cos(angle), (reading + 0.0175) * math.sin(angle)))
    for name, found in zip(names, points):
        axis.plot(*np.array(found).reshape(-1, 2).T, ".", ms=3, label=name.split(".")[1])
    axis.plot(place, 0, "^", color=style.INK, ms=6)
    axis.set(xlabel="x [m]", ylabel="y [m]", title="multi-ranger, one turn at the same place", aspect="equal",
             xlim=(place - 4, place + 4), ylim=(-4, 4))
    axis.legend(fontsize=8, loc="center left")


def main():
    world = World(sys.argv[1])
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.8))
    try:
        pictures(world, axes[0], axes[1])
        ranger_map(world, axes[2])
    finally:
        shutil.rmtree(world.folder)
    figure.tight_layout()
    style.save(figure, ROOT / "docs/img/sensors.png")


if __name__ == "__main__":
    main()
