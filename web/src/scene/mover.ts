// SPDX-License-Identifier: Apache-2.0
// Objects that move on a path. They move at constant speed from point to point, as a function of time, as in the FMU.
import * as THREE from "three";
import type { Json } from "../data/payload";

interface Point {
  time: number;
  offset: [number, number, number];
  turn: number;
}

export class Mover {
  /** Contains the object's faces, with corners relative to `origin`. */
  readonly group = new THREE.Group();
  readonly origin: THREE.Vector3;
  private readonly points: Point[];
  private readonly repeat: boolean;

  constructor(info: Json) {
    this.origin = new THREE.Vector3(...(info.origin as [number, number, number]));
    this.points = info.points;
    this.repeat = info.repeat;
    this.move(0);
  }

  /** The angle by which the object is turned about the vertical [rad]. */
  get turn(): number {
    return this.group.rotation.z;
  }

  move(time: number): void {
    const end = this.points[this.points.length - 1].time;
    const now = this.repeat ? Math.max(time, 0) % end : Math.min(Math.max(time, 0), end);
    const next = Math.max(1, this.points.findIndex((point) => point.time >= now));
    const [a, b] = [this.points[next - 1], this.points[next]];
    const share = (now - a.time) / (b.time - a.time);
    const offset = new THREE.Vector3(...a.offset).lerp(new THREE.Vector3(...b.offset), share);
    this.group.position.copy(this.origin).add(offset);
    this.group.rotation.z = a.turn + share * (b.turn - a.turn);
  }
}
