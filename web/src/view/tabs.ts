// SPDX-License-Identifier: Apache-2.0
// Shows one of several views. Creates a view when it is shown for the first time.
import { element } from "../dom";

export interface Tab {
  name: string;
  content: () => HTMLElement;
}

export function makeTabs(tabs: Tab[]): { root: HTMLElement } {
  const body = element("div", { class: "tab-body" });
  const made = new Map<string, HTMLElement>();
  const buttons = tabs.map((tab) => element("button", { role: "tab", "data-tab": tab.name, onclick: () => choose(tab) }, tab.name));
  const choose = (chosen: Tab) => {
    const content = made.get(chosen.name) ?? chosen.content();
    made.set(chosen.name, content);
    body.replaceChildren(content);
    buttons.forEach((button, i) => button.setAttribute("aria-selected", String(tabs[i] === chosen)));
  };
  choose(tabs[0]);
  return { root: element("div", { class: "tabs" }, element("nav", { role: "tablist" }, ...buttons), body) };
}
