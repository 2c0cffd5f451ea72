// SPDX-License-Identifier: Apache-2.0
// A bar that resizes a part of the page. A drag or the arrow keys move it. A double click restores the size. The
// browser stores the size for the next page.
import { element } from "../dom";
import { recalled, remember } from "../remembered";

const KEY_STEP = 16; // pixels per key press

interface Options {
  /** Describes the bar for screen readers, such as "height of the plot". Also the name under which the size is stored. */
  label: string;
  /** The direction of movement: "x" means left and right. */
  axis: "x" | "y";
  /** Returns the current size [px]. */
  size: () => number;
  /** Sets the size [px]. Null restores the initial size. */
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
