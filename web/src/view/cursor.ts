// SPDX-License-Identifier: Apache-2.0
// Draws two lines across a plot: at the shown time, and at the time under the pointer. The pointer may be on another
// plot.
import type { Clock } from "../clock";
import { element } from "../dom";
import type { Window } from "./window";

/** Adds two vertical lines to an area that spans the times of `window`: at the shown time, and at the time under the
 * pointer. */
export function addCursors(area: HTMLElement, clock: Clock, window: Window): void {
  const moment = element("div", { class: "moment" });
  const pointed = element("div", { class: "pointed" });
  area.append(moment, pointed);
  const place = (line: HTMLElement, time: number | null) => {
    const share = time === null ? -1 : (time - window.start) / (window.stop - window.start);
    line.style.display = share < 0 || share > 1 ? "none" : "block";
    line.style.left = `${100 * share}%`;
  };
  const showMoment = () => place(moment, clock.time);
  const showPointed = () => place(pointed, window.pointed);
  clock.onTime(showMoment);
  window.onPoint(showPointed);
  window.onChange(() => {
    showMoment();
    showPointed();
  });
  showMoment();
  showPointed();
}
