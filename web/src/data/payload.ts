// SPDX-License-Identifier: Apache-2.0
// Reads the payload of a page. master/src/report/page.hpp describes the format.

export interface Place {
  offset: number;
  length: number;
}

export interface VariableInfo {
  type: string;
  causality: string;
  unit?: string;
  text?: string;
  items?: { name: string; value: number }[];
}

export interface CurveInfo {
  variable?: string;
  rate_of?: string;
  label?: string;
}

export interface PanelInfo {
  title: string;
  kind: "lines" | "stack" | "lanes";
  curves: CurveInfo[];
}

export interface SystemInfo {
  name: string;
  text?: string;
  step: number;
  stop_time: number;
  instances: Record<string, { model: string; text?: string; step: number }>;
  connections: { from: string; to: string; type: string; unit?: string }[];
  variables: Record<string, VariableInfo>;
  view: { panels: PanelInfo[]; marks: string[]; scene?: { file: string; instance: string };
    /** The groups of variables in the summary. `members` maps the name of an object, such as a drone, to its variable. */
    groups?: { label: string; members: Record<string, string> }[] };
}

// eslint-disable-next-line @typescript-eslint/no-explicit-any
export type Json = any;

export interface LiveState {
  held: boolean;
  pace: number; // simulated seconds per second; 0 means as fast as possible
  ended: boolean;
  /** The amounts of data that the page had when it sent the request. The payload contains only later data. */
  known: { rows: number; pictures: number; log: number };
  log: number; // number of bytes of the log at present
  stop_time?: number;
  settable?: { variable: string; unit: string; text: string; type: string }[];
}

export interface RunHeader {
  name: string;
  live?: LiveState | null;
  system: SystemInfo | null;
  summary: Json | null;
  log: string;
  texts: string[];
  rows: number;
  span: number; // the server reduced this number of rows to two
  whole: [number, number][]; // all rows within these times are contained
  kept: number;
  /** The columns of the results. A column's numbers are the constant `still`, or in the bytes `block` of the
   * payload, or the list `values`. */
  columns: { name: string; unit: string; still?: number; block?: Place; values?: number[] }[];
  scene: Place | null;
  profiles: Json[];
  /** The report of `mebots-soc run`. If it is present, `system` is null. */
  chip?: Json;
  /** If `every` is n, the page contains every n-th picture. `shrunk` is the number of the file's pixels per pixel in
   * each direction. Both are absent in live data. */
  pictures: { name: string; every?: number; pictures: (Place & { time: number; shrunk?: number })[] }[];
}

export interface Payload {
  runs: RunHeader[];
  bytes(place: Place): Uint8Array<ArrayBuffer>;
}

export function readPayload(all: Uint8Array<ArrayBuffer>): Payload {
  const length = new DataView(all.buffer, all.byteOffset).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(all.subarray(4, 4 + length)));
  if (header.format !== 1) throw new Error(`data of format ${header.format}, which this page cannot read`);
  const start = 4 + length;
  return {
    runs: header.runs,
    bytes: (place) => all.subarray(start + place.offset, start + place.offset + place.length),
  };
}

/** Decodes the numbers of a column. The 64 bits of each number are stored as the difference to the bits of the
 * previous number. Plane i contains byte i of all differences. */
export function numbersOf(planes: Uint8Array): Float64Array {
  const count = planes.length / 8;
  const bytes = new Uint8Array(planes.length);
  for (let plane = 0; plane < 8; ++plane) {
    const from = plane * count;
    for (let i = 0; i < count; ++i) bytes[8 * i + plane] = planes[from + i];
  }
  const words = new Uint32Array(bytes.buffer); // low word, high word
  for (let i = 2; i < words.length; i += 2) {
    const low = words[i] + words[i - 2];
    words[i] = low;
    words[i + 1] += words[i - 1] + (low > 0xffffffff ? 1 : 0);
  }
  return new Float64Array(bytes.buffer);
}
