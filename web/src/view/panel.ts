// SPDX-License-Identifier: Apache-2.0
// Creates a panel: a title, the name, colour and current value of each curve, and the drawing.
import type { Clock } from "../clock";
import type { PanelInfo } from "../data/payload";
import { type Run, rowAt } from "../data/run";
import { SHARE, shown, shownUnit } from "../data/units";
import { element } from "../dom";
import { onTheme } from "../theme";
import { Chart } from "./chart";
import { curveColour, curveDash, type Drawing, type RunCurve } from "./drawing";
import { makeHandle } from "./handle";
import { Lanes } from "./lanes";
import type { Window } from "./window";

interface Options {
  /** If present, the panel has a close button that calls it. */
  onClose?: () => void;
  /** The height of the curves [px]. */
  height?: number;
}

export function makePanel(info: PanelInfo, allRuns: Run[], clock: Clock, window: Window, { onClose, height }: Options = {}): HTMLElement {
  // If the panel stacks shares, shows only the first run, because the sum of all shares is the same in each run.
  const runs = isShares(info, allRuns[0]) ? allRuns.slice(0, 1) : allRuns;
  const curves = curvesOf(info, runs);
  const kind = info.kind === "stack" && runs.length > 1 ? "lines" : info.kind;
  const runCount = new Set(curves.map((entry) => entry.runIndex)).size;
  const root = element("section", { class: `panel panel-${kind}` });
  const values = element("div", { class: "values" });
  const unit = new Set(curves.map(({ curve }) => shownUnit(curve.unit)));
  const title = element("h2", {}, info.title);
  if (unit.size === 1 && kind !== "lanes" && [...unit][0] !== "") {
    title.append(element("span", { class: "unit" }, ` [${[...unit][0]}]`));
  }
  if (curves.some(({ curve }) => curve.isRate)) title.append(meanNote(window));
  if (runs.length < allRuns.length) title.append(element("span", { class: "unit" }, ` of ${runs[0].name}`));
  const heading = element("header", {}, title, values);
  if (onClose) heading.append(element("button", { class: "close", title: "Remove this plot", onclick: onClose }, "\u00d7"));
  root.append(heading);
  if (curves.length === 0) {
    root.append(element("p", { class: "empty" }, "None of these variables was recorded."));
    return root;
  }
  const drawing: Drawing = kind === "lanes" ? new Lanes(curves, clock, window) : new Chart(kind, curves, clock, window, height);
  root.append(drawing.root, makeHandle({
    label: `height of ${info.title}`, axis: "y", size: () => drawing.height, resize: (height) => drawing.setHeight(height),
  }));
  const outputs = curves.map((entry, i) => {
    const value = makeValue(entry, runCount, window);
    if (kind === "lanes") value.swatch.remove(); // lanes have the colours of states
    values.append(value.root);
    return { ...value, paint: () => paintSwatch(value.swatch, curveColour(entry, i, runCount), curveDash(curves, i, runCount)) };
  });
  const show = () => {
    for (const output of outputs) output.show(window.pointed ?? clock.time);
  };
  clock.onTime(show);
  window.onChange(show);
  window.onPoint(show);
  onTheme(() => {
    for (const output of outputs) output.paint();
    drawing.redraw();
  });
  for (const output of outputs) output.paint();
  show();
  return root;
}

function isShares(info: PanelInfo, run: Run): boolean {
  return info.kind === "stack" && info.curves.every((wanted) => run.curve(wanted)?.unit === SHARE);
}

/** Creates a note with the averaging time of the shown values. */
function meanNote(window: Window): HTMLElement {
  const note = element("span", { class: "unit" });
  const show = () => (note.textContent = ` mean over ${shown(Number(window.mean.toPrecision(2)), "s")}`);
  window.onChange(show);
  show();
  return note;
}

/** Returns the curves of each run. For stacked parts or lanes of rates, returns only the sum of each run if there are
 * several runs. */
function curvesOf(info: PanelInfo, runs: Run[]): RunCurve[] {
  const curves: RunCurve[] = [];
  const isParts = info.kind === "stack" || (info.kind === "lanes" && info.curves.every(({ rate_of }) => rate_of !== undefined));
  if (isParts && runs.length > 1) {
    runs.forEach((run, runIndex) => {
      const curve = run.sum(info.curves);
      if (curve) curves.push({ run, runIndex, curve });
    });
    return curves;
  }
  for (const wanted of info.curves) {
    runs.forEach((run, runIndex) => {
      const curve = run.curve(wanted);
      if (curve) curves.push({ run, runIndex, curve });
    });
  }
  return curves;
}

/** Gives the mark in front of a curve's name the colour and the dashes of the curve. */
function paintSwatch(swatch: HTMLElement, tone: string, dash: [number, number] | undefined): void {
  swatch.classList.toggle("dashed", dash !== undefined);
  swatch.style.background = dash
    ? `repeating-linear-gradient(90deg, ${tone} 0 ${dash[0]}px, transparent ${dash[0]}px ${dash[0] + dash[1]}px)`
    : tone;
}

function makeValue(entry: RunCurve, runCount: number, window: Window) {
  const { curve, run } = entry;
  const swatch = element("i", { class: "swatch" });
  const number = element("b", { "data-variable": curve.variable, "data-run": run.name });
  const name = runCount > 1 ? `${curve.label} \u00b7 ${run.name}` : curve.label;
  return {
    root: element("span", { class: "value", title: curve.variable }, swatch, `${name} `, number),
    swatch,
    show(time: number) {
      const value = curve.values(window.mean)[rowAt(run.times, time)];
      number.textContent = curve.isRate ? shown(value, curve.unit) : run.text(curve.variable, value);
    },
  };
}
