// SPDX-License-Identifier: Apache-2.0
// Draws states over time in lanes: blocks with names for an enumeration, on and off, or shades for a share.
import type { Clock } from "../clock";
import { element } from "../dom";
import { colour, styleColour } from "../theme";
import { addCursors } from "./cursor";
import { AXIS, type Drawing, type RunCurve } from "./drawing";
import { makeScrubbable } from "./scrub";
import type { Window } from "./window";

/** Heights [px]: a lane with words, a lane with shades, the gap between lanes, a line for a name. */
const WORDS = 20;
const SHADES = 13;
const GAP = 3;
const NAME = 16;
const NAME_FONT = "11px system-ui, sans-serif";

const SCALES = [0.6, 6];

interface Lane {
  entry: RunCurve;
  name: HTMLElement;
  top: number;
  height: number;
}

/** Draws lanes below each other. Their time axis is aligned with that of the plots. */
export class Lanes implements Drawing {
  readonly root = element("div", { class: "lanes" });
  private readonly canvas = element("canvas", {});
  private readonly area = element("div", { class: "lane-area" }, this.canvas);
  private readonly lanes: Lane[] = [];
  private readonly isAbove: boolean; // true if names are above the lanes
  private readonly natural: number;

  constructor(curves: RunCurve[], clock: Clock, private readonly window: Window) {
    const names = laneNames(curves);
    this.isAbove = widest(names) > AXIS.left - 6; // names are above if one has no space at the left of the lanes
    curves.forEach((entry, i) => {
      const name = element("div", { class: "lane-name", title: `${entry.curve.variable}, ${entry.run.name}` }, names[i]);
      this.root.append(name);
      this.lanes.push({ entry, name, top: 0, height: 0 });
    });
    this.natural = this.layOut(1);
    this.root.classList.toggle("above", this.isAbove);
    this.root.style.setProperty("--axis-left", `${AXIS.left}px`);
    this.root.style.setProperty("--axis-right", `${AXIS.right}px`);
    this.root.append(this.area);
    addCursors(this.area, clock, window);
    makeScrubbable(this.area, clock, window, { drag: "chooses" });
    new ResizeObserver(() => this.redraw()).observe(this.area);
    window.onChange(() => this.redraw());
  }

  /** Sets the positions of lanes and names. Returns the total height. */
  private layOut(scale: number): number {
    let bottom = 0;
    for (const lane of this.lanes) {
      lane.height = scale * (isWords(lane.entry) ? WORDS : SHADES);
      lane.top = bottom + (this.isAbove ? NAME : 0);
      lane.name.style.top = `${this.isAbove ? bottom : lane.top}px`;
      lane.name.style.lineHeight = `${this.isAbove ? NAME : lane.height}px`;
      bottom = lane.top + lane.height + GAP;
    }
    this.area.style.height = `${bottom}px`;
    return bottom;
  }

  get height(): number {
    return this.area.clientHeight;
  }

  /** Sets the total height. Scales only the lanes, because names have a fixed size. */
  setHeight(height: number | null): void {
    const fixed = this.lanes.length * (GAP + (this.isAbove ? NAME : 0));
    const scale = height === null ? 1 : (height - fixed) / (this.natural - fixed);
    this.layOut(Math.min(Math.max(scale, SCALES[0]), SCALES[1]));
    this.redraw();
  }

  redraw(): void {
    const { area } = this;
    const scale = devicePixelRatio;
    this.canvas.width = area.clientWidth * scale;
    this.canvas.height = area.clientHeight * scale;
    const context = this.canvas.getContext("2d")!;
    context.scale(scale, scale);
    context.font = "11px system-ui, sans-serif";
    context.textBaseline = "middle";
    const most = this.greatest();
    for (const lane of this.lanes) this.drawLane(context, lane, most.get(lane.entry.curve.unit) ?? 1, area.clientWidth);
  }

  /** Returns the greatest value of each unit in the lanes whose shades represent numbers. Lanes with the same unit
   * share a scale, so that readers can compare them. */
  private greatest(): Map<string, number> {
    const most = new Map<string, number>();
    for (const { entry: { curve } } of this.lanes.filter(({ entry }) => !isWords(entry))) {
      const own = curve.values(this.window.mean).reduce((a, b) => (b > a ? b : a), 0);
      most.set(curve.unit, Math.max(most.get(curve.unit) ?? 0, own));
    }
    return most;
  }

  private drawLane(context: CanvasRenderingContext2D, lane: Lane, most: number, width: number): void {
    const { entry, top, height } = lane;
    const { start, stop } = this.window;
    const { variable } = entry.curve;
    const values = entry.curve.values(this.window.mean);
    const times = entry.run.times;
    const x = (time: number) => ((time - start) / (stop - start)) * width;
    context.fillStyle = styleColour("--lane");
    context.fillRect(0, top, width, height);
    if (!isWords(entry)) {
      this.drawShades(context, lane, x, most);
      return;
    }
    const items = entry.run.info(variable)?.items;
    for (let i = 0; i < values.length; ) {
      let end = i + 1;
      while (end < values.length && values[end] === values[i]) ++end;
      const from = Math.max(0, x(times[i]));
      const to = Math.min(width, x(times[Math.min(end, values.length - 1)]));
      if (to > from && (items || values[i] !== 0)) {
        context.fillStyle = colour(items ? values[i] : 0) + "c8";
        context.fillRect(from, top, Math.max(1, to - from - 0.5), height);
        const name = entry.run.text(variable, values[i]);
        if (context.measureText(name).width < to - from - 8) {
          context.fillStyle = styleColour("--on-colour");
          context.fillText(name, from + 5, top + height / 2 + 0.5);
        }
      }
      i = end;
    }
  }

  /** Draws a lane whose shades represent numbers. The darkness between two rows is the value at the second row,
   * relative to `most`. */
  private drawShades(context: CanvasRenderingContext2D, { entry, top, height }: Lane, x: (time: number) => number, most: number): void {
    const values = entry.curve.values(this.window.mean);
    const times = entry.run.times;
    context.fillStyle = colour(0);
    for (let i = 1; i < values.length; ++i) {
      const from = Math.round(x(times[i - 1])); // rounds to whole pixels, so that no gap appears between neighbours
      const to = Math.round(x(times[i]));
      if (to < 0 || values[i] <= 0) continue;
      context.globalAlpha = Math.min(1, values[i] / most);
      context.fillRect(from, top, to - from, height);
    }
    context.globalAlpha = 1;
  }
}

/** True if the curve is an enumeration or a Boolean, whose values are shown as words. */
function isWords({ run, curve }: RunCurve): boolean {
  const info = run.info(curve.variable);
  return !curve.isRate && (info?.items !== undefined || info?.type === "Boolean");
}

function laneNames(curves: RunCurve[]): string[] {
  const isOne = new Set(curves.map((entry) => entry.runIndex)).size === 1;
  return curves.map(({ curve, run }) => (isOne ? curve.label : `${curve.label} \u00b7 ${run.name}`));
}

function widest(texts: string[]): number {
  const context = element("canvas", {}).getContext("2d")!;
  context.font = NAME_FONT;
  return Math.max(...texts.map((text) => context.measureText(text).width));
}
