// SPDX-License-Identifier: Apache-2.0
// What stands in the world: faces with the textures and the light that the camera renders.
import * as THREE from "three";
import type { Json } from "../data/payload";

/** A face larger than this is a wall: it is left out while it hides what is looked at. */
const WALL_M2 = 0.8;

export class Surfaces {
  readonly group = new THREE.Group();
  private readonly walls: { mesh: THREE.Mesh; normal: THREE.Vector3; offset: number }[] = [];

  private readonly lights: { material: THREE.MeshBasicMaterial; light: number }[] = [];

  constructor(scene: Json) {
    const textures = (scene.textures ?? []).map(makeTexture);
    for (const face of scene.faces ?? []) {
      const mesh = makeFace(face, textures[face.texture]);
      this.lights.push({ material: mesh.material, light: face.light });
      this.group.add(mesh);
      const normal = new THREE.Vector3(...(face.normal as [number, number, number]));
      if (areaOf(face.corners) > WALL_M2) this.walls.push({ mesh, normal, offset: normal.dot(vector(face.corners[0])) });
    }
  }

  /** Faces whose back is towards the target would stand between it and the eye: as in a doll's house they are open. */
  openTowards(target: THREE.Vector3): void {
    for (const wall of this.walls) wall.mesh.visible = wall.normal.dot(target) - wall.offset > -1e-6;
  }

  /** Multiplies all light. */
  setExposure(exposure: number): void {
    for (const { material, light } of this.lights) material.color.setScalar(light * exposure);
  }

  closeAll(): void {
    for (const wall of this.walls) wall.mesh.visible = true;
  }
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

function makeFace(face: Json, map: THREE.Texture): THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial> {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(face.corners.flat(), 3));
  geometry.setAttribute("uv", new THREE.Float32BufferAttribute(face.texture_coordinates.flat(), 2));
  const triangles: number[] = [];
  for (let i = 1; i + 1 < face.corners.length; ++i) triangles.push(0, i, i + 1);
  geometry.setIndex(triangles);
  return new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ map }));
}

function areaOf(corners: number[][]): number {
  const sum = new THREE.Vector3();
  const first = vector(corners[0]);
  for (let i = 1; i + 1 < corners.length; ++i) {
    sum.add(vector(corners[i]).sub(first).cross(vector(corners[i + 1]).sub(first)));
  }
  return sum.length() / 2;
}
