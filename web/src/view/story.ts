// SPDX-License-Identifier: Apache-2.0
// Describes the results of a run in one sentence, and selects the time at which the page opens.
import type { Json } from "../data/payload";
import { type Run, rowAt } from "../data/run";
import { shown, shownTime } from "../data/units";
import { element } from "../dom";
import { clockText, cyclesPerInstruction } from "./chip";
import { mainValues } from "./statistics";

/** Finds a recorded variable whose name has this ending. Returns the first time at which it is not 0. If no such
 * variable exists, or if it is always 0 or not 0 at the start, returns null. */
function firstTrue(run: Run, ending: string): number | null {
  const name = run.variables.find((candidate) => candidate.endsWith(ending));
  const values = name === undefined ? undefined : run.values(name);
  const row = values?.findIndex((value) => value !== 0) ?? -1;
  return row > 0 ? run.times[row] : null;
}

/** Returns a text such as "crossed the gate 1.4 cm off its middle after 23.5 s". If no gate was crossed, returns an
 * empty text. */
function crossing(run: Run): string {
  const time = firstTrue(run, ".gate.crossed");
  if (time === null) return "";
  const miss = run.summary.lateral_error;
  const off = typeof miss === "number" ? ` ${(100 * Math.abs(miss)).toFixed(1)} cm off its middle` : "";
  return `crossed the gate${off} after ${shownTime(time)}`;
}

function energy(summary: Json): string {
  const { delivered, ...parts } = summary.energy ?? {};
  if (summary.units?.energy?.delivered !== "J" || typeof delivered !== "number" || !(delivered > 0)) return "";
  const total = shown(delivered, "J");
  const used = Object.entries<Json>(parts).filter(([name, value]) => typeof value === "number" && !["open_circuit", "imbalance"].includes(name));
  const [name, largest] = used.reduce((best, one) => (one[1] > best[1] ? one : best), ["", 0] as [string, Json]);
  return name === "" || largest > delivered ? total : `${total}, ${((100 * largest) / delivered).toFixed(0)} % of it ${name.replaceAll("_", " ")}`;
}

function charge(summary: Json): string {
  const left = summary.state_of_charge;
  return typeof left === "number" && summary.units?.state_of_charge === "1" ? `${(100 * left).toFixed(1)} % of the charge left` : "";
}

/** Returns a text about a program that ran on the chip alone: mean power, and the controller's instructions. */
function chip({ header }: Run): string {
  if (!header.chip) return "";
  const { chip_mean_w, controller, cluster, clocks } = header.chip;
  const counts = `${cluster ? "controller" : "core"} at ${clockText(clocks.controller)}: ${controller.instructions.toLocaleString("en")} instructions, ${cyclesPerInstruction(controller)} cycles each`;
  return `${chip_mean_w === null ? "" : `${shown(chip_mean_w, "W")} in the mean; `}${counts}`;
}

/** Describes a run that has ended. If the run left no results, returns "". */
export function storyOf(run: Run): string {
  const { summary } = run;
  if (summary.outcome === undefined) return "";
  const end = `${crossing(run) ? "ended after" : "ran"} ${shown(summary.simulated_time ?? run.end, "s")}: ${String(summary.outcome).replaceAll("_", " ")}`;
  const facts = [crossing(run), end, energy(summary), charge(summary), chip(run)].filter((fact) => fact !== "");
  if (facts.length === 1) {
    const values = mainValues(summary).filter(({ value, unit }) => typeof value === "number" && unit !== "-").slice(0, 3);
    facts.push(...values.map(({ label, value, unit }) => `${label} ${shown(value, unit)}`));
  }
  const text = facts.join("; ");
  return `${text[0].toUpperCase()}${text.slice(1)}.`;
}

export function makeStory(run: Run): HTMLElement {
  const what = element("p", { class: "about" }, run.system?.text ?? "");
  what.hidden = what.textContent === "";
  const happened = element("p", { class: "happened" });
  const show = () => {
    happened.textContent = run.header.live && !run.header.live.ended ? "" : storyOf(run);
    happened.hidden = happened.textContent === "";
  };
  run.onData(show);
  show();
  return element("div", { class: "story" }, what, happened);
}

const MOST_STORIES = 4; // more sentences would leave no space for the scene

export function makeStories(runs: Run[]): HTMLElement {
  const lines = runs.slice(0, MOST_STORIES).filter((run) => storyOf(run) !== "").map((run) => element("p", { class: "happened" }, `${run.name}: ${storyOf(run)}`));
  return element("div", { class: "story" }, ...lines);
}

/** Returns the time at which the page opens. For a flight, this is the time of the first picture, but not before the
 * distance from the start exceeds half of its maximum. For other runs, this is the end, where the results are. */
export function openingTime(run: Run): number {
  const names = (run.scene?.bodies?.[0]?.position ?? []) as string[];
  if (names.length === 0 || run.times.length < 2) return run.end;
  const instance = run.system?.view.scene?.instance ?? "";
  const columns = names.map((name) => run.values(`${instance}.${name}`)).filter((values) => values !== undefined);
  const away = (row: number) => Math.hypot(...columns.map((values) => values[row] - values[0]));
  const rows = Array.from(run.times.keys());
  const farthest = Math.max(...rows.map(away));
  const underWay = rows.find((row) => away(row) > 0.5 * farthest) ?? 0;
  const pictured = run.pictures.length > 0 ? rowAt(run.times, run.pictures[0].time) : 0;
  return run.times[Math.max(pictured, underWay)];
}
