// SPDX-License-Identifier: Apache-2.0
// Draws the report of a study of a rare event, with the parts of report_parts.js.
"use strict";
const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b58900", "#56b4e9", "#5c4d9e", "#7f7f7f"];
const colour = (design) => COLOURS[design % COLOURS.length];
const percent = (share) => (share === null ? "–" : `${short(100 * share)} %`);
/** Of what is rare: 1.4e-5, and 2.1 % where that is easier to read. */
const chance = (value) => (value === null ? "–" : value === 0 ? "0" : value < 1e-3 ? value.toExponential(1) : percent(Number(value.toPrecision(2))));
const goal = (design) => design.levels[design.levels.length - 1];

// The answer in one line, where there is one design.
const parts = designs.reduce((sum, one) => sum + one.missions, 0);
const simulated = designs.reduce((sum, one) => sum + one.simulated_s, 0);
const failures = designs.reduce((sum, one) => sum + one.failed, 0);
if (designs.length === 1) {
  const [probability, low, high, relative] = designs[0].answer;
  const line = node("p", { class: "answer" });
  if (probability === null) line.append("Without an answer: too many missions failed on the way.");
  else line.append(node("strong", {}, chance(probability)), ` (${chance(low)} to ${chance(high)}${relative === null ? "" : `; standard error ${percent(Number(relative.toPrecision(2)))} of it`})`);
  main.append(line);
}
main.append(node("p", {}, `How likely it is that ${study.score} ${study.rises ? "rises" : "falls"} to ${short(goal(designs[0]))}. ` +
  `${study.estimates} estimates of each design, ${study.each} missions from each level to the next; ` +
  `${parts} parts of missions in all, ${short(simulated)} s simulated, ${failures} failed. Intervals: ${100 * (1 - study.error)} %.` +
  (study.found ? " Pilot missions, which count for nothing else, found the levels." : "")));
const known = designs.map((one) => one.counting).filter((value) => value !== null);
if (known.length) {
  main.append(node("p", {}, `For the same error, counting would have to fly ${known.map((value) => short(Number(value.toPrecision(2)))).join(", ")} missions from beginning to end${designs.length > 1 ? ", design by design" : ""}.`));
}

const pair = node("div", { class: "pair" });
main.append(pair);

/** Probabilities over tenths of tenths. */
const logarithmic = (values, from, to) => {
  const positive = values.filter((value) => value > 0);
  const low = Math.floor(Math.log10(Math.min(0.1, ...positive)));
  const at = scale([low, 0], from, to);
  return { at: (value) => at(Math.log10(Math.max(value, 10 ** low))), ticks: Array.from({ length: 1 - low }, (_, i) => 10 ** (low + i)) };
};
const tenth = (value) => (value >= 0.01 ? `${value * 100} %` : value.toExponential(0));

// The way to the event, level by level.
/** How likely it is to come to each level, by an estimate. */
const shares = (reached) => {
  let share = 1;
  return reached.map((count) => (share *= count / study.each));
};
const means = (design) => design.levels.map((_, level) => design.reached.reduce((sum, one) => sum + (shares(one)[level] ?? 0), 0) / design.reached.length);
{
  const made = section(pair, "The way there", "How likely it is to come to each level: thin lines are estimates, the thick one is their mean. The bar is the interval of the answer.");
  chart(made, () => {
    const picture = frame(520, 340);
    const box = { left: 70, right: 500, top: 20, bottom: 295 };
    const levels = designs.flatMap((one) => one.levels);
    const xRange = extent(levels);
    const x = scale(study.rises ? xRange : [xRange[1], xRange[0]], box.left, box.right);
    const values = designs.flatMap((one) => [...one.reached.flatMap(shares), ...one.answer.slice(0, 3)]);
    const y = logarithmic(values, box.bottom, box.top);
    for (const value of ticks(xRange)) {
      picture.append(node("line", { class: "axis", x1: x(value), x2: x(value), y1: box.top, y2: box.bottom }),
        node("text", { x: x(value), y: box.bottom + 16, "text-anchor": "middle" }, short(value)));
    }
    for (const value of y.ticks) {
      picture.append(node("line", { class: "axis", x1: box.left, x2: box.right, y1: y.at(value), y2: y.at(value) }),
        node("text", { x: box.left - 6, y: y.at(value) + 4, "text-anchor": "end" }, tenth(value)));
    }
    picture.append(node("text", { x: box.right, y: box.bottom + 34, "text-anchor": "end" }, study.score));
    const line = (design, probabilities, more) => {
      const points = probabilities.map((value, i) => [x(design.levels[i]), value]).filter(([, value]) => value > 0);
      return node("path", { d: "M" + points.map(([px, value]) => `${px},${y.at(value)}`).join("L"), fill: "none", ...more });
    };
    designs.forEach((design, i) => {
      const faint = chosen >= 0 && chosen !== i;
      if (!faint) for (const one of design.reached) picture.append(line(design, shares(one), { stroke: colour(i), "stroke-opacity": 0.3, "stroke-width": 1 }));
      picture.append(line(design, means(design), { stroke: colour(i), "stroke-opacity": faint ? 0.3 : 1, "stroke-width": 2.5 }));
      means(design).forEach((value, level) => value > 0 && picture.append(mark(i, "circle", { cx: x(design.levels[level]), cy: y.at(value), r: 4, fill: colour(i) })));
      const [, low, high] = design.answer;
      if (low !== null) picture.append(node("line", { x1: x(goal(design)), x2: x(goal(design)), y1: y.at(low), y2: y.at(high), stroke: colour(i), "stroke-width": 2, "stroke-opacity": faint ? 0.3 : 1 }));
    });
    return picture;
  });
}

