// SPDX-License-Identifier: Apache-2.0
// States over time, one lane each: named blocks of an enumeration, on and off, shades of a share.
import type { Clock } from "../clock";
import { rowAt } from "../data/run";
import { shown } from "../data/units";
import { element } from "../dom";
import { colour, styleColour } from "../theme";
import type { Drawing, RunCurve } from "./panel";
import { makeScrubbable } from "./scrub";
import type { Window } from "./window";

const LANE = 20;
const GAP = 3;

export class Lanes implements Drawing {
  readonly root = element("div", { class: "lanes" });
  private readonly canvas = element("canvas", {});
  private readonly cursor = element("div", { class: "moment" });
  private readonly values: HTMLElement[] = [];

  constructor(private readonly curves: RunCurve[], private readonly clock: Clock, private readonly window: Window) {
    const names = element("div", { class: "lane-names" });
    const numbers = element("div", { class: "lane-values" });
    const runCount = new Set(curves.map((entry) => entry.runIndex)).size;
    this.root.classList.toggle("many", runCount > 1);
    for (const { curve, run } of curves) {
      names.append(element("div", { title: `${curve.variable}, ${run.name}` }, runCount > 1 ? `${curve.label} · ${run.name}` : curve.label));
      const value = element("b", { "data-variable": curve.variable });
      this.values.push(value);
      numbers.append(element("div", {}, value));
    }
    const area = element("div", { class: "lane-area" }, this.canvas, this.cursor);
    area.style.height = `${curves.length * (LANE + GAP)}px`;
    this.root.append(names, area, numbers);
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
    this.curves.forEach((entry, lane) => this.drawLane(context, entry, lane, area.clientWidth));
    this.showMoment();
  }

  private drawLane(context: CanvasRenderingContext2D, entry: RunCurve, lane: number, width: number): void {
    const { start, stop } = this.window;
    const { variable, isRate } = entry.curve;
    const values = entry.curve.values(this.window.mean);
    const times = entry.run.times;
    const x = (time: number) => ((time - start) / (stop - start)) * width;
    const top = lane * (LANE + GAP);
    context.fillStyle = styleColour("--lane");
    context.fillRect(0, top, width, LANE);
    const items = entry.run.info(variable)?.items;
    if (isRate || !(items || entry.run.info(variable)?.type === "Boolean")) {
      this.drawShades(context, entry, x, top);
      return;
    }
    for (let i = 0; i < values.length; ) {
      let end = i + 1;
      while (end < values.length && values[end] === values[i]) ++end;
      const from = Math.max(0, x(times[i]));
      const to = Math.min(width, x(times[Math.min(end, values.length - 1)]));
      if (to > from && (items || values[i] !== 0)) {
        context.fillStyle = colour(items ? values[i] : 0) + "c8";
        context.fillRect(from, top, Math.max(1, to - from - 0.5), LANE);
        const name = entry.run.text(variable, values[i]);
        if (context.measureText(name).width < to - from - 8) {
          context.fillStyle = styleColour("--on-colour");
          context.fillText(name, from + 5, top + LANE / 2 + 0.5);
        }
      }
      i = end;
    }
  }

  /** How dark a pixel is says the mean over its time. */
  private drawShades(context: CanvasRenderingContext2D, entry: RunCurve, x: (time: number) => number, top: number): void {
    const values = entry.curve.values(this.window.mean);
    const times = entry.run.times;
    const most = values.reduce((a, b) => Math.max(a, b), 0) || 1;
    context.fillStyle = colour(0);
    for (let i = 1; i < values.length; ++i) {
      const from = Math.round(x(times[i - 1])); // whole pixels, so that neighbours leave no seam
      const to = Math.round(x(times[i]));
      if (to < 0 || values[i] <= 0) continue;
      context.globalAlpha = Math.min(1, values[i] / most);
      context.fillRect(from, top, to - from, LANE);
    }
    context.globalAlpha = 1;
  }

  private showMoment(): void {
    const { start, stop } = this.window;
    const share = (this.clock.time - start) / (stop - start);
    this.cursor.style.display = share < 0 || share > 1 ? "none" : "block";
    this.cursor.style.left = `${100 * share}%`;
    this.curves.forEach(({ run, curve }, lane) => {
      const value = curve.values(this.window.mean)[rowAt(run.times, this.clock.time)];
      this.values[lane].textContent = curve.isRate ? shown(value, curve.unit) : run.text(curve.variable, value);
    });
  }
}
