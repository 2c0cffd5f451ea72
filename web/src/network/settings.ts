// SPDX-License-Identifier: Apache-2.0
// Shows time and energy of an inference for several clocks and numbers of cores.
import { shown } from "../data/units";
import { Plot } from "../report/plot";
import { makeSmallTable, panel } from "../report/widgets";
import { colour } from "../theme";
import { sumOf, type Measured, type NetworkPage } from "./content";

export function makeSettings({ network }: NetworkPage, measured: Measured): HTMLElement {
  const { settings } = measured;
  const macs = sumOf(network.layers, "macs");
  const clocks = [...new Set(settings.map((one) => one.cluster_clock))].sort((a, b) => a - b);
  const times = settings.map(({ time }) => 1e3 * time);
  const energies = settings.map(({ energy }) => 1e3 * energy);
  const xRange: [number, number] = [Math.min(...times) / 1.3, 1.6 * Math.max(...times)];
  const plot = new Plot("energy of an inference over its time", (width) => Math.min(340, Math.max(250, 0.55 * width)), () => {
    plot.axes({ title: "time of an inference [ms]", range: xRange, log: true }, { title: "energy [mJ]", range: [Math.min(...energies) / 1.3, 1.3 * Math.max(...energies)], log: true });
    const { context } = plot;
    clocks.forEach((clock, i) => {
      const own = settings.filter((one) => one.cluster_clock === clock).sort((a, b) => a.cores - b.cores);
      const points = own.map(({ time, energy }): [number, number] => [plot.x(1e3 * time), plot.y(1e3 * energy)]);
      context.strokeStyle = context.fillStyle = colour(i);
      context.lineWidth = 1.5;
      context.beginPath();
      plot.line(points);
      context.stroke();
      points.forEach(([x, y], k) => {
        context.fillStyle = colour(i);
        context.beginPath();
        context.arc(x, y, 4, 0, 2 * Math.PI);
        context.fill();
        const first = k === points.length - 1 ? `${own[k].cores} cores, ${shown(clock, "Hz")}` : String(own[k].cores);
        plot.text(first, x + 7, y + (k === points.length - 1 ? 14 : -6), { colour: colour(i), halo: true, within: true });
      });
    });
  });
  const rows = [...settings].sort((a, b) => a.energy - b.energy).map(({ cores, cluster_clock, time, energy }) => [
    cores, shown(cluster_clock, "Hz"), shown(time, "s"), shown(energy, "J"), shown(energy / time, "W"), (macs / (time * cluster_clock)).toFixed(2)]);
  const made = panel("Clocks and numbers of cores", "All at 1.0 V. The results have the same bits in each setting, so the accuracy is the same. The table begins with the least energy.",
    plot.root, makeSmallTable(["cores", "clock", "time", "energy", "mean power", "MAC/cycle"], rows));
  made.classList.add("settings");
  return made;
}
