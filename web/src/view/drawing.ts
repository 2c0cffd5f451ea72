// SPDX-License-Identifier: Apache-2.0
// Defines data that panels share with their drawings: curves, colours and dashes of runs, and the width of the axes.
import type { Curve, Run } from "../data/run";
import { colour } from "../theme";

/** Width of the axes left and right of the curves [px]. */
export const AXIS = { left: 70, right: 16 };

/** Contains a curve of one of the runs. The first run is shown in full. */
export interface RunCurve {
  run: Run;
  runIndex: number;
  curve: Curve;
}

export interface Drawing {
  readonly root: HTMLElement;
  /** The height in pixels. */
  readonly height: number;
  /** Sets the height; null restores the initial height. */
  setHeight(height: number | null): void;
  redraw(): void;
}

export function curveColour(entry: RunCurve, index: number, runCount: number): string {
  return colour(runCount > 1 ? entry.runIndex : index);
}

/**
 * Returns the lengths of dash and gap. With several runs, each run has a colour: the second and later curves of a run
 * are dashed.
 */
export function curveDash(curves: RunCurve[], index: number, runCount: number): [number, number] | undefined {
  const nth = curves.filter((other, i) => other.runIndex === curves[index].runIndex && i < index).length;
  return runCount > 1 && nth > 0 ? [2 + 3 * nth, 3] : undefined;
}
