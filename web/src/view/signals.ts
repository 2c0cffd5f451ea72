// SPDX-License-Identifier: Apache-2.0
// Lists all recorded variables with their values at the shown time. A search uses words of name, unit or meaning. A
// click plots the variable.
import type { Clock } from "../clock";
import type { Run } from "../data/run";
import { shownUnit, wordsOf } from "../data/units";
import { element } from "../dom";

const MOST_ROWS = 400;

/** Maps a word of a search to other words for the same quantity. */
const SYNONYMS: Record<string, string[]> = {
  altitude: ["position.z", "height"], height: ["position.z", "altitude"], battery: ["cell."], charge: ["state_of_charge", "soc"],
  heading: ["yaw"], cpu: ["soc.", "core"], chip: ["soc."], propeller: ["rotor"], motor: ["rotor"], drone: ["body"],
};

export function makeSignals(run: Run, clock: Clock, plot: (name: string) => void): HTMLElement {
  const search = element("input", { type: "search", id: "search", placeholder: "Search variables: name, unit, meaning  ( / )", "aria-label": "search variables" });
  const body = element("tbody", {});
  const count = element("span", { class: "faint" });
  let cells: [HTMLElement, string][] = [];
  const all = run.variables.map((name) => {
    const text = run.info(name)?.text ?? "";
    const unit = run.unit(name);
    return { name, text, unit, hay: `${name} ${text} ${unit} ${wordsOf(unit)}`.toLowerCase() };
  });
  const show = () => {
    if (root.offsetParent === null) return;
    for (const [cell, name] of cells) cell.textContent = run.textAt(name, clock.time);
  };
  const find = () => {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = all.filter(({ hay }) => words.every((word) => hay.includes(word) || SYNONYMS[word]?.some((other) => hay.includes(other))));
    cells = [];
    body.replaceChildren(...found.slice(0, MOST_ROWS).map(({ name, text, unit }) => {
      const value = element("td", { class: "number", "data-variable": name });
      cells.push([value, name]);
      return element("tr", { class: run.stands(name) ? "still" : "" },
        element("td", {}, element("button", { title: "Plot", onclick: () => plot(name) }, name)),
        element("td", {}, shownUnit(unit) || (unit === "1" ? "1" : "")), value, element("td", { class: "faint" }, text));
    }));
    count.textContent = `${found.length} of ${all.length}${found.length > MOST_ROWS ? `; the first ${MOST_ROWS} are shown` : ""}`;
    show();
  };
  search.addEventListener("input", find);
  const root = element("div", { class: "signals" }, element("div", { class: "bar-line" }, search, count),
    element("div", { class: "scroll" }, element("table", {}, element("thead", {}, element("tr", {}, ...["variable", "unit", "now", "meaning"].map((head) => element("th", {}, head)))), body)));
  if (run.header.texts.length > 0) root.append(element("p", { class: "faint" }, `Texts are not shown: ${run.header.texts.join(", ")}`));
  clock.onTime(show);
  new ResizeObserver(show).observe(root);
  find();
  return root;
}
