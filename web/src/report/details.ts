// SPDX-License-Identifier: Apache-2.0
// Shows the chosen design with its missions, and the commands that repeat and compare missions.
import { element } from "../dom";
import type { Objective, Study } from "./content";
import { counted, factorText, objectiveText, titleOf } from "./format";
import { firstOf } from "./distributions";
import { PLACES } from "./fronts";
import type { Mission, Selection } from "./selection";
import { makeCommand, makeSmallTable } from "./widgets";

const ROWS_AT_ONCE = 100;

export function makeDetails(study: Study, selection: Selection): HTMLElement {
  const root = element("aside", { class: "details", hidden: "", "aria-label": "the chosen design" });
  let shown = -1;
  const draw = () => {
    const design = selection.chosen;
    root.hidden = design < 0;
    document.body.classList.toggle("with-details", design >= 0);
    if (design < 0 || design === shown) return void (shown = design);
    shown = design;
    const { designs } = study;
    const close = element("button", { class: "close", "aria-label": "close", onclick: () => selection.choose(-1) }, "\u00d7");
    const place = designs.front[design];
    root.replaceChildren(
      element("header", {}, element("h2", {}, `Design #${designs.number[design]}${designs.rank[design] === null ? "" : `, rank ${designs.rank[design]}`}`), close),
      element("p", {}, [designs.name[design], designs.note[design], place ? PLACES[place] : "", `${counted(designs.missions[design], "mission")}, ${designs.failed[design]} failed, ${designs.status[design]}`].filter(Boolean).join("; ") + "."),
      makeSmallTable(["factor", "value"], study.factors.map((factor) => [factor.label, factorText(factor, factor.values[design])])),
      makeSmallTable(["objective", "value and interval"], study.objectives.map((one) => [titleOf({ ...one, unit: "" }), one.text[design]])),
      ...(study.missions ? [makeMissions(study, selection, design)] : []),
    );
  };
  selection.onChange(draw);
  return root;
}

/** Creates the sortable table of a design's missions. A click on a mission shows the command that repeats the mission. */
function makeMissions(study: Study, selection: Selection, design: number): HTMLElement {
  const missions = study.missions!;
  const start = firstOf(missions.counts)[design];
  const count = missions.counts[design];
  const replicates = Array.from({ length: count }, (_, i) => i);
  const valueOf = (row: number, column: number): number | string | null =>
    column === 0 ? row * missions.every : column === 1 && missions.outcomes.length ? missions.outcomes[missions.outcome[start + row]] : missions.values[column - 1 - (missions.outcomes.length ? 1 : 0)][start + row];
  const heads = ["mission", ...(missions.outcomes.length ? ["outcome"] : []), ...study.objectives.map(({ label }) => label)];
  let [by, sign, rows, opened] = [0, 1, ROWS_AT_ONCE, -1];
  const command = element("div", {});
  const body = element("tbody", {});
  const more = element("button", { onclick: () => ((rows += ROWS_AT_ONCE), draw()) }, "show more");

  const open = (replicate: number) => {
    opened = replicate;
    command.replaceChildren(...replayTexts(study, { design, replicate }));
    draw();
  };
  const makeRow = (row: number) => {
    const mission = { design, replicate: row * missions.every };
    const box = element("input", { type: "checkbox", "aria-label": `compare mission ${mission.replicate}`, onclick: (event) => event.stopPropagation(), onchange: () => selection.tick(mission) });
    box.checked = selection.isTicked(mission);
    const cells = study.objectives.map((one, i) => element("td", { class: "number" }, missionText(one, missions.values[i][start + row])));
    const button = element("button", { class: "link", "aria-label": `replay mission ${mission.replicate}` }, `\u25b6 ${mission.replicate}`);
    return element("tr", { class: mission.replicate === opened ? "chosen" : "", onclick: () => open(mission.replicate) },
      element("td", {}, box), element("td", {}, button), ...(missions.outcomes.length ? [element("td", {}, String(valueOf(row, 1)).replaceAll("_", " "))] : []), ...cells);
  };
  const draw = () => {
    const order = [...replicates].sort((a, b) => {
      const [first, second] = [valueOf(a, by), valueOf(b, by)];
      if (first === second) return a - b;
      if (first === null || second === null) return first === null ? 1 : -1;
      return sign * (first < second ? -1 : 1);
    });
    body.replaceChildren(...order.slice(0, rows).map(makeRow));
    more.hidden = rows >= count;
  };
  const sortBy = (column: number) => {
    sign = by === column ? -sign : 1;
    by = column;
    draw();
  };
  draw();
  const thin = missions.every > 1 ? ` Every ${missions.every}th mission is in this page.` : "";
  return element("div", {}, element("h3", {}, "Missions"),
    element("p", { class: "note" }, `Click one to replay it; tick several to compare them.${thin}`), command,
    element("div", { class: "scroll missions" }, element("table", {},
      element("thead", {}, element("tr", {}, element("th", {}), ...heads.map((head, i) => element("th", {}, element("button", { class: "link", onclick: () => sortBy(i) }, head))))), body)), more);
}