// Estimates, or designs beside each other.
{
  const many = designs.length > 1;
  const made = section(pair, many ? "Designs" : "Estimates", many ? "Probability with its interval; dots are estimates. Click one for what it is." : "Each dot an estimate that knows nothing of the others; the bar is the interval of their mean. One at the left edge is 0.");
  chart(made, () => {
    const step = many ? Math.max(18, Math.min(40, 280 / designs.length)) : 60;
    const height = 50 + designs.length * step;
    const picture = frame(520, height);
    const values = designs.flatMap((one) => [...one.reached.map((counts) => estimate(one, counts)), ...one.answer.slice(0, 3)]);
    const x = logarithmic(values, 90, 488);
    for (const value of x.ticks) {
      picture.append(node("line", { class: "axis", x1: x.at(value), x2: x.at(value), y1: 10, y2: height - 34 }),
        node("text", { x: x.at(value), y: height - 16, "text-anchor": "middle" }, tenth(value)));
    }
    designs.forEach((design, i) => {
      const y = 10 + (i + 0.5) * step;
      const [probability, low, high] = design.answer;
      if (many) picture.append(node("text", { x: 84, y: y + 4, "text-anchor": "end" }, `design ${i}`));
      for (const counts of design.reached) picture.append(node("circle", { cx: x.at(estimate(design, counts)), cy: y, r: 3, fill: colour(i), "fill-opacity": 0.35 }));
      if (low !== null) picture.append(node("line", { x1: x.at(low), x2: x.at(high), y1: y, y2: y, stroke: colour(i), "stroke-width": 2 }));
      if (probability) picture.append(mark(i, "circle", { cx: x.at(probability), cy: y, r: 6, fill: colour(i) }));
    });
    return picture;
  });
}
function estimate(design, counts) {
  return counts.length < design.levels.length ? 0 : shares(counts)[counts.length - 1];
}

// Numbers.
{
  const made = section(main, "Designs");
  chart(made, () => {
    const head = node("tr", {}, ...["design", ...factors, "probability", "interval", "standard error", "parts of missions", "simulated [s]", "failed", "counting needs"].map((name) => node("th", {}, name)));
    const body = node("tbody");
    designs.forEach((design, i) => {
      const [probability, low, high, relative] = design.answer;
      const cells = [i, ...design.values.map(short), chance(probability), low === null ? "–" : `${chance(low)} to ${chance(high)}`, percent(relative && Number(relative.toPrecision(2))),
        design.missions, short(design.simulated_s), design.failed, design.counting === null ? "–" : `${short(Number(design.counting.toPrecision(2)))} missions`];
      body.append(node("tr", { class: i === chosen ? "chosen" : "", onclick: () => choose(i) }, ...cells.map((cell) => node("td", {}, String(cell)))));
    });
    return node("div", { class: "scroll" }, node("table", {}, node("thead", {}, head), body));
  });
}
{
  const made = section(main, "Levels", "Of the missions that start for a level, the share that reaches it: over all estimates, and from the least to the greatest. A fifth to a third is good; where one is far from it, other levels would bring a smaller error.");
  chart(made, () => {
    const body = node("tbody");
    designs.forEach((design, i) => {
      if (chosen >= 0 && chosen !== i) return;
      design.levels.forEach((level, number) => {
        const found = design.reached.filter((counts) => counts.length > number && (number === 0 || counts[number - 1] > 0)).map((counts) => counts[number] / study.each);
        const mean = found.length ? found.reduce((sum, one) => sum + one, 0) / found.length : null;
        const cells = [i, short(level), percent(mean), found.length ? `${percent(Math.min(...found))} to ${percent(Math.max(...found))}` : "–", found.length];
        body.append(node("tr", {}, ...cells.map((cell) => node("td", {}, String(cell)))));
      });
    });
    const head = node("tr", {}, ...["design", `level of ${study.score}`, "reach it", "estimates differ", "estimates that came so far"].map((name) => node("th", {}, name)));
    return node("div", { class: "scroll" }, node("table", {}, node("thead", {}, head), body));
  });
}

// One that it happened to.
{
  const made = section(main, "See it happen");
  chart(made, () => {
    const box = node("div");
    designs.forEach((design, i) => {
      if ((chosen >= 0 && chosen !== i) || !design.command) return;
      box.append(node("p", {}, `A mission ${designs.length > 1 ? `of design ${i} ` : ""}that reached the last level, with pictures and all results; then \`mebots report\` on its folder makes a page:`), node("code", {}, design.command));
    });
    if (!box.childNodes.length) box.append(node("p", {}, "No mission reached the last level, or only another config could fly it again."));
    return box;
  });
}
showProvenance("What was flown");
redraws.forEach((redraw) => redraw());
