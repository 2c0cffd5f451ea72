// SPDX-License-Identifier: Apache-2.0
// Computes call trees from a speedscope profile: of the whole run, and of a time span if fmu_soc wrote windows.
import type { Json } from "./payload";

export interface Call {
  name: string;
  value: number;
  children: Call[];
}

/** The costs in a profile, in their order in a window's `parts`. */
export const COSTS = ["cycles", "time", "energy"] as const;
export type Cost = (typeof COSTS)[number];
const SCALES: Record<Cost, [number, string]> = { cycles: [1, "-"], time: [1e-12, "s"], energy: [1e-15, "J"] };
const PART = 2 + COSTS.length; // numbers per part: hart, node, then the costs

const IDLE = new Set(["[asleep]", "[off]"]);

/** Selects all harts, each as a branch. */
export const BY_CORE = -1;
/** Selects all harts, summed by function. */
export const BY_FUNCTION = -2;

/** The costs of all time windows of the profile that overlap a time span. */
export interface Slice {
  from: number;
  to: number;
  /** Returns a call tree. `hart` is the number of a hart in the file, BY_CORE or BY_FUNCTION. */
  tree(hart: number, cost: Cost, withIdle: boolean): Call;
  functions(withIdle: boolean): FunctionCost[];
}

/** The cost of a function without the functions that it calls, summed over all harts [J, s]. */
export interface FunctionCost {
  name: string;
  energy: number;
  time: number;
  cycles: number;
}

export class WindowedProfile {
  readonly harts: string[];

  constructor(private readonly file: Json) {
    this.harts = file.mebots.harts.map((hart: Json) => hart.name || "fabric controller");
  }

  static of(files: Json[]): WindowedProfile | null {
    const found = files.find((file) => file.mebots?.windows?.length > 0);
    return found ? new WindowedProfile(found) : null;
  }

  unit(cost: Cost): string {
    return SCALES[cost][1];
  }

  /** Returns the sum of the costs of all the profile's time windows that overlap the time span from `start` to
   * `stop` [s]. */
  slice(start: number, stop: number): Slice {
    const { windows, harts } = this.file.mebots;
    const inside = windows.filter((window: Json) => window.to * 1e-9 > start && window.from * 1e-9 < stop);
    const sums = harts.map((hart: Json) => COSTS.map(() => new Float64Array(hart.nodes.length / 2)));
    for (const { parts } of inside) {
      for (let i = 0; i < parts.length; i += PART) {
        for (let cost = 0; cost < COSTS.length; ++cost) sums[parts[i]][cost][parts[i + 1]] += parts[i + 2 + cost];
      }
    }
    return {
      from: inside.length > 0 ? inside[0].from * 1e-9 : start,
      to: inside.length > 0 ? inside[inside.length - 1].to * 1e-9 : start,
      tree: (hart, cost, withIdle) => {
        const one = (number: number) => this.hartTree(number, sums[number][COSTS.indexOf(cost)], SCALES[cost][0], withIdle);
        if (hart >= 0) return one(hart);
        const cores: Call[] = harts.map((_: Json, number: number) => one(number)).filter(({ value }: Call) => value > 0);
        const value = cores.reduce((total, core) => total + core.value, 0);
        return { name: "chip", value, children: hart === BY_CORE ? cores : added(cores.flatMap(({ children }) => children)) };
      },
      functions: (withIdle) => this.functionCosts(sums, withIdle),
    };
  }

  private functionCosts(sums: Float64Array[][], withIdle: boolean): FunctionCost[] {
    const found = new Map<string, FunctionCost>();
    sums.forEach((own, number) => {
      for (let node = 0; node < own[0].length; ++node) {
        const name = this.nodeName(number, node);
        if (own.every((costs) => costs[node] === 0) || (!withIdle && IDLE.has(name))) continue;
        const sum = found.get(name) ?? { name, energy: 0, time: 0, cycles: 0 };
        for (const [i, cost] of COSTS.entries()) sum[cost] += own[i][node] * SCALES[cost][0];
        found.set(name, sum);
      }
    });
    return [...found.values()];
  }

  private nodeName(number: number, node: number): string {
    return node === 0 ? this.harts[number] : this.file.shared.frames[this.file.mebots.harts[number].nodes[2 * node + 1]].name;
  }

  private hartTree(hart: number, own: Float64Array, scale: number, withIdle: boolean): Call {
    const { nodes } = this.file.mebots.harts[hart];
    const calls: Call[] = [];
    for (let node = 0; node < own.length; ++node) {
      const name = this.nodeName(hart, node);
      calls.push({ name, value: withIdle || !IDLE.has(name) ? own[node] * scale : 0, children: [] });
    }
    for (let node = own.length - 1; node > 0; --node) { // the number of a child is greater than that of its parent
      const parent = calls[nodes[2 * node]];
      parent.value += calls[node].value;
      if (calls[node].value > 0) parent.children.unshift(calls[node]);
    }
    return calls[0];
  }
}

function added(calls: Call[]): Call[] {
  const byName = new Map<string, Call[]>();
  for (const call of calls) byName.set(call.name, [...(byName.get(call.name) ?? []), call]);
  return [...byName].map(([name, same]) => ({
    name, value: same.reduce((total, { value }) => total + value, 0), children: added(same.flatMap(({ children }) => children)),
  }));
}

/** Returns the call tree of an evented profile of speedscope. */
export function treeOf(profile: Json, frames: { name: string }[], withIdle: boolean): Call {
  const root: Call = { name: profile.name, value: 0, children: [] };
  const stack: Call[] = [root];
  let skipped = 0;
  let last = 0;
  for (const event of profile.events) {
    if (skipped === 0) for (const call of stack) call.value += event.at - last;
    last = event.at;
    const name = frames[event.frame].name;
    if (event.type === "O") {
      if (skipped > 0 || (!withIdle && IDLE.has(name))) {
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
