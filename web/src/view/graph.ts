// SPDX-License-Identifier: Apache-2.0
// Draws the system as a graph: instances on a ring. One arrow shows all connections from one instance to another.
import type { Clock } from "../clock";
import type { SystemInfo } from "../data/payload";
import type { Run } from "../data/run";
import { shown, shownUnit } from "../data/units";
import { dotted, element, svg } from "../dom";

const BOX = { width: 170, height: 58 };
const NAME = { size: 15, fits: 16 }; // font size, and the number of letters that fit into a box
const LARGEST = 1.25; // maximum number of page pixels per unit of the drawing; a single instance would exceed it

/** Positions of an arrow's label as shares of its length, in order of preference. Positions near the tail come first,
 * because arrows cross in the middle. */
const SHARES = [0.34, 0.42, 0.5, 0.26, 0.58, 0.66, 0.74];

/** A box: its centre and size. */
interface Place {
  x: number;
  y: number;
  width: number;
  height: number;
}

interface Bundle {
  from: string;
  to: string;
  connections: SystemInfo["connections"];
}

export function makeGraph(run: Run, clock: Clock): HTMLElement {
  const system = run.system;
  const root = element("div", { class: "graph" });
  if (!system) {
    root.append(element("p", { class: "empty" }, "The folder has no list of connections, because an older mebots wrote it."));
    return root;
  }
  const names = Object.keys(system.instances);
  const places = placesOf(names);
  const width = Math.max(...[...places.values()].map(([x]) => x)) + BOX.width / 2 + 30;
  const height = Math.max(...[...places.values()].map(([, y]) => y)) + BOX.height / 2 + 30;
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": "instances and connections", style: `max-height:${LARGEST * height}px` });
  drawing.append(svg("defs", {}, svg("marker", { id: "arrow", viewBox: "0 0 8 8", refX: "7", refY: "4", markerWidth: "7", markerHeight: "7", orient: "auto-start-reverse" },
    svg("path", { d: "M0 0L8 4L0 8z", class: "arrow" }))));
  const list = element("div", { class: "connections" });
  const bundles = bundlesOf(run, system);
  let show = () => {};
  const choose = (chosen: Bundle[], title: string, instances: string[] = []) => (show = showConnections(run, clock, list, chosen, title, makeInstances(system, instances)));
  clock.onTime(() => show());
  const taken: Place[] = [...places.values()].map(([x, y]) => ({ x, y, ...BOX }));
  for (const bundle of bundles) {
    const from = places.get(bundle.from);
    const to = places.get(bundle.to);
    if (from && to) drawing.append(makeArrow(bundle, from, to, taken, () => choose([bundle], `${bundle.from} \u2192 ${bundle.to}`)));
  }
  for (const name of names) {
    const touching = bundles.filter((bundle) => bundle.from === name || bundle.to === name);
    drawing.append(makeBox(name, system.instances[name].model, places.get(name)!, () => choose(touching, name, [name])));
  }
  root.append(drawing, list);
  choose(bundles, "All connections", names);
  return root;
}

function placesOf(names: string[]): Map<string, [number, number]> {
  const count = names.length;
  if (count === 1) return new Map([[names[0], [140, 70]]]);
  if (count === 2) return new Map([[names[0], [130, 90]], [names[1], [480, 90]]]);
  const radiusY = Math.max(150, 22 * count); // leaves space for texts between boxes
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
    svg("text", { x: String(x), y: String(y - 3), class: "name", style: `font-size:${NAME.size * Math.min(1, NAME.fits / name.length)}px` }, shortened(name)),
    svg("text", { x: String(x), y: String(y + 16), class: "model" }, shortened(model)));
}

