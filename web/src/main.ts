// SPDX-License-Identifier: Apache-2.0
// Builds the page of one or several runs.
import { Clock } from "./clock";
import { panelsOf } from "./data/panels";
import { readPayload } from "./data/payload";
import { fetchAll, follow, makeInputs } from "./live";
import { Run } from "./data/run";
import { setTimeScale, shown } from "./data/units";
import { element } from "./dom";
import { LOOKS, type PathColour, Stage } from "./scene/stage";
import { isDark, setTheme } from "./theme";
import { makeChip } from "./view/chip";
import { makeComparison } from "./view/compare";
import { makeDrones } from "./view/drones";
import { makeFlames } from "./view/flame";
import { makeGraph } from "./view/graph";
import { makeHandle } from "./view/handle";
import { makeMessages } from "./view/messages";
import { makePanel } from "./view/panel";
import { makePicture } from "./view/picture";
import { makeSignals } from "./view/signals";
import { mainValues, makeStatistics } from "./view/statistics";
import { makeStories, makeStory, openingTime } from "./view/story";
import { makeTabs, type Tab } from "./view/tabs";
import { makeThinNote } from "./view/thin";
import { makeTimeline, nextSpeed } from "./view/timeline";
import { Window as Span } from "./view/window";

declare global {
  interface Window {
    mebots: { inflated(id: string): Promise<Uint8Array<ArrayBuffer>>; failed(error: unknown): void };
  }
}

/** If the page has no scene and at most this number of panels, curves have the height ROOMY_HEIGHT. */
const FEW_PANELS = 4;
/** In pixels. */
const ROOMY_HEIGHT = 150;

async function main(): Promise<void> {
  const isLive = document.getElementById("mebots-data")!.textContent!.trim() === "";
  const payload = isLive ? await fetchAll() : readPayload(await globalThis.window.mebots.inflated("mebots-data"));
  const runs = payload.runs.map((header) => new Run(header, payload));
  const run = runs[0];
  const clock = new Clock(Math.max(...runs.map(({ end }) => end)));
  if (!isLive) setTimeScale(clock.end);
  const span = new Span(clock.end);
  const stage = makeStage(runs, clock);
  const panels = element("div", { class: "panels" });
  const plot = (name: string) => {
    const panel: HTMLElement = makePanel({ title: name, kind: "lines", curves: [{ variable: name, label: name.slice(run.instanceOf(name).length + 1) }] },
      runs, clock, span, { onClose: () => panel.remove() });
    panels.prepend(panel);
    panel.scrollIntoView({ block: "nearest" });
  };
  panels.append(makeThinNote(run, span));
  const infos = panelsOf(run);
  const height = !stage && infos.length <= FEW_PANELS ? ROOMY_HEIGHT : undefined;
  for (const info of infos) panels.append(makePanel(info, runs, clock, span, { height }));
  if (infos.length === 0 && !run.header.live) {
    panels.append(element("p", { class: "faint" }, "No recorded variable changes in this run. Set inputs or parameters, or run it longer; the tab Variables has all values."));
  }
  const isChip = run.header.chip != null;
  const tabs = makeTabs([
    ...(runs.length > 1 ? [{ name: "Runs", content: () => makeComparison(runs) }] : []),
    ...(isChip ? [{ name: "Chip", content: () => makeChip(run) }, makeProfileTab(run, span)] : []),
    ...(stage || isChip ? [] : [{ name: "System", content: () => makeGraph(run, clock) }]),
    ...(stage && runs.length === 1 && stage.bodies.length > 1 ? [{ name: "Drones", content: () => makeDrones(run, clock, stage) }] : []),
    { name: "Messages", content: () => makeMessages(run, clock) },
    { name: "Variables", content: () => makeSignals(run, clock, plot) },
    ...(stage ? [{ name: "System", content: () => makeGraph(run, clock) }] : []),
    ...(isLive ? [{ name: "Inputs", content: () => makeInputs(run) }] : []),
    { name: "Numbers", content: () => makeStatistics(run) },
    ...(run.header.profiles.length > 0 && !isChip ? [makeProfileTab(run, span)] : []),
  ]);
  const left = element("div", { class: "left" });
  if (stage) {
    if (run.pictures.length > 0) stage.root.append(makePicture(run, clock));
    left.append(stage.root, makeSplit("height of the scene", "y", stage.root, left, "--top"));
  }
  left.append(tabs.root);
  const body = element("main", {}, left);
  body.append(makeSplit("width of the left side", "x", left, body, "--left"), panels);
  const page = document.getElementById("page")!;
  page.classList.toggle("no-scene", !stage);
  page.replaceChildren(makeHeading(runs), runs.length === 1 ? makeStory(run) : makeStories(runs), body, makeTimeline(run, clock, span));
  listenToKeys(clock, span, stage, run);
  const asked = timeOfAddress();
  clock.set(isLive ? clock.end : asked ?? openingTime(run));
  if (isLive) page.querySelector("h1")!.after(follow(run, clock, span));
  Object.assign(globalThis.window.mebots, { clock, runs, span }); // used by scripts and tests
  await stage?.ready;
  await new Promise(requestAnimationFrame);
  document.documentElement.dataset.state = "ready";
  const isCalm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (stage && !isLive && asked === null && !isCalm) clock.play();
}

