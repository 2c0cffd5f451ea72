// SPDX-License-Identifier: Apache-2.0
// Shows results, cost and inputs of the run as numbers.
import type { Json } from "../data/payload";
import type { Run } from "../data/run";
import { shown, shownUnit } from "../data/units";
import { element } from "../dom";

/** The keys of summary.json that do not come from the config's `summary`. */
const OWN = new Set(["outcome", "end_reason", "end_text", "error", "real_time_factor", "step", "steps", "stop_time", "rows", "units",
  "wall_clock", "versions", "parameters", "inputs", "notices", "statistics", "scenario", "lost_instances", "simulated_time"]);

export interface FinalValue {
  label: string;
  value: Json;
  unit: string;
}

/** Returns the values of summary.json that come from the config's `summary`. The label of a nested value begins with
 * the keys of the objects that contain it. If `members` is false, omits the values of single objects in a group,
 * such as those of each drone. */
export function finalValues(summary: Json, members = true): FinalValue[] {
  const found: FinalValue[] = [];
  const walk = (values: Json, units: Json, path: string[]) => {
    for (const [key, value] of Object.entries(values ?? {})) {
      if (path.length === 0 && OWN.has(key)) continue;
      const label = [...path, key];
      if (value !== null && typeof value === "object" && !Array.isArray(value)) {
        if (members || path.length === 0 || key !== "each") walk(value, units?.[key] ?? {}, label);
      } else found.push({ label: label.join(" · ").replaceAll("_", " "), value, unit: typeof units?.[key] === "string" ? units[key] : "-" });
    }
  };
  walk(summary, summary.units ?? {}, []);
  return found;
}

/** Returns the values of finalValues() without those of single objects in a group. The statistics of a group remain. */
export function mainValues(summary: Json): FinalValue[] {
  return finalValues(summary, false);
}

export function shownValue(value: Json, unit: string): string {
  if (typeof value === "number") return Number.isInteger(value) && shownUnit(unit) === "" ? String(value) : shown(value, unit);
  if (typeof value === "boolean") return value ? "yes" : "no";
  return String(value);
}

function table(heads: string[], rows: (string | Node)[][]): HTMLElement {
  const cell = (content: string | Node, i: number) => element("td", { class: i > 0 ? "number" : "" }, content);
  return element("table", {},
    element("thead", {}, element("tr", {}, ...heads.map((head) => element("th", {}, head)))),
    element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map(cell)))));
}

export function makeStatistics(run: Run): HTMLElement {
  const { summary, header } = run;
  const root = element("div", { class: "statistics scroll" });
  const finals = finalValues(summary);
  if (finals.length > 0) root.append(element("h3", {}, "At the end"), table(["", "value"], finals.map(({ label, value, unit }) => [label, shownValue(value, unit)])));
  const facts: [string, string][] = [
    ["simulated", shown(summary.simulated_time ?? run.end, "s")],
    ["end", summary.end_text ?? "unknown: the run wrote no summary"],
    ["steps", summary.steps === undefined ? "" : `${summary.steps} of ${shown(summary.step, "s")}`],
    ["rows", `${header.rows}${header.span > 1 ? `; the page has the extremes of every ${header.span}${header.whole?.length > 0 ? ", and all rows of a chosen span" : ""}` : ""}`],
    ["times real time", summary.real_time_factor === undefined ? "" : shown(summary.real_time_factor, "1")],
    ["wall clock", summary.wall_clock === undefined ? "" : shown(summary.wall_clock.total, "s")],
    ["mebots", summary.versions?.mebots ?? ""],
    ["inputs", summary.inputs?.sha256?.slice(0, 16) ?? ""],
  ];
  root.append(element("h3", {}, "Run"), table(["", ""], facts.filter(([, value]) => value !== "")));
  const statistics = summary.statistics?.instances;
  if (statistics) {
    const rows = Object.entries<Json>(statistics).map(([name, entry]) => [name, String(entry.calls ?? ""), entry.time === undefined ? "" : shown(entry.time, "s"),
      entry.share === undefined ? "" : `${(100 * entry.share).toFixed(1)} %`,
      entry.slowest_step === undefined ? "" : `${shown(1000 * entry.slowest_step, "ms")} at ${shown(entry.slowest_step_at, "s")}`]);
    root.append(element("h3", {}, "Time by instance"), table(["instance", "calls", "time", "share", "slowest step"], rows));
  } else {
    root.append(element("p", { class: "faint" }, "Calls and time of every instance: run with --statistics."));
  }
  const changes: string[] = summary.inputs?.changes ?? [];
  if (changes.length > 0) root.append(element("h3", {}, "Changed from the config"), table([""], changes.map((change) => [change])));
  const parameters = Object.entries<Json>(summary.parameters ?? {}).flatMap(([instance, values]) => Object.entries<Json>(values).map(([name, value]) => [`${instance}.${name}`, String(value)]));
  if (parameters.length > 0) root.append(element("h3", {}, "Parameters"), table(["", ""], parameters));
  return root;
}
