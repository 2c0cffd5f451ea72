// SPDX-License-Identifier: Apache-2.0
// Plots designs by two of their values, with confidence intervals. Also marks the Pareto front of the mean values, and
// the designs that are proven to be on the front.
import { element } from "../dom";
import { colour, styleColour } from "../theme";
import type { Place, Study } from "./content";
import { digits, factorText, objectiveText, titleOf } from "./format";
import { extent, listenToPointer, Plot } from "./plot";
import type { Selection } from "./selection";
import { makeChoice, makeTooltip, panel } from "./widgets";

export const PLACES: Record<Exclude<Place, "">, string> = {
  on: "proven to be on the front",
  undecided: "may be on the front",
  off: "proven to be off the front",
  excluded: "breaks a constraint",
};
const MOST_INTERVALS = 150; // intervals of more designs would hide the points

interface Choice {
  name: string;
  share: boolean;
  scale: number;
  sense: number;
  constraint: { above: boolean; bound: number } | null;
  at(design: number): number | null;
  low(design: number): number | null;
  high(design: number): number | null;
  text(design: number): string;
}

export function placeColour(place: Place): string {
  const own = { on: 2, undecided: 0, off: -1, excluded: 1, "": 0 }[place];
  return own < 0 ? styleColour("--off") : colour(own);
}

