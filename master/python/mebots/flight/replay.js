// SPDX-License-Identifier: Apache-2.0
// Draws the page of a replayed flight, with the parts of page_parts.js.
"use strict";
const COLOURS = { measured: "var(--ink)", "needed by the motion": "var(--ink)", model: "var(--undecided)", commands: "var(--undecided)" };
const OTHERS = ["var(--on)", "var(--excluded)", "var(--off)"];
const colourOf = (curves) => {
  let next = 0;
  return curves.map((one) => COLOURS[one.name] ?? OTHERS[next++ % OTHERS.length]);
};

main.append(node("p", { class: "answer" }, content.answer));

// A broken line for each curve: nothing is drawn where nothing was measured.
const path = (xs, ys, x, y) => {
  let text = "";
  let down = false;
  ys.forEach((value, i) => {
    if (value === null) {
      down = false;
      return;
    }
    text += `${down ? "L" : "M"}${x(xs[i]).toFixed(1)} ${y(value).toFixed(1)}`;
    down = true;
  });
  return text;
};
const pair = node("div", { class: "pair" });
main.append(pair);
for (const one of content.charts) {
  const made = section(pair, one.title);
  const colours = colourOf(one.curves);
  const key = node("p");
  one.curves.forEach((curve, i) => key.append(node("span", { class: "key", style: `background:${colours[i]}` }), curve.name));
  const picture = frame(520, 260);
  const box = { left: 60, right: 505, top: 16, bottom: 215 };
  const yRange = extent(one.curves.flatMap((curve) => curve.y));
  const xRange = extent(one.x);
  const x = scale(xRange, box.left, box.right);
  const y = scale(yRange, box.bottom, box.top);
  axes(picture, box, x, y, xRange, yRange, "time [s]", "");
  one.curves.forEach((curve, i) =>
    picture.append(node("path", { d: path(one.x, curve.y, x, y), fill: "none", stroke: colours[i], "stroke-width": 1.2 })));
  made.append(key, picture);
}

const grid = (heads, rows) => {
  const body = node("tbody");
  for (const row of rows) body.append(node("tr", {}, ...row.map((cell, i) => node("td", typeof cell === "number" || i > 2 ? {} : { class: "left" }, short(cell)))));
  return node("div", { class: "scroll" }, node("table", {}, node("thead", {}, node("tr", {}, ...heads.map((head, i) => node("th", i > 2 ? {} : { style: "text-align:left" }, head)))), body));
};
section(main, "Errors", "Model less measurement. p5, p50 and p95 are percentiles of the error; excluded samples are not in n. " +
  `Rows of thrust and acceleration compare means over ${content.window} s: a replay of the whole flight would drift away, since no pilot answers its errors. ` +
  (content.settle ? `The model's rotors start at rest, so the first ${content.settle} s are left out.` : "")).append(grid(content.fields, content.errors));
if (content.findings.length) {
  section(main, "Samples of the log").append(...content.findings.map((text) => node("p", {}, text)));
}
if (content.notes.length) section(main, "Notes").append(...content.notes.map((text) => node("p", {}, text)));
showProvenance("What was flown");
