// SPDX-License-Identifier: Apache-2.0
// Shows accuracy and energy for each size of the input, clock and number of cores.
import { shown } from "../data/units";
import { element } from "../dom";
import { digits, percent } from "../report/format";
import { Plot } from "../report/plot";
import { makeSmallTable, panel } from "../report/widgets";
import { colour } from "../theme";
import { sumOf, type Accuracy, type Judged, type Measured, type NetworkPage, type SizeRow } from "./content";

/** A quantity that is plotted for each size of the network's input: a share or an error. */
interface Quantity {
  title: string;
  of: (row: SizeRow) => Judged | undefined;
}

export function makeSizes({ network }: NetworkPage, measured: Measured): HTMLElement {
  const { input, accuracy, sizes, layers } = network;
  const own: SizeRow = { rows: input.rows, columns: input.columns, macs: sumOf(layers, "macs"), accuracy, settings: measured.settings };
  const rows = [own, ...sizes.rows];
  const quantities = quantitiesOf(accuracy);
  const parts: HTMLElement[] = [];
  if (sizes.none !== undefined) parts.push(element("p", {}, `${sizes.rows.length > 0 ? "No smaller input" : "One size of the input only"}: ${sizes.none}.`));
  if (quantities.length > 0) parts.push(makePlot(rows, quantities[0]), makeTable(rows, quantities));
  const text = quantities.length > 0 ? `${accuracy.pictures} pictures of ${accuracy.data}; 95 % intervals in brackets.` : "The model has whole numbers, which the chip computes without rounding.";
  const made = panel("Accuracy next to energy", text, ...parts);
  made.classList.add("sizes");
  return made;
}

/** Returns the quantities to plot: first comparisons with the labels, then differences from the float model. */
function quantitiesOf({ float, labels }: Accuracy): Quantity[] {
  const judged = Object.entries(labels?.outputs ?? {}).flatMap(([name, { int8 }]) => [
    { title: int8.share === undefined ? `error of ${name}` : `right: ${name}`, of: (row: SizeRow) => row.accuracy.labels?.outputs[name]?.int8 },
    { title: `lost against float: ${name}`, of: (row: SizeRow) => row.accuracy.labels?.outputs[name]?.loss },
  ]);
  const differing = Object.keys(float ?? {}).map((name) => ({ title: `difference from float: ${name}`, of: (row: SizeRow) => row.whole?.[name] ?? row.accuracy.float?.[name] }));
  return [...judged, ...differing];
}

const valueOf = (judged?: Judged) => judged?.share ?? judged?.error;

function text(judged?: Judged): string {
  const value = valueOf(judged);
  if (judged === undefined || value === undefined) return "-";
  const format = judged.share === undefined ? (x: number) => digits(x, 3) : percent;
  return `${format(value)} (${format(judged.interval[0])} to ${format(judged.interval[1])})`;
}

function makePlot(rows: SizeRow[], { title, of }: Quantity): HTMLElement {
  const drawn = rows.filter((row) => valueOf(of(row)) !== undefined);
  const energies = drawn.flatMap(({ settings }) => settings.map(({ energy }) => 1e3 * energy));
  const ends = drawn.flatMap((row) => of(row)!.interval);
  const most = Math.max(...ends, 1e-9);
  const plot = new Plot(`${title} over energy`, (width) => Math.min(320, Math.max(240, 0.5 * width)), () => {
    plot.axes({ title: "energy of an inference [mJ]", range: [Math.min(...energies) / 1.3, 1.6 * Math.max(...energies)], log: true }, { title, range: [Math.min(0, ...ends), 1.15 * most] });
    const { context } = plot;
    drawn.forEach((row, i) => {
      const judged = of(row)!;
      const y = plot.y(valueOf(judged)!);
      const xs = row.settings.map(({ energy }) => plot.x(1e3 * energy));
      const least = Math.min(...xs);
      context.strokeStyle = context.fillStyle = colour(i);
      context.lineWidth = 1.5;
      context.beginPath();
      plot.line([[least, plot.y(judged.interval[0])], [least, plot.y(judged.interval[1])]]);
      context.stroke();
      for (const x of xs) {
        context.beginPath();
        context.arc(x, y, 3.5, 0, 2 * Math.PI);
        context.fill();
      }
      plot.text(`${row.columns} x ${row.rows}`, least + 6, y - 8, { colour: colour(i), halo: true, within: true });
    });
  });
  return plot.root;
}

function makeTable(rows: SizeRow[], quantities: Quantity[]): HTMLElement {
  const cells = rows.map((row) => {
    const best = row.settings.reduce((least, one) => (one.energy < least.energy ? one : least));
    return [`${row.columns} x ${row.rows}`, row.macs.toLocaleString("en"), shown(best.time, "s"), shown(best.energy, "J"), `${best.cores}, ${shown(best.cluster_clock, "Hz")}`, ...quantities.map(({ of }) => text(of(row)))];
  });
  return makeSmallTable(["input", "MACs", "time", "least energy", "cores, clock", ...quantities.map(({ title }) => title)], cells);
}
