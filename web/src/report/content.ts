// SPDX-License-Identifier: Apache-2.0
// The numbers of a page, as mebots.exploration.report, rare_report and mebots.flight.replay_page write them.

export interface Page {
  kind: "study" | "rare" | "replay" | "network";
  title: string;
  provenance: Record<string, string>;
}

export interface Factor {
  name: string;
  label: string;
  unit: string;
  /** Factor from a value to the unit in which the page shows it. */
  scale: number;
  number: boolean;
  values: (number | string | boolean)[];
  levels: string[];
  level: number[];
}

type Numbers = (number | null)[];

export interface Objective {
  label: string;
  unit: string;
  scale: number;
  /** The direction of optimisation: -1 to minimise, 1 to maximise, 0 for neither. */
  sense: number;
  share: boolean;
  statistic: string;
  where: string | null;
  mean: Numbers;
  low: Numbers;
  high: Numbers;
  count: number[];
  /** Value and interval of each design, as formatted texts. */
  text: string[];
}

/** Contains the designs in the page, by column. `number` is the number of each design in the study, which has `of`
 * designs. */
export interface Designs {
  of: number;
  number: number[];
  name: string[];
  rank: Numbers;
  note: string[];
  front: Place[];
  status: string[];
  failed: number[];
  missions: number[];
}

export type Place = "on" | "undecided" | "off" | "excluded" | "";

/** Contains every n-th mission of each design, one design after the other. */
export interface Missions {
  every: number;
  counts: number[];
  values: Numbers[];
  outcome: number[];
  outcomes: string[];
  outcome_counts: number[][];
}

export interface Effects {
  pairs: [number, number][];
  means: Numbers[][];
  pair_means: Numbers[][];
  importances: ({ factors: number[]; pairs: number[] } | null)[];
}

export interface Course {
  design: number;
  counts: number[];
  mean: Numbers[];
  low: Numbers[];
  high: Numbers[];
}

export interface Replay {
  run: string;
  folder: string;
  name: string;
  designs: (string | null)[];
  draws: string[];
  pages: string[];
}

export interface Study extends Page {
  answer: { headlines: string[]; remarks: string[] };
  refresh_s: number | null;
  error: number;
  sequence: boolean;
  constraints: { objective: number; above: boolean; bound: number }[];
  factors: Factor[];
  objectives: Objective[];
  designs: Designs;
  missions_of: number;
  failed_of: number;
  effects: Effects;
  indices: { method: string; titles: string[]; rows: string[][] } | null;
  /** For each objective and design: the least value, the 5, 25, 50, 75 and 95 % quantiles, and the greatest value. */
  quantiles: (number[] | null)[][] | null;
  missions: Missions | null;
  replay: Replay | null;
  courses: Course[];
  best: number[];
}

export interface RareDesign {
  name: string;
  values: (number | string | boolean)[];
  missions: number;
  failed: number;
  simulated_s: number;
  answer: [number | null, number | null, number | null, number | null];
  levels: number[];
  reached: number[][];
  shares: number[][];
  mean_shares: number[];
  command: string;
  counting: number | null;
}

export interface Rare extends Page {
  error: number;
  factors: string[];
  score: string;
  unit: string;
  rises: boolean;
  each: number;
  found: boolean;
  estimates: number;
  designs: RareDesign[];
}

export interface ReplayedFlight extends Page {
  fields: string[];
  errors: (string | number | null)[][];
  findings: string[];
  notes: string[];
  answer: string;
  charts: { title: string; x: number[]; curves: { name: string; y: Numbers }[] }[];
  window: number;
  settle: number;
}

export async function readPage(): Promise<Page> {
  return JSON.parse(new TextDecoder().decode(await window.mebots.inflated("mebots-data")));
}
