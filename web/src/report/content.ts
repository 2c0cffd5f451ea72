// SPDX-License-Identifier: Apache-2.0
// The data of a page. mebots.exploration.report, rare_report and mebots.flight.replay_page write them.

export interface Page {
  kind: "study" | "rare" | "replay" | "network";
  title: string;
  provenance: Record<string, string>;
}

export interface Factor {
  name: string;
  label: string;
  unit: string;
  /** The factor that converts a value to the displayed unit. */
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
  /** The value and the interval of each design, as text. */
  text: string[];
}

/** The designs in the page: one array for each column of the table. `number` contains each design's number in the
 * study. `of` is the number of designs in the study. */
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

/** The missions in the page: the first and then every n-th mission of each design, where n is `every`. They are
 * ordered by design. */
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
  /** For each objective and design: the minimum, the 5, 25, 50, 75 and 95 % quantiles, and the maximum. */
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