/** Creates an arrow. Appends the position of its label to `taken`. */
function makeArrow(bundle: Bundle, from: [number, number], to: [number, number], taken: Place[], onChoose: () => void): SVGElement {
  const group = svg("g", { class: "bundle", tabindex: "0", onclick: onChoose, onfocus: onChoose });
  const text = labelOf(bundle);
  if (bundle.from === bundle.to) return group;
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  const [nx, ny] = [-dy / length, dx / length];
  const bend = 0.13 * length;
  const control: [number, number] = [(from[0] + to[0]) / 2 + bend * nx, (from[1] + to[1]) / 2 + bend * ny];
  const start = edgeOf(from, control);
  const end = edgeOf(to, control);
  const at = (share: number, axis: 0 | 1) => (1 - share) ** 2 * start[axis] + 2 * share * (1 - share) * control[axis] + share ** 2 * end[axis];
  const size = { width: 6.6 * text.length + 8, height: 18 };
  const label = SHARES.map((share) => ({ x: at(share, 0), y: at(share, 1), ...size }));
  const place = label.find((one) => !taken.some((other) => overlap(one, other))) ?? label[0];
  taken.push(place);
  group.append(
    svg("path", { d: `M${start} Q${control} ${end}`, "marker-end": "url(#arrow)" }),
    svg("rect", { x: String(place.x - place.width / 2), y: String(place.y - place.height / 2), width: String(place.width), height: String(place.height), class: "behind" }),
    svg("text", { x: String(place.x), y: String(place.y + 4) }, text),
  );
  return group;
}

function overlap(one: Place, other: Place): boolean {
  return 2 * Math.abs(one.x - other.x) < one.width + other.width && 2 * Math.abs(one.y - other.y) < one.height + other.height;
}

/** Returns the label of an arrow. For one connection, this is the variable's name and unit. For several connections,
 * it is their number and up to two units, or the number of units. */
function labelOf({ from, connections }: Bundle): string {
  const units = [...new Set(connections.map(({ unit, type }) => shownUnit(unit ?? "") || (type === "Binary" ? "bytes" : "")))].filter(Boolean);
  if (connections.length === 1) return shortened(connections[0].from.slice(from.length + 1)) + (units.length > 0 ? ` [${units[0]}]` : "");
  return `${connections.length} values` + (units.length > 2 ? `, ${units.length} units` : units.length > 0 ? `: ${units.join(", ")}` : "");
}

function shortened(name: string): string {
  return name.length > 26 ? name.slice(0, 25) + "\u2026" : name;
}

/** Returns the point where the line from a box's centre to a point crosses the edge of the box. */
function edgeOf([x, y]: [number, number], [px, py]: [number, number]): [number, number] {
  const [dx, dy] = [px - x, py - y];
  const share = Math.min(Math.abs((BOX.width / 2 + 4) / (dx || 1e-9)), Math.abs((BOX.height / 2 + 4) / (dy || 1e-9)));
  return [x + share * dx, y + share * dy];
}

/** Creates a table of instances with model, description and step. */
function makeInstances(system: SystemInfo, names: string[]): HTMLElement[] {
  if (names.length === 0) return [];
  const rows = names.map((name) => {
    const { model, text, step } = system.instances[name];
    return element("tr", {}, element("td", { class: "whole" }, name), element("td", { class: "whole" }, shortened(model)), element("td", { class: "faint" }, text ?? ""), element("td", { class: "number" }, shown(step, "s")));
  });
  return [element("h3", {}, names.length === 1 ? names[0] : `${names.length} FMUs`),
    element("table", {}, element("thead", {}, element("tr", {}, ...["instance", "model", "what it is", "step"].map((head) => element("th", { class: "whole" }, head)))), element("tbody", {}, ...rows))];
}

/** Replaces the content of `into` by `before` and a table of connections. Returns the function that updates the table
 * to the shown time. */
function showConnections(run: Run, clock: Clock, into: HTMLElement, bundles: Bundle[], title: string, before: HTMLElement[]): () => void {
  const rows = bundles.flatMap((bundle) => bundle.connections);
  const body = element("tbody", {});
  const values: [HTMLElement, string][] = [];
  for (const { from, to, unit, type } of rows) {
    const value = element("td", { class: "number" });
    if (run.has(from)) values.push([value, from]);
    body.append(element("tr", {}, element("td", {}, ...dotted(from)), element("td", {}, ...dotted(to)), element("td", { class: "whole" }, shownUnit(unit ?? "") || (unit === "1" ? "1" : type === "Real" ? "" : type)), value));
  }
  const show = () => {
    for (const [cell, name] of values) cell.textContent = run.textAt(name, clock.time);
  };
  if (rows.length === 0) {
    into.replaceChildren(...before, element("p", { class: "faint" }, "No connections."));
    return show;
  }
  into.replaceChildren(...before, element("h3", {}, `${title}: ${rows.length} connection${rows.length === 1 ? "" : "s"}`),
    element("table", {}, element("thead", {}, element("tr", {}, ...["from", "to", "unit", "now"].map((head) => element("th", { class: "whole" }, head)))), body));
  show();
  return show;
}
