// SPDX-License-Identifier: Apache-2.0
// The panels of a run. If the config defines no panels, they show variables that change, grouped by instance and unit.
import type { CurveInfo, PanelInfo } from "./payload";
import type { Run } from "./run";
import { meaningOf } from "./units";

const MOST_CURVES = 6;
const MOST_PANELS = 14;
const MOST_STATES = 10;

interface Found {
  instance: string;
  unit: string;
  names: string[];
}

/** Returns the panels of the config. If the config defines none, returns panels of variables that change. During a live
 * run, variables that have not changed yet may have panels, too. */
export function panelsOf(run: Run): PanelInfo[] {
  const asked = run.system?.view.panels ?? [];
  return asked.length > 0 ? asked : defaultPanels(run);
}

function defaultPanels(run: Run): PanelInfo[] {
  const varying = run.variables.filter((name) => run.header.live || !run.stands(name)); // at the start of a live run, none has changed
  const isState = (name: string) => ["Boolean", "Enumeration"].includes(run.info(name)?.type ?? "");
  const found = taken(groupsOf(run, varying.filter((name) => !isState(name))).map((group) => panelOf(run, group)));
  const states = varying.filter(isState).slice(0, MOST_STATES);
  const lanes: PanelInfo[] = states.length > 0 ? [{ title: "States", kind: "lanes", curves: states.map((variable) => ({ variable })) }] : [];
  return [...found, ...lanes];
}

/** Groups variables by instance and unit. A variable without a unit forms its own group, because numbers without a unit
 * may be of different kinds. */
function groupsOf(run: Run, names: string[]): Found[] {
  const groups = new Map<string, Found>();
  for (const name of names) {
    const unit = run.unit(name);
    const instance = run.instanceOf(name);
    const key = unit === "-" ? name : `${instance} ${unit}`;
    const group = groups.get(key) ?? { instance, unit, names: [] };
    groups.set(key, group);
    group.names.push(name);
  }
  return [...groups.values()];
}

function panelOf(run: Run, { instance, unit, names }: Found): PanelInfo & { instance: string } {
  const curves = run.header.live ? names.map((variable) => ({ variable, label: shortName(variable, instance) })) : joined(run, instance, names);
  const rest = curves.length > MOST_CURVES ? `, ${MOST_CURVES} of ${curves.length}` : "";
  const meaning = meaningOf(unit) || (curves.length === 1 ? curves[0].label ?? "" : "");
  return { instance, title: `${instance}${meaning === "" ? "" : `: ${meaning}`}${rest}`, kind: "lines", curves: curves.slice(0, MOST_CURVES) };
}

const shortName = (name: string, instance: string) => name.slice(instance.length + 1);

/** Joins variables with equal values into one curve. Its label is, for example, "rotor[1].speed, and 3 alike". */
function joined(run: Run, instance: string, names: string[]): CurveInfo[] {
  const found: { variable: string; alike: number }[] = [];
  for (const variable of names) {
    const values = run.values(variable)!;
    const same = found.find((other) => run.values(other.variable)!.every((value, row) => Object.is(value, values[row])));
    if (same) ++same.alike;
    else found.push({ variable, alike: 0 });
  }
  return found.map(({ variable, alike }) => ({ variable, label: shortName(variable, instance) + (alike > 0 ? `, and ${alike} alike` : "") }));
}

/** Returns at most MOST_PANELS panels. First takes the first panel of each instance, then the second panel of each, and
 * so on. */
function taken(panels: (PanelInfo & { instance: string })[]): PanelInfo[] {
  const seen = new Map<string, number>();
  const round = panels.map(({ instance }) => {
    const count = seen.get(instance) ?? 0;
    seen.set(instance, count + 1);
    return count;
  });
  return panels.map((_, i) => i).sort((a, b) => round[a] - round[b] || a - b).slice(0, MOST_PANELS).map((i) => panels[i]);
}
