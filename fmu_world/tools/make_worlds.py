#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the two example worlds: params/scenes/warehouse.json and forest.json, with their pictures and meshes in
params/things.

    .venv/bin/python fmu_world/tools/make_worlds.py

Needs NumPy and Pillow. Each run writes the same bytes. Before you commit the worlds, look at them: mebots-camera renders a scene.
The ground of each world is one picture with painted shadows of the objects.
"""
import json
import math
import struct
from pathlib import Path

import numpy as np
from PIL import Image

PARAMS = Path(__file__).resolve().parent.parent / "params"
THINGS = PARAMS / "things"
CONTACT = json.loads((PARAMS / "scenes/gate_easy.json").read_text())["contact"]
rng = np.random.default_rng(7)


# Functions that draw pictures.


def value_noise(size, cells, octaves=4):
    """Returns smooth repeating noise in 0..1, size x size."""
    total = np.zeros((size, size))
    weight = 0.0
    for octave in range(octaves):
        n = cells << octave
        lattice = rng.random((n, n))
        at = np.arange(size) * n / size
        i = at.astype(int)
        f = at - i
        f = f * f * (3 - 2 * f)
        j = (i + 1) % n
        rows = lattice[i] * (1 - f)[:, None] + lattice[j] * f[:, None]
        total += (rows[:, i] * (1 - f) + rows[:, j] * f) / (1 << octave)
        weight += 1 / (1 << octave)
    return total / weight


def save(name, grey):
    Image.fromarray(np.clip(np.round(grey), 0, 255).astype(np.uint8)).save(THINGS / name, optimize=True)


def crate():
    size = 128
    grain = value_noise(size, 4)
    stretched = np.repeat(grain[:, ::8], 8, axis=1)
    picture = 150 + 50 * (stretched - 0.5) + 16 * (value_noise(size, 16) - 0.5)
    for board in range(0, size, 32):
        picture[board:board + 2] = 70
    frame = 14
    for part in (np.s_[:frame], np.s_[-frame:], np.s_[:, :frame], np.s_[:, -frame:]):
        picture[part] = 178 + 30 * (grain[part] - 0.5)
    picture[frame] = picture[-frame] = 60
    picture[:, frame] = picture[:, -frame] = 60
    y, x = np.mgrid[:size, :size]
    brace = np.abs(x - y) < 9
    inside = (x > frame) & (x < size - frame) & (y > frame) & (y < size - frame)
    picture[brace & inside] = 185 + 30 * (grain[brace & inside] - 0.5)
    picture[(np.abs(np.abs(x - y) - 9) < 1) & inside] = 70
    nails = np.zeros((size, size), bool)
    for a in (7, 64, size - 8):
        for b in (7, size - 8):
            nails |= ((x - a) ** 2 + (y - b) ** 2 < 6) | ((x - b) ** 2 + (y - a) ** 2 < 6)
    picture[nails] = 50
    save("crate.png", picture)


def sign():
    """Draws an arrow on a board, and saves the picture."""
    width, height = 128, 64
    picture = np.full((height, width), 225.0)
    y, x = np.mgrid[:height, :width]
    shaft = (np.abs(y - 31.5) < 8) & (x > 16) & (x < 80)
    head = (x >= 78) & (np.abs(y - 31.5) < (112 - x) * 0.75)
    picture[shaft | head] = 40
    picture[:3] = picture[-3:] = 40
    picture[:, :3] = picture[:, -3:] = 40
    save("sign.png", picture)


def bark_and_metal():
    size = 128
    noise = value_noise(size, 4)
    sheet = 172 + 22 * np.sin(np.arange(size) * 2 * math.pi * 8 / size)[None, :] + 26 * (noise - 0.5)
    save("sheet.png", sheet)


# Functions that draw shadows on a ground.


def soft_shadow(points, to_sun, boxes, balls, samples=12):
    """Returns the share of the sun that reaches points (n, 3). Boxes: (centre, size, yaw); balls: (centre, radius)."""
    to_sun = np.array(to_sun) / np.linalg.norm(to_sun)
    slope = np.hypot(*to_sun[:2]) / to_sun[2] + 0.1
    seen = np.full(len(points), float(samples))
    blocked = np.zeros((samples, len(points)), bool)

    def near(centre, radius, top):
        """Returns the indices of points that the object's shadow can reach."""
        return np.nonzero(((points[:, :2] - np.array(centre)[:2]) ** 2).sum(axis=1) < (radius + slope * top) ** 2)[0]

    for k in range(samples):
        turn = 2 * math.pi * k / samples
        towards = to_sun + 0.05 * np.array([math.cos(turn), math.sin(turn), 0])
        towards /= np.linalg.norm(towards)
        for centre, size, yaw in boxes:
            there = near(centre, 0.5 * math.hypot(*size[:2]), centre[2] + size[2] / 2)
            c, s = math.cos(yaw), math.sin(yaw)
            turned = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
            p = (points[there] - centre) @ turned.T
            d = turned @ towards
            one, other = (-np.array(size) / 2 - p) / d, (np.array(size) / 2 - p) / d
            enter = np.minimum(one, other).max(axis=1)
            leave = np.maximum(one, other).min(axis=1)
            blocked[k, there] |= (enter <= leave) & (leave > 1e-3)
        for centre, radius in balls:
            there = near(centre, radius, centre[2] + radius)
            way = np.array(centre) - points[there]
            along = way @ towards
            blocked[k, there] |= (along > 0) & ((way ** 2).sum(axis=1) - along ** 2 < radius ** 2)
    return (seen - blocked.sum(axis=0)) / samples


