// SPDX-License-Identifier: Apache-2.0
// Flame graphs of a profile: each box is a function, as wide as its share with all that it calls.
import { select } from "d3-selection";
import flamegraph from "d3-flame-graph";
import type { Json } from "../data/payload";
import { shown } from "../data/units";
import { element } from "../dom";

const UNITS: Record<string, [number, string]> = { nanoseconds: [1e-9, "s"], none: [1, "-"] };

interface Call {
  name: string;
  value: number;
  children: Call[];
}

export function makeFlames(profiles: Json[]): HTMLElement {
  const choice = element("select", { "aria-label": "profile" });
  const drawing = element("div", { class: "flames" });
  const asleep = element("input", { type: "checkbox" });
  const list = profiles.flatMap((file) => file.profiles.map((profile: Json) => ({ profile, frames: file.shared.frames })));
  list.forEach(({ profile }, i) => choice.append(element("option", { value: String(i) }, profile.name)));
  // Cycles first: of time and energy most is what a core does when its program is over.
  choice.value = String(Math.max(0, list.findIndex(({ profile }) => profile.name === "cycles")));
  const draw = () => {
    const { profile, frames } = list[Number(choice.value)];
    const [factor, unit] = UNITS[profile.unit] ?? [1, "-"];
    const left = asleep.checked ? new Set<string>() : new Set(["[asleep]", "[off]"]);
    const root = treeOf(profile, frames, left);
    drawing.replaceChildren();
    const chart = flamegraph().width(Math.max(300, drawing.clientWidth || 700)).cellHeight(18).minFrameSize(2).inverted(true)
      .label((d: Json) => `${d.data.name}: ${shown(d.value * factor, unit)}, ${((100 * d.value) / root.value).toFixed(1)} %`);
    select(drawing).datum(root as Json).call(chart as Json);
  };
  choice.addEventListener("change", draw);
  asleep.addEventListener("change", draw);
  new ResizeObserver(() => draw()).observe(drawing.parentElement ?? drawing);
  queueMicrotask(draw);
  return element("div", { class: "profile scroll" },
    element("div", { class: "bar-line" }, choice, element("label", {}, asleep, " with sleep")), drawing,
    element("p", { class: "faint" }, "Over the whole run. Click a box to look closer."));
}

/** The call tree of an evented profile of speedscope. */
function treeOf(profile: Json, frames: { name: string }[], left: Set<string>): Call {
  const root: Call = { name: profile.name, value: 0, children: [] };
  const stack: Call[] = [root];
  let skipped = 0;
  let last = 0;
  for (const event of profile.events) {
    if (skipped === 0) for (const call of stack) call.value += event.at - last;
    last = event.at;
    const name = frames[event.frame].name;
    if (event.type === "O") {
      if (skipped > 0 || left.has(name)) {
        ++skipped;
        continue;
      }
      const top = stack[stack.length - 1];
      const known = top.children.find((call) => call.name === name) ?? { name, value: 0, children: [] };
      if (!top.children.includes(known)) top.children.push(known);
      stack.push(known);
    } else if (skipped > 0) {
      --skipped;
    } else {
      stack.pop();
    }
  }
  return root;
}
