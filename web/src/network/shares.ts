// SPDX-License-Identifier: Apache-2.0
// Stacked bars for each layer: cycles of the cores by cause, and energy by part of the chip.
import { shown } from "../data/units";
import { element } from "../dom";
import { digits, percent } from "../report/format";
import { makeChoice, makeTooltip, panel } from "../report/widgets";
import { colour, onTheme, styleColour } from "../theme";
import type { Cost, Measured, NetworkPage } from "./content";

const MOST_PARTS = 7; // the other parts are drawn as one grey part

const CAUSES: Record<string, string> = {
  base: "executing", load_use: "load used at once", jump: "jumps", jump_register: "jumps to a register", branch: "branches", multiply_divide: "multiply, divide",
  floats: "floating point", system: "system instructions", misaligned: "misaligned accesses", cache: "instruction cache", memory: "slow memory",
  bank_conflict: "bank conflicts", far_memory: "accesses to L2", device: "device registers", trap: "traps", other: "other stalls", asleep: "asleep (barrier or DMA)",
};

const REST = "smaller parts";

interface Row {
  name: string;
  parts: Record<string, number>;
}

export function makeCycles({ network }: NetworkPage, measured: Measured): HTMLElement {
  const partsOf = ({ causes, asleep }: Cost) => ({ ...causes, asleep });
  const rows = network.layers.map(({ name }, i) => ({ name, parts: partsOf(measured.layers[i]) }));
  const all = { name: "all layers", parts: partsOf(measured.total) };
  return panel("Where the cycles go", `Cycles of ${measured.cores} cores by cause.`,
    ...makeBars(rows, all, (cause) => CAUSES[cause] ?? cause, (value) => (value < 1e4 ? String(Math.round(value)) : `${digits(value / 1e6)} M`)));
}

export function makeEnergy({ network }: NetworkPage, measured: Measured): HTMLElement {
  const rows = network.layers.map(({ name }, i) => ({ name, parts: measured.layers[i].parts }));
  const all = { name: "all layers", parts: measured.total.parts };
  return panel("Where the joules go", "Energy of the chip by part, without its devices.",
    ...makeBars(rows, all, (part) => part.replaceAll("_", " "), (value) => shown(value, "J")));
}

/** Creates a legend of the parts, a bar for each layer, and a bar for the sum of all layers. */
function makeBars(layers: Row[], whole: Row, nameOf: (part: string) => string, textOf: (value: number) => string): HTMLElement[] {
  const sum = whole.parts;
  const sorted = Object.entries(sum).filter(([, value]) => value > 0).sort(([, a], [, b]) => b - a).map(([part]) => part);
  const named = sorted.slice(0, sorted.length > MOST_PARTS + 1 ? MOST_PARTS : sorted.length);
  const all = totalOf(sum);
  const tip = makeTooltip();
  const paints: (() => void)[] = [];
  const fill = (target: HTMLElement, index: number) => paints.push(() => (target.style.background = index < named.length ? colour(index) : styleColour("--off")));
  const valuesOf = (parts: Record<string, number>): number[] => {
    const own = named.map((part) => Math.max(0, parts[part] ?? 0));
    const rest = sorted.slice(named.length).reduce((left, part) => left + Math.max(0, parts[part] ?? 0), 0);
    return sorted.length > named.length ? [...own, rest] : own;
  };
  const names = [...named.map(nameOf), ...(sorted.length > named.length ? [REST] : [])];
  const longest = Math.max(...layers.map(({ parts }) => totalOf(parts)));
  const lengths: ((isWhole: boolean) => void)[] = [];
  const bars = [...layers, whole].map((row) => {
    const { name, parts } = row;
    const own = totalOf(parts);
    const isSum = row === whole;
    const pieces = valuesOf(parts).map((value, i) => {
      const piece = element("i", {
        style: `width:${own > 0 ? (100 * value) / own : 0}%`,
        onpointermove: (event) => tip.show(event as PointerEvent, name, [`${names[i]}: ${textOf(value)}, ${percent(value / own)} of the layer`]),
        onpointerleave: () => tip.hide(),
      });
      fill(piece, i);
      return piece;
    });
    const stack = element("span", { class: "pieces" }, ...pieces);
    lengths.push((isWhole) => (stack.style.width = `${isSum || isWhole ? 100 : (100 * own) / longest}%`));
    return element("div", { class: `split${isSum ? " sum" : ""}`, "data-layer": name }, element("span", { class: "name" }, name),
      element("span", { class: "rail" }, stack), element("b", {}, isSum ? textOf(own) : percent(own / all)));
  });
  const key = element("div", { class: "key" }, ...valuesOf(sum).map((value, i) => {
    const dot = element("i", { class: "dot" });
    fill(dot, i);
    return element("span", {}, dot, `${names[i]} ${percent(value / all)}`);
  }));
  const paint = () => paints.forEach((one) => one());
  paint();
  onTheme(paint);
  const choose = (choice: number) => lengths.forEach((set) => set(choice === 1));
  choose(0);
  return [element("div", { class: "choices" }, makeChoice("length of a bar", ["the layer's cost", "the same for all"], 0, choose)), key, ...bars];
}

const totalOf = (parts: Record<string, number>) => Object.values(parts).reduce((sum, value) => sum + Math.max(0, value), 0);
