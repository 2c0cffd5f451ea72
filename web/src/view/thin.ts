// SPDX-License-Identifier: Apache-2.0
// Of a recording that is too long for a page the extremes are here: who looks closer is told how to get every row.
import type { Run } from "../data/run";
import { element } from "../dom";
import type { Window } from "./window";

export function makeThinNote(run: Run, window: Window): HTMLElement {
  const note = element("p", { class: "thin-note", hidden: "" });
  const show = () => {
    const { header } = run;
    const isWhole = header.whole?.some(([from, to]) => from <= window.start && window.stop <= to);
    note.hidden = header.span <= 1 || window.isWhole || isWhole || header.live != null;
    if (note.hidden) return;
    note.replaceChildren(`Of every ${header.span} rows the least and the greatest numbers are here. Every row of what you look at: `,
      element("code", {}, `mebots report ${run.name} --detail ${rounded(window.start, Math.floor)}:${rounded(window.stop, Math.ceil)}`));
  };
  window.onChange(show);
  show();
  return note;
}

const rounded = (time: number, to: (value: number) => number) => to(time * 1000) / 1000;
