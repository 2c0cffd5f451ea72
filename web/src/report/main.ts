// SPDX-License-Identifier: Apache-2.0
// Builds the page of a study, of a replayed flight or of a deployed network.
import { element } from "../dom";
import { isDark, setTheme } from "../theme";
import type { NetworkPage } from "../network/content";
import { makeNetwork } from "../network/network";
import { type Page, type Rare, readPage, type ReplayedFlight, type Study } from "./content";
import { makeRare } from "./rare";
import { makeReplay } from "./replay";
import { makeStudy } from "./study";

const KEYS: [string, string][] = [
  ["tab, \u2191 \u2193", "in the table and on the front: choose a design"],
  ["space", "in the table: tick a design for comparison"],
  ["escape", "close the design, then show all designs"],
  ["d", "dark or light"],
];

async function main(): Promise<void> {
  const page = await readPage();
  const makers: Record<Page["kind"], () => HTMLElement[]> = {
    study: () => makeStudy(page as Study), rare: () => makeRare(page as Rare), replay: () => makeReplay(page as ReplayedFlight),
    network: () => makeNetwork(page as NetworkPage),
  };
  const root = document.getElementById("page")!;
  root.classList.add("report");
  root.replaceChildren(makeHeading(page), ...makers[page.kind](), makeProvenance(page));
  await new Promise(requestAnimationFrame);
  await new Promise(requestAnimationFrame);
  document.documentElement.dataset.state = "ready";
}

function makeHeading(page: Page): HTMLElement {
  const theme = element("button", { title: "Dark or light (d)", "aria-label": "dark or light", onclick: () => setTheme(!isDark()) }, "\u25d0");
  const rows = KEYS.map(([key, does]) => element("tr", {}, element("th", {}, key), element("td", {}, does)));
  const keys = element("dialog", { class: "keys", onclick: () => keys.close() }, element("table", {}, ...rows));
  const help = element("button", { title: "Keys (?)", "aria-label": "keys", onclick: () => keys.showModal() }, "?");
  document.addEventListener("keydown", (event) => {
    const { tagName } = event.target as HTMLElement;
    if (["INPUT", "SELECT", "TEXTAREA"].includes(tagName) || event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    if (event.key === "d") setTheme(!isDark());
    if (event.key === "?") keys.showModal();
  });
  return element("header", { class: "heading" }, keys, element("h1", {}, page.title), element("div", { class: "facts" }), ...(page.kind === "study" ? [help] : []), theme);
}

function makeProvenance(page: Page): HTMLElement {
  const rows = Object.entries(page.provenance).map(([name, value]) => element("tr", {}, element("th", {}, name), element("td", {}, element("code", {}, String(value)))));
  return element("details", { class: "panel provenance" }, element("summary", {}, page.kind === "network" ? "What was deployed" : "What was flown"), element("table", {}, element("tbody", {}, ...rows)));
}

main().catch((error) => {
  window.mebots.failed(error);
  throw error;
});
