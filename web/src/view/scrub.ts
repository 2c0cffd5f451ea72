// SPDX-License-Identifier: Apache-2.0
// Handles the pointer on elements with a time axis. On a plot, dragging selects a time span, and a click sets the shown
// time. On the timeline, dragging moves the shown time. Shift exchanges these two actions. A finger moves the shown
// time. Two fingers zoom, as does the wheel with ctrl or shift. A double click shows the whole run.
import type { Clock } from "../clock";
import { element } from "../dom";
import type { Window } from "./window";

/** A press with less movement of the mouse is a click [px]. */
const CLICK = 4;

interface Options {
  /** The action of dragging with the mouse without shift: "chooses" selects a time span, "moves" moves the shown
   * time. */
  drag: "chooses" | "moves";
  /** The time span from the left to the right end of the element. The default is the span of `window`. */
  along?: Window;
}

export function makeScrubbable(target: HTMLElement, clock: Clock, window: Window, { drag, along = window }: Options): void {
  const shareAt = (event: MouseEvent) => {
    const box = target.getBoundingClientRect();
    return Math.min(Math.max((event.clientX - box.left) / Math.max(1, box.width), 0), 1);
  };
  const timeAt = (event: MouseEvent) => along.start + shareAt(event) * (along.stop - along.start);
  const fingers = new Map<number, PointerEvent>(); // pressed fingers, or the pressed mouse button
  let marked: { from: PointerEvent; box: HTMLElement } | null = null; // span that the present drag selects
  const isDrag = (event: MouseEvent) => Math.abs(event.clientX - marked!.from.clientX) >= CLICK;
  const showMarked = (event: MouseEvent) => {
    const [low, high] = [shareAt(marked!.from), shareAt(event)].sort((a, b) => a - b);
    marked!.box.hidden = !isDrag(event);
    marked!.box.style.left = `${100 * low}%`;
    marked!.box.style.width = `${100 * (high - low)}%`;
  };
  const moveTo = (event: MouseEvent) => {
    clock.pause();
    clock.set(timeAt(event));
  };
  const spread = () => {
    const [one, other] = [...fingers.values()];
    return Math.max(8, Math.abs(one.clientX - other.clientX));
  };
  target.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || fingers.size === 2) return;
    target.setPointerCapture(event.pointerId);
    if (event.pointerType === "mouse" && (drag === "chooses") !== event.shiftKey) {
      marked = { from: event, box: element("div", { class: "marked", hidden: "" }) };
      target.append(marked.box);
      return;
    }
    fingers.set(event.pointerId, event);
    if (fingers.size === 1) moveTo(event);
  });
  target.addEventListener("pointermove", (event) => {
    if (event.pointerType === "mouse") window.point(timeAt(event));
    if (marked) return showMarked(event);
    if (!fingers.has(event.pointerId)) return;
    if (fingers.size === 1) return clock.set(timeAt(event));
    const before = spread();
    fingers.set(event.pointerId, event);
    const [one, other] = [...fingers.values()].map(timeAt);
    window.zoom(before / spread(), (one + other) / 2);
  });
  target.addEventListener("pointerleave", () => window.point(null));
  for (const end of ["pointerup", "pointercancel"] as const) {
    target.addEventListener(end, (event) => {
      fingers.delete(event.pointerId);
      if (!marked) return;
      const [low, high] = [timeAt(marked.from), timeAt(event)].sort((a, b) => a - b);
      const wasDrag = isDrag(event);
      marked.box.remove();
      marked = null;
      if (end === "pointercancel") return;
      if (wasDrag && high > low) window.set(low, high);
      else moveTo(event);
    });
  }
  target.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey && !event.shiftKey) return; // lets the page scroll
      event.preventDefault();
      window.zoom(Math.exp((event.deltaY || event.deltaX) / 300), timeAt(event));
    },
    { passive: false },
  );
  target.addEventListener("dblclick", () => window.reset());
}
