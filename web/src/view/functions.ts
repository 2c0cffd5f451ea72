// SPDX-License-Identifier: Apache-2.0
// Shows the cost of each function in the time span of the plots, without the functions that it calls.
import { type FunctionCost, type WindowedProfile } from "../data/profile";
import { shown } from "../data/units";
import { element } from "../dom";
import type { Window } from "./window";

const MOST_ROWS = 30;

export function makeFunctions(profile: WindowedProfile, window: Window, withIdle: () => boolean): { root: HTMLElement; draw: () => void } {
  const body = element("tbody", {});
  const rest = element("p", { class: "faint" });
  let order: keyof FunctionCost = "energy";
  const heads = (["name", "energy", "time", "cycles"] as const).map((key) => element("th", key === "name" ? {} : { class: "right" },
    key === "name" ? "function, by itself" : element("button", { class: "sort", "data-sort": key, onclick: () => { order = key; draw(); } }, key)));
  const draw = () => {
    const all = profile.slice(window.start, window.stop).functions(withIdle()).sort((a, b) => Number(b[order]) - Number(a[order]));
    const total = all.reduce((sum, { energy }) => sum + energy, 0) || 1;
    for (const head of heads.slice(1)) head.setAttribute("aria-sort", head.firstElementChild!.getAttribute("data-sort") === order ? "descending" : "none");
    body.replaceChildren(...all.slice(0, MOST_ROWS).map(({ name, energy, time, cycles }) => element("tr", {},
      element("td", {}, name), element("td", { class: "number" }, `${shown(energy, "J")}, ${((100 * energy) / total).toFixed(1)} %`),
      element("td", { class: "number" }, shown(time, "s")), element("td", { class: "number" }, cycles.toLocaleString("en")))));
    rest.textContent = all.length > MOST_ROWS ? `and ${all.length - MOST_ROWS} more` : "";
  };
  return { root: element("div", { class: "functions" }, element("table", {}, element("thead", {}, element("tr", {}, ...heads)), body), rest), draw };
}
