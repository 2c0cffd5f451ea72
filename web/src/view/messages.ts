// SPDX-License-Identifier: Apache-2.0
// Lists the messages of the FMUs and of the run. A click on a message sets the shown time to the time of the message.
import type { Clock } from "../clock";
import { shortText } from "../data/messages";
import type { Run } from "../data/run";
import { shownTime } from "../data/units";
import { element } from "../dom";

export function makeMessages(run: Run, clock: Clock): HTMLElement {
  const root = element("div", { class: "messages scroll" });
  let rows = rowsOf(run, clock);
  const fill = () => {
    rows = rowsOf(run, clock);
    root.replaceChildren(rows.length > 0
      ? element("table", {}, element("tbody", {}, ...rows.map(({ row }) => row))) : element("p", { class: "empty" }, "No messages."));
  };
  let last: HTMLElement | null = null;
  clock.onTime((time) => {
    const said = rows.filter((entry) => entry.time !== null && entry.time <= time + 1e-9);
    const row = said.length > 0 ? said[said.length - 1].row : null;
    if (row === last) return;
    last?.classList.remove("now-row");
    row?.classList.add("now-row");
    last = row;
    if (row && root.offsetParent !== null) root.scrollTop = row.offsetTop - root.clientHeight / 2;
  });
  run.onData(() => {
    if (rows.length !== run.messages.length) fill();
  });
  fill();
  return root;
}

function rowsOf(run: Run, clock: Clock): { row: HTMLElement; time: number | null }[] {
  return run.messages.map((message) => {
    const row = element("tr", { class: message.severity },
      element("td", { class: "number" }, message.time === null ? "" : shownTime(message.time)),
      element("td", { class: "who" }, message.instance), element("td", { title: message.text }, shortText(message)));
    if (message.time !== null) row.addEventListener("click", () => clock.set(message.time!));
    return { row, time: message.time };
  });
}
