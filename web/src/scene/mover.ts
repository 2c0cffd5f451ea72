// SPDX-License-Identifier: Apache-2.0
// Objects that move. An object on a path moves at constant speed from point to point, as in the FMU. A robot has its
// recorded pose.
import * as THREE from "three";
import type { Json } from "../data/payload";
import type { Run } from "../data/run";

interface Point {
  time: number;
  offset: [number, number, number];
  turn: number;
}

export class Mover {
  /** The object's faces. Their corners are relative to `origin`. */
  readonly group = new THREE.Group();
  readonly origin: THREE.Vector3;
  private readonly points: Point[] | null;
  private readonly repeat: boolean;
  /** Variables of a robot: x, y, z and yaw. */
  private readonly pose: string[];

  constructor(info: Json, private readonly run: Run) {
    const instance = run.system?.view.scene?.instance ?? "";
    this.origin = new THREE.Vector3(...(info.origin as [number, number, number]));
    this.points = info.points ?? null;
    this.repeat = info.repeat ?? false;
    this.pose = this.points ? [] : [...(info.position as string[]), info.yaw as string].map((name) => `${instance}.${name}`);
    this.move(0);
  }

  /** The rotation about the vertical [rad]. */
  get turn(): number {
    return this.group.rotation.z;
  }

  move(time: number): void {
    if (this.points) this.moveOnPath(this.points, time);
    else this.moveAsRecorded(time);
  }

  private moveOnPath(points: Point[], time: number): void {
    const end = points[points.length - 1].time;
    const now = this.repeat ? Math.max(time, 0) % end : Math.min(Math.max(time, 0), end);
    const next = Math.max(1, points.findIndex((point) => point.time >= now));
    const [a, b] = [points[next - 1], points[next]];
    const share = (now - a.time) / (b.time - a.time);
    const offset = new THREE.Vector3(...a.offset).lerp(new THREE.Vector3(...b.offset), share);
    this.group.position.copy(this.origin).add(offset);
    this.group.rotation.z = a.turn + share * (b.turn - a.turn);
  }

  /** Hides a robot whose pose was not recorded. */
  private moveAsRecorded(time: number): void {
    this.group.visible = this.pose.every((name) => this.run.has(name));
    if (!this.group.visible) return;
    const [x, y, z] = this.pose.map((name) => this.run.between(name, time));
    this.group.position.set(x, y, z).add(this.origin);
    this.group.rotation.z = this.run.at(this.pose[3], time); // yaw jumps from pi to -pi
  }
}
