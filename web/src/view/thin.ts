// SPDX-License-Identifier: Apache-2.0
// A note for recordings that are too long for a page. Such a page contains only extremes and smaller pictures. If the
// user zooms in, the note names the command for a page with all values.
import type { Run } from "../data/run";
import { element } from "../dom";
import type { Window } from "./window";

export function makeThinNote(run: Run, window: Window): HTMLElement {
  const note = element("p", { class: "thin-note", hidden: "" });
  const show = () => {
    const { header } = run;
    const isWhole = header.whole?.some(([from, to]) => from <= window.start && window.stop <= to);
    const parts = [];
    if (header.span > 1) parts.push(`The page has the smallest and the largest numbers of every ${header.span} rows.`);
    if (run.pictures.some(({ shrunk }) => shrunk > 1)) parts.push("Pictures are reduced in size.");
    if (run.pictureEvery > 1) parts.push(`The page has one of every ${run.pictureEvery} pictures.`);
    note.hidden = parts.length === 0 || window.isWhole || isWhole || header.live != null;
    if (note.hidden) return;
    note.replaceChildren(`${parts.join(" ")} To see all rows of this time span: `,
      element("code", {}, `mebots report ${run.name} --detail ${rounded(window.start, Math.floor)}:${rounded(window.stop, Math.ceil)}`));
  };
  window.onChange(show);
  show();
  return note;
}

const rounded = (time: number, to: (value: number) => number) => to(time * 1000) / 1000;
