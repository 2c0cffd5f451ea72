// SPDX-License-Identifier: Apache-2.0
// A table of the drones in a scene: the nearest other drone, the number of crashes, and the drone's variables from the
// groups of the config's summary.
import type { Clock } from "../clock";
import type { Run } from "../data/run";
import { shown } from "../data/units";
import { element } from "../dom";
import type { Stage } from "../scene/stage";

/** Returns the variable of a group for a body: the member with the body's name, or with the index in this name. */
function memberFor(members: Record<string, string>, body: string): string | undefined {
  return members[body] ?? members[/\[(\d+)\]$/.exec(body)?.[1] ?? ""];
}

export function makeDrones(run: Run, clock: Clock, stage: Stage): HTMLElement {
  const bodies = stage.bodies;
  const groups = (run.system?.view.groups ?? []).filter(({ members }) => Object.values(members).some((name) => run.has(name)));
  const crashes = bodies.map(({ name }) =>
    run.messages.filter(({ text, time }) => time !== null && text.startsWith(`${name}: `) && /\bcrash\b/.test(text)).map(({ time }) => time!));
  const rows = bodies.map(({ name }, i) => {
    const cells = Array.from({ length: 3 + groups.length }, () => element("td", { class: "number" }));
    const choose = element("button", { title: `Follow ${name}`, "data-body": name, onclick: () => stage.choose(i) }, name);
    return { row: element("tr", {}, element("td", {}, choose), ...cells), cells };
  });
  const show = () => {
    if (root.offsetParent === null) return;
    const places = bodies.map(({ position }) => position(clock.time));
    rows.forEach(({ row, cells }, i) => {
      row.classList.toggle("chosen", i === stage.chosenBody);
      const distances = places.map((place, other) => (other === i ? Infinity : place.distanceTo(places[i])));
      const nearest = distances.indexOf(Math.min(...distances));
      cells[0].textContent = shown(distances[nearest], "m");
      cells[1].textContent = bodies[nearest].name;
      cells[2].textContent = String(crashes[i].filter((time) => time <= clock.time).length);
      groups.forEach(({ members }, column) => {
        const variable = memberFor(members, bodies[i].name);
        cells[3 + column].textContent = variable !== undefined && run.has(variable) ? run.textAt(variable, clock.time) : "";
      });
    });
  };
  const heads = ["drone", "distance to the nearest", "which", "crashes", ...groups.map(({ label }) => label.replaceAll("_", " "))];
  const root = element("div", { class: "drones scroll" },
    element("table", {}, element("thead", {}, element("tr", {}, ...heads.map((head) => element("th", {}, head)))), element("tbody", {}, ...rows.map(({ row }) => row))));
  clock.onTime(show);
  stage.onChoice(show);
  new ResizeObserver(show).observe(root);
  return root;
}
