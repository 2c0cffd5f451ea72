// SPDX-License-Identifier: Apache-2.0
// A table of the means at each combination of two factors' levels, with coloured cells.
import { element } from "../dom";
import { onTheme, scaleColour } from "../theme";
import type { Study } from "./content";
import { cellMeans } from "./effects";
import { objectiveText, percent } from "./format";
import { extent } from "./plot";
import type { Selection } from "./selection";
import type { Shown } from "./shown";
import { makeChoice, panel } from "./widgets";

export function makeInteractions(study: Study, selection: Selection, shown: Shown): HTMLElement | null {
  const { pairs } = study.effects;
  if (pairs.length === 0) return null;
  const body = element("div", {});
  const choice = element("div", { class: "choices" });
  let chosen = 0;
  const shares = () => study.effects.importances[shown.objective]?.pairs ?? [];

  const draw = () => {
    const objective = study.objectives[shown.objective];
    const [rows, columns] = ordered(study, pairs[chosen]);
    const [first, second] = [study.factors[rows], study.factors[columns]];
    const width = second.levels.length;
    const all = study.effects.pair_means[shown.objective][chosen];
    const isSwapped = rows !== pairs[chosen][0];
    const whole = (row: number, column: number) => (isSwapped ? all[column * first.levels.length + row] : all[row * width + column]);
    const own = selection.isFiltered ? cellMeans(first.levels.length * width, (i) => first.level[i] * width + second.level[i], objective, selection) : null;
    const [low, high] = extent(all, { margin: 0 });
    const cell = (row: number, column: number) => {
      const value = own ? own[row * width + column] : whole(row, column);
      if (value === null) return element("td", { class: "none" }, "\u2013");
      const [red, green, blue] = scaleColour((value - low) / (high - low || 1));
      const isDark = 0.299 * red + 0.587 * green + 0.114 * blue < 0.5;
      const style = `background:rgb(${[red, green, blue].map((part) => Math.round(255 * part)).join(" ")});color:${isDark ? "#fff" : "#111"}`;
      return element("td", { style }, objectiveText(objective, value));
    };
    body.replaceChildren(element("div", { class: "scroll" }, element("table", { class: "heat" },
      element("thead", {}, element("tr", {}, element("th", {}, `${first.label} \\ ${second.label}`), ...second.levels.map((name) => element("th", {}, name)))),
      element("tbody", {}, ...first.levels.map((name, row) => element("tr", {}, element("th", {}, name), ...second.levels.map((_, column) => cell(row, column))))))));
  };
  const renew = () => {
    const known = shares();
    if (known.length) chosen = known.indexOf(Math.max(...known));
    const names = pairs.map(([a, b], i) => `${study.factors[a].label} and ${study.factors[b].label}${known.length ? ` (${percent(known[i])})` : ""}`);
    choice.replaceChildren(makeChoice("factors", names, chosen, (value) => ((chosen = value), draw())));
    draw();
  };
  shown.onChange(renew);
  selection.onChange(draw);
  onTheme(draw);
  renew();
  return panel("Interactions", "Mean of the designs with both levels. In brackets: the share of the variance that a pair explains beyond its two factors. It opens with the largest.", choice, body);
}

/** Orders two factors. The factor with longer names is in the rows, which have more space. */
function ordered(study: Study, [a, b]: [number, number]): [number, number] {
  const length = (factor: number) => Math.max(...study.factors[factor].levels.map((name) => name.length)) + study.factors[factor].levels.length;
  return length(a) >= length(b) ? [a, b] : [b, a];
}
