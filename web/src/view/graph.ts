// SPDX-License-Identifier: Apache-2.0
// The system as a graph: instances on a ring, an arrow for all that goes from one to another.
import type { Clock } from "../clock";
import type { SystemInfo } from "../data/payload";
import type { Run } from "../data/run";
import { shownUnit } from "../data/units";
import { element, svg } from "../dom";

const BOX = { width: 170, height: 58 };

interface Bundle {
  from: string;
  to: string;
  connections: SystemInfo["connections"];
}

export function makeGraph(run: Run, clock: Clock): HTMLElement {
  const system = run.system;
  const root = element("div", { class: "graph" });
  if (!system) {
    root.append(element("p", { class: "empty" }, "The folder does not say what was connected: an older mebots wrote it."));
    return root;
  }
  const names = Object.keys(system.instances);
  const places = placesOf(names);
  const width = Math.max(...[...places.values()].map(([x]) => x)) + BOX.width / 2 + 30;
  const height = Math.max(...[...places.values()].map(([, y]) => y)) + BOX.height / 2 + 30;
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": "instances and connections" });
  drawing.append(svg("defs", {}, svg("marker", { id: "arrow", viewBox: "0 0 8 8", refX: "7", refY: "4", markerWidth: "7", markerHeight: "7", orient: "auto-start-reverse" },
    svg("path", { d: "M0 0L8 4L0 8z", class: "arrow" }))));
  const list = element("div", { class: "connections" });
  const bundles = bundlesOf(run, system);
  let show = () => {};
  const choose = (chosen: Bundle[], title: string) => (show = showConnections(run, clock, list, chosen, title));
  clock.onTime(() => show());
  for (const bundle of bundles) {
    const from = places.get(bundle.from);
    const to = places.get(bundle.to);
    if (from && to) drawing.append(makeArrow(bundle, from, to, () => choose([bundle], `${bundle.from} \u2192 ${bundle.to}`)));
  }
  for (const name of names) {
    const touching = bundles.filter((bundle) => bundle.from === name || bundle.to === name);
    drawing.append(makeBox(name, system.instances[name].model, places.get(name)!, () => choose(touching, name)));
  }
  root.append(drawing, list);
  choose(bundles, "All connections");
  return root;
}

function placesOf(names: string[]): Map<string, [number, number]> {
  const count = names.length;
  if (count === 1) return new Map([[names[0], [140, 70]]]);
  if (count === 2) return new Map([[names[0], [130, 90]], [names[1], [480, 90]]]);
  const radiusY = Math.max(120, 22 * count);
  const radiusX = 1.7 * radiusY;
  return new Map(names.map((name, i) => {
    const angle = (2 * Math.PI * i) / count - Math.PI / 2 - Math.PI / count;
    return [name, [radiusX * (1 + Math.cos(angle)) + 120, radiusY * (1 + Math.sin(angle)) + 60]];
  }));
}

function bundlesOf(run: Run, system: SystemInfo): Bundle[] {
  const bundles = new Map<string, Bundle>();
  for (const connection of system.connections) {
    const from = run.instanceOf(connection.from);
    const to = run.instanceOf(connection.to);
    const key = JSON.stringify([from, to]);
    const bundle = bundles.get(key) ?? { from, to, connections: [] };
    bundles.set(key, bundle);
    bundle.connections.push(connection);
  }
  return [...bundles.values()];
}

function makeBox(name: string, model: string, [x, y]: [number, number], onChoose: () => void): SVGElement {
  return svg("g", { class: "box", tabindex: "0", onclick: onChoose, onfocus: onChoose },
    svg("rect", { x: String(x - BOX.width / 2), y: String(y - BOX.height / 2), width: String(BOX.width), height: String(BOX.height), rx: "8" }),
    svg("text", { x: String(x), y: String(y - 3), class: "name" }, name),
    svg("text", { x: String(x), y: String(y + 16), class: "model" }, model.length > 26 ? model.slice(0, 25) + "\u2026" : model));
}

function makeArrow(bundle: Bundle, from: [number, number], to: [number, number], onChoose: () => void): SVGElement {
  const group = svg("g", { class: "bundle", tabindex: "0", onclick: onChoose, onfocus: onChoose });
  const units = [...new Set(bundle.connections.map((connection) => shownUnit(connection.unit ?? "") || (connection.type === "Binary" ? "bytes" : "")))].filter(Boolean);
  const text = `${bundle.connections.length}${units.length > 0 ? `: ${units.slice(0, 3).join(", ")}${units.length > 3 ? " \u2026" : ""}` : ""}`;
  if (bundle.from === bundle.to) return group;
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  const [nx, ny] = [-dy / length, dx / length];
  const bend = 0.13 * length;
  const control: [number, number] = [(from[0] + to[0]) / 2 + bend * nx, (from[1] + to[1]) / 2 + bend * ny];
  const start = edgeOf(from, control);
  const end = edgeOf(to, control);
  const at = (axis: 0 | 1) => 0.4356 * start[axis] + 0.4488 * control[axis] + 0.1156 * end[axis]; // a third of the way
  const middle = [at(0), at(1)];
  group.append(
    svg("path", { d: `M${start} Q${control} ${end}`, "marker-end": "url(#arrow)" }),
    svg("rect", { x: String(middle[0] - 3.3 * text.length - 4), y: String(middle[1] - 9), width: String(6.6 * text.length + 8), height: "18", class: "behind" }),
    svg("text", { x: String(middle[0]), y: String(middle[1] + 4) }, text),
  );
  return group;
}

/** Where the line from a box's middle to a point leaves the box. */
function edgeOf([x, y]: [number, number], [px, py]: [number, number]): [number, number] {
  const [dx, dy] = [px - x, py - y];
  const share = Math.min(Math.abs((BOX.width / 2 + 4) / (dx || 1e-9)), Math.abs((BOX.height / 2 + 4) / (dy || 1e-9)));
  return [x + share * dx, y + share * dy];
}

/** Returns what brings the values up to the moment. */
function showConnections(run: Run, clock: Clock, into: HTMLElement, bundles: Bundle[], title: string): () => void {
  const rows = bundles.flatMap((bundle) => bundle.connections);
  const body = element("tbody", {});
  const values: [HTMLElement, string][] = [];
  for (const { from, to, unit, type } of rows) {
    const value = element("td", { class: "number" });
    if (run.has(from)) values.push([value, from]);
    body.append(element("tr", {}, element("td", {}, from), element("td", {}, to), element("td", {}, shownUnit(unit ?? "") || (unit === "1" ? "1" : type)), value));
  }
  const show = () => {
    for (const [cell, name] of values) cell.textContent = run.textAt(name, clock.time);
  };
  into.replaceChildren(element("h3", {}, `${title}: ${rows.length} connection${rows.length === 1 ? "" : "s"}`),
    element("table", {}, element("thead", {}, element("tr", {}, ...["from", "to", "unit", "now"].map((head) => element("th", {}, head)))), body));
  show();
  return show;
}
