// SPDX-License-Identifier: Apache-2.0
// The objects of the world: faces with the textures and the light of the camera's pictures.
import * as THREE from "three";
import type { Json } from "../data/payload";
import type { Run } from "../data/run";
import { Mover } from "./mover";

/** A larger face that does not move is a wall. A wall is hidden while it would hide the target. */
const WALL_M2 = 0.8;

/** Faces with one texture, which are drawn together. `lights` contains the light on each corner. */
interface Batch {
  material: THREE.MeshBasicMaterial;
  colours: THREE.BufferAttribute;
  lights: Float32Array;
  /** Exists for objects that move: the light of each corner depends on their rotation. */
  turning?: { mover: Mover; normals: THREE.Vector3[] };
}

export class Surfaces {
  readonly group = new THREE.Group();
  private readonly walls: { mesh: THREE.Mesh; normal: THREE.Vector3; offset: number }[] = [];
  private readonly batches: Batch[] = [];
  private readonly movers: Mover[];
  private readonly lighting: { ambient: number; sun: number; toSun: THREE.Vector3 } | null;

  constructor(scene: Json, run: Run) {
    const textures = (scene.textures ?? []).map(makeTexture);
    this.movers = (scene.movers ?? []).map((info: Json) => new Mover(info, run));
    for (const mover of this.movers) this.group.add(mover.group);
    this.lighting = scene.lighting
      ? { ambient: scene.lighting.ambient, sun: scene.lighting.sun, toSun: vector(scene.lighting.to_sun) }
      : null;
    // Creates a mesh per wall, so that walls can be hidden separately. All other faces are drawn by texture.
    const shared = new Map<string, Json[]>();
    for (const face of scene.faces ?? []) {
      if (face.mover === undefined && areaOf(face.corners) > WALL_M2) {
        const normal = vector(face.normal);
        const mesh = this.add([face], textures[face.texture], null);
        this.walls.push({ mesh, normal, offset: normal.dot(vector(face.corners[0])) });
        continue;
      }
      const key = `${face.texture} ${face.mover ?? "stands"}`;
      if (!shared.has(key)) shared.set(key, []);
      shared.get(key)!.push(face);
    }
    for (const faces of shared.values()) this.add(faces, textures[faces[0].texture], this.movers[faces[0].mover] ?? null);
  }

  /** Hides walls that show their back to the target, because they would hide it. */
  openTowards(target: THREE.Vector3): void {
    for (const wall of this.walls) wall.mesh.visible = wall.normal.dot(target) - wall.offset > -1e-6;
  }

  /** Sets the factor of the brightness of all faces. */
  setExposure(exposure: number): void {
    for (const { material } of this.batches) material.color.setScalar(exposure);
  }

  closeAll(): void {
    for (const wall of this.walls) wall.mesh.visible = true;
  }

  /** Moves the objects to their positions at a time [s]. */
  move(time: number): void {
    for (const mover of this.movers) mover.move(time);
    for (const batch of this.batches) {
      if (!batch.turning || !this.lighting) continue;
      const { mover, normals } = batch.turning;
      const { ambient, sun } = this.lighting;
      const toSun = this.lighting.toSun.clone().applyAxisAngle(UP, -mover.turn);
      normals.forEach((normal, i) => (batch.lights[i] = ambient + sun * Math.max(0, normal.dot(toSun))));
      paint(batch);
    }
  }

  private add(faces: Json[], map: THREE.Texture, mover: Mover | null): THREE.Mesh {
    const corners: number[] = [];
    const coordinates: number[] = [];
    const lights: number[] = [];
    const normals: THREE.Vector3[] = [];
    const triangles: number[] = [];
    for (const face of faces) {
      const first = lights.length;
      for (const corner of face.corners) {
        const place = mover ? vector(corner).sub(mover.origin) : vector(corner);
        corners.push(place.x, place.y, place.z);
        lights.push(face.light);
        normals.push(vector(face.normal));
      }
      coordinates.push(...face.texture_coordinates.flat());
      for (let i = 1; i + 1 < face.corners.length; ++i) triangles.push(first, first + i, first + i + 1);
    }
    const geometry = new THREE.BufferGeometry();
    const colours = new THREE.Float32BufferAttribute(3 * lights.length, 3);
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
    geometry.setAttribute("uv", new THREE.Float32BufferAttribute(coordinates, 2));
    geometry.setAttribute("color", colours);
    geometry.setIndex(triangles);
    const material = new THREE.MeshBasicMaterial({ map, vertexColors: true });
    const batch: Batch = { material, colours, lights: Float32Array.from(lights) };
    if (mover) batch.turning = { mover, normals };
    paint(batch);
    this.batches.push(batch);
    const mesh = new THREE.Mesh(geometry, material);
    (mover?.group ?? this.group).add(mesh);
    return mesh;
  }
}

const UP = new THREE.Vector3(0, 0, 1);

function paint(batch: Batch): void {
  batch.lights.forEach((light, i) => batch.colours.setXYZ(i, light, light, light));
  batch.colours.needsUpdate = true;
}

function vector(values: number[]): THREE.Vector3 {
  return new THREE.Vector3(values[0], values[1], values[2]);
}

function makeTexture(info: { size: number; grey: string }): THREE.DataTexture {
  const grey = Uint8Array.from(atob(info.grey), (c) => c.charCodeAt(0));
  const pixels = new Uint8Array(4 * grey.length);
  for (let i = 0; i < grey.length; ++i) pixels.set([grey[i], grey[i], grey[i], 255], 4 * i);
  const texture = new THREE.DataTexture(pixels, info.size, info.size, THREE.RGBAFormat);
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.magFilter = THREE.LinearFilter;
  texture.minFilter = THREE.LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.anisotropy = 8;
  texture.needsUpdate = true;
  return texture;
}

function areaOf(corners: number[][]): number {
  const sum = new THREE.Vector3();
  const first = vector(corners[0]);
  for (let i = 1; i + 1 < corners.length; ++i) {
    sum.add(vector(corners[i]).sub(first).cross(vector(corners[i + 1]).sub(first)));
  }
  return sum.length() / 2;
}
