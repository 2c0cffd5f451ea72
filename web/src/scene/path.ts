// SPDX-License-Identifier: Apache-2.0
// The path of a flight, coloured by a variable: strong until the shown time, then faint.
import { Line2 } from "three/addons/lines/Line2.js";
import { LineGeometry } from "three/addons/lines/LineGeometry.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import * as THREE from "three";
import { scaleColour } from "../theme";

export class Path {
  readonly group = new THREE.Group();
  private readonly flown: Line2;
  private readonly ahead: Line2;
  private segments = 0;

  constructor(points: Float32Array, plainColour: string | null) {
    this.ahead = makeLine(2, 0.6);
    this.flown = makeLine(4.5, 1);
    this.ahead.material.color.set(plainColour ?? "#dfe6ee");
    if (plainColour) {
      this.flown.material.color.set(plainColour);
    } else {
      this.flown.material.vertexColors = true;
      this.ahead.material.depthWrite = false;
    }
    this.group.add(this.ahead, this.flown);
    this.setPoints(points);
  }

  setPoints(points: Float32Array): void {
    this.segments = Math.max(0, points.length / 3 - 1);
    for (const line of [this.flown, this.ahead]) {
      line.geometry.dispose();
      line.geometry = new LineGeometry();
      line.geometry.setPositions(points.length >= 6 ? points : new Float32Array(6));
    }
  }

  colourBy(values: Float64Array, low: number, high: number): void {
    const colours = new Float32Array(3 * values.length);
    values.forEach((value, i) => colours.set(scaleColour(high > low ? (value - low) / (high - low) : 0.5), 3 * i));
    this.flown.geometry.setColors(colours);
  }

  /** Draws the path strongly until the row with index `row`. For row 0, hides the strong part. */
  show(row: number): void {
    this.flown.geometry.instanceCount = Math.min(row, this.segments);
    this.flown.visible = row > 0;
  }

  setResolution(width: number, height: number): void {
    for (const line of [this.flown, this.ahead]) line.material.resolution.set(width, height);
  }
}

function makeLine(width: number, opacity: number): Line2 {
  const line = new Line2(new LineGeometry(), new LineMaterial({ linewidth: width, transparent: opacity < 1, opacity }));
  line.frustumCulled = false;
  return line;
}
