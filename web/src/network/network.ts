// SPDX-License-Identifier: Apache-2.0
// Creates the page of a deployed network: the cost of an inference, and its parts by layer, cause and part of the chip.
import { shown } from "../data/units";
import { element } from "../dom";
import { digits, percent } from "../report/format";
import { makeColumns } from "../report/widgets";
import { sumOf, type NetworkPage } from "./content";
import { makeLayers } from "./layers";
import { makeMemory } from "./memory";
import { makeRoofline } from "./roofline";
import { makeSettings } from "./settings";
import { makeSizes } from "./sizes";
import { makeCycles, makeEnergy } from "./shares";

export function makeNetwork(page: NetworkPage): HTMLElement[] {
  Object.assign(window.mebots, { page }); // used by scripts and tests
  const { measured } = page.network;
  const panels = measured ? [makeRoofline(page, measured), makeCycles(page, measured), makeEnergy(page, measured), makeSettings(page, measured), makeSizes(page, measured)] : [];
  return [makeAnswer(page), makeLayers(page), makeColumns([...panels, makeMemory(page)])];
}

function makeAnswer({ network, board }: NetworkPage): HTMLElement {
  const { measured, flight, layers, input } = network;
  const macs = sumOf(layers, "macs");
  const weights = sumOf(layers, "weights");
  const flies = flight.program ? `It flies in missions with firmware ${flight.firmware!.join(" or ")}.` : `It does not fly: ${flight.none}.`;
  const size = `Input ${input.rows} x ${input.columns} x ${input.channels}; ${layers.length} layers, ${macs.toLocaleString("en")} MACs, ${weights.toLocaleString("en")} weights. ${flies}`;
  if (!measured) {
    return element("section", { class: "answer" }, element("p", { class: "headline" }, "Not measured on the chip (--no-measure)"), element("p", {}, size));
  }
  const { total } = measured;
  const slowest = measured.layers.reduce((most, cost, i) => (cost.time > measured.layers[most].time ? i : most), 0);
  const cost = measured.layers[slowest];
  return element("section", { class: "answer" },
    element("p", { class: "headline" }, `One inference takes ${shown(total.time, "s")} and ${shown(total.energy, "J")} on ${measured.cores} cores at ${shown(measured.cluster_clock, "Hz")}.`),
    element("p", {}, `${digits(total.macs_per_cycle, 3)} MAC/cycle, ${percent(total.roofline)} of the roofline. Layer ${layers[slowest].name} takes ${percent(cost.time / total.time)} of the time and ${percent(cost.energy / total.energy)} of the energy.`),
    element("p", {}, size),
    element("p", { class: "faint" }, `Board ${board.name}, simulated, without the start of the cluster. A layer's cost is the difference of two runs, with and without it.`));
}
