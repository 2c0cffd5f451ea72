// SPDX-License-Identifier: Apache-2.0
// Draws curves over time with uPlot, in one plot or stacked.
import uPlot from "uplot";
import type { Clock } from "../clock";
import { prefixFor, shownTick, shownUnit } from "../data/units";
import { element } from "../dom";
import { styleColour } from "../theme";
import { addCursors } from "./cursor";
import { AXIS, curveColour, curveDash, type Drawing, type RunCurve } from "./drawing";
import { makeScrubbable } from "./scrub";
import type { Window } from "./window";

const HEIGHT = 84;
const LEAST_HEIGHT = 50;
const FONT = "11px system-ui, sans-serif";

export class Chart implements Drawing {
  readonly root = element("div", { class: "chart" });
  private readonly cursors = element("div", { class: "cursors" });
  private plot: uPlot | null = null;
  private pixels: number;
  private readonly runCount: number;

  constructor(
    private readonly kind: string, private readonly curves: RunCurve[], private readonly clock: Clock, private readonly window: Window,
    private readonly firstHeight = HEIGHT,
  ) {
    this.pixels = firstHeight;
    this.runCount = new Set(curves.map((entry) => entry.runIndex)).size;
    new ResizeObserver(() => this.fit()).observe(this.root);
    addCursors(this.cursors, clock, window);
    window.onChange(() => this.showWindow());
    for (const run of new Set(curves.map((entry) => entry.run))) run.onData(() => this.plot?.setData(this.data(), false));
  }

  get height(): number {
    return this.pixels;
  }

  setHeight(height: number | null): void {
    this.pixels = Math.max(LEAST_HEIGHT, height ?? this.firstHeight);
    this.fit();
  }

  redraw(): void {
    this.plot?.destroy();
    this.plot = null;
    this.fit();
  }

  private fit(): void {
    const width = this.root.clientWidth;
    if (width === 0) return;
    if (!this.plot) this.make(width);
    else if (this.plot.width !== width || this.plot.height !== this.pixels) this.plot.setSize({ width, height: this.pixels });
  }

  private make(width: number): void {
    const data = this.data();
    this.plot = new uPlot(this.options(width, data), data, this.root);
    this.plot.over.append(this.cursors);
    makeScrubbable(this.plot.over, this.clock, this.window, { drag: "chooses" });
    this.showWindow();
  }

  /** Returns the data for uPlot. If the runs have different times, merges the times. Lines bridge the resulting gaps. */
  private data(): uPlot.AlignedData {
    const stacked = this.kind === "stack";
    const values = this.curves.map(({ curve }) => curve.values(this.window.mean));
    const sums = stacked ? cumulated(values) : values;
    const groups = new Map<number, { times: Float64Array; values: Float64Array[] }>();
    this.curves.forEach(({ run, runIndex }, i) => {
      const group = groups.get(runIndex) ?? { times: run.times, values: [] };
      groups.set(runIndex, group);
      group.values.push(sums[i]);
    });
    if (groups.size === 1) return [this.curves[0].run.times, ...sums];
    return uPlot.join([...groups.entries()].sort(([a], [b]) => a - b).map(([, group]) => group)
      .map((group) => [group.times, ...group.values] as uPlot.AlignedData));
  }

  /** The curves in the order of uPlot.join, which keeps the curves of a run together. */
  private get ordered(): RunCurve[] {
    return this.runCount === 1 ? this.curves : [...this.curves].sort((a, b) => a.runIndex - b.runIndex);
  }

  private options(width: number, data: uPlot.AlignedData): uPlot.Options {
    const grid = { stroke: styleColour("--grid"), width: 1 };
    const text = styleColour("--faint");
    const stacked = this.kind === "stack";
    const unit = this.curves[0].curve.unit;
    const [factor, prefix] = prefixFor(largest(data), unit);
    const name = shownUnit(unit);
    return {
      width,
      height: this.pixels,
      legend: { show: false },
      cursor: { show: false },
      padding: [8, AXIS.right, 0, 0],
      scales: { x: { time: false }, y: { range: (_plot, low, high) => niceRange(low, high, stacked) } },
      axes: [
        { stroke: text, grid, font: FONT, size: 22, ticks: { show: false }, values: (_plot, ticks) => ticks.map(shownTick) },
        {
          stroke: text, grid, font: FONT, size: AXIS.left, ticks: { show: false }, space: 13,
          values: (_plot, ticks, _axis, _space, step) => ticks.map((tick) => tickText(tick / factor, step / factor, prefix, name)),
        },
      ],
      series: [{}, ...this.ordered.map((entry) => this.series(entry, stacked))],
      bands: stacked ? this.curves.slice(1).map((_, i) => ({ series: [i + 2, i + 1] as [number, number] })) : [],
    };
  }

  private series(entry: RunCurve, stacked: boolean): uPlot.Series {
    const index = this.curves.indexOf(entry);
    const colour = curveColour(entry, index, this.runCount);
    const discrete = ["Integer", "Boolean", "Enumeration"].includes(entry.run.info(entry.curve.variable)?.type ?? "");
    const stepped = uPlot.paths.stepped!;
    return {
      stroke: colour,
      width: stacked ? 0.75 : 1.6,
      fill: stacked ? colour + "b0" : undefined,
      dash: curveDash(this.curves, index, this.runCount),
      points: { show: false },
      spanGaps: true,
      paths: entry.curve.isRate ? stepped({ align: -1 }) : discrete ? stepped({ align: 1 }) : undefined,
    };
  }

  private showWindow(): void {
    if (this.curves.some(({ curve }) => curve.isRate)) this.plot?.setData(this.data(), false);
    this.plot?.setScale("x", { min: this.window.start, max: this.window.stop });
  }
}

function cumulated(curves: Float64Array[]): Float64Array[] {
  const sums: Float64Array[] = [];
  for (const values of curves) {
    const below = sums[sums.length - 1];
    sums.push(below ? values.map((value, i) => value + below[i]) : values);
  }
  return sums;
}

function largest(data: uPlot.AlignedData): number {
  let most = 0;
  for (const series of data.slice(1)) for (const value of series) if (value != null && Math.abs(value) > most) most = Math.abs(value);
  return most;
}

/** Formats a tick with enough digits to distinguish it from its neighbours. Adds the unit if it has a prefix. If space
 * is short, adds only the prefix. */
function tickText(value: number, step: number, prefix: string, unit: string): string {
  const places = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  const isQuarter = Math.abs(step * 10 ** places - Math.round(step * 10 ** places)) > 1e-6; // for example 0.25
  const decimals = Math.min(12, places + (isQuarter ? 1 : 0));
  const number = String(+value.toFixed(decimals)).replace("-", "\u2212");
  if (prefix === "") return number;
  const text = `${number} ${prefix}${unit}`;
  return text.length <= 9 ? text : `${number} ${prefix}`;
}

function niceRange(low: number | null, high: number | null, fromZero: boolean): [number, number] {
  if (low == null || high == null) return [0, 1];
  const bottom = fromZero ? Math.min(0, low) : low;
  // Rates are differences of recorded totals, which are exact to about nine digits. Therefore a smaller relative change
  // counts as no change.
  const isStill = high - bottom < 1e-7 * Math.abs(high);
  const span = isStill ? Math.abs(high) || 1 : high - bottom;
  return [fromZero && bottom === 0 ? 0 : bottom - 0.06 * span, high + 0.06 * span];
}
