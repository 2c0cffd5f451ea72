// SPDX-License-Identifier: Apache-2.0
// What all pages that Python writes are drawn with. Their numbers are in the page as JSON.
"use strict";
const content = JSON.parse(document.getElementById("data").textContent);
const main = document.getElementById("main");

const node = (name, attributes = {}, ...children) => {
  const svg = ["svg", "g", "line", "circle", "rect", "path", "text", "title"].includes(name);
  const made = svg ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
};
const short = (value) => {
  if (value === null || value === undefined) return "–";
  if (typeof value !== "number") return String(value);
  return Number(value.toPrecision(4)).toString();
};
/** A text of at most this many characters; all of it is its title. */
const label = (attributes, text, most) =>
  text.length <= most ? node("text", attributes, text) : node("text", attributes, node("title", {}, text), `${text.slice(0, most - 1)}\u2026`);
const section = (parent, title, text) => {
  const made = node("section", {}, node("h2", {}, title));
  if (text) made.append(node("p", {}, text));
  parent.append(made);
  return made;
};
const selector = (made, label, names, start, change) => {
  const box = node("select", { "aria-label": label, onchange: () => change(Number(box.value)) });
  names.forEach((name, i) => box.append(node("option", i === start ? { value: i, selected: "" } : { value: i }, name)));
  made.append(label + " ", box, " ");
};
const extent = (values) => {
  const known = values.filter((value) => typeof value === "number");
  let [low, high] = [Math.min(...known), Math.max(...known)];
  if (!known.length) [low, high] = [0, 1];
  // Of values that differ by rounding alone, the middle of a range that shows so.
  if (high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high))) [low, high] = [low - 1, high + 1];
  return [low - 0.04 * (high - low), high + 0.04 * (high - low)];
};
const scale = ([low, high], from, to) => (value) => from + ((value - low) / (high - low)) * (to - from);
const ticks = ([low, high], count = 5) => {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((one) => one * power >= raw) * power;
  const found = [];
  for (let i = Math.ceil(low / step); i * step <= high; ++i) found.push(Number((i * step).toPrecision(12)));
  return found;
};
const frame = (width, height) => node("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
const axes = (picture, box, x, y, xRange, yRange, xName, yName) => {
  for (const value of ticks(xRange)) {
    picture.append(
      node("line", { class: "axis", x1: x(value), x2: x(value), y1: box.top, y2: box.bottom }),
      node("text", { x: x(value), y: box.bottom + 16, "text-anchor": "middle" }, short(value)),
    );
  }
  for (const value of ticks(yRange)) {
    picture.append(
      node("line", { class: "axis", x1: box.left, x2: box.right, y1: y(value), y2: y(value) }),
      node("text", { x: box.left - 6, y: y(value) + 4, "text-anchor": "end" }, short(value)),
    );
  }
  picture.append(
    node("text", { x: box.right, y: box.bottom + 32, "text-anchor": "end" }, xName),
    node("text", { x: box.left - 40, y: box.top - 8 }, yName),
  );
};
const showProvenance = (title) => {
  const made = section(main, title);
  const body = node("tbody");
  for (const [name, value] of Object.entries(content.provenance)) body.append(node("tr", {}, node("th", {}, name), node("td", { class: "left" }, node("code", {}, value))));
  made.append(node("table", {}, body));
};
