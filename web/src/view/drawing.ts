// SPDX-License-Identifier: Apache-2.0
// Definitions that panels share with their drawings.
import type { Curve, Run } from "../data/run";
import { colour } from "../theme";

/** The width of the axes left and right of the curves [px]. */
export const AXIS = { left: 70, right: 16 };

export interface RunCurve {
  run: Run;
  runIndex: number;
  curve: Curve;
}

export interface Drawing {
  readonly root: HTMLElement;
  /** The height in pixels. */
  readonly height: number;
  /** Sets the height [px]. Null restores the initial height. */
  setHeight(height: number | null): void;
  redraw(): void;
}

export function curveColour(entry: RunCurve, index: number, runCount: number): string {
  return colour(runCount > 1 ? entry.runIndex : index);
}

/** Returns the lengths of dash and gap. With several runs, the colour identifies the run. The second and later curves
 * of a run are dashed. */
export function curveDash(curves: RunCurve[], index: number, runCount: number): [number, number] | undefined {
  const nth = curves.filter((other, i) => other.runIndex === curves[index].runIndex && i < index).length;
  return runCount > 1 && nth > 0 ? [2 + 3 * nth, 3] : undefined;
}
