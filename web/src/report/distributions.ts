// SPDX-License-Identifier: Apache-2.0
// Shows the outcomes of missions, the distribution of their values, and the spread in each design.
import { element } from "../dom";
import { colour, onTheme, styleColour } from "../theme";
import type { Study } from "./content";
import { counted, objectiveText, percent, titleOf } from "./format";
import { placeColour } from "./fronts";
import { extent, listenToPointer, Plot } from "./plot";
import type { Selection } from "./selection";
import type { Shown } from "./shown";
import { makeTooltip, panel } from "./widgets";

const BINS = 48;
const MOST_BOXES = 80; // if there are more designs, bands replace their boxes
const MOST_DOTS = 3000;

export function makeDistributions(study: Study, selection: Selection, shown: Shown): HTMLElement {
  const { missions } = study;
  const quantiles = study.quantiles!;
  const starts = firstOf(missions!.counts);
  const tooltip = makeTooltip();
  let order: number[] = []; // designs in the order in which they are drawn

  const spread = new Plot("Spread of the missions of each design", () => 250, () => {
    const objective = study.objectives[shown.objective];
    const own = quantiles[shown.objective];
    const known = (i: number) => own[i] !== null;
    order = selection.designs.filter(known).sort((a, b) => (objective.mean[a] ?? 0) - (objective.mean[b] ?? 0));
    const range = extent(own.flatMap((each) => (each ? [each[0], each[6]] : [])), { isShare: objective.share });
    const names: [number, string][] = order.length <= MOST_BOXES ? order.map((i, place) => [place + 0.5, `#${study.designs.number[i]}`]) : [];
    spread.axes({ title: `${counted(order.length, "design")}, sorted by ${objective.statistic}`, range: [0, Math.max(1, order.length)], names }, { title: titleOf(objective), scale: objective.scale, range });
    if (order.length <= MOST_BOXES) order.forEach((i, place) => drawBox(i, place, own[i]!));
    else drawBands(order.map((i) => own[i]!));
  });

  function drawBox(design: number, place: number, [least, low, quarter, middle, threeQuarters, high, most]: number[]): void {
    const { context } = spread;
    const [left, right] = [spread.x(place + 0.18), spread.x(place + 0.82)];
    const centre = (left + right) / 2;
    context.strokeStyle = context.fillStyle = design === selection.chosen ? styleColour("--text") : placeColour(study.designs.front[design]);
    context.lineWidth = 1;
    context.beginPath();
    spread.segment(centre, spread.y(low), centre, spread.y(high));
    context.stroke();
    context.globalAlpha = 0.35;
    context.fillRect(left, spread.y(threeQuarters), right - left, Math.max(1, spread.y(quarter) - spread.y(threeQuarters)));
    context.globalAlpha = 1;
    context.fillRect(left, spread.y(middle) - 1, right - left, 2.5);
    for (const end of [least, most]) context.fillRect(centre - 1.5, spread.y(end) - 1.5, 3, 3);
    if (missions!.values[0].length > MOST_DOTS) return;
    context.globalAlpha = 0.55;
    for (let k = 0; k < missions!.counts[design]; ++k) {
      const value = missions!.values[shown.objective][starts[design] + k];
      if (value !== null) context.fillRect(left + ((k * 0.618) % 1) * (right - left) - 1, spread.y(value) - 1, 2, 2);
    }
    context.globalAlpha = 1;
  }

  /** Draws bands: minimum to maximum, 5 to 95 % quantile, 25 to 75 % quantile. Draws the median as a line. If several
   * designs share a pixel, draws their outermost values. */
  function drawBands(own: number[][]): void {
    const { context } = spread;
    const columns = Math.min(own.length, Math.floor(spread.box.right - spread.box.left));
    const area = (low: number, high: number, alpha: number) => {
      context.globalAlpha = alpha;
      for (let column = 0; column < columns; ++column) {
        const part = own.slice(Math.floor((column * own.length) / columns), Math.floor(((column + 1) * own.length) / columns));
        const [bottom, top] = [Math.min(...part.map((each) => each[low])), Math.max(...part.map((each) => each[high]))];
        const [left, right] = [spread.x((column * own.length) / columns), spread.x(((column + 1) * own.length) / columns)];
        context.fillRect(left, spread.y(top), Math.max(1, right - left), Math.max(1.5, spread.y(bottom) - spread.y(top)));
      }
      context.globalAlpha = 1;
    };
    context.fillStyle = colour(0);
    area(0, 6, 0.15);
    area(1, 5, 0.25);
    area(2, 4, 0.35);
    area(3, 3, 1);
  }

  const histogram = new Plot("Histogram of missions", () => 150, () => {
    const objective = study.objectives[shown.objective];
    const values = missions!.values[shown.objective];
    const range = extent(values, { margin: 0.01 });
    const [all, own] = [new Uint32Array(BINS), new Uint32Array(BINS)];
    missions!.counts.forEach((count, i) => {
      for (let k = starts[i]; k < starts[i] + count; ++k) {
        const value = values[k];
        if (value === null) continue;
        const bin = Math.min(BINS - 1, Math.floor(((value - range[0]) / (range[1] - range[0])) * BINS));
        ++all[bin];
        own[bin] += selection.isIn[i];
      }
    });
    histogram.axes({ title: titleOf(objective), scale: objective.scale, range }, { title: "missions", range: [0, 1.05 * Math.max(1, ...all)] });
    const { context } = histogram;
    for (const [counts, fill] of [[all, styleColour("--line")], [own, colour(0)]] as const) {
      context.fillStyle = fill;
      counts.forEach((count, bin) => {
        const [left, right] = [bin, bin + 1].map((edge) => histogram.x(range[0] + (edge / BINS) * (range[1] - range[0])));
        if (count) context.fillRect(left + 0.5, histogram.y(count), right - left - 1, histogram.y(0) - histogram.y(count));
      });
    }
  });

  listenToPointer(spread.canvas, { click: (x) => selection.choose(order[Math.floor(spread.at(x, 0)[0])] ?? -1) });
  spread.canvas.addEventListener("pointermove", (event) => {
    const design = order[Math.floor(spread.at(event.offsetX, 0)[0])];
    if (design === undefined) return tooltip.hide();
    const objective = study.objectives[shown.objective];
    const [least, , , middle, , , most] = quantiles[shown.objective][design]!;
    tooltip.show(event, `#${study.designs.number[design]} ${study.designs.name[design]}`,
      [objective.text[design], `median ${objectiveText(objective, middle)}, from ${objectiveText(objective, least)} to ${objectiveText(objective, most)}`]);
  });
  spread.canvas.addEventListener("pointerleave", () => tooltip.hide());
  const redraw = () => {
    spread.redraw();
    histogram.redraw();
  };
  selection.onChange(redraw);
  shown.onChange(redraw);
  const thin = missions!.every > 1 ? ` The histogram counts every ${missions!.every}th mission; boxes and bands are of all.` : "";
  return panel("Distributions", `A box holds the middle half of a design's missions, a line 90 %, dots the extremes. Grey: all missions; colour: the selection.${thin}`,
    ...(missions!.outcomes.length ? [makeEnds(study, selection)] : []), spread.root, histogram.root);
}

