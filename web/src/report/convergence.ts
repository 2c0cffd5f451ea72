// SPDX-License-Identifier: Apache-2.0
// Shows how the confidence intervals of the best designs narrow with the number of missions. For a search, shows the
// best design so far.
import { element } from "../dom";
import { colour, styleColour } from "../theme";
import type { Course, Study } from "./content";
import { objectiveText, titleOf } from "./format";
import { extent, Plot } from "./plot";
import type { Selection } from "./selection";
import type { Shown } from "./shown";
import { panel } from "./widgets";

const MOST_CURVES = 5;

export function makeConvergence(study: Study, selection: Selection, shown: Shown): HTMLElement | null {
  const made = [...(study.courses.length > 0 ? [makeCourses(study, selection, shown)] : []), ...(study.best.length > 0 ? [makeHistory(study, selection, shown)] : [])];
  if (made.length === 0) return null;
  return panel("Convergence", `Estimates and their intervals over the number of missions. The page has those of the best ${study.courses.length}; the chosen design and the best ${MOST_CURVES} of the selection are drawn.`, ...made);
}

function makeCourses(study: Study, selection: Selection, shown: Shown): HTMLElement {
  const places = new Map(study.designs.number.map((number, i) => [number, i]));
  const key = element("p", { class: "key" });
  const plot = new Plot("Estimates over the number of missions", () => 240, () => {
    const objective = study.objectives[shown.objective];
    const curves = study.courses.filter(({ design }) => selection.isIn[places.get(design) ?? -1]);
    const own = curves.find(({ design }) => places.get(design) === selection.chosen);
    const drawn = [...new Set([...(own ? [own] : []), ...curves])].slice(0, MOST_CURVES);
    const values = drawn.flatMap((one) => [...one.mean[shown.objective], ...laterBounds(one, shown.objective)]);
    const most = Math.max(3, ...drawn.map(({ counts }) => counts[counts.length - 1]));
    plot.axes({ title: "missions of the design", range: [2, most], log: most > 30 }, { title: titleOf(objective), scale: objective.scale, range: extent(values, { isShare: objective.share }) });
    drawn.forEach((one, i) => drawCourse(one, shown.objective, colour(i)));
    key.replaceChildren(...drawn.map((one, i) => {
      const place = places.get(one.design)!;
      return element("span", {}, element("i", { class: "dot", style: `background:${colour(i)}` }), `#${one.design} ${study.designs.name[place]}: ${objectiveText(objective, objective.mean[place])}`);
    }));
  });

  function drawCourse({ counts, mean, low, high }: Course, objective: number, stroke: string): void {
    const { context, box } = plot;
    const point = (value: number | null, count: number): [number, number] | null =>
      value === null ? null : [plot.x(count), Math.min(box.bottom, Math.max(box.top, plot.y(value)))];
    const known = counts.map((_, i) => i).filter((i) => low[objective][i] !== null && high[objective][i] !== null);
    context.fillStyle = `${stroke}22`;
    context.beginPath();
    plot.line([...known.map((i) => point(high[objective][i], counts[i])), ...known.reverse().map((i) => point(low[objective][i], counts[i]))]);
    context.fill();
    context.strokeStyle = stroke;
    context.lineWidth = 2;
    context.beginPath();
    plot.line(counts.map((count, i) => point(mean[objective][i], count)));
    context.stroke();
  }
  selection.onChange(() => plot.redraw());
  shown.onChange(() => plot.redraw());
  return element("div", {}, plot.root, key);
}

/** Returns the bounds of a design's confidence intervals in the later half of its missions. Earlier intervals are so
 * wide that they would hide the later intervals. */
function laterBounds({ counts, low, high }: Course, objective: number): (number | null)[] {
  const from = Math.floor(counts.length / 2);
  return [...low[objective].slice(from), ...high[objective].slice(from)];
}

function makeHistory(study: Study, selection: Selection, shown: Shown): HTMLElement {
  const best = new Set(study.best);
  const plot = new Plot("Designs in the order of the search", () => 220, () => {
    const objective = study.objectives[shown.objective];
    const { number } = study.designs;
    plot.axes({ title: "designs in the order of the search", range: [0, study.designs.of] }, { title: titleOf(objective), scale: objective.scale, range: extent(objective.mean, { isShare: objective.share }) });
    const { context } = plot;
    const corners: [number, number][] = [];
    number.forEach((design, i) => {
      const mean = objective.mean[i];
      if (mean === null) return;
      context.fillStyle = best.has(design) ? colour(1) : selection.isIn[i] ? colour(0) : styleColour("--line");
      context.fillRect(plot.x(design) - 2, plot.y(mean) - 2, 4, 4);
      if (best.has(design)) corners.push([plot.x(design), corners.at(-1)?.[1] ?? plot.y(mean)], [plot.x(design), plot.y(mean)]);
    });
    if (corners.length) corners.push([plot.box.right, corners.at(-1)![1]]);
    context.strokeStyle = colour(1);
    context.lineWidth = 2;
    context.beginPath();
    plot.line(corners);
    context.stroke();
    plot.text("best so far", plot.box.right, (corners.at(-1)?.[1] ?? 0) - 6, { align: "right", colour: colour(1), halo: true });
  });
  selection.onChange(() => plot.redraw());
  shown.onChange(() => plot.redraw());
  return plot.root;
}
