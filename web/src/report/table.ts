// SPDX-License-Identifier: Apache-2.0
// The ranked table of designs. The document contains only the rows in view, so that thousands of rows scroll smoothly.
import { element } from "../dom";
import type { Study } from "./content";
import { factorText, objectiveText, titleOf } from "./format";
import { PLACES } from "./fronts";
import type { Selection } from "./selection";

const ROW = 28; // height of a row in pixels, as in report.css
const MOST_ROWS_IN_VIEW = 12;
const LONGEST = 46; // maximum number of characters in a column
const NARROW = 620; // width of a narrow page in pixels, as in report.css

interface Column {
  title: string;
  text(design: number): string;
  /** The value by which the table is sorted. */
  value(design: number): number | string | null;
  isNumber: boolean;
  /** The order after a first click on the title: 1 for ascending, -1 for descending. For an objective, better values
   * come first. */
  sign: number;
}

export function makeTable(study: Study, selection: Selection): HTMLElement {
  const columns = columnsOf(study);
  const widths = columns.map(({ title, text }) => {
    let most = Math.max(5, title.length + 2);
    for (let i = 0; i < selection.size; ++i) most = Math.max(most, text(i).length);
    return `${0.86 * Math.min(most, LONGEST) + 3}ch`; // most letters are narrower than a digit
  });
  const template = `34px ${widths.join(" ")}`;
  let [by, sign] = [0, 1];
  let order: number[] = [];
  let search = "";
  const heads = columns.map(({ title, isNumber }, i) =>
    element("button", { role: "columnheader", class: isNumber ? "number" : "", title: `sort by ${title}`, onclick: () => sortBy(i) }));
  const head = element("div", { class: "row head", role: "row", style: `grid-template-columns:${template}` }, element("span", { role: "columnheader" }), ...heads);
  const space = element("div", { class: "space" });
  const view = element("div", { class: "view", role: "grid", tabindex: "0", "aria-label": "designs", "aria-rowcount": String(selection.size) }, head, space);
  view.style.height = `${(Math.min(selection.size, MOST_ROWS_IN_VIEW) + 1) * ROW + 18}px`; // with every selection, so that no panel moves under a brush
  const status = element("span", { class: "faint" });

  const sort = () => {
    const { value } = columns[by];
    const words = search.toLowerCase().split(/\s+/).filter(Boolean);
    const fits = (i: number) => words.every((word) => columns.some(({ text }) => text(i).toLowerCase().includes(word)));
    order = selection.designs.filter((i) => words.length === 0 || fits(i)).sort((a, b) => {
      const [first, second] = [value(a), value(b)];
      if (first === second) return a - b;
      if (first === null || second === null) return first === null ? 1 : -1;
      return sign * (first < second ? -1 : 1);
    });
    heads.forEach((button, i) => {
      button.setAttribute("aria-sort", i !== by ? "none" : sign > 0 ? "ascending" : "descending");
      button.textContent = columns[i].title + (i !== by ? "" : sign > 0 ? " \u25b4" : " \u25be");
    });
    space.style.height = `${order.length * ROW}px`;
    const thinned = study.designs.of > selection.size ? ` The page has ${selection.size.toLocaleString("en")} of ${study.designs.of.toLocaleString("en")} designs: the best ones, those on the front, and every n-th of the others; designs.csv has all.` : "";
    status.textContent = `${order.length.toLocaleString("en")} of ${selection.size.toLocaleString("en")} designs.${thinned}`;
    draw();
  };
  const sortBy = (column: number) => {
    sign = column === by ? -sign : columns[column].sign;
    by = column;
    sort();
  };
  const draw = () => {
    const first = Math.max(0, Math.floor(view.scrollTop / ROW) - 3);
    const rows = order.slice(first, first + MOST_ROWS_IN_VIEW + 8).map((design, i) => makeRow(design, first + i));
    space.replaceChildren(...rows);
  };
  const makeRow = (design: number, place: number) => {
    const mission = { design, replicate: 0 };
    const box = element("input", { type: "checkbox", tabindex: "-1", "aria-label": `compare design ${study.designs.number[design]}`, onclick: (event) => event.stopPropagation(), onchange: () => selection.tick(mission) });
    box.checked = selection.isTicked(mission);
    const cells = columns.map(({ text, isNumber }) => element("span", { role: "gridcell", class: isNumber ? "number" : "", title: text(design) }, text(design)));
    return element("div", {
      class: `row ${design === selection.chosen ? "chosen" : ""}`, role: "row", "aria-rowindex": String(place + 1), "aria-selected": String(design === selection.chosen),
      "data-design": String(study.designs.number[design]), style: `top:${place * ROW}px;grid-template-columns:${template}`, onclick: () => selection.choose(design),
    }, element("span", {}, ...(study.replay?.designs[design] != null ? [box] : [])), ...cells);
  };
  const move = (steps: number) => {
    if (order.length === 0) return;
    const place = Math.min(order.length - 1, Math.max(0, order.indexOf(selection.chosen) + steps));
    selection.choose(order[place]);
    const top = place * ROW;
    if (top < view.scrollTop || top > view.scrollTop + view.clientHeight - 2 * ROW) view.scrollTop = top - 4 * ROW;
  };
  view.addEventListener("scroll", draw);
  view.addEventListener("keydown", (event) => {
    if (event.target !== view) return;
    const keys: Record<string, () => void> = {
      ArrowDown: () => move(1), ArrowUp: () => move(-1), PageDown: () => move(10), PageUp: () => move(-10), Home: () => move(-Infinity), End: () => move(order.length),
      " ": () => selection.chosen >= 0 && selection.tick({ design: selection.chosen, replicate: 0 }),
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
  selection.onChange(sort);
  const field = element("input", { type: "search", placeholder: "search in the table", "aria-label": "search in the table", oninput: () => ((search = field.value), sort()) });
  sort();
  return element("div", { class: "designs" }, element("div", { class: "choices" }, field, status), view);
}

function columnsOf(study: Study): Column[] {
  const { designs } = study;
  const number = (title: string, value: (i: number) => number | null): Column =>
    ({ title, value, isNumber: true, sign: 1, text: (i) => value(i)?.toLocaleString("en") ?? "\u2013" });
  const text = (title: string, value: (i: number) => string): Column => ({ title, value, isNumber: false, sign: 1, text: value });
  const objectives = study.objectives.map((one): Column => ({
    title: titleOf({ ...one, unit: "" }), value: (i) => one.mean[i], isNumber: true, sign: one.sense > 0 || one.share ? -1 : 1, text: (i) => one.text[i],
  }));
  const factors = study.factors.map((one): Column => {
    const value = (i: number) => (typeof one.values[i] === "number" ? (one.values[i] as number) : String(one.values[i]));
    return { title: one.label, value, isNumber: one.number, sign: 1, text: (i) => factorText(one, one.values[i]) };
  });
  const failed = designs.failed.some((count) => count > 0) ? [number("failed", (i) => designs.failed[i])] : [];
  const front = designs.front.some((place) => place !== "") ? [text("front", (i) => PLACES[designs.front[i] || "undecided"])] : [];
  const rank = number("rank", (i) => designs.rank[i]);
  const place = { ...number("#", (i) => designs.number[i]), text: (i: number) => `#${designs.number[i]}` };
  const name = text("design", (i) => designs.name[i]);
  const note = text("note", (i) => designs.note[i]);
  const first = study.objectives.findIndex(({ sense }) => sense !== 0);
  const value = first < 0 ? [] : [{ ...objectives[first], text: (i: number) => objectiveText(study.objectives[first], study.objectives[first].mean[i]) }];
  return [
    ...(innerWidth < NARROW ? [rank, ...value, name, place, note] : [rank, place, name, note]), // the value is in view on a phone, too
    ...objectives, number("missions", (i) => designs.missions[i]), ...failed, ...front, text("status", (i) => designs.status[i]), ...factors,
  ];
}
