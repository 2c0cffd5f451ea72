// SPDX-License-Identifier: Apache-2.0
// The page of a study that compares designs: headline, ranked table, and panels with a common selection.
import { element } from "../dom";
import type { Study } from "./content";
import { makeConvergence } from "./convergence";
import { makeComparison, makeDetails } from "./details";
import { makeDistributions } from "./distributions";
import { makeEffects } from "./effects";
import { counted, titleOf } from "./format";
import { makeFronts } from "./fronts";
import { makeImportances } from "./importances";
import { makeInteractions } from "./interactions";
import { makeParallel } from "./parallel";
import { Selection } from "./selection";
import { Shown } from "./shown";
import { makeTable } from "./table";
import { makeChoice, makeColumns } from "./widgets";

export function makeStudy(study: Study): HTMLElement[] {
  const selection = new Selection(study.designs.number.length);
  const shown = new Shown(study);
  Object.assign(window.mebots, { study, selection, shown }); // used by scripts and tests
  const hasMeans = study.objectives.length > 0 && study.factors.some(({ levels }) => levels.length > 1);
  const fronts = study.objectives.length > 0 ? makeFronts(study, selection) : null;
  const effects = hasMeans ? makeEffects(study, selection, shown) : null;
  const distributions = study.quantiles && study.objectives.length > 0 ? makeDistributions(study, selection, shown) : null;
  const left = [fronts, effects, distributions];
  const panels = [
    fronts,
    study.objectives.length > 0 ? makeParallel(study, selection) : null,
    effects,
    hasMeans ? makeInteractions(study, selection, shown) : null,
    distributions,
    hasMeans && study.refresh_s === null ? makeImportances(study, shown) : null,
    makeConvergence(study, selection, shown),
  ].filter((one) => one !== null);
  listenToEscape(selection);
  if (study.refresh_s !== null) reload(study.refresh_s, selection);
  return [
    makeAnswer(study),
    element("section", { class: "panel table-panel" }, element("h2", {}, "Designs"), makeTable(study, selection)),
    makeToolbar(study, selection, shown),
    makeColumns(panels, (one) => !left.includes(one)),
    makeDetails(study, selection),
    makeComparison(study, selection),
  ];
}

function makeAnswer(study: Study): HTMLElement {
  const { headlines, remarks } = study.answer;
  const failed = study.failed_of ? `${study.failed_of.toLocaleString("en")} failed` : "none failed";
  const facts = `${counted(study.designs.of, "design")}, ${counted(study.missions_of, "mission")}, ${failed}. Intervals: ${100 * (1 - study.error)} %, ` +
    (study.sequence ? "valid at every number of missions." : "for a number of missions that was settled beforehand.") +
    (study.refresh_s === null ? "" : ` The study is running: this page loads itself again every ${study.refresh_s} s, unless something is selected.`);
  return element("section", { class: "answer" }, ...headlines.map((text) => element("p", { class: "headline" }, text)),
    ...remarks.map((text) => element("p", {}, text)), element("p", { class: "faint" }, facts));
}

/** Creates the controls for all panels: the objective and the selection. They stay in view while the page scrolls. */
function makeToolbar(study: Study, selection: Selection, shown: Shown): HTMLElement {
  const text = element("span", { class: "status", role: "status" });
  const clear = element("button", { onclick: () => selection.reset() }, "show all");
  const draw = () => {
    clear.style.visibility = selection.isFiltered ? "visible" : "hidden"; // keeps its space, so that no panel moves during a drag
    text.textContent = selection.isFiltered ? `${selection.count.toLocaleString("en")} of ${counted(selection.size, "design")} selected` : "all designs";
  };
  selection.onChange(draw);
  draw();
  const choice = makeChoice("effects, distributions, importances of", study.objectives.map(titleOf), shown.objective, (value) => shown.set(value));
  return element("div", { class: "toolbar" }, ...(study.objectives.length ? [choice] : []), text, clear);
}

/** Reloads the page of a running study periodically. While the user has selected or chosen a design, does not reload. */
function reload(period_s: number, selection: Selection): void {
  setInterval(() => {
    if (!selection.isFiltered && selection.chosen < 0) location.reload();
  }, 1000 * period_s);
}

function listenToEscape(selection: Selection): void {
  document.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || document.querySelector("dialog[open]")) return;
    if (selection.chosen >= 0) selection.choose(-1);
    else selection.reset();
  });
}
