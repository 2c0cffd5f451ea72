// SPDX-License-Identifier: Apache-2.0
// The page of a study of a rare event: the probability to reach each level of the score.
import { element } from "../dom";
import { colour } from "../theme";
import type { Rare, RareDesign } from "./content";
import { chanceText, counted, digits, joined, percent } from "./format";
import { extent, listenToPointer, Plot } from "./plot";
import { makeColumns, makeCommand, makeSmallTable, panel } from "./widgets";

export function makeRare(rare: Rare): HTMLElement[] {
  Object.assign(window.mebots, { rare }); // used by scripts and tests
  let chosen = -1;
  const redraws: (() => void)[] = [];
  const choose = (design: number) => {
    chosen = design === chosen ? -1 : design;
    redraws.forEach((redraw) => redraw());
  };
  const isShown = (design: number) => chosen < 0 || chosen === design;
  return [
    makeAnswer(rare),
    makeColumns([makeWay(rare, isShown, redraws), makeEstimates(rare, isShown, choose, redraws), makeLevels(rare, isShown, redraws), makeReplays(rare)]),
    element("section", { class: "panel" }, element("h2", {}, "Designs"), makeSmallTable(
      ["design", "name", "probability", "interval", "standard error", "parts of missions", "simulated", "failed", "counting needs"],
      rare.designs.map((one, i) => [i, one.name, ...answerCells(one), one.missions, `${digits(one.simulated_s)} s`, one.failed, one.counting === null ? null : `${digits(one.counting, 2)} missions`]))),
  ];
}

function answerCells({ answer: [probability, low, high, relative] }: RareDesign): (string | null)[] {
  return [chanceText(probability), low === null ? null : `${chanceText(low)} to ${chanceText(high)}`, relative === null ? null : percent(relative)];
}

function makeAnswer(rare: Rare): HTMLElement {
  const { designs } = rare;
  const lines = designs.slice(0, 10).map((one, i) => {
    const [probability, interval, error] = answerCells(one);
    const text = one.answer[0] === null ? "no answer: too many missions failed on the way" : `${probability} (${interval}${error ? `; standard error ${error} of it` : ""})`;
    return element("p", { class: "headline" }, designs.length > 1 ? `#${i} ${one.name}: ${text}` : text);
  });
  const goal = joined(digits(designs[0].levels[designs[0].levels.length - 1] ?? 0), rare.unit);
  const parts = designs.reduce((sum, one) => sum + one.missions, 0);
  const simulated = designs.reduce((sum, one) => sum + one.simulated_s, 0);
  const failed = designs.reduce((sum, one) => sum + one.failed, 0);
  const counting = designs.map((one) => one.counting).filter((one) => one !== null).map((one) => digits(one, 2));
  return element("section", { class: "answer" }, ...lines,
    element("p", {}, `The probability that ${rare.score} ${rare.rises ? "rises" : "falls"} to ${goal}.`),
    element("p", { class: "faint" }, `${counted(rare.estimates, "estimate")} of each design, ${rare.each} missions from each level to the next; ${parts.toLocaleString("en")} parts of missions, ${digits(simulated)} s simulated, ${failed} failed. ` +
      `Intervals: ${100 * (1 - rare.error)} %.${rare.found ? " Pilot missions found the levels and have no other use." : ""}`),
    ...(counting.length ? [element("p", {}, `For the same error, counting would need ${counting.join(", ")} whole missions.`)] : []));
}

const least = (values: number[]) => 10 ** Math.floor(Math.log10(Math.min(0.1, ...values.filter((value) => value > 0))));
const chanceTick = (value: number) => (value >= 0.01 ? `${digits(100 * value, 3)} %` : value.toExponential(0).replace("-", "\u2212"));
const known = (values: (number | null)[]) => values.filter((value) => value !== null);