# Functions that write meshes.


def linear(grey):
    """Converts a grey level of a picture to the linear light of glTF's colours."""
    value = grey / 255
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def save_mesh(name, parts):
    """Saves a mesh. A part is (points (n, 3) with x forward, y left, z up; triangles (m, 3); grey level)."""
    blob, views, accessors, primitives, materials = b"", [], [], [], []
    for points, triangles, grey in parts:
        places = np.asarray(points, dtype="<f4")[:, [1, 2, 0]]  # glTF: x left, y up, z forward
        corners = np.asarray(triangles, dtype="<u2").reshape(-1)
        for data, kind, target, count in ((places, 5126, 34962, len(places)), (corners, 5123, 34963, len(corners))):
            raw = data.tobytes()
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(raw), "target": target})
            accessor = {"bufferView": len(views) - 1, "componentType": kind, "count": count,
                        "type": "VEC3" if kind == 5126 else "SCALAR"}
            if kind == 5126:
                accessor |= {"min": places.min(axis=0).tolist(), "max": places.max(axis=0).tolist()}
            accessors.append(accessor)
            blob += raw + b"\0" * (-len(raw) % 4)
        factor = round(linear(grey), 6)
        materials.append({"pbrMetallicRoughness": {"baseColorFactor": [factor, factor, factor, 1], "metallicFactor": 0}})
        primitives.append({"attributes": {"POSITION": len(accessors) - 2}, "indices": len(accessors) - 1,
                           "material": len(materials) - 1, "mode": 4})
    document = json.dumps({
        "asset": {"version": "2.0", "generator": "MEbots make_worlds.py"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}], "meshes": [{"primitives": primitives}], "materials": materials,
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(blob)}]}, separators=(",", ":")).encode()
    document += b" " * (-len(document) % 4)
    body = struct.pack("<II", len(document), 0x4E4F534A) + document + struct.pack("<II", len(blob), 0x004E4942) + blob
    (THINGS / name).write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)


def lathe(rings, sides, jitter=0.0):
    """Returns a closed surface around z from rings of (radius, height). A ring with radius 0 is a tip."""
    points, starts = [], []
    for radius, height in rings:
        starts.append(len(points))
        for i in range(sides if radius > 0 else 1):
            turn = 2 * math.pi * i / sides
            r = radius * (1 + jitter * (rng.random() - 0.5))
            points.append((r * math.cos(turn), r * math.sin(turn), height + jitter * radius * 0.5 * (rng.random() - 0.5)))
    triangles = []
    for (a, b), (ra, rb) in zip(zip(starts, starts[1:]), zip((r for r, _ in rings), (r for r, _ in rings[1:]))):
        for i in range(sides):
            j = (i + 1) % sides
            if ra > 0 and rb > 0:
                triangles += [(a + i, a + j, b + j), (a + i, b + j, b + i)]
            elif ra > 0:
                triangles.append((a + i, a + j, b))
            elif rb > 0:
                triangles.append((a, b + j, b + i))
    return np.array(points), np.array(triangles)