export function makeFronts(study: Study, selection: Selection): HTMLElement {
  const choices = choicesOf(study);
  let [across, up] = firstChoices(study);
  let brush: [number, number, number, number] | null = null; // selected rectangle in pixels
  const tooltip = makeTooltip();
  const front = element("p", { class: "note front-note" });

  const draw = () => {
    const [x, y] = [choices[across], choices[up]];
    const all = Array.from({ length: selection.size }, (_, i) => i).filter((i) => x.at(i) !== null && y.at(i) !== null);
    const bounds = (choice: Choice) => (choice.constraint ? [choice.constraint.bound] : []);
    plot.axes(
      { title: x.name, scale: x.scale, range: extent([...all.map(x.at), ...bounds(x)], { isShare: x.share }) },
      { title: y.name, scale: y.scale, range: extent([...all.map(y.at), ...bounds(y)], { isShare: y.share }) },
    );
    drawBounds(x, y);
    if (all.length <= MOST_INTERVALS) for (const i of all) drawInterval(i, x, y);
    drawFront(all, x, y);
    const shown = all.sort((a, b) => selection.isIn[a] - selection.isIn[b] || (study.designs.front[a] === "on" ? 1 : 0) - (study.designs.front[b] === "on" ? 1 : 0));
    const size = all.length > 400 ? 3 : 5;
    for (const i of shown) drawPoint(i, x, y, size);
    if (selection.chosen >= 0) drawPoint(selection.chosen, x, y, 6);
    nameSome(shown, x, y);
    if (brush) drawBrush(brush);
  };
  const plot = new Plot("Designs by two of their values. Arrow keys choose the next design.", (width) => Math.min(380, Math.max(280, 0.62 * width)), draw);
  const { canvas } = plot;

  function drawBounds(x: Choice, y: Choice): void {
    const { context, box } = plot;
    context.strokeStyle = colour(1);
    context.setLineDash([4, 3]);
    context.beginPath();
    if (x.constraint) plot.segment(plot.x(x.constraint.bound), box.top, plot.x(x.constraint.bound), box.bottom);
    if (y.constraint) plot.segment(box.left, plot.y(y.constraint.bound), box.right, plot.y(y.constraint.bound));
    context.stroke();
    context.setLineDash([]);
    if (y.constraint) plot.text(y.constraint.above ? "has to be above" : "has to be below", box.right, plot.y(y.constraint.bound) - 4, { align: "right", colour: colour(1), halo: true });
  }

  function drawInterval(i: number, x: Choice, y: Choice): void {
    const { context, box } = plot;
    const [cx, cy] = [plot.x(x.at(i)!), plot.y(y.at(i)!)];
    const [low, high, left, right] = [y.low(i), y.high(i), x.low(i), x.high(i)];
    context.globalAlpha = selection.isIn[i] ? 0.45 : 0.1;
    context.strokeStyle = placeColour(study.designs.front[i]);
    context.lineWidth = 1;
    context.beginPath();
    if (low !== null && high !== null) plot.segment(cx, Math.min(plot.y(low), box.bottom), cx, Math.max(plot.y(high), box.top));
    if (left !== null && right !== null) plot.segment(Math.max(plot.x(left), box.left), cy, Math.min(plot.x(right), box.right), cy);
    context.stroke();
    context.globalAlpha = 1;
  }

  function drawPoint(i: number, x: Choice, y: Choice, size: number): void {
    const { context } = plot;
    const [vx, vy] = [x.at(i), y.at(i)];
    if (vx === null || vy === null) return;
    context.globalAlpha = selection.isIn[i] ? 0.9 : 0.15;
    context.fillStyle = placeColour(study.designs.front[i]);
    context.beginPath();
    context.arc(plot.x(vx), plot.y(vy), size, 0, 7);
    context.fill();
    if (i === selection.chosen) {
      context.strokeStyle = styleColour("--text");
      context.lineWidth = 2;
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  function drawFront(all: number[], x: Choice, y: Choice): void {
    const best = across === up ? [] : leaders(all.filter((i) => keepsConstraints(study, i) && selection.isIn[i]), x, y);
    const proven = best.filter((i) => study.designs.front[i] === "on");
    front.textContent = best.length < 2 ? "" : `${best.length} designs are on the front of these two by means (dashed); ${proven.length} of them are proven to be on the study's front.`;
    if (best.length < 2) return;
    const { context } = plot;
    context.strokeStyle = styleColour("--text");
    context.lineWidth = 1.5;
    context.setLineDash([5, 4]);
    context.beginPath();
    plot.line(best.map((i) => [plot.x(x.at(i)!), plot.y(y.at(i)!)]));
    context.stroke();
    context.setLineDash([]);
    if (proven.length < 2) return;
    context.strokeStyle = placeColour("on");
    context.lineWidth = 2.5;
    context.beginPath();
    plot.line(proven.map((i) => [plot.x(x.at(i)!), plot.y(y.at(i)!)]));
    context.stroke();
  }

  /** Draws the names of the chosen design and of the best design where they cover the fewest points. */
  function nameSome(shown: number[], x: Choice, y: Choice): void {
    const points = shown.map((i): [number, number] => [plot.x(x.at(i)!), plot.y(y.at(i)!)]);
    for (const i of shown.filter((each) => each === selection.chosen || (study.designs.rank[each] === 1 && selection.isIn[each])).sort((a) => (a === selection.chosen ? -1 : 1))) {
      const [px, py] = [plot.x(x.at(i)!), plot.y(y.at(i)!)];
      const text = plot.fitted(`#${study.designs.number[i]} ${study.designs.name[i]}`, 0.6 * plot.width);
      const width = plot.context.measureText(text).width;
      const places = [-30, -9, 16, 40].flatMap((dy): [number, number][] => [[px + 9, py + dy], [px - 9 - width, py + dy]]);
      const covered = ([left, base]: [number, number]) => points.filter(([a, b]) => a > left - 4 && a < left + width + 4 && b > base - 15 && b < base + 7).length;
      places.map((place) => ({ place, count: covered(place) })).sort((a, b) => a.count - b.count).some(({ place: [left, base] }) => plot.text(text, left, base, { halo: true }));
    }
  }

  function drawBrush([x1, y1, x2, y2]: [number, number, number, number]): void {
    const { context } = plot;
    context.fillStyle = `${colour(0)}22`;
    context.strokeStyle = colour(0);
    context.lineWidth = 1;
    context.fillRect(x1, y1, x2 - x1, y2 - y1);
    context.strokeRect(x1, y1, x2 - x1, y2 - y1);
  }

  /** Returns the design whose point is nearest to the pixel. If no point is near, returns -1. */
  const nearest = (px: number, py: number): number => {
    let [found, distance] = [-1, 18];
    for (let i = 0; i < selection.size; ++i) {
      const [vx, vy] = [choices[across].at(i), choices[up].at(i)];
      if (vx === null || vy === null || !selection.isIn[i]) continue;
      const own = Math.hypot(plot.x(vx) - px, plot.y(vy) - py);
      if (own < distance) [found, distance] = [i, own];
    }
    return found;
  };
  const unbrush = () => {
    brush = null;
    selection.filter("front", null);
  };
  listenToPointer(canvas, {
    click: (px, py) => {
      if (brush) unbrush();
      else selection.choose(nearest(px, py));
    },
    drag: ([x1, y1], [x2, y2]) => {
      brush = [Math.min(x1, x2), Math.min(y1, y2), Math.max(x1, x2), Math.max(y1, y2)];
      const [left, bottom] = plot.at(brush[0], brush[3]);
      const [right, top] = plot.at(brush[2], brush[1]);
      const [x, y] = [choices[across], choices[up]];
      const isWithin = (value: number | null, low: number, high: number) => value !== null && value >= low && value <= high;
      selection.filter("front", (i) => isWithin(x.at(i), left, right) && isWithin(y.at(i), bottom, top));
    },
  });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const { at } = choices[across];
    const order = selection.designs.filter((i) => at(i) !== null).sort((a, b) => at(a)! - at(b)!);
    const next = order.indexOf(selection.chosen) + step;
    selection.choose(order[Math.min(order.length - 1, Math.max(0, next))] ?? -1);
  });
  canvas.addEventListener("pointermove", (event) => {
    const design = event.buttons ? -1 : nearest(event.offsetX, event.offsetY);
    canvas.style.cursor = design < 0 ? "crosshair" : "pointer";
    if (design < 0) return tooltip.hide();
    tooltip.show(event, `#${study.designs.number[design]} ${study.designs.name[design]}`, [choices[across], choices[up]].map((one) => `${one.name}: ${one.text(design)}`));
  });
  canvas.addEventListener("pointerleave", () => tooltip.hide());
  selection.onChange(() => plot.redraw());
  selection.onReset(() => (brush = null));

  const names = choices.map(({ name }) => name);
  const renew = () => {
    unbrush();
    plot.redraw();
  };
  const key = element("p", { class: "key" });
  for (const [place, text] of Object.entries(PLACES)) {
    const count = study.designs.front.filter((one) => one === place).length;
    if (count) key.append(element("span", {}, element("i", { class: `dot ${place}` }), `${text}: ${count}`));
  }
  return panel("Front", "Each point is a design; bars are intervals. Drag to select, click for details.",
    element("div", { class: "choices" },
      makeChoice("across", names, across, (value) => ((across = value), renew())), makeChoice("up", names, up, (value) => ((up = value), renew()))),
    key, plot.root, front);
}

