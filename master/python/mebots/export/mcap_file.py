# SPDX-License-Identifier: Apache-2.0
"""Writes a run's results as an MCAP file, which Foxglove, Lichtblick and PlotJuggler open.

Channels: /<instance> for the recorded variables of each instance, nested by the dots of the names (`rotor[1]` becomes
`rotor_1`), with units in the schema; /tf for the poses of the bodies in the scene; /scene for its faces; /<picture> for
the pictures of a camera; /log. Poses, faces, pictures and log have Foxglove's own schemas, in JSON.
"""

from __future__ import annotations

import base64
import gzip
import json
import math
import pathlib
import re
from typing import Any

from mebots.errors import InputError
from mebots.results import Results, read

try:
    from mcap.writer import Writer
except ImportError as error:
    raise InputError(
        "an MCAP file needs the package mcap: install it with pip for the Python that MEBOTS_PYTHON names", "not_offered") from error

NUMBER, TEXT, INTEGER = {"type": "number"}, {"type": "string"}, {"type": "integer"}


def record(title=None, **properties):
    """Returns a JSON schema of an object."""
    schema = {"type": "object", "properties": properties}
    return {"title": title, **schema} if title else schema


TIME = record(sec=INTEGER, nsec=INTEGER)
POINT = record(x=NUMBER, y=NUMBER, z=NUMBER)
QUATERNION = record(x=NUMBER, y=NUMBER, z=NUMBER, w=NUMBER)
COLOUR = record(r=NUMBER, g=NUMBER, b=NUMBER, a=NUMBER)
BYTES = {"type": "string", "contentEncoding": "base64"}


def list_of(items):
    return {"type": "array", "items": items}


SCHEMAS = {
    "foxglove.FrameTransform": record("foxglove.FrameTransform", timestamp=TIME, parent_frame_id=TEXT, child_frame_id=TEXT,
                                      translation=POINT, rotation=QUATERNION),
    "foxglove.CompressedImage": record("foxglove.CompressedImage", timestamp=TIME, frame_id=TEXT, data=BYTES, format=TEXT),
    "foxglove.Log": record("foxglove.Log", timestamp=TIME, level=INTEGER, message=TEXT, name=TEXT, file=TEXT, line=INTEGER),
    "foxglove.SceneUpdate": record("foxglove.SceneUpdate", deletions=list_of(record()), entities=list_of(record(
        timestamp=TIME, frame_id=TEXT, id=TEXT, lifetime=TIME, frame_locked={"type": "boolean"}, metadata=list_of(record()),
        triangles=list_of(record(pose=record(position=POINT, orientation=QUATERNION), points=list_of(POINT), color=COLOUR,
                                 colors=list_of(COLOUR), indices=list_of(INTEGER)))))),
}
LEVELS = {"warning": 3, "error": 4}  # levels of foxglove.Log; 2 = info


def nanoseconds(time_s):
    time_ns = round(float(time_s) * 1e9)
    if time_ns < 0:
        raise InputError(f"a point at {time_s} s: MCAP has no times before 0 s; start the run at 0 s or later", "invalid_value")
    return time_ns


