// SPDX-License-Identifier: Apache-2.0
// Shows main effects: the mean over designs at each level of each factor. If designs are selected, also shows the means
// over these designs.
import { element } from "../dom";
import { colour, onTheme, styleColour } from "../theme";
import type { Factor, Objective, Study } from "./content";
import { objectiveText } from "./format";
import { extent } from "./plot";
import type { Selection } from "./selection";
import type { Shown } from "./shown";
import { panel } from "./widgets";

const ROW = 22; // height of a row in pixels
const SELECTED = 0;

export function makeEffects(study: Study, selection: Selection, shown: Shown): HTMLElement {
  const body = element("div", { class: "effects" });
  const draws: (() => void)[] = [];
  const renew = () => {
    draws.length = 0;
    const objective = study.objectives[shown.objective];
    const range = extent(objective.mean, { isShare: objective.share });
    body.replaceChildren(...study.factors.flatMap((factor, number) => {
      if (factor.levels.length < 2) return [];
      const means = study.effects.means[shown.objective][number];
      const { root, draw } = makeBlock(factor, means, objective, range, selection);
      draws.push(draw);
      return [root];
    }));
    for (const draw of draws) draw();
  };
  shown.onChange(renew);
  selection.onChange(() => draws.forEach((draw) => draw()));
  onTheme(() => draws.forEach((draw) => draw()));
  new ResizeObserver(() => draws.forEach((draw) => draw())).observe(body);
  renew();
  return panel("Main effects", "Faint marks are designs; the dot is the mean of the designs with that level, each counted once. A diamond is the mean of selected designs.", body);
}

function makeBlock(
  factor: Factor, means: (number | null)[], objective: Objective, range: [number, number], selection: Selection,
): { root: HTMLElement; draw: () => void } {
  const canvas = element("canvas", { "aria-hidden": "true" });
  const numbers = factor.levels.map((_, level) => element("td", { class: "number" }, objectiveText(objective, means[level])));
  const rows = factor.levels.map((name, level) => element("tr", {}, element("th", { title: name }, name),
    element("td", { class: "track", ...(level === 0 ? { rowspan: String(factor.levels.length) } : {}) }), numbers[level]));
  rows.forEach((row, level) => (level === 0 ? row.children[1].append(canvas) : row.children[1].remove()));
  const root = element("div", { class: "effect" }, element("h3", { title: factor.name }, factor.label), element("table", {}, element("tbody", {}, ...rows)));
  const height = ROW * factor.levels.length;
  canvas.style.height = `${height}px`;
  const draw = () => {
    const width = canvas.parentElement!.clientWidth;
    if (width === 0) return;
    const ratio = devicePixelRatio;
    [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    const context = canvas.getContext("2d")!;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const x = (value: number) => 7 + ((value - range[0]) / (range[1] - range[0])) * (width - 14);
    const y = (level: number) => (level + 0.5) * ROW;
    drawDesigns(context, factor, objective, selection, x, y);
    context.strokeStyle = colour(SELECTED);
    context.lineWidth = 1.5;
    context.beginPath();
    means.forEach((mean, level) => mean !== null && context.lineTo(x(mean), y(level)));
    if (factor.number) context.stroke(); // levels that are not numbers have no order
    context.fillStyle = colour(SELECTED);
    means.forEach((mean, level) => {
      if (mean === null) return;
      context.beginPath();
      context.arc(x(mean), y(level), 5, 0, 7);
      context.fill();
    });
    const own = selection.isFiltered ? levelMeans(factor, objective, selection) : [];
    context.fillStyle = colour(1);
    own.forEach((mean, level) => mean !== null && diamond(context, x(mean), y(level)));
    numbers.forEach((cell, level) => (cell.textContent = objectiveText(objective, selection.isFiltered ? own[level] : means[level])));
  };
  return { root, draw };
}

/** Draws each design as an upright mark, the selected designs last. */
function drawDesigns(
  context: CanvasRenderingContext2D, factor: Factor, objective: Objective, selection: Selection, x: (value: number) => number, y: (level: number) => number,
): void {
  for (const isIn of selection.isFiltered ? [0, 1] : [1]) {
    context.fillStyle = isIn && selection.isFiltered ? colour(1) : styleColour("--faint");
    context.globalAlpha = isIn ? Math.min(0.5, Math.max(0.12, 12 / selection.size)) : 0.06;
    for (let i = 0; i < selection.size; ++i) {
      const mean = objective.mean[i];
      if (selection.isIn[i] === isIn && mean !== null) context.fillRect(x(mean) - 1, y(factor.level[i]) - 7, 2, 14);
    }
  }
  context.globalAlpha = 1;
}

function diamond(context: CanvasRenderingContext2D, x: number, y: number): void {
  context.beginPath();
  for (const [dx, dy] of [[0, -6], [6, 0], [0, 6], [-6, 0]]) context.lineTo(x + dx, y + dy);
  context.fill();
}

/** Returns the objective's mean over the selected designs at each level of the factor. At a level without a selected
 * design, returns null. */
export function levelMeans(factor: Factor, objective: Objective, selection: Selection): (number | null)[] {
  return cellMeans(factor.levels.length, (i) => factor.level[i], objective, selection);
}

export function cellMeans(cells: number, cellOf: (design: number) => number, objective: Objective, selection: Selection): (number | null)[] {
  const sums = new Float64Array(cells);
  const counts = new Uint32Array(cells);
  for (let i = 0; i < selection.size; ++i) {
    const mean = objective.mean[i];
    if (!selection.isIn[i] || mean === null) continue;
    sums[cellOf(i)] += mean;
    ++counts[cellOf(i)];
  }
  return Array.from(sums, (sum, cell) => (counts[cell] ? sum / counts[cell] : null));
}
