// SPDX-License-Identifier: Apache-2.0
import { element } from "../dom";

export function panel(title: string, text: string, ...children: (Node | string)[]): HTMLElement {
  return element("section", { class: "panel" }, element("h2", {}, title), element("p", { class: "note" }, text), ...children);
}

/** Creates two columns of panels. `isRight` selects the panels of the second column. In a narrow page, all panels are
 * in one column, in the given order. */
export function makeColumns(panels: HTMLElement[], isRight = (_: HTMLElement, i: number) => i % 2 === 1): HTMLElement {
  panels.forEach((one, i) => (one.style.order = String(i)));
  const [left, right] = [panels.filter((one, i) => !isRight(one, i)), panels.filter(isRight)];
  return element("div", { class: "panels-grid" }, element("div", { class: "column" }, ...left), element("div", { class: "column" }, ...right));
}

export function makeChoice(label: string, names: string[], start: number, change: (value: number) => void): HTMLElement {
  const box = element("select", { onchange: () => change(Number(box.value)) });
  names.forEach((name, i) => box.append(element("option", { value: String(i), ...(i === start ? { selected: "" } : {}) }, name)));
  return element("label", { class: "choice" }, `${label} `, box);
}

export interface Tooltip {
  show(event: PointerEvent, title: string, lines: string[]): void;
  hide(): void;
}

export function makeTooltip(): Tooltip {
  const root = element("div", { class: "tooltip", hidden: "" });
  return {
    show(event, title, lines) {
      if (!root.isConnected) document.body.append(root);
      root.replaceChildren(element("b", {}, title), ...lines.map((line) => element("div", {}, line)));
      root.hidden = false;
      const { width, height } = root.getBoundingClientRect();
      root.style.left = `${Math.max(4, Math.min(event.clientX + 14, innerWidth - width - 8))}px`;
      root.style.top = `${event.clientY + 18 + height > innerHeight ? event.clientY - height - 10 : event.clientY + 18}px`;
    },
    hide() {
      root.hidden = true;
    },
  };
}

/** Creates a command and a button that copies it. */
export function makeCommand(text: string): HTMLElement {
  const code = element("code", {}, text);
  const button = element("button", { class: "copy", onclick: () => void copy() }, "copy");
  const copy = async () => {
    try {
      await navigator.clipboard.writeText(text);
      button.textContent = "copied";
    } catch {
      getSelection()?.selectAllChildren(code); // if the browser forbids copying, selects the text for the keyboard
      button.textContent = "selected";
    }
    setTimeout(() => (button.textContent = "copy"), 1500);
  };
  return element("div", { class: "command" }, code, button);
}

/** Creates a table. Numbers are right-aligned. */
export function makeSmallTable(heads: string[], rows: (string | number | null)[][]): HTMLElement {
  const cell = (value: string | number | null) => element("td", typeof value === "number" || /^[\u2212–\d]/.test(value ?? "–") ? { class: "number" } : {}, String(value ?? "–"));
  return element("div", { class: "scroll" }, element("table", {},
    element("thead", {}, element("tr", {}, ...heads.map((head) => element("th", {}, head)))),
    element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map(cell))))));
}
