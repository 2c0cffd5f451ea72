// SPDX-License-Identifier: Apache-2.0
// The numbers of a deployed network: network.json, which mebots.deploy.report describes, and the board.
import type { Page } from "../report/content";

/** Cost of a layer, or of all. `asleep` and `causes` are sums over the cores. */
export interface Cost {
  cycles: number;
  time: number;
  energy: number;
  macs_per_cycle: number;
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

export interface Measured {
  cores: number;
  cluster_clock: number;
  roof: { macs_per_cycle: number; bytes_per_cycle: number };
  layers: Cost[];
  total: Cost;
  settings: Setting[];
}

export interface NetworkPage extends Page {
  network: {
    input: { rows: number; columns: number; channels: number; tensor: string };
    outputs: Record<string, { shape: number[] }>;
    memory: { weights: number; activations: number; l1: number; picture: number };
    layers: Layer[];
    flight: { program?: string; firmware?: string[]; none?: string };
    measured?: Measured;
  };
  board: { name: string; cores: number; l1: number; l2: number };
}

export function sumOf(layers: Layer[], key: "macs" | "weights"): number {
  return layers.reduce((sum, layer) => sum + layer[key], 0);
}
