// SPDX-License-Identifier: Apache-2.0
// The pointer on anything that lies along time: drag moves the moment; shift and drag, the wheel or two fingers zoom in; double
// click shows all again.
import type { Clock } from "../clock";
import { element } from "../dom";
import type { Window } from "./window";

/** `left` and `right` [px]: margins of the element outside the time axis. */
export function makeScrubbable(target: HTMLElement, clock: Clock, window: Window, left = 0, right = 0): void {
  const timeAt = (event: MouseEvent) => {
    const box = target.getBoundingClientRect();
    const share = (event.clientX - box.left - left) / Math.max(1, box.width - left - right);
    return window.start + Math.min(Math.max(share, 0), 1) * (window.stop - window.start);
  };
  const fingers = new Map<number, PointerEvent>(); // or the mouse
  let marked: { from: number; box: HTMLElement } | null = null; // a span that shift and drag choose
  const showMarked = (event: MouseEvent) => {
    const share = (time: number) => (time - window.start) / (window.stop - window.start);
    const [low, high] = [marked!.from, timeAt(event)].sort((a, b) => a - b);
    const width = target.getBoundingClientRect().width - left - right;
    marked!.box.style.left = `${left + width * share(low)}px`;
    marked!.box.style.width = `${width * (share(high) - share(low))}px`;
  };
  const spread = () => {
    const [one, other] = [...fingers.values()];
    return Math.max(8, Math.abs(one.clientX - other.clientX));
  };
  target.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || fingers.size === 2) return;
    if (event.shiftKey && fingers.size === 0) {
      marked = { from: timeAt(event), box: element("div", { class: "marked" }) };
      target.append(marked.box);
      target.setPointerCapture(event.pointerId);
      return;
    }
    fingers.set(event.pointerId, event);
    target.setPointerCapture(event.pointerId);
    clock.pause();
    if (fingers.size === 1) clock.set(timeAt(event));
  });
  target.addEventListener("pointermove", (event) => {
    if (marked) return showMarked(event);
    if (!fingers.has(event.pointerId)) return;
    if (fingers.size === 1) return clock.set(timeAt(event));
    const before = spread();
    fingers.set(event.pointerId, event);
    const [one, other] = [...fingers.values()].map(timeAt);
    window.zoom(before / spread(), (one + other) / 2);
  });
  for (const end of ["pointerup", "pointercancel"] as const) {
    target.addEventListener(end, (event) => {
      fingers.delete(event.pointerId);
      if (!marked) return;
      const [low, high] = [marked.from, timeAt(event)].sort((a, b) => a - b);
      marked.box.remove();
      marked = null;
      if (end === "pointerup" && high > low) window.set(low, high);
    });
  }
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