def icosphere(level):
    phi = (1 + 5 ** 0.5) / 2
    points = [np.array(p) / math.hypot(1, phi) for p in
              [(-1, phi, 0), (1, phi, 0), (-1, -phi, 0), (1, -phi, 0), (0, -1, phi), (0, 1, phi), (0, -1, -phi),
               (0, 1, -phi), (phi, 0, -1), (phi, 0, 1), (-phi, 0, -1), (-phi, 0, 1)]]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
             (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
             (8, 6, 7), (9, 8, 1)]
    for _ in range(level):
        halves, finer = {}, []

        def half(a, b):
            key = (min(a, b), max(a, b))
            if key not in halves:
                middle = points[a] + points[b]
                points.append(middle / np.linalg.norm(middle))
                halves[key] = len(points) - 1
            return halves[key]

        for a, b, c in faces:
            ab, bc, ca = half(a, b), half(b, c), half(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return np.array(points), np.array(faces)


def things_of_the_forest():
    trunk = lathe([(0.16, -0.3), (0.11, 0.6), (0.08, 1.2), (0, 1.5)], 7, 0.1)
    cones = []
    for base, top, radius, grey in ((0.7, 2.0, 0.95, 84), (1.35, 2.6, 0.78, 92), (1.95, 3.3, 0.56, 100)):
        cones.append((*lathe([(0, base + 0.12), (radius, base), (0.35 * radius, 0.5 * (base + top)), (0, top)], 9, 0.22), grey))
    save_mesh("fir.glb", [(*trunk, 72), *cones])
    trunk = lathe([(0.2, -0.3), (0.13, 0.7), (0.1, 1.5), (0, 1.9)], 7, 0.1)
    crowns = []
    for (x, y, z), radius, grey in (((0, 0, 2.1), 0.85, 124), ((0.5, 0.25, 1.75), 0.55, 112), ((-0.45, -0.3, 1.8), 0.6, 118)):
        points, faces = icosphere(1)
        crowns.append((points * (radius * (0.88 + 0.24 * rng.random(len(points))))[:, None] + (x, y, z), faces, grey))
    save_mesh("oak.glb", [(*trunk, 96), *crowns])
    points, faces = icosphere(1)
    rock = points * (0.8 + 0.4 * rng.random(len(points)))[:, None] * (1.0, 0.8, 0.6)
    save_mesh("rock.glb", [(rock, faces, 150)])
    points, faces = icosphere(2)
    basket = lathe([(0, -0.62), (0.09, -0.62), (0.11, -0.45), (0, -0.45)], 8)
    envelope = points * 0.34
    envelope[:, 2] *= np.where(points[:, 2] < 0, 1.25, 1.0)
    stripes = [(envelope, [f for f in faces if int((math.atan2(*envelope[f].mean(axis=0)[[1, 0]]) + math.pi) / (math.pi / 4)) % 2 == k],
                grey) for k, grey in ((0, 235), (1, 120))]
    save_mesh("balloon.glb", [*stripes, (*basket, 70)])


# Functions that write scenes.


def picture(file, scale, **more):
    return {"kind": "picture", "file": f"../things/{file}", "scale": scale, **more}


def box(name, position, size, texture, **more):
    return {"name": name, "position": position, "size": size, "texture": texture, **more}


def write(scene):
    """Writes a scene as JSON with one line per object."""
    lines = ["{"]
    keys = list(scene)
    for key in keys:
        comma = "," if key != keys[-1] else ""
        value = scene[key]
        if isinstance(value, list):
            lines.append(f'  "{key}": [')
            lines += [f"    {json.dumps(each)}{',' if i + 1 < len(value) else ''}" for i, each in enumerate(value)]
            lines.append(f"  ]{comma}")
        else:
            lines.append(f'  "{key}": {json.dumps(value)}{comma}')
    (PARAMS / f"scenes/{scene['name']}.json").write_text("\n".join(lines) + "\n}\n")


def head(name, text, start, ground, yaw=0):
    return {"$schema": "../../../configs/schemas/mebots-scene.schema.json", "name": name, "text": text,
            "drone": "../drones/crazyflie.json", "start": {"position": start, "yaw": yaw}, "ground": ground}


def warehouse():
    lighting = {"ambient": 0.5, "sun": 0.55, "to_sun": [-0.45, 0.4, 0.85], "background": 52}
    steel = {"kind": "uniform", "light": 92}
    board = {"kind": "noise", "light": 168, "dark": 130, "scale": 0.05, "seed": 5}
    boxes, cylinders = [], []
    sheet = picture("sheet.png", 1.6)
    for name, position, size in (("east wall", [14.05, 0, 2.0], [0.1, 10.2, 4.0]), ("north wall", [6.0, 5.05, 2.0], [16.0, 0.1, 4.0]),
                                 ("west wall", [-2.05, 0, 2.0], [0.1, 10.2, 4.0]), ("south wall", [6.0, -5.05, 2.0], [16.0, 0.1, 4.0])):
        boxes.append(box(name, position, size, sheet))
    boxes += [box(f"skirting {i}", p, s, {"kind": "uniform", "light": 70}) for i, (p, s) in enumerate((
        ([13.97, 0, 0.15], [0.06, 10.0, 0.3]), ([6.0, 4.97, 0.15], [15.9, 0.06, 0.3]), ([6.0, -4.97, 0.15], [15.9, 0.06, 0.3])))]
    for row, y in (("north", 3.7), ("south", -3.7)):
        for x in (2.0, 4.5, 7.0, 9.5):
            boxes += [box(f"{row} upright {x} {a}{b}", [x + a * 1.15, y + b * 0.42, 1.35], [0.07, 0.07, 2.7], steel)
                      for a in (-1, 1) for b in (-1, 1)]
            for level, z in enumerate((0.12, 1.0, 1.9)):
                boxes.append(box(f"{row} shelf {x} level {level}", [x, y, z], [2.3, 0.9, 0.05], board))
                for slot in (-0.72, 0.0, 0.72):
                    edge = float(rng.choice([0.45, 0.55, 0.62]))
                    if rng.random() < 0.28:
                        continue
                    boxes.append(box(f"{row} crate {x} {level} {slot}",
                                     [round(x + slot + 0.03 * float(rng.standard_normal()), 3), y, z + 0.025 + edge / 2], [edge, edge, edge],
                                     picture("crate.png", edge, light=int(rng.integers(200, 256))), yaw=round(0.08 * float(rng.standard_normal()), 3)))
    for i, (x, y) in enumerate(((3.4, 1.9), (8.6, -1.9), (11.6, 2.6))):
        cylinders.append({"name": f"pillar {i + 1}", "position": [x, y, 2.0], "radius": 0.16, "height": 4.0,
                          "texture": {"kind": "stripes", "light": 205, "dark": 190, "scale": 0.02}})
        cylinders.append({"name": f"bumper {i + 1}", "position": [x, y, 0.3], "radius": 0.2, "height": 0.6,
                          "texture": {"kind": "checker", "light": 230, "dark": 40, "scale": 0.157}})
    for i, (x, y) in enumerate(((12.6, -3.4), (12.0, -3.9), (12.9, -4.2), (12.45, -3.75))):
        z = 0.44 if i < 3 else 1.32
        cylinders.append({"name": f"barrel {i + 1}", "position": [x, y, z], "radius": 0.29, "height": 0.88,
                          "texture": {"kind": "noise", "light": 190 - 25 * i, "dark": 120 - 10 * i, "scale": 0.08, "seed": i}})
    cylinders.append({"name": "barrel that lies", "position": [11.2, -4.2, 0.29], "radius": 0.29, "height": 0.88, "roll": 1.5708,
                      "yaw": 0.5, "texture": {"kind": "noise", "light": 150, "dark": 95, "scale": 0.08, "seed": 9}})
    boxes.append(box("ramp", [0.2, -2.7, 0.28], [2.2, 1.1, 0.06], {"kind": "stripes", "light": 150, "dark": 110, "scale": 0.1}, pitch=-0.26))
    boxes.append(box("platform", [2.0, -2.7, 0.27], [1.5, 1.1, 0.54], board))
    boxes.append(box("sign", [13.98, 2.2, 2.2], [0.02, 1.6, 0.8], picture("sign.png", 1.6)))
    boxes.append(box("window", [13.98, -1.6, 2.7], [0.02, 2.4, 1.1], {"kind": "checker", "light": 250, "dark": 235, "scale": 0.4}))
    for x in (1.0, 5.0, 9.0, 13.0):
        boxes.append(box(f"beam {x}", [x, 0, 3.85], [0.18, 10.0, 0.22], steel))
    there_and_back = {"repeat": True, "points": [{"time": 0, "offset": [0, 0, 0]}, {"time": 8, "offset": [4.0, 0, 0]},
                                                 {"time": 10, "offset": [4.0, 0, 0], "turn": 3.14159265},
                                                 {"time": 18, "offset": [0, 0, 0], "turn": 3.14159265},
                                                 {"time": 20, "offset": [0, 0, 0], "turn": 6.2831853}]}
    boxes.append(box("cart", [5.6, -1.0, 0.2], [0.9, 0.6, 0.22], {"kind": "uniform", "light": 225}, path=there_and_back))
    boxes.append(box("crate on the cart", [5.6, -1.0, 0.56], [0.5, 0.5, 0.5], picture("crate.png", 0.5), path=there_and_back))
    gates = [
        {"name": "gate 1", "shape": "rectangle", "inner": [0.8, 0.6], "outer": [1.0, 0.8], "thickness": 0.05, "position": [4.0, 0.3],
         "opening_lower_edge": 0.75, "yaw": 0.05, "texture": {"kind": "uniform", "light": 250}},
        {"name": "gate 2", "shape": "circle", "inner": 0.7, "outer": 0.9, "thickness": 0.05, "position": [8.0, 0.6],
         "opening_lower_edge": 0.7, "yaw": 0.1, "texture": {"kind": "uniform", "light": 250}}]
    # Draws the floor: slabs, wear, lanes, shadows.
    size, left, bottom, edge = 512, -2.0, -8.0, 16.0
    x = left + edge * (np.arange(size) + 0.5) / size
    y = bottom + edge * (np.arange(size) + 0.5) / size
    gx, gy = np.meshgrid(x, y)
    floor = 150 + 42 * (value_noise(size, 6, 6) - 0.5)
    for lane in (-2.3, 2.3):
        floor[np.abs(gy - lane) < 0.05] = 228
    floor[(np.abs((gx - left) % 2.0) < 0.04) | (np.abs((gy - bottom) % 2.0) < 0.04)] *= 0.75
    points = np.stack([gx.ravel(), gy.ravel(), np.zeros(gx.size)], axis=1)
    solid = [(np.array(b["position"]), b["size"], b.get("yaw", 0)) for b in boxes
             if "path" not in b and "wall" not in b["name"] and "skirting" not in b["name"] and "beam" not in b["name"]]
    solid += [(np.array(c["position"]), [1.8 * c["radius"], 1.8 * c["radius"], c["height"]], 0.4) for c in cylinders]
    sun = soft_shadow(points, lighting["to_sun"], solid, []).reshape(gx.shape)
    near_wall = np.minimum.reduce([gx + 2, 14 - gx, gy + 5, 5 - gy])
    corner = 0.75 + 0.25 * np.clip(near_wall / 0.7, 0, 1)
    level = lighting["to_sun"][2] / np.linalg.norm(lighting["to_sun"])
    share = (lighting["ambient"] + lighting["sun"] * level * sun) / (lighting["ambient"] + lighting["sun"] * level)
    save("warehouse_floor.png", (floor * share * corner)[::-1])
    # Shifts the picture to its place, because the texture starts at the world's origin.
    ground = {"half_size": 14.0, "texture": picture("warehouse_floor.png", edge)}
    shift_picture("warehouse_floor.png", left, bottom, edge)
    write(head("warehouse", "A hall with shelves, pillars, a ramp and a cart that drives to and fro; a rectangular gate, then a round one.",
               [0, 0, 0.0145], ground) | {"boxes": boxes, "cylinders": cylinders, "gates": gates, "lighting": lighting, "contact": CONTACT})


def shift_picture(name, left, bottom, edge):
    """Shifts the picture of a ground texture cyclically. The texture repeats every `edge` metres from the world's origin. After
    the shift, the picture's lower left corner appears at (left, bottom)."""
    grey = np.asarray(Image.open(THINGS / name))
    size = grey.shape[0]
    save(name, np.roll(grey, (-round(bottom / edge * size), round(left / edge * size)), axis=(0, 1)))


def forest():
    lighting = {"ambient": 0.42, "sun": 0.72, "to_sun": [-0.5, -0.45, 0.75], "background": 226}
    cells, spacing, left, bottom = 30, 0.8, -6.0, -12.0
    edge = cells * spacing
    x = left + spacing * np.arange(cells + 1)
    y = bottom + spacing * np.arange(cells + 1)
    gx, gy = np.meshgrid(x, y)
    hills = 1.5 * np.exp(-((gx - 13) ** 2 + (gy - 5) ** 2) / 18) + 1.9 * np.exp(-((gx - 11) ** 2 + (gy + 8) ** 2) / 14)
    hills += 1.2 * np.exp(-((gx + 4) ** 2 + (gy - 8) ** 2) / 12) + 2.2 * np.exp(-((gx - 17) ** 2 + (gy + 1) ** 2) / 16)
    # The glade in the middle is level, because the drone starts there.
    rough = 0.5 * value_noise(32, 4, 3)[: cells + 1, : cells + 1]
    glade = np.clip((np.hypot((gx - 4) / 7.5, gy / 2.6) - 1) / 0.8, 0, 1)
    # The glade is 8 mm above the plane z = 0, which would otherwise hide it.
    heights = np.round(0.008 + (hills + rough) * glade, 3)

    def height_at(px, py):
        i, j = (px - left) / spacing, (py - bottom) / spacing
        a, b = min(int(i), cells - 1), min(int(j), cells - 1)
        return float((1 - (i - a)) * (1 - (j - b)) * heights[b, a] + (i - a) * (1 - (j - b)) * heights[b, a + 1]
                     + (1 - (i - a)) * (j - b) * heights[b + 1, a] + (i - a) * (j - b) * heights[b + 1, a + 1])

    meshes, balls = [], []
    places = [(9.5, 1.9), (6.4, -2.6), (2.5, 2.9), (12.2, -1.6), (-2.5, 2.6), (5.2, 4.1), (8.7, -4.6), (1.0, -3.6)]
    while len(places) < 34:
        px, py = left + 1 + (edge - 2) * rng.random(), bottom + 1 + (edge - 2) * rng.random()
        if math.hypot((px - 4) / 8.2, py / 2.8) > 1.05 and all(math.hypot(px - a, py - b) > 1.5 for a, b in places):
            places.append((px, py))
    for i, (px, py) in enumerate(places):
        kind = "oak" if i % 3 == 2 else "fir"
        scale = float(np.round(0.8 + 0.6 * rng.random(), 2))
        z = height_at(px, py)
        meshes.append({"name": f"{kind} {i + 1}", "file": f"../things/{kind}.glb", "scale": scale,
                       "position": [round(px, 2), round(py, 2), round(z, 3)], "yaw": round(6.28 * float(rng.random()), 2)})
        balls += [((px, py, z + scale * h), scale * r) for h, r in
                  (((2.05, 0.85), (1.75, 0.5)) if kind == "oak" else ((1.1, 0.75), (1.8, 0.55), (2.5, 0.33), (0.4, 0.12)))]
    for i in range(14):
        px, py = left + 2 + (edge - 4) * rng.random(), bottom + 2 + (edge - 4) * rng.random()
        if math.hypot((px - 4) / 7, py / 1.8) < 1:
            py += math.copysign(2.2, py)
        scale = float(np.round(0.25 + 0.5 * rng.random() ** 2, 2))
        meshes.append({"name": f"rock {i + 1}", "file": "../things/rock.glb", "scale": scale, "roll": round(float(rng.standard_normal()) * 0.3, 2),
                       "position": [round(px, 2), round(py, 2), round(height_at(px, py) + 0.2 * scale, 3)], "yaw": round(6.28 * float(rng.random()), 2)})
        balls.append(((px, py, height_at(px, py) + 0.2 * scale), 0.7 * scale))
    drift = {"repeat": True, "points": [{"time": 0, "offset": [0, 0, 0]}, {"time": 12, "offset": [1.5, 2.0, 0.4], "turn": 1.5},
                                        {"time": 24, "offset": [3.0, 0, 0], "turn": 3.0}, {"time": 36, "offset": [1.5, -2.0, -0.3], "turn": 4.6},
                                        {"time": 48, "offset": [0, 0, 0], "turn": 6.2831853}]}
    meshes.append({"name": "balloon", "file": "../things/balloon.glb", "position": [9.0, 0.8, 2.4], "path": drift})
    cylinders = [{"name": "log", "position": [3.2, -1.55, 0.16], "radius": 0.17, "height": 1.9, "roll": 1.5708, "yaw": 1.9,
                  "texture": {"kind": "noise", "light": 120, "dark": 70, "scale": 0.03, "seed": 3}},
                 {"name": "stump", "position": [1.6, 1.5, 0.18], "radius": 0.24, "height": 0.36,
                  "texture": {"kind": "noise", "light": 150, "dark": 95, "scale": 0.03, "seed": 4}}]
    for c in cylinders:
        balls.append((tuple(c["position"]), 0.22))
    gates = [
        {"name": "ring", "shape": "circle", "inner": 0.8, "outer": 1.0, "thickness": 0.06, "position": [4.0, 0.2], "opening_lower_edge": 0.7,
         "yaw": 0.0, "texture": {"kind": "uniform", "light": 250}},
        {"name": "hexagon", "shape": "polygon", "sides": 6, "inner": 0.8, "outer": 1.02, "thickness": 0.06, "position": [7.6, -0.5],
         "opening_lower_edge": 0.8, "yaw": -0.25, "roll": 0.2, "texture": {"kind": "uniform", "light": 250}}]
    size = 512
    px = left + edge * (np.arange(size) + 0.5) / size
    py = bottom + edge * (np.arange(size) + 0.5) / size
    mx, my = np.meshgrid(px, py)
    at_x, at_y = (mx - left) / spacing, (my - bottom) / spacing
    ix, iy = np.minimum(at_x.astype(int), cells - 1), np.minimum(at_y.astype(int), cells - 1)
    fx, fy = at_x - ix, at_y - iy
    mz = ((1 - fx) * (1 - fy) * heights[iy, ix] + fx * (1 - fy) * heights[iy, ix + 1] + (1 - fx) * fy * heights[iy + 1, ix]
          + fx * fy * heights[iy + 1, ix + 1])
    grass = 128 + 60 * (value_noise(size, 12, 5) - 0.5) + 40 * (rng.random((size, size)) - 0.5)
    trail = np.abs(my - 0.5 * np.sin(mx / 2.2)) - 0.35 - 0.15 * (value_noise(size, 24, 2) - 0.5)
    share_trail = np.clip(1 - trail / 0.25, 0, 1)
    grass = grass * (1 - share_trail) + share_trail * (182 + 30 * (rng.random((size, size)) - 0.5))
    points = np.stack([mx.ravel(), my.ravel(), mz.ravel()], axis=1)
    sun = soft_shadow(points, lighting["to_sun"], [], balls).reshape(mx.shape)
    level = lighting["to_sun"][2] / np.linalg.norm(lighting["to_sun"])
    share = (lighting["ambient"] + lighting["sun"] * level * sun) / (lighting["ambient"] + lighting["sun"] * level)
    save("forest_ground.png", (grass * share)[::-1])
    terrain = {"position": [left, bottom], "spacing": spacing, "texture": picture("forest_ground.png", edge), "heights": heights.tolist()}
    ground = {"half_size": 40.0, "texture": {"kind": "noise", "light": 140, "dark": 110, "scale": 0.6, "seed": 2}}
    write(head("forest", "A glade in a hilly wood with a balloon that drifts over it; a ring, then a tilted hexagon.", [0, 0, 0.0225], ground)
          | {"boxes": [], "cylinders": cylinders, "meshes": meshes, "terrain": terrain, "gates": gates, "lighting": lighting, "contact": CONTACT})


if __name__ == "__main__":
    THINGS.mkdir(exist_ok=True)
    crate()
    sign()
    bark_and_metal()
    things_of_the_forest()
    warehouse()
    forest()
