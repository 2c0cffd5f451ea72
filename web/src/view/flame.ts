// SPDX-License-Identifier: Apache-2.0
// Draws flame graphs. The width of a box is the cost of a function and of the functions that it calls, as a share of
// all costs. If the profile has time windows, counts only the windows in the time span of the plots.
import { select } from "d3-selection";
import flamegraph from "d3-flame-graph";
import { BY_CORE, BY_FUNCTION, type Call, type Cost, COSTS, treeOf, WindowedProfile } from "../data/profile";
import type { Json } from "../data/payload";
import { shown, shownTime } from "../data/units";
import { element } from "../dom";
import { makeFunctions } from "./functions";
import type { Window } from "./window";

const UNITS: Record<string, [number, string]> = { nanoseconds: [1e-9, "s"], none: [1, "-"] };

interface Flames {
  tree: Call;
  unit: string;
  factor: number;
  note: string;
}

export function makeFlames(profiles: Json[], window: Window): HTMLElement {
  const asleep = element("input", { type: "checkbox" });
  const drawing = element("div", { class: "flames" });
  const note = element("p", { class: "faint", id: "flame-note" });
  const windowed = WindowedProfile.of(profiles);
  const choices = windowed ? windowedChoices(windowed, window) : wholeChoices(profiles);
  const functions = windowed ? makeFunctions(windowed, window, () => asleep.checked) : null;
  const draw = () => {
    functions?.draw();
    const { tree, unit, factor, note: said } = choices.read(asleep.checked);
    note.textContent = said;
    drawing.replaceChildren();
    if (!(tree.value > 0)) return;
    const chart = flamegraph().width(Math.max(300, drawing.clientWidth || 700)).cellHeight(18).minFrameSize(2).inverted(true).transitionDuration(0)
      .label((d: Json) => `${d.data.name}: ${shown(d.value * factor, unit)}, ${((100 * d.value) / tree.value).toFixed(1)} %`);
    select(drawing).datum(tree as Json).call(chart as Json);
  };
  for (const input of [...choices.inputs, asleep]) input.addEventListener("change", draw);
  let asked = false;
  window.onChange(() => {
    if (!windowed || asked || !drawing.isConnected) return;
    asked = true; // wheel events occur more often than animation frames
    requestAnimationFrame(() => {
      asked = false;
      draw();
    });
  });
  new ResizeObserver(() => draw()).observe(drawing.parentElement ?? drawing);
  queueMicrotask(draw);
  return element("div", { class: "profile scroll" },
    element("div", { class: "bar-line" }, ...choices.inputs, element("label", {}, asleep, " with sleep")), note, drawing, ...(functions ? [functions.root] : []));
}

interface Choices {
  inputs: HTMLSelectElement[];
  read(withIdle: boolean): Flames;
}

function option(value: string, text: string): HTMLOptionElement {
  return element("option", { value }, text);
}

function windowedChoices(profile: WindowedProfile, window: Window): Choices {
  const cost = element("select", { "aria-label": "what is counted", id: "flame-cost" }, option("energy", "energy"), option("time", "time"), option("cycles", "cycles"));
  const hart = element("select", { "aria-label": "core" }, option(String(BY_FUNCTION), "whole chip"), option(String(BY_CORE), "whole chip, core by core"), ...profile.harts.map((name, i) => option(String(i), name)));
  return {
    inputs: [cost, hart],
    read: (withIdle) => {
      const chosen = COSTS.find((each) => each === cost.value) as Cost;
      const slice = profile.slice(window.start, window.stop);
      const tree = slice.tree(Number(hart.value), chosen, withIdle);
      const span = `from ${shownTime(slice.from)} to ${shownTime(slice.to)}`;
      const total = `${shown(tree.value, profile.unit(chosen))}${chosen === "energy" ? `, ${shown(tree.value / (slice.to - slice.from || 1), "W")} in the mean` : ""}${withIdle ? "" : " while awake"}`;
      return { tree, factor: 1, unit: profile.unit(chosen),
        note: `${total}, ${span}${window.isWhole ? "; a drag on a plot chooses a span" : ", the span of the plots in whole windows of the profile"}. Click a box to zoom in.` };
    },
  };
}

function wholeChoices(profiles: Json[]): Choices {
  const list = profiles.flatMap((file) => file.profiles.map((profile: Json) => ({ profile, frames: file.shared.frames })));
  const choice = element("select", { "aria-label": "profile" }, ...list.map(({ profile }, i) => option(String(i), profile.name)));
  // Shows cycles first, because the core uses most time and energy after its program has ended.
  choice.value = String(Math.max(0, list.findIndex(({ profile }) => profile.name === "cycles")));
  return {
    inputs: [choice],
    read: (withIdle) => {
      const { profile, frames } = list[Number(choice.value)];
      const [factor, unit] = UNITS[profile.unit] ?? [1, "-"];
      return { tree: treeOf(profile, frames, withIdle), factor, unit, note: "Over the whole run. Click a box to zoom in." };
    },
  };
}
