// SPDX-License-Identifier: Apache-2.0
// The roofline diagram (Williams, Waterman and Patterson 2009): the speed of each layer [MAC/cycle] over its MAC per
// byte that the DMA moves.
import { element } from "../dom";
import { digits, percent } from "../report/format";
import { Plot } from "../report/plot";
import { makeTooltip, panel } from "../report/widgets";
import { colour, styleColour } from "../theme";
import type { Measured, NetworkPage } from "./content";

const RADIUS = 5;
const NEAR = 14; // pixels

export function makeRoofline({ network }: NetworkPage, measured: Measured): HTMLElement {
  const { macs_per_cycle: peak, bytes_per_cycle: bandwidth, hyper_bytes_per_cycle: hyper } = measured.roof;
  const points = network.layers.flatMap(({ name, macs, weights, l1 }, i) => {
    const cost = measured.layers[i];
    return l1 && macs > 0 && l1.moved > 0 && cost.cycles > 0 ? [{ name, intensity: macs / l1.moved, speed: cost.macs_per_cycle, bound: macs / cost.bound, perWeight: hyper ? macs / weights : Infinity, roofline: cost.roofline, share: cost.cycles / measured.total.cycles }] : [];
  });
  const title = "Roofline";
  if (points.length === 0) return panel(title, "", element("p", { class: "empty" }, "No layer has products."));
  const ridge = peak / bandwidth;
  const intensities = [...points.flatMap(({ intensity, perWeight }) => (perWeight < Infinity ? [intensity, perWeight] : [intensity])), ridge];
  const xRange: [number, number] = [Math.min(...intensities) / 2, 2 * Math.max(...intensities)];
  const yRange: [number, number] = [Math.min(...points.map(({ speed }) => speed), bandwidth * xRange[0]) / 1.5, 2 * peak];
  const plot = new Plot("speed of each layer over its products per byte", (width) => Math.min(360, Math.max(260, 0.6 * width)), () => {
    plot.axes({ title: "MAC per byte that the DMA moves", range: xRange, log: true }, { title: "MAC/cycle", range: yRange, log: true });
    const { context } = plot;
    context.strokeStyle = styleColour("--text");
    context.lineWidth = 2;
    context.beginPath();
    plot.line([[plot.x(xRange[0]), plot.y(bandwidth * xRange[0])], [plot.x(ridge), plot.y(peak)], [plot.x(xRange[1]), plot.y(peak)]]);
    context.stroke();
    plot.text(`products: ${digits(peak, 3)} MAC/cycle`, plot.box.right - 4, plot.y(peak) - 6, { align: "right" });
    const below = Math.sqrt(xRange[0] * ridge);
    plot.text(`DMA: ${bandwidth} bytes/cycle`, plot.x(below) + 14, plot.y(bandwidth * below) + 14, { halo: true });
    if (hyper) {
      context.setLineDash([4, 4]);
      context.beginPath();
      plot.line([[plot.x(xRange[0]), plot.y(hyper * xRange[0])], [plot.x(peak / hyper), plot.y(peak)]]);
      context.stroke();
      context.setLineDash([]);
      plot.text(`HyperRAM: ${digits(hyper, 2)} bytes/cycle of weights`, plot.x(ridge) + 14, plot.y(hyper * ridge) + 14, { halo: true });
    }
    for (const { intensity, bound, perWeight, speed } of points) {
      context.lineWidth = 1;
      context.strokeStyle = styleColour("--text");
      context.beginPath();
      plot.line([[plot.x(intensity), plot.y(speed)], [plot.x(intensity), plot.y(bound)]]);
      plot.line([[plot.x(intensity) - RADIUS, plot.y(bound)], [plot.x(intensity) + RADIUS, plot.y(bound)]]);
      if (perWeight < Infinity) {
        context.moveTo(plot.x(perWeight) + RADIUS, plot.y(speed));
        context.arc(plot.x(perWeight), plot.y(speed), RADIUS, 0, 2 * Math.PI);
      }
      context.stroke();
    }
    for (const { intensity, speed, share } of points) {
      context.fillStyle = colour(0);
      context.globalAlpha = 0.75;
      context.beginPath();
      context.arc(plot.x(intensity), plot.y(speed), RADIUS + 10 * Math.sqrt(share), 0, 2 * Math.PI);
      context.fill();
    }
    context.globalAlpha = 1;
    for (const { name, intensity, speed, share } of [...points].sort((a, b) => b.share - a.share)) {
      plot.text(name, plot.x(intensity) + RADIUS + 10 * Math.sqrt(share) + 4, plot.y(speed) + 4, { halo: true, within: true });
    }
  });
  const tip = makeTooltip();
  plot.canvas.addEventListener("pointermove", (event) => {
    const { left, top } = plot.canvas.getBoundingClientRect();
    const distance = ({ intensity, speed }: (typeof points)[number]) => Math.hypot(plot.x(intensity) - event.clientX + left, plot.y(speed) - event.clientY + top);
    const nearest = points.reduce((best, one) => (distance(one) < distance(best) ? one : best));
    if (distance(nearest) > NEAR) return tip.hide();
    tip.show(event, nearest.name, [`${digits(nearest.speed, 3)} MAC/cycle, ${percent(nearest.roofline)} of the roofline`, `${digits(nearest.intensity, 3)} MAC per byte`, `${percent(nearest.share)} of the cycles`]);
  });
  plot.canvas.addEventListener("pointerleave", () => tip.hide());
  const circles = hyper ? " Circles are layers over their products per weight, which the HyperRAM provides." : "";
  const note =
    "The line is the speed that the products of the inner loop or the DMA allow. The dash above a disc is the bound of this layer, " +
    `with its conversions of sums and its shape. Larger discs take more cycles.${circles}`;
  return panel(title, note, plot.root);
}
