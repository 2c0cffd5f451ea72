// SPDX-License-Identifier: Apache-2.0
// A picture on a canvas with two axes. Omits a text that would overlap another text or leave the picture.
import { element } from "../dom";
import { onTheme, styleColour } from "../theme";

export interface Axis {
  title: string;
  range: [number, number];
  /** A tick shows its value multiplied by this factor. */
  scale?: number;
  log?: boolean;
  /** Values with names. Their ticks replace ticks at round numbers. */
  names?: [number, string][];
  /** Returns the text of a tick. By default, this is the number. */
  text?: (value: number) => string;
}

interface Box {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

const FONT = "12px system-ui, sans-serif";
const LINE = 15; // height of a line of text in pixels

export class Plot {
  readonly canvas = element("canvas", { role: "img", tabindex: "0" });
  readonly root: HTMLElement = element("div", { class: "plot" }, this.canvas);
  context!: CanvasRenderingContext2D;
  width = 0;
  height = 0;
  box: Box = { left: 0, right: 1, top: 0, bottom: 1 };
  /** The texts of the last drawing and their positions. */
  texts: (Box & { text: string })[] = [];
  private xAxis!: Axis;
  private yAxis!: Axis;

  /** `label` describes the picture for screen readers. `heightOf` returns the height for a width. */
  constructor(label: string, private readonly heightOf: (width: number) => number, private readonly draw: () => void) {
    this.canvas.setAttribute("aria-label", label);
    (this.canvas as HTMLCanvasElement & { plot: Plot }).plot = this; // used by tests
    new ResizeObserver(() => this.redraw()).observe(this.root);
    onTheme(() => this.redraw());
  }

  redraw(): void {
    const width = this.root.clientWidth;
    if (width === 0) return;
    const height = this.heightOf(width);
    const ratio = devicePixelRatio;
    if (this.width !== width || this.height !== height || this.canvas.width !== Math.round(width * ratio)) {
      [this.width, this.height] = [width, height];
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
      this.canvas.style.height = `${height}px`;
    }
    this.context = this.canvas.getContext("2d")!;
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, width, height);
    this.context.font = FONT;
    this.texts = [];
    this.draw();
  }

  /** Draws the axes. Sets `box` to the area of the plot between the axes. */
  axes(x: Axis, y: Axis): void {
    [this.xAxis, this.yAxis] = [x, y];
    const lines = x.title === "" ? 1.4 : 2.6;
    this.box = { left: 0, right: this.width - 10, top: y.title === "" ? 8 : LINE + 8, bottom: this.height - lines * LINE };
    const yTicks = this.ticksOf(y, (this.box.bottom - this.box.top) / 34);
    this.box.left = 10 + Math.max(0, ...yTicks.map(([, text]) => this.context.measureText(text).width));
    const xTicks = this.ticksOf(x, (this.box.right - this.box.left) / 80);
    const { context, box } = this;
    context.strokeStyle = styleColour("--grid");
    context.lineWidth = 1;
    context.beginPath();
    for (const [value] of yTicks) this.segment(box.left, this.y(value), box.right, this.y(value));
    if (!x.names) for (const [value] of xTicks) this.segment(this.x(value), box.top, this.x(value), box.bottom);
    context.stroke();
    const colour = styleColour("--faint");
    for (const [value, text] of yTicks) this.text(text, box.left - 6, this.y(value) + 4, { align: "right", colour });
    for (const [value, text] of xTicks) this.text(text, this.x(value), box.bottom + LINE, { align: "center", colour, within: true });
    this.text(y.title, 2, LINE - 3, { colour });
    this.text(x.title, box.right, box.bottom + 2 * LINE + 2, { align: "right", colour });
  }

  x(value: number): number {
    return this.box.left + shareOf(this.xAxis, value) * (this.box.right - this.box.left);
  }

  y(value: number): number {
    return this.box.bottom - shareOf(this.yAxis, value) * (this.box.bottom - this.box.top);
  }

  at(x: number, y: number): [number, number] {
    const { left, right, top, bottom } = this.box;
    return [valueOf(this.xAxis, (x - left) / (right - left)), valueOf(this.yAxis, (bottom - y) / (bottom - top))];
  }

  segment(x1: number, y1: number, x2: number, y2: number): void {
    this.context.moveTo(x1, y1);
    this.context.lineTo(x2, y2);
  }

  /** Draws a line through the points. A null interrupts it. */
  line(points: ([number, number] | null)[]): void {
    let isDown = false;
    for (const point of points) {
      if (point) this.context[isDown ? "lineTo" : "moveTo"](point[0], point[1]);
      isDown = point !== null;
    }
  }

