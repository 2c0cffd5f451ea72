// SPDX-License-Identifier: Apache-2.0
// The table of layers. Rows have costs only if the network was measured.
import { shown } from "../data/units";
import { element } from "../dom";
import { percent } from "../report/format";
import { panel } from "../report/widgets";
import { sumOf, type Cost, type NetworkPage } from "./content";

/** Returns the number of cycles in which cores were awake but executed no instruction. */
function stalledOf({ causes }: Cost): number {
  return Object.entries(causes).reduce((sum, [cause, cycles]) => (cause === "base" ? sum : sum + cycles), 0);
}

const HEADS = ["layer", "operators", "output", "MACs", "weights", "cycles", "of all", "MAC/cycle", "roofline", "stalled", "asleep", "DMA waits", "energy"];

export function makeLayers({ network }: NetworkPage): HTMLElement {
  const { layers, measured } = network;
  const whole = (value: number) => (value === 0 ? "" : value.toLocaleString("en"));
  const cells = (cost: Cost): string[] => {
    const all = measured!.cores * cost.cycles;
    const share = (part: number) => (all > 0 ? percent(part / all) : "");
    return [
      whole(cost.cycles), percent(cost.cycles / measured!.total.cycles), cost.macs_per_cycle ? cost.macs_per_cycle.toFixed(2) : "", percent(cost.roofline),
      share(stalledOf(cost)), share(cost.asleep), shown(cost.dma, "s"), shown(cost.energy, "J"),
    ];
  };
  const row = (texts: string[]) => element("tr", {}, ...texts.map((text, i) => element("td", { class: i < 2 ? "whole" : "number" }, text)));
  const heads = measured ? HEADS : HEADS.slice(0, 5);
  const rows = layers.map((layer, i) => row([
    layer.name, layer.op, layer.shape.join(" x "), whole(layer.macs), whole(layer.weights), ...(measured ? cells(measured.layers[i]) : [])]));
  const total = row(["all", "", "", whole(sumOf(layers, "macs")), whole(sumOf(layers, "weights")), ...(measured ? cells(measured.total) : [])]);
  total.classList.add("sum");
  const table = element("table", { class: "layers" },
    element("thead", {}, element("tr", {}, ...heads.map((head, i) => element("th", i < 2 ? {} : { class: "right" }, head)))), element("tbody", {}, ...rows, total));
  const note = measured
    ? "Roofline: the least cycles that products or the DMA would take, as a share of the cycles. Stalled, asleep: shares of the cores' cycles. DMA waits: time in which the cores wait for a copy that is not hidden behind computing."
    : "";
  const made = panel("Layers", note, element("div", { class: "scroll" }, table));
  made.classList.add("table-panel");
  return made;
}