function choicesOf(study: Study): Choice[] {
  const objectives = study.objectives.map((one, number): Choice => ({
    name: titleOf(one), share: one.share, scale: one.scale, sense: one.sense || (one.share ? 1 : 0),
    constraint: study.constraints.find(({ objective }) => objective === number) ?? null,
    at: (i) => one.mean[i], low: (i) => one.low[i], high: (i) => one.high[i], text: (i) => objectiveText(one, one.mean[i]),
  }));
  const factors = study.factors.filter((one) => one.number).map((one): Choice => ({
    name: one.unit ? `${one.label} [${one.unit}]` : one.label, share: false, scale: one.scale, sense: 0, constraint: null,
    at: (i) => Number(one.values[i]), low: () => null, high: () => null, text: (i) => factorText(one, one.values[i]),
  }));
  const all = [...objectives, ...factors];
  const place: Choice = { name: "rank", share: false, scale: 1, sense: 0, constraint: null, at: (i) => study.designs.rank[i], low: () => null, high: () => null, text: (i) => digits(study.designs.rank[i] ?? 0) };
  return [...all, place];
}

/** Returns the default axes. The first axis is the first minimised or maximised objective. The second axis is the
 * next such objective. If the study has no second one, it is another objective, preferably a share. If the study has
 * only one objective, it is the first factor. */
function firstChoices(study: Study): [number, number] {
  const { objectives } = study;
  const sorted = objectives.map((_, i) => i).sort((a, b) => Math.abs(objectives[b].sense) - Math.abs(objectives[a].sense));
  const across = sorted[0] ?? 0;
  let up = sorted.length > 1 && objectives[sorted[1]].sense ? sorted[1] : objectives.findIndex((one, i) => one.share && i !== across);
  if (up < 0) up = sorted[1] ?? objectives.length;
  return [across, up];
}

function keepsConstraints({ constraints, objectives, designs }: Study, design: number): boolean {
  return designs.front[design] !== "excluded" && constraints.every(({ objective, above, bound }) => {
    const mean = objectives[objective].mean[design];
    return mean !== null && (above ? mean > bound : mean < bound);
  });
}

/** Returns the designs that no other design dominates in the means of both values. */
function leaders(designs: number[], x: Choice, y: Choice): number[] {
  if (!x.sense || !y.sense) return [];
  const sorted = [...designs].sort((a, b) => x.sense * (x.at(b)! - x.at(a)!) || y.sense * (y.at(b)! - y.at(a)!));
  let best = -Infinity;
  return sorted.filter((i) => {
    const value = y.sense * y.at(i)!;
    const leads = value > best;
    if (leads) best = value;
    return leads;
  });
}