/** Formats a value of one mission. In one mission, a share is 0 or 1. */
const missionText = (objective: Objective, value: number | null) => (objective.share && value !== null ? (value ? "yes" : "no") : objectiveText(objective, value));

const folderOf = (study: Study, { design, replicate }: Mission) => `design_${study.designs.number[design]}_mission_${replicate}`;

/** Returns the command that repeats a mission. If a factor changes the config itself, or if the page lacks the
 * values that were drawn for the mission, returns null. */
function commandOf(study: Study, mission: Mission): string | null {
  const { replay } = study;
  const [own, draws] = [replay?.designs[mission.design], replay?.draws[mission.replicate]];
  if (!replay || own == null || draws === undefined) return null;
  return [replay.run, "--out", `${replay.folder}/${folderOf(study, mission)}`, own, draws].filter(Boolean).join(" ");
}

function replayTexts(study: Study, mission: Mission): HTMLElement[] {
  const command = commandOf(study, mission);
  const name = `Mission ${mission.replicate} of design #${study.designs.number[mission.design]}`;
  if (command === null) return [element("p", {}, `${name}: no command can repeat it, because a factor changes the config itself, or because this page lacks some of the draws. missions.csv has its values.`)];
  const folder = folderOf(study, mission);
  const page = `${study.replay!.name}/${folder}/flight.html`;
  const isThere = study.replay!.pages.includes(page);
  return [
    element("p", {}, `${name} again, with pictures and all results, and its page:`),
    makeCommand(`${command} && mebots report ${study.replay!.folder}/${folder}`),
    element("p", {}, isThere ? "It was flown before: " : "Then open ", element("a", { href: page, target: "_blank" }, page), "."),
    element("p", {}, "Or watch it while it flies; it starts when a browser opens the address that it prints:"),
    makeCommand(`${command} --live`),
  ];
}

/** Creates a bar that is visible while missions are ticked, and a dialog with commands that compare these missions. */
export function makeComparison(study: Study, selection: Selection): HTMLElement {
  const body = element("div", {});
  const dialog = element("dialog", { class: "compare" }, element("header", {}, element("h2", {}, "Compare missions"),
    element("button", { class: "close", "aria-label": "close", onclick: () => dialog.close() }, "\u00d7")), body);
  const text = element("span", {});
  const bar = element("div", { class: "compare-bar", hidden: "" }, text,
    element("button", { class: "primary", onclick: () => dialog.showModal() }, "commands"), element("button", { onclick: () => selection.clearTicks() }, "clear"));
  const draw = () => {
    const { ticked } = selection;
    bar.hidden = ticked.length === 0;
    text.textContent = `${counted(ticked.length, "mission")} ticked`;
    const commands = ticked.map((mission) => commandOf(study, mission)).filter((one) => one !== null);
    if (commands.length === 0) return body.replaceChildren(element("p", {}, "No command can repeat these missions."));
    const folders = ticked.map((mission) => `${study.replay!.folder}/${folderOf(study, mission)}`);
    const page = `${study.replay!.name}/${ticked.length > 1 ? "compared.html" : `${folderOf(study, ticked[0])}/flight.html`}`;
    const report = `mebots report ${folders.join(" ")}${ticked.length > 1 ? ` --out ${study.replay!.folder}/compared.html` : ""}`;
    body.replaceChildren(
      element("p", {}, "These lines fly the missions again and bring them into one scene, on one page, with the differences of all numbers. Missions with one number have the same draws."),
      makeCommand([...commands, report].join("\n")), element("p", {}, "Then open ", element("a", { href: page, target: "_blank" }, page), "."));
  };
  selection.onChange(draw);
  return element("div", {}, bar, dialog);
}
