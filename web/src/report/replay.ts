// SPDX-License-Identifier: Apache-2.0
// The page of a replayed flight: curves of the log and of the models, and errors.
import { element } from "../dom";
import { colour, styleColour } from "../theme";
import type { ReplayedFlight } from "./content";
import { digits } from "./format";
import { extent, Plot } from "./plot";
import { makeColumns, makeSmallTable, panel } from "./widgets";

export function makeReplay(flight: ReplayedFlight): HTMLElement[] {
  const settled = flight.settle ? ` The model's rotors start at rest, so the first ${flight.settle} s are left out.` : "";
  const texts = (title: string, lines: string[]) => (lines.length ? [panel(title, "", ...lines.map((line) => element("p", {}, line)))] : []);
  return [
    element("section", { class: "answer" }, element("p", { class: "headline" }, flight.answer)),
    makeColumns(flight.charts.map(makeChart)),
    panel("Errors", "Model less measurement. p5, p50 and p95 are percentiles of the error; excluded samples are not in n. " +
      `Rows of thrust and acceleration compare means over ${flight.window} s: a replay of the whole flight would drift away, since no pilot corrects its errors.${settled}`,
    makeSmallTable(flight.fields, flight.errors.map((row) => row.map((cell) => (typeof cell === "number" ? digits(cell) : cell))))),
    ...texts("Samples of the log", flight.findings),
    ...texts("Notes", flight.notes),
  ];
}

function makeChart({ title, x, curves }: ReplayedFlight["charts"][number]): HTMLElement {
  const strokes = () => {
    let next = 0;
    const others = [1, 2, 3, 4];
    const own: Record<string, () => string> = { measured: () => styleColour("--text"), "needed by the motion": () => styleColour("--text"), model: () => colour(0), commands: () => colour(0) };
    return curves.map(({ name }) => own[name]?.() ?? colour(others[next++ % others.length]));
  };
  const key = element("p", { class: "key" });
  const plot = new Plot(title, () => 250, () => {
    plot.axes({ title: "time [s]", range: extent(x, { margin: 0 }) }, { title: "", range: extent(curves.flatMap(({ y }) => y)) });
    const colours = strokes();
    const { context } = plot;
    const isMeasured = (i: number) => curves[i].name === "measured" || curves[i].name === "needed by the motion";
    const order = curves.map((_, i) => i).sort((a, b) => Number(isMeasured(b)) - Number(isMeasured(a)));
    order.forEach((i) => {
      const { y } = curves[i];
      context.strokeStyle = colours[i];
      context.globalAlpha = isMeasured(i) ? 0.4 : 1; // draws the log as a wide line, so that the model's line is visible on it
      context.lineWidth = isMeasured(i) ? 4 : 1.4;
      context.beginPath();
      plot.line(y.map((value, k) => (value === null ? null : [plot.x(x[k]), plot.y(value)])));
      context.stroke();
    });
    context.globalAlpha = 1;
    key.replaceChildren(...curves.map(({ name }, i) => element("span", {}, element("i", { class: "dot", style: `background:${colours[i]}` }), name)));
  });
  return panel(title, "", key, plot.root);
}
