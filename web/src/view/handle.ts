// SPDX-License-Identifier: Apache-2.0
// A bar between two parts of the page, or below one, that a drag or the arrow keys move. A double click restores the size. The browser stores the
// size, and the next page starts with it.
import { element } from "../dom";
import { recalled, remember } from "../remembered";

const KEY_STEP = 16; // pixels per key press

interface Options {
  /** Describes the bar for screen readers, such as "height of the plot". The size is stored under this name. */
  label: string;
  /** The direction of movement. "x": the bar moves to the left and right. */
  axis: "x" | "y";
  /** The size that the bar changes [px]. */
  size: () => number;
  /** Sets the size [px]; null restores the initial size. */
  resize: (size: number | null) => void;
}

export function makeHandle({ label, axis, size, resize }: Options): HTMLElement {
  const bar = element("div", {
    class: `handle handle-${axis}`, role: "separator", tabindex: "0", "aria-label": label, "aria-orientation": axis === "x" ? "vertical" : "horizontal",
    title: `Drag: ${label}. Double click: as before`,
  });
  const place = (event: PointerEvent) => (axis === "x" ? event.clientX : event.clientY);
  let start: { at: number; size: number } | null = null;
  bar.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    event.preventDefault();
    bar.setPointerCapture(event.pointerId);
    start = { at: place(event), size: size() };
  });
  bar.addEventListener("pointermove", (event) => {
    if (start) resize(start.size + place(event) - start.at);
  });
  for (const end of ["pointerup", "pointercancel"] as const) {
    bar.addEventListener(end, () => {
      if (start && size() !== start.size) remember(label, size());
      start = null;
    });
  }
  bar.addEventListener("dblclick", () => {
    resize(null);
    remember(label, null);
  });
  const [less, more] = axis === "x" ? ["ArrowLeft", "ArrowRight"] : ["ArrowUp", "ArrowDown"];
  bar.addEventListener("keydown", (event) => {
    if (event.key !== less && event.key !== more) return;
    event.preventDefault();
    event.stopPropagation(); // otherwise, the page would change the shown time
    resize(size() + (event.key === more ? KEY_STEP : -KEY_STEP));
    remember(label, size());
  });
  const last = recalled(label);
  if (last !== null) requestAnimationFrame(() => resize(last)); // waits until the page has its layout
  return bar;
}
