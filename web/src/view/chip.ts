// SPDX-License-Identifier: Apache-2.0
// Shows the report of `mebots-soc run`: counts of the cores, time in states, energy of parts and devices.
import type { Json } from "../data/payload";
import type { Run } from "../data/run";
import { shown } from "../data/units";
import { element } from "../dom";
import { colour, onTheme } from "../theme";

interface Cores {
  cores: number;
  instructions: number;
  cycles: number;
  cache_refills?: number;
  cycles_waited?: number;
}

/** The clock of a core during the time in which the core had power. */
interface Clock {
  least_hz: number;
  most_hz: number;
  mean_hz: number;
}

/** Returns a text such as "87 MHz". If the clock changed, returns its range. */
export function clockText(clock: Clock | null): string {
  if (clock === null) return "off";
  const { least_hz, most_hz, mean_hz } = clock;
  if (least_hz === most_hz) return shown(most_hz, "Hz");
  return `${shown(least_hz, "Hz")} to ${shown(most_hz, "Hz")}, in the mean ${shown(mean_hz, "Hz")}`;
}

export function cyclesPerInstruction({ cycles, instructions }: Cores): string {
  return instructions > 0 ? (cycles / instructions).toFixed(3) : "\u2013";
}

export function makeChip(run: Run): HTMLElement {
  const chip: Json = run.header.chip;
  return element("div", { class: "chip scroll" },
    element("h3", {}, "Energy"), makeEnergy(chip),
    element("p", { class: "faint" }, `Range of the chip's energy by ${chip.checks.count} measured programs: ${shown(chip.checks.least_j, "J")} to ${shown(chip.checks.most_j, "J")}. This is not a confidence interval.`),
    element("h3", {}, "Instructions"), makeCounts(chip),
    element("h3", {}, "Time"), makeShares(chip.states_s, chip.time_s, "s"));
}

function number(text: string): HTMLElement {
  return element("td", { class: "number" }, text);
}

function bar(share: number): HTMLElement {
  const filled = element("i", { style: `width: ${Math.max(0, 100 * share)}%` });
  const paint = () => (filled.style.background = colour(0));
  paint();
  onTheme(paint);
  return element("td", { class: "share" }, filled);
}

function shareText(share: number): string {
  return `${(100 * share).toFixed(1)} %`;
}

/** Creates the table of energies. First come the parts of the chip, the largest energy first, and their sum. The
 * devices of the board follow; the sum does not include them. Parts and devices without energy are omitted. */
function makeEnergy(chip: Json): HTMLElement {
  const used = (list: Record<string, number>) => Object.entries(list).filter(([, joules]) => joules !== 0).sort(([, a], [, b]) => b - a);
  const row = (name: string, joules: number, text: string, share?: number) => element("tr", {},
    element("td", { class: "whole" }, name.replaceAll("_", " ")), number(shown(joules, "J")), number(chip.time_s > 0 ? shown(joules / chip.time_s, "W") : "\u2013"),
    number(share === undefined ? "" : shareText(share)), share === undefined ? element("td") : bar(share), element("td", { class: "faint" }, text));
  const parts = used(chip.parts_j).map(([name, joules]) => row(name, joules, chip.texts[name] ?? "", joules / chip.chip_j));
  const sum = row("chip", chip.chip_j, "the parts above");
  sum.classList.add("sum");
  const devices = used(chip.devices_j).map(([name, joules]) => row(name, joules, chip.texts[name] ?? ""));
  const heads = ["part", "energy", "mean power", "share", "", "what it is"].map((head, i) => element("th", i > 0 && i < 4 ? { class: "right" } : {}, head));
  return element("table", { class: "energy" }, element("thead", {}, element("tr", {}, ...heads)), element("tbody", {}, ...parts, sum, ...devices));
}

function makeCounts(chip: Json): HTMLElement {
  const columns: [string, Cores, Clock | null][] = [];
  if (chip.controller) columns.push([chip.cluster ? "fabric controller" : "core", chip.controller, chip.clocks.controller]);
  if (chip.cluster) columns.push([`cluster, ${chip.cluster.cores} cores`, chip.cluster, chip.clocks.cluster]);
  const whole = (value: number | undefined) => (value === undefined ? "\u2013" : value.toLocaleString("en"));
  const rows: [string, (cores: Cores, clock: Clock | null) => string][] = [
    ["clock", (_, clock) => clockText(clock)], ["instructions", ({ instructions }) => whole(instructions)], ["cycles", ({ cycles }) => whole(cycles)],
    ["cycles per instruction", cyclesPerInstruction],
    ["refills of the instruction cache", ({ cache_refills }) => whole(cache_refills)], ["cycles waited for it", ({ cycles_waited }) => whole(cycles_waited)],
  ];
  return element("table", {}, element("thead", {}, element("tr", {}, ...["", ...columns.map(([name]) => name)].map((head, i) => element("th", i > 0 ? { class: "right" } : {}, head)))),
    element("tbody", {}, ...rows.map(([name, read]) => element("tr", {}, element("td", {}, name), ...columns.map(([, cores, clock]) => number(read(cores, clock)))))));
}

function makeShares(values: Record<string, number>, total: number, unit: string): HTMLElement {
  const rows = Object.entries(values).filter(([, value]) => value > 0).sort(([, a], [, b]) => b - a);
  return element("table", {}, element("tbody", {}, ...rows.map(([name, value]) =>
    element("tr", {}, element("td", {}, name), number(shown(value, unit)), number(shareText(value / total)), bar(value / total)))));
}
