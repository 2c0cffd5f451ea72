// SPDX-License-Identifier: Apache-2.0
// The numbers of a deployed network, from network.json (see mebots.deploy.report), and the board.
import type { Page } from "../report/content";

/** The cost of a layer, or of all layers. `asleep` and `causes` are sums over the cores. */
export interface Cost {
  cycles: number;
  time: number;
  energy: number;
  macs_per_cycle: number;
  bound: number; // least cycles
  roofline: number;
  asleep: number;
  parts: Record<string, number>;
  causes: Record<string, number>;
  dma: number;
}

export interface Layer {
  name: string;
  op: string;
  output: string;
  shape: number[];
  macs: number;
  weights: number;
  l2: { offset: number; bytes: number; from: number; to: number };
  l1: { bytes: number; moved: number } | null;
}

export interface Setting {
  cores: number;
  cluster_clock: number;
  time: number;
  energy: number;
  parts: Record<string, number>;
}

/** An error or a share of pictures. `interval` is its confidence interval at 95 %. */
export interface Judged {
  error?: number;
  share?: number;
  interval: [number, number];
  deviation?: number;
}

/** `float`: differences from the float model, by output. `labels`: errors, or shares of right outputs,
 * compared with the labels in `file`, by output. */
export interface Accuracy {
  pictures: number;
  data: string;
  float?: Record<string, Judged>;
  labels?: { file: string; outputs: Record<string, { float?: Judged; int8: Judged; loss?: Judged }> };
}

/** The network with a smaller input. `whole` contains the differences from the float model with the full input, by
 * output. */
export interface SizeRow {
  rows: number;
  columns: number;
  macs: number;
  accuracy: Accuracy;
  settings: { cores: number; cluster_clock: number; time: number; energy: number }[];
  whole?: Record<string, Judged>;
}

export interface Measured {
  cores: number;
  cluster_clock: number;
  roof: { macs_per_cycle: number; bytes_per_cycle: number; hyper_bytes_per_cycle?: number };
  layers: Cost[];
  total: Cost;
  settings: Setting[];
}

export interface NetworkPage extends Page {
  network: {
    input: { rows: number; columns: number; channels: number; tensor: string };
    outputs: Record<string, { shape: number[] }>;
    memory: { weights: number; fetched: number; activations: number; l1: number; picture: number };
    layers: Layer[];
    flight: { program?: string; firmware?: string[]; none?: string };
    measured?: Measured;
    accuracy: Accuracy;
    sizes: { rows: SizeRow[]; none?: string };
  };
  board: { name: string; cores: number; l1: number; l2: number };
}

export function sumOf(layers: Layer[], key: "macs" | "weights"): number {
  return layers.reduce((sum, layer) => sum + layer[key], 0);
}
