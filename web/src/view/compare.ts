// SPDX-License-Identifier: Apache-2.0
// Compares the settings and the results of runs.
import type { Json } from "../data/payload";
import type { Run } from "../data/run";
import { element } from "../dom";
import { colour, onTheme } from "../theme";
import { finalValues, shownValue } from "./statistics";

interface Row {
  label: string;
  cells: string[];
  /** The change as text. For numbers, this is the last run minus the first run. */
  difference: string;
}

/** A value as text. A number also has its value and unit. */
interface Cell {
  text: string;
  number?: number;
  unit?: string;
}

export function makeComparison(runs: Run[]): HTMLElement {
  const heads = runs.map((run) => ({ swatch: element("i", { class: "swatch" }), run }));
  const paint = () => heads.forEach(({ swatch }, i) => (swatch.style.background = colour(i)));
  paint();
  onTheme(paint);
  const last = runs.length === 2 ? "difference" : "last less first";
  const head = element("tr", {}, element("th", {}), ...heads.map(({ swatch, run }) => element("th", {}, swatch, run.name)), element("th", {}, last));
  const given = differing(parameterRows(runs));
  const came = outcomeRows(runs);
  const section = (title: string, rows: Row[], empty: string) => [
    element("tr", {}, element("th", { class: "part", colspan: String(runs.length + 2) }, title)),
    ...(rows.length > 0
      ? rows.map((row) => element("tr", {}, element("td", {}, row.label), ...[...row.cells, row.difference].map((cell) => element("td", { class: "number" }, cell))))
      : [element("tr", {}, element("td", { class: "faint", colspan: String(runs.length + 2) }, empty))]),
  ];
  return element("div", { class: "comparison scroll" }, element("table", {}, element("thead", {}, head),
    element("tbody", {}, ...section("Different settings", given, "No parameter: same settings."), ...section("Different results", came, ""))));
}

function rowsOf(runs: Run[], missing: string, read: (run: Run) => Map<string, Cell>): Row[] {
  const all = runs.map(read);
  const labels = new Set(all.flatMap((values) => [...values.keys()]));
  return [...labels].map((label) => {
    const cells = all.map((values) => values.get(label));
    return { label, cells: cells.map((cell) => cell?.text ?? missing), difference: differenceOf(cells[0], cells[cells.length - 1]) };
  });
}

/** Returns a difference such as "+12.3 J (+4.5 %)". If the values are not numbers of the same unit, returns "". */
function differenceOf(first: Cell | undefined, last: Cell | undefined): string {
  if (first?.number === undefined || last?.number === undefined || first.unit !== last.unit) return "";
  const difference = last.number - first.number;
  if (difference === 0) return "0";
  if (Math.abs(difference) < 1e-8 * Math.abs(first.number)) return "\u2248 0";
  const sign = difference > 0 ? "+" : "";
  const share = first.number !== 0 ? ` (${sign}${+((100 * difference) / Math.abs(first.number)).toPrecision(2)} %)` : "";
  return `${sign}${shownValue(difference, first.unit ?? "")}${share}`;
}

function cellOf(value: Json, unit: string): Cell {
  return { text: shownValue(value, unit), number: typeof value === "number" ? value : undefined, unit };
}

function differing(rows: Row[]): Row[] {
  return rows.filter(({ cells }) => new Set(cells).size > 1);
}

function parameterRows(runs: Run[]): Row[] {
  return rowsOf(runs, "default", (run) => {
    const values = new Map<string, Cell>();
    for (const [instance, parameters] of Object.entries<Json>(run.summary.parameters ?? {})) {
      for (const [name, value] of Object.entries<Json>(parameters)) values.set(`${instance}.${name}`, { ...cellOf(value, ""), text: String(value) });
    }
    for (const change of run.summary.inputs?.changes ?? []) if (!change.startsWith("set ")) values.set(change, { text: "yes" });
    return values;
  });
}

function outcomeRows(runs: Run[]): Row[] {
  return rowsOf(runs, "\u2013", (run) => {
    const values = new Map<string, Cell>([
      ["outcome", { text: run.summary.outcome ?? "unknown" }],
      ["simulated time", cellOf(run.summary.simulated_time ?? run.end, "s")],
    ]);
    for (const { label, value, unit } of finalValues(run.summary)) values.set(label, cellOf(value, unit));
    return values;
  });
}
