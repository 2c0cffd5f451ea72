// SPDX-License-Identifier: Apache-2.0
// What the reports of all studies are drawn with, on top of page_parts.js. No statistics are computed here.
"use strict";
const study = content;
const { factors, designs } = study;
let chosen = -1;
const redraws = [];

const told = (design) => factors.map((name, i) => `${name} = ${short(designs[design].values[i])}`).join("\n");
const choose = (design) => {
  chosen = design;
  redraws.forEach((redraw) => redraw());
};

/** A chart that is drawn anew when a choice or the chosen design changes. */
const chart = (made, draw) => {
  const place = node("div");
  made.append(place);
  const redraw = () => place.replaceChildren(draw());
  redraws.push(redraw);
  return redraw;
};
const mark = (design, shape, attributes) =>
  node(
    shape,
    {
      ...attributes,
      class: design === chosen ? "mark chosen" : "mark",
      onclick: () => choose(design),
    },
    node("title", {}, told(design)),
  );
