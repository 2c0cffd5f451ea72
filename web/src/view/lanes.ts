// SPDX-License-Identifier: Apache-2.0
// States over time, one lane each: named blocks of an enumeration, on and off, shades of a share.
import type { Clock } from "../clock";
import { element } from "../dom";
import { colour, styleColour } from "../theme";
import { AXIS, type Drawing, type RunCurve } from "./drawing";
import { makeScrubbable } from "./scrub";
import type { Window } from "./window";

/** Heights [px]: a lane with words, a lane with shades only, the gap between lanes, a line for a name. */
const WORDS = 20;
const SHADES = 13;
const GAP = 3;
const NAME = 16;
const NAME_FONT = "11px system-ui, sans-serif";

interface Lane {
  entry: RunCurve;
  top: number;
  height: number;
}

/** Their area lies under the plots' one, so that a moment is at the same place in all of them. */
export class Lanes implements Drawing {
  readonly root = element("div", { class: "lanes" });
  private readonly canvas = element("canvas", {});
  private readonly cursor = element("div", { class: "moment" });
  private readonly lanes: Lane[] = [];

  constructor(curves: RunCurve[], private readonly clock: Clock, private readonly window: Window) {
    const names = laneNames(curves);
    const isAbove = widest(names) > AXIS.left - 6; // as soon as one has no room beside the lanes
    let bottom = 0;
    curves.forEach((entry, i) => {
      const height = isWords(entry) ? WORDS : SHADES;
      const top = bottom + (isAbove ? NAME : 0);
      const name = element("div", { class: "lane-name", title: `${entry.curve.variable}, ${entry.run.name}` }, names[i]);
      name.style.top = `${isAbove ? bottom : top}px`;
      name.style.lineHeight = `${isAbove ? NAME : height}px`;
      this.root.append(name);
      this.lanes.push({ entry, top, height });
      bottom = top + height + GAP;
    });
    this.root.classList.toggle("above", isAbove);
    this.root.style.setProperty("--axis-left", `${AXIS.left}px`);
    this.root.style.setProperty("--axis-right", `${AXIS.right}px`);
    const area = element("div", { class: "lane-area" }, this.canvas, this.cursor);
    area.style.height = `${bottom}px`;
    this.root.append(area);
    makeScrubbable(area, clock, window);
    new ResizeObserver(() => this.redraw()).observe(area);
    clock.onTime(() => this.showMoment());
    window.onChange(() => this.redraw());
    this.showMoment();
  }

  redraw(): void {
    const area = this.canvas.parentElement!;
    const scale = devicePixelRatio;
    this.canvas.width = area.clientWidth * scale;
    this.canvas.height = area.clientHeight * scale;
    const context = this.canvas.getContext("2d")!;
    context.scale(scale, scale);
    context.font = "11px system-ui, sans-serif";
    context.textBaseline = "middle";
    const most = this.greatest();
    for (const lane of this.lanes) this.drawLane(context, lane, most.get(lane.entry.curve.unit) ?? 1, area.clientWidth);
    this.showMoment();
  }

  /** By unit, of the lanes of shades: those of one unit can be compared. */
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

  /** The darkness of a pixel is the mean over its time, relative to the greatest mean. */
  private drawShades(context: CanvasRenderingContext2D, { entry, top, height }: Lane, x: (time: number) => number, most: number): void {
    const values = entry.curve.values(this.window.mean);
    const times = entry.run.times;
    context.fillStyle = colour(0);
    for (let i = 1; i < values.length; ++i) {
      const from = Math.round(x(times[i - 1])); // whole pixels, so that neighbours leave no seam
      const to = Math.round(x(times[i]));
      if (to < 0 || values[i] <= 0) continue;
      context.globalAlpha = Math.min(1, values[i] / most);
      context.fillRect(from, top, to - from, height);
    }
    context.globalAlpha = 1;
  }

  private showMoment(): void {
    const { start, stop } = this.window;
    const share = (this.clock.time - start) / (stop - start);
    this.cursor.style.display = share < 0 || share > 1 ? "none" : "block";
    this.cursor.style.left = `${100 * share}%`;
  }
}

/** States have names, or are on and off. */
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