function makeProfileTab(run: Run, span: Span): Tab {
  return { name: "Profile", content: () => makeFlames(run.header.profiles, span) };
}

/** Creates a handle that resizes a part of a grid. `track` is the name of the part's size in the grid's template. */
function makeSplit(label: string, axis: "x" | "y", part: HTMLElement, grid: HTMLElement, track: string): HTMLElement {
  const least = 160; // minimum size in pixels
  const sizeOf = (one: HTMLElement) => (axis === "x" ? one.clientWidth : one.clientHeight);
  return makeHandle({
    label, axis, size: () => sizeOf(part),
    resize: (size) => {
      if (size === null) grid.style.removeProperty(track);
      else grid.style.setProperty(track, `${Math.min(Math.max(size, least), Math.max(least, sizeOf(grid) - least))}px`);
    },
  });
}

/** Returns the time in the page's address. For example, flight.html#t=12.5 opens at 12.5 s without playing. */
function timeOfAddress(): number | null {
  const found = /^#t=(\d+(?:\.\d+)?)$/.exec(location.hash);
  return found ? Number(found[1]) : null;
}

/** Creates the view of the scene. Returns null if the first run has no scene, or if the browser has no WebGL. */
function makeStage(runs: Run[], clock: Clock): Stage | null {
  const run = runs[0];
  if (!run.scene?.bodies?.length) return null;
  const colours: PathColour[] = [];
  const instance = run.system?.view.scene?.instance ?? "";
  for (const { variable, label } of run.scene.bodies[0].colours ?? []) {
    const name = `${instance}.${variable}`;
    if (run.has(name)) colours.push({ label, unit: run.unit(name), values: () => run.values(name)! });
  }
  for (const panel of panelsOf(run)) {
    if (panel.kind !== "stack") continue;
    const sum = run.sum(panel.curves);
    if (sum) colours.push({ label: panel.title.toLowerCase(), unit: sum.unit, values: () => sum.values(clock.end / 110) });
  }
  try {
    const stage = new Stage(runs, clock, colours);
    return stage;
  } catch (error) {
    console.warn("The scene is not drawn:", error);
    return null;
  }
}

