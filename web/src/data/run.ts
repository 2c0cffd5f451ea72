// SPDX-License-Identifier: Apache-2.0
// A run: columns by name, values by time, and curves.
import { type Message, readMessages } from "./messages";
import { type CurveInfo, type Json, numbersOf, type Payload, type RunHeader, type SystemInfo, type VariableInfo } from "./payload";
import { rateUnit, shown } from "./units";

export interface Picture {
  time: number;
  url: string;
  /** The number of the camera's pixels per pixel of the picture, in each direction. */
  shrunk: number;
}

/** The numbers of a panel's curve over the run's times. */
export interface Curve {
  label: string;
  unit: string;
  isRate: boolean;
  variable: string;
  /** Returns one value per row. For a rate, each value is the mean over at least `mean` seconds, or between two rows
   * if these are further apart. Rates are exact, because they are computed from recorded totals, such as power from
   * energy. */
  values(mean: number): Float64Array;
}

/** Returns the index of the last row whose time is not later than `time`. */
export function rowAt(times: Float64Array, time: number): number {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** If a run in progress has more values, the server sends a reduced number of values. */
const MOST_NUMBERS = 4e6;

export class Run {
  readonly name: string;
  readonly scene: Json | null;
  readonly system: SystemInfo | null;
  times!: Float64Array;
  messages!: Message[];
  summary!: Json;
  readonly pictures: Picture[] = [];
  private readonly places = new Map<string, RunHeader["columns"][number]>();
  private readonly numbers = new Map<string, Float64Array>();
  private kept = 0; // number of rows that this page has
  private camera: string | undefined; // the first camera that took a picture; the page shows its pictures
  private readonly listeners: (() => void)[] = [];
  private version = 0;

  constructor(public header: RunHeader, private payload: Payload) {
    this.name = header.name;
    this.system = header.system;
    this.scene = header.scene ? JSON.parse(new TextDecoder().decode(payload.bytes(header.scene))) : null;
    this.take(header, payload);
  }

  /** Adds a listener for new data of a run in progress. */
  onData(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** Adds new data of a run in progress. If the server sent all data, replaces the old data. */
  goOn(header: RunHeader, payload: Payload): void {
    const isAll = header.live?.known.rows === 0;
    if (isAll) return this.take(header, payload);
    this.header = { ...header, log: this.header.log + header.log, system: this.system, scene: this.header.scene,
      profiles: header.profiles.length > 0 ? header.profiles : this.header.profiles, live: { ...this.header.live, ...header.live! } };
    this.summary = header.summary ?? {};
    if (header.kept > 0) {
      for (const column of header.columns) this.append(column, header, payload);
      this.kept += header.kept;
      this.times = this.values("time")!;
      ++this.version;
    }
    if (header.log !== "") this.messages = readMessages(this.header.log);
    this.takePictures(header, payload);
  }

  tell(): void {
    for (const listener of this.listeners) listener();
  }

  /** The amounts of data of a run in progress that this page has: rows, pictures, and bytes of the log. */
  get known(): { rows: number; pictures: number; log: number } {
    return { rows: this.header.rows, pictures: this.pictures.length, log: this.header.live?.log ?? 0 };
  }

  /** True if the run has so many values that the server reduces them. Then each request must fetch all data. */
  get isLong(): boolean {
    return this.kept * this.places.size > MOST_NUMBERS;
  }

  private append(column: RunHeader["columns"][number], header: RunHeader, payload: Payload): void {
    const before = this.places.get(column.name);
    if (before?.still !== undefined && before.still === column.still) {
      this.numbers.delete(column.name);
      return;
    }
    const joined = new Float64Array(this.kept + header.kept);
    joined.set(this.values(column.name) ?? new Float64Array(this.kept).fill(NaN));
    if (column.block) joined.set(numbersOf(payload.bytes(column.block)), this.kept);
    else joined.fill(column.still ?? NaN, this.kept);
    this.numbers.set(column.name, joined);
    this.places.set(column.name, { name: column.name, unit: column.unit });
  }

  private take(header: RunHeader, payload: Payload): void {
    this.header = { ...header, system: this.system, profiles: header.profiles };
    this.payload = payload;
    this.summary = header.summary ?? {};
    this.kept = header.kept;
    this.numbers.clear();
    for (const column of header.columns) this.places.set(column.name, column);
    this.times = this.values("time")!;
    this.messages = readMessages(header.log);
    this.takePictures(header, payload);
    ++this.version;
  }

  private takePictures(header: RunHeader, payload: Payload): void {
    const known = header.live?.known.pictures ?? 0;
    this.camera ??= header.pictures[0]?.name;
    const series = header.pictures.find(({ name }) => name === this.camera);
    for (const picture of (series?.pictures ?? []).slice(this.pictures.length - known)) {
      const url = URL.createObjectURL(new Blob([payload.bytes(picture)], { type: "image/png" }));
      this.pictures.push({ time: picture.time, url, shrunk: picture.shrunk ?? 1 });
    }
  }

  get end(): number {
    return this.times.length > 0 ? this.times[this.times.length - 1] : 0;
  }

  /** Returns n if the page contains every n-th picture of the camera. */
  get pictureEvery(): number {
    return this.header.pictures.find(({ name }) => name === this.camera)?.every ?? 1;
  }

  /** The names of the recorded variables, in the order of the columns. */
  get variables(): string[] {
    return [...this.places.keys()].filter((name) => name !== "time");
  }

  has(name: string): boolean {
    return this.places.has(name);
  }

  stands(name: string): boolean {
    return this.places.get(name)?.still !== undefined;
  }

  unit(name: string): string {
    return this.places.get(name)?.unit ?? "-";
  }

  info(name: string): VariableInfo | undefined {
    return this.system?.variables[name];
  }

  values(name: string): Float64Array | undefined {
    const known = this.numbers.get(name);
    if (known) return known;
    const place = this.places.get(name);
    if (!place) return undefined;
    const made = place.block ? numbersOf(this.payload.bytes(place.block))
      : place.values ? Float64Array.from(place.values) : new Float64Array(this.kept).fill(place.still ?? NaN);
    this.numbers.set(name, made);
    return made;
  }

  at(name: string, time: number): number {
    const values = this.values(name);
    return values ? values[rowAt(this.times, time)] : NaN;
  }

  /** Formats the value of a variable at a time: an item of an enumeration, on or off, or a number with its unit. */
  textAt(name: string, time: number): string {
    return this.text(name, this.at(name, time));
  }

  text(name: string, value: number): string {
    const info = this.info(name);
    const item = info?.items?.find((candidate) => candidate.value === value);
    if (item) return item.name.replaceAll("_", " ");
    if (info?.type === "Boolean") return value !== 0 ? "on" : "off";
    return shown(value, this.unit(name));
  }

  /** Interpolates between two rows. Used for motion, not for displayed numbers. */
  between(name: string, time: number): number {
    const values = this.values(name);
    if (!values) return NaN;
    const row = rowAt(this.times, time);
    if (row + 1 >= values.length) return values[row];
    const part = (time - this.times[row]) / (this.times[row + 1] - this.times[row]);
    return values[row] + Math.min(Math.max(part, 0), 1) * (values[row + 1] - values[row]);
  }

  /** Returns a curve. If the run did not record the variable, returns null. */
  curve(info: CurveInfo): Curve | null {
    const variable = info.rate_of ?? info.variable ?? "";
    if (!this.has(variable)) return null;
    const isRate = info.rate_of !== undefined;
    let rates: Float64Array | null = null;
    let ratesOf = "";
    return {
      label: info.label ?? variable,
      unit: isRate ? rateUnit(this.unit(variable)) : this.unit(variable),
      isRate,
      variable,
      values: (mean) => {
        const values = this.values(variable)!;
        if (!isRate) return values;
        const wanted = `${this.version} ${mean}`;
        if (rates === null || ratesOf !== wanted) rates = meanRates(this.times, values, mean);
        ratesOf = wanted;
        return rates;
      },
    };
  }

  /** Returns the sum of the recorded curves. If the run recorded none of them, returns null. */
  sum(infos: CurveInfo[]): Curve | null {
    const curves = infos.map((info) => this.curve(info)).filter((curve) => curve !== null);
    if (curves.length === 0) return null;
    return {
      label: "total",
      unit: curves[0].unit,
      isRate: curves.some((curve) => curve.isRate),
      variable: curves.map((curve) => curve.variable).join(" + "),
      values: (mean) => {
        const parts = curves.map((curve) => curve.values(mean));
        return parts[0].map((_, row) => parts.reduce((total, values) => total + values[row], 0));
      },
    };
  }

  instanceOf(name: string): string {
    const known = Object.keys(this.system?.instances ?? {}).find((instance) => name.startsWith(instance + "."));
    return known ?? name.split(".")[0];
  }

  get marks(): Message[] {
    const chosen = this.system?.view.marks ?? [];
    return this.messages.filter(
      (message) => message.time !== null && (message.severity !== "info" || chosen.length === 0 || chosen.includes(message.instance)),
    );
  }
}

/** Returns the mean rate of change for each row. Forms groups of consecutive rows that each span at least `mean`
 * seconds. All rows of a group have the same rate. */
function meanRates(times: Float64Array, values: Float64Array, mean: number): Float64Array {
  const result = new Float64Array(values.length);
  for (let first = 0; first + 1 < values.length; ) {
    let last = first + 1;
    while (last + 1 < values.length && times[last] - times[first] < mean * (1 - 1e-9)) ++last;
    const span = times[last] - times[first];
    result.fill(span > 0 ? (values[last] - values[first]) / span : 0, first + 1, last + 1);
    first = last;
  }
  if (result.length > 1) result[0] = result[1];
  return result;
}