  /** Draws a text if there is space for it. `halo` separates the text from lines behind it. `within` moves the text
   * into the picture. Returns true if the text was drawn. */
  text(
    text: string, x: number, y: number,
    { align = "left", colour = "", halo = false, within = false }: { align?: CanvasTextAlign; colour?: string; halo?: boolean; within?: boolean } = {},
  ): boolean {
    if (text === "") return false;
    const { context } = this;
    const width = context.measureText(text).width;
    let left = align === "left" ? x : align === "right" ? x - width : x - width / 2;
    if (within) left = Math.min(Math.max(left, 1), this.width - width - 1);
    const box = { left, right: left + width, top: y - 11, bottom: y + 3, text };
    const gap = 4;
    const isFree = this.texts.every((other) => box.left >= other.right + gap || box.right + gap <= other.left || box.top >= other.bottom || box.bottom <= other.top);
    if (!isFree || left < 0 || box.right > this.width || box.top < 0 || box.bottom > this.height) return false;
    this.texts.push(box);
    context.textAlign = "left";
    if (halo) {
      context.strokeStyle = styleColour("--card");
      context.lineWidth = 4;
      context.lineJoin = "round";
      context.strokeText(text, left, y);
    }
    context.fillStyle = colour || styleColour("--text");
    context.fillText(text, left, y);
    return true;
  }

  fitted(text: string, width: number): string {
    if (this.context.measureText(text).width <= width) return text;
    let length = text.length;
    while (length > 1 && this.context.measureText(`${text.slice(0, length)}\u2026`).width > width) --length;
    return `${text.slice(0, length)}\u2026`;
  }

  private ticksOf(axis: Axis, most: number): [number, string][] {
    if (axis.names) return axis.names;
    const { scale = 1, range, text } = axis;
    const [low, high] = [range[0] * scale, range[1] * scale];
    const values = axis.log ? powers(low, high) : roundNumbers(low, high, Math.max(2, most));
    return values.map((value) => [value / scale, text ? text(value) : tickText(value, values)]);
  }
}

const shareOf = ({ range: [low, high], log }: Axis, value: number) =>
  log ? (Math.log(value) - Math.log(low)) / (Math.log(high) - Math.log(low)) : (value - low) / (high - low);

const valueOf = ({ range: [low, high], log }: Axis, share: number) =>
  log ? low * (high / low) ** share : low + share * (high - low);

/** Returns about `most` round numbers in a range: multiples of 1, 2 or 5 times a power of ten. */
export function roundNumbers(low: number, high: number, most: number): number[] {
  const raw = (high - low) / most;
  if (!(raw > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5, 10].find((each) => each * power >= raw * (1 - 1e-9)) ?? 10);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.max(0, Math.floor(high / step + 1e-9) - first + 1) }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** Returns the powers of ten in a range, or every n-th power if the range is long. If the range is short, also returns
 * 2 and 5 times these powers. */
function powers(low: number, high: number): number[] {
  const decades = Math.log10(high / low);
  const every = Math.max(1, Math.ceil(decades / 8));
  const found: number[] = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += every) {
    for (const factor of decades <= 2 ? [1, 2, 5] : [1]) found.push(Number((factor * 10 ** power).toPrecision(6)));
  }
  return found.filter((value) => value >= low * 0.999 && value <= high * 1.001);
}

function tickText(value: number, all: number[]): string {
  const largest = Math.max(...all.map(Math.abs));
  if (value === 0) return "0";
  const text = largest >= 1e6 || Math.abs(value) < 1e-4 ? value.toExponential() : String(value);
  return text.replace("e+", "e").replaceAll("-", "\u2212");
}

/** Returns the range of the values with a margin. If all values are equal, returns a range around them. The range of
 * shares is within 0 to 1. */
export function extent(values: Iterable<number | null>, { margin = 0.05, isShare = false } = {}): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value === null) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return [0, 1];
  const isFlat = high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high));
  const space = isFlat ? Math.max(1e-9, 0.05 * Math.abs(high)) : margin * (high - low);
  return isShare ? [Math.max(0, low - space), Math.min(1, high + space)] : [low - space, high + space];
}

/** Calls the listeners with the position of the pointer. A press without a movement is a click. A press with a movement
 * is a drag. */
export function listenToPointer(
  target: HTMLElement,
  { click, drag, end }: { click: (x: number, y: number) => void; drag?: (from: [number, number], to: [number, number]) => void; end?: () => void },
): void {
  let from: [number, number] | null = null;
  let moved = false;
  const place = (event: PointerEvent): [number, number] => {
    const { left, top } = target.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  };
  target.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    [from, moved] = [place(event), false];
    target.setPointerCapture(event.pointerId);
  });
  target.addEventListener("pointermove", (event) => {
    if (!from || !drag) return;
    const to = place(event);
    moved ||= Math.hypot(to[0] - from[0], to[1] - from[1]) > 5;
    if (moved) drag(from, to);
  });
  target.addEventListener("pointerup", (event) => {
    if (!from) return;
    if (moved) {
      drag?.(from, place(event)); // the browser may merge moves, so that it does not report the last one
      end?.();
    } else click(...from);
    from = null;
  });
  target.addEventListener("pointercancel", () => (from = null));
}
