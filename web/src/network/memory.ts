// SPDX-License-Identifier: Apache-2.0
// Shows the tensors in L2: over time if the times were measured, otherwise by layer. Also shows each layer's use of L1.
import { element } from "../dom";
import { counted, digits } from "../report/format";
import { Plot } from "../report/plot";
import { makeSmallTable, panel } from "../report/widgets";
import { colour, styleColour } from "../theme";
import type { NetworkPage } from "./content";

const KIB = 1024;
const kib = (bytes: number) => `${digits(bytes / KIB, 3)} KiB`;

export function makeMemory({ network, board }: NetworkPage): HTMLElement {
  const { layers, memory, measured } = network;
  const begins = [0];
  for (let i = 0; i < layers.length; ++i) begins.push(begins[i] + (measured ? measured.layers[i].time * 1e3 : 1));
  const end = begins[layers.length];
  const at = (layer: number) => begins[Math.min(Math.max(layer, 0), layers.length)];
  const plot = new Plot("tensors in L2 over time", (width) => Math.min(320, Math.max(240, 0.5 * width)), () => {
    plot.axes({ title: measured ? "time [ms]" : "layer", range: [0, end] }, { title: "activations in L2 [KiB]", range: [0, (1.06 * Math.max(1, memory.activations)) / KIB] });
    const { context } = plot;
    layers.forEach(({ output, l2 }, i) => {
      const [left, right, top, bottom] = [plot.x(at(l2.from)), plot.x(at(l2.to + 1)), plot.y((l2.offset + l2.bytes) / KIB), plot.y(l2.offset / KIB)];
      context.globalAlpha = 0.55;
      context.fillStyle = colour(i);
      context.fillRect(left, top, right - left, bottom - top);
      context.globalAlpha = 1;
      context.strokeStyle = styleColour("--card");
      context.strokeRect(left, top, right - left, bottom - top);
      const name = plot.fitted(output, right - left - 6);
      if (bottom - top > 15 && name.length > 1) plot.text(name, left + 4, top + 13);
    });
  });
  const inL2 = memory.fetched || memory.weights; // if the weights are in HyperRAM, L2 contains only their buffers
  const rest = board.l2 - inL2 - memory.picture - memory.activations;
  const whole: [string, number][] = [[memory.fetched ? "buffers for weights in HyperRAM" : "weights", inL2], ["picture", memory.picture], ["activations", memory.activations], ["program, stacks and free", rest]];
  const l1 = layers.flatMap(({ name, l1 }) => (l1 ? [[name, kib(l1.bytes), `${digits((100 * l1.bytes) / board.l1, 3)} %`]] : []));
  const beside = memory.fetched ? "the buffers for weights in HyperRAM" : "the weights";
  return panel("Memory over time", `Each box is a tensor, from the layer that writes it to the last one that reads it. L2 also contains ${beside} (${kib(inL2)}) and the picture (${kib(memory.picture)}).`,
    plot.root, element("h3", {}, `L2 of board ${board.name}: ${kib(board.l2)}`),
    makeSmallTable(["content", "size", "of L2"], whole.map(([name, bytes]) => [name, kib(bytes), `${digits((100 * bytes) / board.l2, 3)} %`])),
    element("h3", {}, `L1, ${kib(board.l1)}, of ${counted(l1.length, "layer")}`), makeSmallTable(["layer", "buffers in L1", "of L1"], l1));
}
