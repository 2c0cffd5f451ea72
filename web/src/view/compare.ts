// SPDX-License-Identifier: Apache-2.0
// Compares runs: their different settings and their results.
import type { Json } from "../data/payload";
import type { Run } from "../data/run";
import { element } from "../dom";
import { colour, onTheme } from "../theme";
import { finalValues, shownValue } from "./statistics";

interface Row {
  label: string;
  cells: string[];
}

export function makeComparison(runs: Run[]): HTMLElement {
  const heads = runs.map((run) => ({ swatch: element("i", { class: "swatch" }), run }));
  const paint = () => heads.forEach(({ swatch }, i) => (swatch.style.background = colour(i)));
  paint();
  onTheme(paint);
  const head = element("tr", {}, element("th", {}), ...heads.map(({ swatch, run }) => element("th", {}, swatch, run.name)));
  const given = differing(parameterRows(runs));
  const came = outcomeRows(runs);
  const section = (title: string, rows: Row[], empty: string) => [
    element("tr", {}, element("th", { class: "part", colspan: String(runs.length + 1) }, title)),
    ...(rows.length > 0
      ? rows.map((row) => element("tr", {}, element("td", {}, row.label), ...row.cells.map((cell) => element("td", { class: "number" }, cell))))
      : [element("tr", {}, element("td", { class: "faint", colspan: String(runs.length + 1) }, empty))]),
  ];
  return element("div", { class: "comparison scroll" }, element("table", {}, element("thead", {}, head),
    element("tbody", {}, ...section("What was given differently", given, "No parameter: same settings."), ...section("What came of it", came, ""))));
}

function rowsOf(runs: Run[], read: (run: Run) => Map<string, string>): Row[] {
  const all = runs.map(read);
  const labels = new Set(all.flatMap((values) => [...values.keys()]));
  return [...labels].map((label) => ({ label, cells: all.map((values) => values.get(label) ?? "\u2013") }));
}

function differing(rows: Row[]): Row[] {
  return rows.filter(({ cells }) => new Set(cells).size > 1);
}

function parameterRows(runs: Run[]): Row[] {
  return rowsOf(runs, (run) => {
    const values = new Map<string, string>();
    for (const [instance, parameters] of Object.entries<Json>(run.summary.parameters ?? {})) {
      for (const [name, value] of Object.entries<Json>(parameters)) values.set(`${instance}.${name}`, String(value));
    }
    for (const change of run.summary.inputs?.changes ?? []) if (!change.startsWith("set ")) values.set(change, "yes");
    return values;
  });
}

function outcomeRows(runs: Run[]): Row[] {
  return rowsOf(runs, (run) => {
    const values = new Map<string, string>([
      ["outcome", run.summary.outcome ?? "unknown"],
      ["simulated time", shownValue(run.summary.simulated_time ?? run.end, "s")],
    ]);
    for (const { label, value, unit } of finalValues(run.summary)) values.set(label, shownValue(value, unit));
    return values;
  });
}