def timestamp(time_ns):
    return {"sec": time_ns // 1_000_000_000, "nsec": time_ns % 1_000_000_000}


def path_of(variable):
    """Returns the keys of a variable in the message of its instance, one for each part of the name. `rotor[1].speed` gives `rotor_1` and
    `speed`."""
    return [re.sub(r"\[([^\]]*)\]", r"_\1", step).replace(",", "_") for step in variable.split(".")]


def put(message, path, value):
    """Sets the value at a path of nested dicts. If one name is the beginning of another (`power`, `power.l2`), its value gets the key
    `value` in the dict `power`."""
    for step in path[:-1]:
        inner = message.setdefault(step, {})
        if not isinstance(inner, dict):
            inner = message[step] = {"value": inner}
        message = inner
    last = path[-1]
    if isinstance(message.get(last), dict):
        message[last]["value"] = value
    else:
        message[last] = value


def quaternion(roll, pitch, yaw):
    """Returns the rotation by yaw about z, then pitch about the new y, then roll about the new x."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return {"w": cr * cp * cy + sr * sp * sy, "x": sr * cp * cy - cr * sp * sy,
            "y": cr * sp * cy + sr * cp * sy, "z": cr * cp * sy - sr * sp * cy}


class Export:
    """An open MCAP file. The messages of a channel must be in the order of time."""

    def __init__(self, file):
        self.writer = Writer(file)
        self.writer.start(profile="", library="mebots")
        self.schemas = {}
        self.channels = {}

    def add(self, topic, schema_name, schema, time_ns, message):
        if topic not in self.channels:
            if schema_name not in self.schemas:
                self.schemas[schema_name] = self.writer.register_schema(
                    name=schema_name, encoding="jsonschema", data=json.dumps(schema).encode())
            self.channels[topic] = self.writer.register_channel(
                topic=topic, message_encoding="json", schema_id=self.schemas[schema_name])
        self.writer.add_message(channel_id=self.channels[topic], log_time=time_ns, publish_time=time_ns,
                                data=json.dumps(message).encode())

    def add_known(self, topic, schema_name, time_ns, message):
        self.add(topic, schema_name, SCHEMAS[schema_name], time_ns, message)

    def finish(self):
        self.writer.finish()


def instance_of(name, instances):
    return next((each for each in instances if name.startswith(each + ".")), name.split(".")[0])


def export_variables(export, results: Results, instances):
    groups: dict[str, list[tuple[list, list, str]]] = {}
    for name in results.variables:
        instance = instance_of(name, instances)
        values = results[name]
        values = values if isinstance(values, list) else values.tolist()
        groups.setdefault(instance, []).append((values, path_of(name[len(instance) + 1:]), results.unit(name) or "-"))
    for instance, columns in groups.items():
        units: dict[str, Any] = {}
        for values, path, unit in columns:
            put(units, path, {"type": "string" if values and isinstance(values[0], str) else "number", "description": f"[{unit}]"})
        schema = record(f"mebots.{instance}", **units)
        for row, time in enumerate(results.times):
            message: dict[str, Any] = {}
            for values, path, _ in columns:
                put(message, path, values[row])
            export.add(f"/{instance}", f"mebots.{instance}", schema, nanoseconds(time), message)


def export_scene(export, results: Results, scene, instance):
    for body in scene.get("bodies", []):
        names = [f"{instance}.{name}" for name in body["position"] + body["attitude"]]
        if not all(name in results for name in names):
            continue
        rows = zip(results.times.tolist(), *(results[name].tolist() for name in names), strict=True)
        for time, x, y, z, *angles in rows:
            time_ns = nanoseconds(time)
            export.add_known("/tf", "foxglove.FrameTransform", time_ns, {
                "timestamp": timestamp(time_ns), "parent_frame_id": "world", "child_frame_id": body["name"],
                "translation": {"x": x, "y": y, "z": z}, "rotation": quaternion(*angles)})
    greys = [mean_grey(texture) for texture in scene.get("textures", [])]
    movers = scene.get("movers", [])
    standing: list[dict[str, Any]] = []
    moving: list[list[dict[str, Any]]] = [[] for _ in movers]
    for face in scene.get("faces", []):
        grey = min(1.0, greys[face["texture"]] * face["light"] / 255)
        moved = "mover" in face
        origin = movers[face["mover"]]["origin"] if moved else (0, 0, 0)
        points = [dict(zip("xyz", (a - b for a, b in zip(corner, origin)))) for corner in face["corners"]]
        (moving[face["mover"]] if moved else standing).append({
            "pose": {"position": {"x": 0, "y": 0, "z": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}},
            "points": points, "color": {"r": grey, "g": grey, "b": grey, "a": 1}, "colors": [],
            "indices": [index for i in range(1, len(points) - 1) for index in (0, i, i + 1)]})
    entities = [entity("world", scene.get("name", "scene"), False, standing)]
    entities += [entity(f"mover {i}", f"mover {i}", True, triangles) for i, triangles in enumerate(moving)]
    export.add_known("/scene", "foxglove.SceneUpdate", 0, {"deletions": [], "entities": entities})
    for i, mover in enumerate(movers):
        a, b, c = mover["origin"]
        for time, (x, y, z), turn in displacements(mover, instance, results):
            time_ns = nanoseconds(time)
            export.add_known("/tf", "foxglove.FrameTransform", time_ns, {
                "timestamp": timestamp(time_ns), "parent_frame_id": "world", "child_frame_id": f"mover {i}",
                "translation": {"x": a + x, "y": b + y, "z": c + z}, "rotation": quaternion(0, 0, turn)})


def entity(frame, name, locked, triangles):
    return {"timestamp": timestamp(0), "frame_id": frame, "id": name, "lifetime": timestamp(0), "frame_locked": locked,
            "metadata": [], "triangles": triangles}


def displacements(mover, instance, results):
    """Yields time, offset and rotation of an object on a path, or of a robot with a recorded pose."""
    times = results.times.tolist()
    if "points" in mover:
        yield from ((time, *displacement(mover, time)) for time in times)
        return
    names = [f"{instance}.{name}" for name in (*mover["position"], mover["yaw"])]
    if all(name in results for name in names):
        for time, x, y, z, yaw in zip(times, *(results[name].tolist() for name in names), strict=True):
            yield time, (x, y, z), yaw


def displacement(mover, time_s):
    """Returns offset and rotation of a body on its own path (docs/seeing.md)."""
    points = mover["points"]
    end = points[-1]["time"]
    now = time_s % end if mover["repeat"] else min(time_s, end)
    a, b = next((a, b) for a, b in zip(points, points[1:]) if now <= b["time"])
    share = (now - a["time"]) / (b["time"] - a["time"])
    return [p + share * (q - p) for p, q in zip(a["offset"], b["offset"])], a["turn"] + share * (b["turn"] - a["turn"])


def mean_grey(texture):
    grey = base64.b64decode(texture["grey"])
    return sum(grey) / len(grey)


def export_pictures(export, folder):
    for series in sorted(folder.glob("pictures/*")):
        for file in sorted(series.glob("*.png")):
            time_ns = nanoseconds(file.stem)
            export.add_known(f"/{series.name}", "foxglove.CompressedImage", time_ns, {
                "timestamp": timestamp(time_ns), "frame_id": series.name, "format": "png",
                "data": base64.b64encode(file.read_bytes()).decode()})


def export_log(export, file):
    for line in file.read_text(errors="replace").splitlines():
        timed = re.match(r"\[\s*([\d.]+) s\] ([^:]+): (?:(warning|error): )?(.*)", line)
        if not timed:
            continue  # notices of the run have no time
        time_s, name, severity, text = timed.groups()
        time_ns = nanoseconds(time_s)
        export.add_known("/log", "foxglove.Log", time_ns, {
            "timestamp": timestamp(time_ns), "level": LEVELS.get(severity, 2), "message": text, "name": name, "file": "", "line": 0})


def write_mcap(folder: pathlib.Path, out: pathlib.Path) -> None:
    """Writes a results folder as an MCAP file. Raises InputError if this fails."""
    results = read(folder)
    try:
        system = json.loads((folder / "system.json").read_text())
        scene = read_scene(folder)
    except (OSError, ValueError) as error:
        raise InputError(f"{folder}: this is not the results folder of a run: {error}", "file_not_found") from None
    with out.open("wb") as file:
        export = Export(file)
        export_variables(export, results, system["instances"])
        if scene:
            export_scene(export, results, scene, system["view"]["scene"]["instance"])
        export_pictures(export, folder)
        if (folder / "log.txt").exists():
            export_log(export, folder / "log.txt")
        export.finish()


def read_scene(folder: pathlib.Path):
    """Returns the scene of a run, or None."""
    file = folder / "scene.json.gz"
    return json.loads(gzip.decompress(file.read_bytes())) if file.exists() else None