function makeWay(rare: Rare, isShown: (design: number) => boolean, redraws: (() => void)[]): HTMLElement {
  const { designs } = rare;
  const low = least(designs.flatMap((one) => [...one.shares.flat(), ...known(one.answer.slice(0, 3))]));
  const plot = new Plot("Probability of reaching each level", (width) => Math.min(360, Math.max(260, 0.6 * width)), () => {
    const range = extent(designs.flatMap(({ levels }) => levels));
    plot.axes({ title: joined(rare.score, rare.unit && `[${rare.unit}]`), range: rare.rises ? range : [range[1], range[0]] }, { title: "probability", log: true, range: [low, 1.2], text: chanceTick });
    const { context } = plot;
    const path = (levels: number[], shares: number[]) => {
      context.beginPath();
      plot.line(shares.map((share, i): [number, number] | null => (share > 0 ? [plot.x(levels[i]), plot.y(share)] : null)));
      context.stroke();
    };
    designs.forEach(({ levels, shares, mean_shares, answer: [, from, to] }, i) => {
      context.strokeStyle = context.fillStyle = colour(i);
      context.lineWidth = 1;
      context.globalAlpha = 0.3;
      if (isShown(i)) for (const own of shares) path(levels, own);
      context.globalAlpha = isShown(i) ? 1 : 0.2;
      context.lineWidth = 2.5;
      path(levels, mean_shares);
      if (from === null || to === null) return;
      context.beginPath();
      const x = plot.x(levels[levels.length - 1]);
      plot.segment(x, plot.y(Math.max(from, low)), x, plot.y(to));
      context.stroke();
    });
    context.globalAlpha = 1;
  });
  redraws.push(() => plot.redraw());
  return panel("Levels on the way", "Probability of reaching each level: thin lines are estimates, the thick one is their mean. The bar is the interval of the answer.", plot.root);
}

function makeEstimates(rare: Rare, isShown: (design: number) => boolean, choose: (design: number) => void, redraws: (() => void)[]): HTMLElement {
  const { designs } = rare;
  const last = ({ shares, levels }: RareDesign) => shares.map((own) => (own.length < levels.length ? 0 : own[own.length - 1]));
  const all = designs.flatMap((one) => [...last(one), ...known(one.answer.slice(0, 3))]);
  const [low, high] = [least(all), Math.max(...all, 1e-12) * 2];
  const plot = new Plot("Probability of each design with its interval", () => 70 + Math.max(28, Math.min(44, 300 / designs.length)) * designs.length, () => {
    const names = designs.map((_, i): [number, string] => [designs.length - i - 0.5, designs.length > 1 ? `#${i}` : ""]);
    plot.axes({ title: "probability", log: true, range: [low, Math.min(1.2, high)], text: chanceTick }, { title: "", range: [0, designs.length], names });
    const { context } = plot;
    designs.forEach((one, i) => {
      const y = plot.y(names[i][0]);
      const [probability, from, to] = one.answer;
      context.strokeStyle = context.fillStyle = colour(i);
      context.lineWidth = 2;
      const dot = (value: number, size: number, alpha: number) => {
        context.globalAlpha = isShown(i) ? alpha : 0.2 * alpha;
        context.beginPath();
        context.arc(plot.x(Math.max(value, low)), y, size, 0, 7);
        context.fill();
      };
      for (const value of last(one)) dot(value, 3, 0.4);
      if (from !== null && to !== null) {
        context.globalAlpha = isShown(i) ? 1 : 0.2;
        context.beginPath();
        plot.segment(plot.x(Math.max(from, low)), y, plot.x(to), y);
        context.stroke();
      }
      if (probability) dot(probability, 6, 1);
    });
    context.globalAlpha = 1;
  });
  listenToPointer(plot.canvas, { click: (x, y) => choose(Math.floor(designs.length - plot.at(x, y)[1])) });
  redraws.push(() => plot.redraw());
  return panel(designs.length > 1 ? "Designs" : "Estimates", "A dot is an independent estimate, the bar the interval of their mean. An estimate of 0 is at the left edge. Click to show one design alone.", plot.root);
}

function makeLevels(rare: Rare, isShown: (design: number) => boolean, redraws: (() => void)[]): HTMLElement {
  const body = element("div", {});
  const draw = () => {
    const rows = rare.designs.flatMap((design, i) => (isShown(i) ? design.levels.map((level, number) => {
      const found = design.reached.filter((counts) => counts.length > number && (number === 0 || counts[number - 1] > 0)).map((counts) => counts[number] / rare.each);
      const mean = found.length ? found.reduce((sum, one) => sum + one, 0) / found.length : null;
      return [i, joined(digits(level), rare.unit), mean === null ? null : percent(mean), found.length ? `${percent(Math.min(...found))} to ${percent(Math.max(...found))}` : null, found.length];
    }) : []));
    body.replaceChildren(makeSmallTable(["design", "level", "reach it", "least and greatest share", "estimates that reached the level before"], rows));
  };
  redraws.push(draw);
  draw();
  return panel("Levels", "The share of the missions starting for a level that reach it. A fifth to a third is good; if one is far from that, other levels give a smaller error.", body);
}

function makeReplays(rare: Rare): HTMLElement {
  const commands = rare.designs.flatMap((one, i) => (one.command ? [element("p", {}, `A mission of #${i} that reached the last level:`), makeCommand(one.command)] : []));
  const text = commands.length ? "These commands fly a mission again, with pictures and all results; then `mebots report` on its folder writes a page." : "No mission reached the last level, or only another config could fly it again.";
  return panel("Replay the event", text, ...commands);
}
