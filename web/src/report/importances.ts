// SPDX-License-Identifier: Apache-2.0
// Draws the variance that factors and pairs of factors explain. If the study requests sensitivity indices, shows them,
// too.
import { element } from "../dom";
import type { Study } from "./content";
import { digits, percent } from "./format";
import type { Shown } from "./shown";
import { makeSmallTable, panel } from "./widgets";

const MOST_BARS = 14;
const LEAST = 0.001;

export function makeImportances(study: Study, shown: Shown): HTMLElement {
  const body = element("div", { class: "bars" });
  const renew = () => {
    const found = study.effects.importances[shown.objective];
    if (!found) return body.replaceChildren(element("p", { class: "empty" }, "All designs have the same value."));
    const factors = study.factors.map(({ label }, i) => ({ name: label, share: found.factors[i], isPair: false }));
    const pairs = study.effects.pairs.map(([a, b], i) => ({ name: `${study.factors[a].label} with ${study.factors[b].label}`, share: found.pairs[i], isPair: true }));
    const all = [...factors, ...pairs].filter(({ share, isPair }) => !isPair || share >= LEAST).sort((a, b) => b.share - a.share);
    const rows = all.slice(0, MOST_BARS).map(({ name, share, isPair }) => bar(name, share, isPair ? "pair" : ""));
    const rest = 1 - all.slice(0, MOST_BARS).reduce((sum, { share }) => sum + share, 0);
    if (rest >= LEAST) rows.push(bar("all else", rest, "rest"));
    body.replaceChildren(...rows);
  };
  shown.onChange(renew);
  renew();
  const made = panel("Importances", "Shares of the variance between designs: of a factor alone, and of a pair beyond its two factors.", body);
  if (study.indices) {
    const { method, titles, rows } = study.indices;
    made.append(element("h3", {}, `Sensitivity indices (${method})`),
      makeSmallTable(titles, rows.map((row) => row.map((cell, i) => (i < 2 || cell === "" ? cell : digits(Number(cell), 3))))));
  }
  return made;
}

function bar(name: string, share: number, kind: string): HTMLElement {
  return element("div", { class: `bar ${kind}` }, element("span", { class: "name" }, name),
    element("span", { class: "rail" }, element("i", { style: `width:${100 * Math.min(1, share)}%` })), element("b", {}, percent(share)));
}
