// SPDX-License-Identifier: Apache-2.0
// The pointer on anything that lies along time: drag moves the moment, wheel looks closer, double click shows all again.
import type { Clock } from "../clock";
import type { Window } from "./window";

/** `left` and `right` [px]: what of the element's width is no time. */
export function makeScrubbable(target: HTMLElement, clock: Clock, window: Window, left = 0, right = 0): void {
  const timeAt = (event: MouseEvent) => {
    const box = target.getBoundingClientRect();
    const share = (event.clientX - box.left - left) / Math.max(1, box.width - left - right);
    return window.start + Math.min(Math.max(share, 0), 1) * (window.stop - window.start);
  };
  let dragging = false;
  target.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    dragging = true;
    target.setPointerCapture(event.pointerId);
    clock.pause();
    clock.set(timeAt(event));
  });
  target.addEventListener("pointermove", (event) => {
    if (dragging) clock.set(timeAt(event));
  });
  for (const end of ["pointerup", "pointercancel"]) target.addEventListener(end, () => (dragging = false));
  target.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey && !event.shiftKey) return; // the page scrolls
      event.preventDefault();
      window.zoom(Math.exp((event.deltaY || event.deltaX) / 300), timeAt(event));
    },
    { passive: false },
  );
  target.addEventListener("dblclick", () => window.reset());
}