/** Creates a bar with the shares of the outcomes in missions of the selected designs. */
function makeEnds(study: Study, selection: Selection): HTMLElement {
  const { outcomes, outcome_counts } = study.missions!;
  const root = element("div", { class: "ends" });
  const fill = (place: number) => colour([2, 1, 0][place] ?? place);
  const draw = () => {
    const counts = outcomes.map((_, name) => outcome_counts.reduce((sum, own, i) => sum + (selection.isIn[i] ? own[name] : 0), 0));
    const all = counts.reduce((sum, count) => sum + count, 0);
    const order = outcomes.map((_, i) => i).filter((i) => counts[i] > 0).sort((a, b) => counts[b] - counts[a]);
    root.replaceChildren(
      element("div", { class: "stack" }, ...order.map((i, place) => element("i", { style: `flex:${counts[i]};background:${fill(place)}`, title: outcomes[i] }))),
      element("p", { class: "key" }, ...order.map((i, place) => element("span", {}, element("i", { class: "dot", style: `background:${fill(place)}` }),
        `${outcomes[i].replaceAll("_", " ")} ${counts[i].toLocaleString("en")} (${percent(counts[i] / all)})`))));
  };
  selection.onChange(draw);
  onTheme(draw);
  draw();
  return root;
}

export function firstOf(counts: number[]): number[] {
  let sum = 0;
  return counts.map((count) => (sum += count) - count);
}