function makeHeading(runs: Run[]): HTMLElement {
  const run = runs[0];
  const facts = element("div", { class: "facts" });
  const outcome = element("span", { class: "outcome" });
  const fact = (label: string, value: string) => facts.append(element("span", {}, `${label} `, element("b", {}, value)));
  const show = () => {
    const { summary } = run;
    outcome.textContent = String(summary.outcome ?? "no summary").replaceAll("_", " ");
    // Hides the outcome if the table of runs shows it, or if the run has not ended.
    outcome.hidden = runs.length > 1 || (run.header.live != null && !run.header.live.ended);
    facts.replaceChildren();
    if (runs.length > 1) return;
    fact("simulated", shown(summary.simulated_time ?? run.end, "s"));
    for (const { label, value, unit } of mainValues(summary)) {
      if (typeof value === "number" && ["J", "m"].includes(unit) && /delivered|path/.test(label)) fact(label, shown(value, unit));
    }
  };
  run.onData(show);
  show();
  const names = element("h1", {}, runs.map(({ name }) => name).join(" · "));
  const theme = element("button", { title: "Dark or light (d)", "aria-label": "dark or light", onclick: () => setTheme(!isDark()) }, "\u25d0");
  const rows = KEYS.map(([key, does]) => element("tr", {}, element("th", {}, key), element("td", {}, does)));
  const keys = element("dialog", { class: "keys", onclick: () => keys.close() }, element("table", {}, ...rows));
  const help = element("button", { title: "Keys (?)", id: "help", "aria-label": "keys", onclick: () => keys.showModal() }, "?");
  return element("header", { class: "heading" }, keys, names, outcome, facts, help, theme);
}

const KEYS: [string, string][] = [
  ["space", "play, pause"],
  ["\u2190 \u2192", "one row back, forward; with shift one second"],
  ["home, end", "start, end"],
  ["+ \u2212", "faster, slower"],
  [LOOKS.map((_, i) => i + 1).join(" "), `camera: ${LOOKS.join(", ")}`],
  ["click, shift + drag", "on a plot: set the present time"],
  ["drag, ctrl + wheel, two fingers", "on a plot: zoom in; double click or escape: show all"],
  ["/", "search a variable"],
  ["d", "dark or light"],
];

function listenToKeys(clock: Clock, span: Span, stage: Stage | null, run: Run): void {
  const stepBy = (event: KeyboardEvent, direction: number) => {
    clock.pause();
    if (event.shiftKey) return clock.set(clock.time + direction);
    const later = run.times.findIndex((time) => time > clock.time + 1e-9);
    const next = direction > 0 ? later : (later < 0 ? run.times.length : later) - 2;
    clock.set(next < 0 ? (direction > 0 ? clock.end : 0) : run.times[next]);
  };
  const keys: Record<string, (event: KeyboardEvent) => void> = {
    " ": () => clock.toggle(),
    ArrowLeft: (event) => stepBy(event, -1),
    ArrowRight: (event) => stepBy(event, 1),
    Home: () => clock.set(0),
    End: () => clock.set(clock.end),
    "+": () => clock.setSpeed(nextSpeed(clock.speed, 1)),
    "-": () => clock.setSpeed(nextSpeed(clock.speed, -1)),
    d: () => setTheme(!isDark()),
    "?": () => document.getElementById("help")?.click(),
    Escape: () => span.reset(),
    "/": () => {
      document.querySelector<HTMLButtonElement>('[data-tab="Variables"]')?.click();
      document.getElementById("search")?.focus();
    },
  };
  LOOKS.forEach((look, i) => (keys[String(i + 1)] = () => stage?.setLook(look)));
  document.addEventListener("keydown", (event) => {
    const target = event.target as HTMLElement;
    if (document.querySelector("dialog[open]")) return; // Escape closes the dialog
    if (["INPUT", "SELECT", "TEXTAREA"].includes(target.tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === " " && target.tagName === "BUTTON") return; // the space bar presses the button
    const act = keys[event.key];
    if (!act) return;
    event.preventDefault();
    act(event);
  });
}

main().catch((error) => {
  globalThis.window.mebots.failed(error);
  throw error;
});
