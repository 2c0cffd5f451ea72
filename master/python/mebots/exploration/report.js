// SPDX-License-Identifier: Apache-2.0
// Draws the report of a study that compares designs, with the parts of report_parts.js.
"use strict";
const { objectives } = study;
const MOST_NAMED = 50; // designs side by side whose numbers have room
const PLACES = {
  on: "proven to be on the front",
  undecided: "may be on the front",
  off: "proven to be off the front",
  excluded: "breaks a constraint",
};
const colour = (design) => `var(--${designs[design].front || "undecided"})`;
const titled = (objective) => objective.label + (objective.unit ? ` [${objective.unit}]` : "");
/** A value of a factor with its unit: 102.7 MHz. */
const valued = (value, factor) => {
  const unit = study.factor_units[factor];
  if (typeof value !== "number" || !unit) return short(value);
  const [size, prefix] = ["Hz", "J", "W", "A", "V"].includes(unit)
    ? [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"]].find(([one]) => Math.abs(value) >= one) ?? [1, ""]
    : [1, ""];
  return `${short(value / size)} ${prefix}${unit}`;
};

// What came of it.
const flown = designs.reduce((sum, one) => sum + one.missions, 0);
const failed = designs.reduce((sum, one) => sum + one.failed, 0);
for (const text of study.answer.headlines) main.append(node("p", { class: "answer" }, text));
for (const text of study.answer.remarks) main.append(node("p", {}, text));
main.append(node("p", {}, `${designs.length} designs, ${flown} missions, ${failed} failed. Intervals: ` +
  `${100 * (1 - study.error)} %, ${study.sequence ? "valid at every number of missions" : "for a number of missions settled beforehand"}.`));
const key = node("p");
for (const [place, text] of Object.entries(PLACES)) {
  const count = designs.filter((one) => one.front === place).length;
  if (count) key.append(node("span", { class: "key", style: `background:var(--${place})` }), `${text}: ${count}`);
}
main.append(key);

// Two objectives against each other, with their intervals; one alone stands over a factor that is a number.
const pair = node("div", { class: "pair" });
main.append(pair);
{
  const sorted = objectives.map((_, i) => i).sort((a, b) => Math.abs(objectives[b].sense) - Math.abs(objectives[a].sense));
  const choices = [
    ...objectives.map((one, i) => ({ name: titled(one), label: one.label, share: one.share, at: (design) => design.estimates[i] })),
    ...factors.map((name, i) => ({ name, at: (design) => [design.values[i], null, null] })).filter(({ at }) => designs.every((one) => typeof at(one)[0] === "number")),
  ];
  let across = sorted[0];
  let up = objectives.findIndex((one, i) => one.share && i !== across);
  if (up < 0) up = sorted[Math.min(1, sorted.length - 1)];
  if (up === across && choices.length > objectives.length) across = objectives.length;
  const made = section(pair, "Front", "Each point a design; bars are intervals; the dashed line is the front by means. Click one for what it is.");
  const names = choices.map((one) => one.name);
  /** The designs that no other one dominates by the two means that are shown, where both are to be minimised or maximised. */
  const frontLine = (x, y) => {
    const senseOf = (choice) => objectives[choice]?.sense || (objectives[choice]?.share ? 1 : 0);
    const [sx, sy] = [senseOf(across), senseOf(up)];
    if (!sx || !sy || across === up) return [];
    const points = designs.filter((one) => one.front !== "excluded").map((one) => [choices[across].at(one)[0], choices[up].at(one)[0]]).filter((point) => !point.includes(null));
    const beats = (a, b) => sx * (a[0] - b[0]) >= 0 && sy * (a[1] - b[1]) >= 0 && (a[0] !== b[0] || a[1] !== b[1]);
    const best = points.filter((one) => !points.some((other) => beats(other, one))).sort((a, b) => a[0] - b[0]);
    if (best.length < 2) return [];
    return [node("path", { d: "M" + best.map(([a, b]) => `${x(a)},${y(b)}`).join("L"), fill: "none", stroke: "var(--ink)", "stroke-width": 1.5, "stroke-dasharray": "5 4" },
      node("title", {}, "front by means"))];
  };
  const redraw = chart(made, () => {
    const picture = frame(520, 340);
    const box = { left: 60, right: 505, top: 24, bottom: 295 };
    const xRange = extent(designs.map((one) => choices[across].at(one)[0]));
    const yRange = choices[up].share ? [-0.03, 1.03] : extent(designs.map((one) => choices[up].at(one)[0]));
    const x = scale(xRange, box.left, box.right);
    const y = scale(yRange, box.bottom, box.top);
    axes(picture, box, x, y, xRange, yRange, names[across], names[up]);
    for (const bound of study.constraints.filter((one) => one.label === choices[up].label)) {
      picture.append(node("line", { x1: box.left, x2: box.right, y1: y(bound.bound), y2: y(bound.bound), stroke: "var(--excluded)", "stroke-dasharray": "4 3" }));
    }
    picture.append(...frontLine(x, y));
    const inside = (value, [low, high]) => Math.min(Math.max(value, low), high);
    const order = designs.map((_, i) => i).sort((a, b) => (a === chosen) - (b === chosen) || (designs[a].front === "on") - (designs[b].front === "on"));
    for (const i of order) {
      const [ex, ey] = [choices[across].at(designs[i]), choices[up].at(designs[i])];
      if (ex[0] === null || ey[0] === null) continue;
      const faint = { stroke: colour(i), "stroke-opacity": i === chosen ? 1 : 0.3 };
      if (ex[1] !== null) picture.append(node("line", { ...faint, x1: x(inside(ex[1], xRange)), x2: x(inside(ex[2], xRange)), y1: y(ey[0]), y2: y(ey[0]) }));
      if (ey[1] !== null) picture.append(node("line", { ...faint, x1: x(ex[0]), x2: x(ex[0]), y1: y(inside(ey[1], yRange)), y2: y(inside(ey[2], yRange)) }));
      picture.append(mark(i, "circle", { cx: x(ex[0]), cy: y(ey[0]), r: 5, fill: colour(i) }));
    }
    return picture;
  });
  selector(made, "across", names, across, (value) => ((across = value), redraw()));
  selector(made, "up", names, up, (value) => ((up = value), redraw()));
}

// Levels of a factor: its values where there are few, fifths of its range where there are many.
const levelsOf = (factor) => {
  const values = [...new Set(designs.map((one) => one.values[factor]))];
  if (values.length <= 12) {
    if (values.every((one) => typeof one === "number")) values.sort((a, b) => a - b);
    return values.map((value) => ({ name: valued(value, factor), has: (one) => one === value }));
  }
  const [low, high] = [Math.min(...values), Math.max(...values)];
  return Array.from({ length: 5 }, (_, i) => {
    const [from, to] = [low + ((high - low) * i) / 5, low + ((high - low) * (i + 1)) / 5];
    return { name: `${valued(from, factor)} to ${valued(to, factor)}`, has: (one) => one >= from && (one < to || (i === 4 && one <= to)) };
  });
};
/** Mean over the missions of some designs. */
const pooled = (some, objective) => {
  let [sum, count] = [0, 0];
  for (const one of some) {
    const [mean, , , number] = one.estimates[objective];
    if (mean !== null) [sum, count] = [sum + mean * number, count + number];
  }
  return count ? sum / count : null;
};

// A map over two factors.
if (factors.length >= 2) {
  let [rows, columns, objective] = [0, 1, Math.max(0, objectives.findIndex((one) => one.share))];
  const made = section(pair, "Map", "Mean over all missions with these two values, whatever the other factors.");
  const redraw = chart(made, () => {
    const [up, across] = [levelsOf(rows), levelsOf(columns)];
    const picture = frame(520, 340);
    const [left, top, width, height] = [110, 20, 400 / across.length, 280 / up.length];
    const cells = up.map((r) => across.map((c) => pooled(designs.filter((one) => r.has(one.values[rows]) && c.has(one.values[columns])), objective)));
    const range = objectives[objective].share ? [0, 1] : extent(cells.flat());
    up.forEach((r, i) => {
      picture.append(label({ x: left - 6, y: top + (i + 0.5) * height + 4, "text-anchor": "end" }, r.name, 14));
      across.forEach((c, j) => {
        const value = cells[i][j];
        if (value === null) return;
        const strength = scale(range, 0.08, 1)(value);
        picture.append(
          node("rect", { x: left + j * width + 1, y: top + i * height + 1, width: width - 2, height: height - 2, rx: 3, fill: "var(--undecided)", "fill-opacity": strength }),
          node("text", { x: left + (j + 0.5) * width, y: top + (i + 0.5) * height + 4, "text-anchor": "middle", style: strength > 0.65 ? "fill:var(--back)" : "fill:var(--ink)" }, short(value)),
        );
      });
    });
    across.forEach((c, j) => picture.append(label({ x: left + (j + 0.5) * width, y: top + 296, "text-anchor": "middle" }, c.name, Math.floor(width / 7))));
    return picture;
  });
  selector(made, "of", objectives.map(titled), objective, (value) => ((objective = value), redraw()));
  selector(made, "rows", factors, rows, (value) => ((rows = value), redraw()));
  selector(made, "columns", factors, columns, (value) => ((columns = value), redraw()));
}

// Main effects.
{
  let objective = Math.max(0, objectives.findIndex((one) => one.sense !== 0));
  const made = section(pair, "Main effects", "Mean over all missions at each level of a factor.");
  const redraw = chart(made, () => {
    const picture = frame(520, 300);
    const levels = factors.map((_, i) => levelsOf(i));
    const means = levels.map((own, i) => own.map((level) => pooled(designs.filter((one) => level.has(one.values[i])), objective)));
    const range = extent(means.flat());
    const y = scale(range, 225, 20);
    const width = 450 / factors.length;
    for (const value of ticks(range)) {
      picture.append(node("line", { class: "axis", x1: 60, x2: 515, y1: y(value), y2: y(value) }), node("text", { x: 54, y: y(value) + 4, "text-anchor": "end" }, short(value)));
    }
    levels.forEach((own, i) => {
      const x = (j) => 60 + i * width + ((j + 0.5) / own.length) * width;
      const points = means[i].map((mean, j) => (mean === null ? null : [x(j), y(mean)])).filter(Boolean);
      picture.append(node("path", { d: "M" + points.map((point) => point.join(",")).join("L"), fill: "none", stroke: "var(--undecided)", "stroke-width": 2 }));
      points.forEach(([cx, cy]) => picture.append(node("circle", { cx, cy, r: 4, fill: "var(--undecided)" })));
      const every = Math.max(1, Math.ceil((own.length * 14) / width)); // lines of text do not touch
      own.forEach((level, j) => {
        if (j % every === 0) picture.append(label({ x: x(j) + 4, y: 240, "text-anchor": "end", transform: `rotate(-40 ${x(j) + 4} 240)` }, level.name, 12));
      });
      picture.append(label({ x: 60 + (i + 0.5) * width, y: 12, "text-anchor": "middle" }, factors[i].split(".").pop(), Math.floor(width / 7)));
    });
    return picture;
  });
  selector(made, "of", objectives.map(titled), objective, (value) => ((objective = value), redraw()));
}

// Parallel coordinates.
{
  const made = section(pair, "Parallel coordinates", "A line for each design through its factors and means.");
  const columns = [
    ...factors.map((name, i) => ({ name: name.split(".").pop(), value: (one) => one.values[i] })),
    ...objectives.map((one, i) => ({ name: one.label, value: (design) => design.estimates[i][0] })),
  ];
  chart(made, () => {
    const picture = frame(520, 300);
    const x = (i) => 50 + (i * 420) / Math.max(1, columns.length - 1);
    const scales = columns.map(({ value }, i) => {
      const values = designs.map(value);
      if (values.every((one) => typeof one === "number" || one === null)) {
        const range = extent(values);
        const name = (one) => (i < factors.length ? valued(one, i) : short(one));
        return { at: scale(range, 260, 30), name, names: [Math.min(...values.filter((one) => one !== null)), Math.max(...values.filter((one) => one !== null))] };
      }
      const words = [...new Set(values)];
      return { at: (one) => 260 - (230 * (words.indexOf(one) + 0.5)) / words.length, name: short, names: words };
    });
    const order = designs.map((_, i) => i).sort((a, b) => (a === chosen) - (b === chosen) || (designs[a].front === "on") - (designs[b].front === "on"));
    for (const i of order) {
      const points = columns.map(({ value }, j) => [value(designs[i]), j]).filter(([value]) => value !== null);
      const line = "M" + points.map(([value, j]) => `${x(j)},${scales[j].at(value)}`).join("L");
      const loud = i === chosen || designs[i].front === "on";
      picture.append(mark(i, "path", { d: line, fill: "none", stroke: colour(i), "stroke-opacity": loud ? 1 : 0.35, "stroke-width": loud ? 2 : 1.2 }));
    }
    columns.forEach(({ name }, i) => {
      picture.append(node("line", { class: "axis", x1: x(i), x2: x(i), y1: 30, y2: 260 }), label({ x: x(i), y: i % 2 ? 294 : 280, "text-anchor": "middle" }, name, Math.floor(840 / columns.length / 7)));
      const room = Math.max(4, Math.floor(420 / Math.max(1, columns.length - 1) / 7) - 1);
      const every = Math.max(1, Math.ceil((scales[i].names.length * 13) / 230));
      scales[i].names.forEach((value, j) => {
        const last = i === columns.length - 1; // its names lie at the left: there is more space
        if (j % every === 0) picture.append(label({ x: x(i) + (last ? -4 : 4), y: scales[i].at(value) + 4, "text-anchor": last ? "end" : "start", class: "lettered" }, scales[i].name(value), room));
      });
    });
    return picture;
  });
}

// Distributions.
if (designs.some((one) => one.flights.length)) {
  let objective = Math.max(0, objectives.findIndex((one) => !one.share));
  const made = section(main, "Distributions", "Each dot a mission, designs by their mean, with their numbers; the chosen one is outlined.");
  const redraw = chart(made, () => {
    const order = designs.map((_, i) => i).filter((i) => designs[i].estimates[objective][0] !== null)
      .sort((a, b) => designs[a].estimates[objective][0] - designs[b].estimates[objective][0]);
    const wide = Math.max(340, Math.min(1300, made.clientWidth || 1080));
    const picture = frame(wide, 260);
    const values = order.flatMap((i) => designs[i].flights[objective] ?? []);
    const range = extent(values);
    const y = scale(range, 235, 15);
    for (const value of ticks(range)) {
      picture.append(node("line", { class: "axis", x1: 60, x2: wide - 10, y1: y(value), y2: y(value) }), node("text", { x: 54, y: y(value) + 4, "text-anchor": "end" }, short(value)));
    }
    const width = (wide - 70) / Math.max(1, order.length);
    const named = Math.min(MOST_NAMED, Math.floor((wide - 70) / 18));
    order.forEach((i, place) => {
      const middle = 60 + (place + 0.5) * width;
      const dots = (designs[i].flights[objective] ?? []).filter((one) => one !== null);
      const path = dots.map((one, j) => `M${middle + (((j * 0.618) % 1) - 0.5) * width * 0.6},${y(one)}h0`).join("");
      if (order.length <= named) picture.append(node("text", { x: middle, y: 252, "text-anchor": "middle" }, String(i)));
      picture.append(
        node("path", { d: path, stroke: colour(i), "stroke-opacity": 0.5, "stroke-width": 4, "stroke-linecap": "round" }),
        mark(i, "rect", { x: middle - width / 2, y: 15, width, height: 220, fill: "transparent" }),
      );
    });
    return picture;
  });
  selector(made, "of", objectives.map(titled), objective, (value) => ((objective = value), redraw()));
}

// All designs.
{
  const made = section(main, "Designs", designs.some((one) => one.command) ? "Click one for what it is; tick several to see their missions beside each other." : "");
  const ticked = new Set();
  let [by, sign] = [0, 1];
  const columns = [
    ["rank", (i) => designs[i].rank],
    ["design", (i) => i],
    ...factors.map((name, f) => [name, (i) => designs[i].values[f]]),
    ["missions", (i) => designs[i].missions],
    ...objectives.map((one, o) => [titled(one), (i) => designs[i].estimates[o][0]]),
    ["status", (i) => designs[i].status],
    ["front", (i) => PLACES[designs[i].front] ?? ""],
    ["note", (i) => designs[i].note],
  ];
  const redraw = chart(made, () => {
    const order = designs.map((_, i) => i);
    if (by >= 0) {
      const value = columns[by][1];
      order.sort((a, b) => sign * (value(a) === value(b) ? 0 : value(a) === null ? 1 : value(b) === null ? -1 : value(a) < value(b) ? -1 : 1));
    }
    const head = node("tr", {}, node("th", {}, ""));
    columns.forEach(([name], i) => head.append(node("th", { onclick: () => ((sign = by === i ? -sign : 1), (by = i), redraw()) }, name)));
    const body = node("tbody");
    for (const i of order) {
      const row = node("tr", { class: i === chosen ? "chosen" : "", onclick: () => choose(i) });
      const box = node("input", { type: "checkbox", "aria-label": `design ${i} beside others`, onclick: (event) => event.stopPropagation(),
        onchange: () => (box.checked ? ticked.add(i) : ticked.delete(i), together()) });
      box.checked = ticked.has(i);
      row.append(node("td", { class: "left" }, ...(designs[i].command ? [box] : [])));
      columns.forEach(([name, value]) => {
        const objective = objectives.findIndex((one) => titled(one) === name);
        const factor = factors.indexOf(name);
        let text = factor >= 0 ? valued(value(i), factor) : short(value(i));
        if (objective >= 0 && designs[i].estimates[objective][1] !== null) {
          const [, low, high] = designs[i].estimates[objective];
          text += ` (${short(low)} to ${short(high)})`;
        }
        row.append(node("td", {}, text));
      });
      body.append(row);
    }
    return node("div", { class: "scroll" }, node("table", {}, node("thead", {}, head), body));
  });
  const together = chart(made, () => {
    const some = [...ticked].sort((a, b) => a - b);
    if (some.length < 2) return node("div");
    const lines = [...some.map((i) => designs[i].command), `mebots report ${some.map((i) => designs[i].folder).join(" ")} --out ${study.beside.out}`];
    return node("div", { id: "beside" }, node("p", {}, `The first mission of designs ${some.join(", ")}: the same draws, one page with all of them in one scene. These lines fly and draw it; then open `,
      node("a", { href: study.beside.page }, study.beside.page), "."), node("pre", {}, node("code", {}, lines.join("\n"))));
  });
}

showProvenance("What was flown");

// The chosen design.
{
  const panel = node("div", { id: "chosen" });
  main.append(panel);
  redraws.push(() => {
    panel.hidden = chosen < 0;
    if (chosen < 0) return;
    const design = designs[chosen];
    const facts = factors.map((name, i) => `${name} = ${valued(design.values[i], i)}`);
    const found = objectives.map((one, i) => {
      const [mean, low, high, count] = design.estimates[i];
      return `${titled(one)} ${short(mean)}${low === null ? "" : ` (${short(low)} to ${short(high)})`} of ${count}`;
    });
    panel.replaceChildren(
      node("strong", {}, `Design ${chosen}, ${design.name}: ${design.note || PLACES[design.front] || ""}`),
      node("p", {}, facts.join(", ")),
      node("p", {}, `${design.missions} missions, ${design.failed} failed, ${design.status}. ${found.join("; ")}`),
    );
    if (design.command) panel.append(node("p", {}, "Its first mission again, with pictures and all results:"), node("code", {}, design.command));
    if (design.replay) panel.append(node("p", {}, node("a", { href: design.replay }, "See it fly"), " (made when this report was written)"));
    else if (design.command) panel.append(node("p", {}, "Then `mebots report` on that folder makes a page to see it fly; the study's next `mebots sweep`, which flies nothing again, links it here."));
  });
}
redraws.forEach((redraw) => redraw());
