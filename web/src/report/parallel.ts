// SPDX-License-Identifier: Apache-2.0
// Parallel coordinates: each design is a line through its factors and values. Dragging along an axis filters all
// panels. In a narrow page, the axes are one below the other.
import { element } from "../dom";
import { colour, styleColour } from "../theme";
import type { Place, Study } from "./content";
import { digits } from "./format";
import { placeColour } from "./fronts";
import { extent, listenToPointer, Plot } from "./plot";
import type { Selection } from "./selection";
import { panel } from "./widgets";

const NARROW = 520; // width below which the axes are one below the other [px]
const MANY = 200; // lines
const MOST_TICKS = 7;
const PLACES_IN_ORDER: Place[] = ["excluded", "off", "", "undecided", "on"];

interface Scale {
  label: string;
  /** The width of the axis's column, relative to that of an axis with numbers. Longer names of ticks need more
   * width. */
  room: number;
  /** The position of each design on the axis from 0 to 1; NaN if the design has no value. */
  place: Float64Array;
  ticks: [number, string][];
  brush: [number, number] | null;
}

export function makeParallel(study: Study, selection: Selection): HTMLElement {
  const scales = scalesOf(study, selection.size);
  const back = document.createElement("canvas"); // picture of the lines of all designs
  let backKey = "";
  let active = -1; // axis on which the user drags; -1 if none

  const isNarrow = () => plot.width < NARROW;
  const ends = (): [number, number] => (isNarrow() ? [14, plot.width - 14] : [plot.height - 34, 34]);
  const rooms = scales.map(({ room }) => room);
  const sum = (count: number) => rooms.slice(0, count).reduce((all, room) => all + room, 0);
  const side = (axis: number) => {
    if (isNarrow()) return 34 + axis * ((plot.height - 60) / Math.max(1, scales.length - 1));
    return 16 + (sum(axis) / sum(scales.length)) * (plot.width - 20);
  };
  const roomOf = (axis: number) => (axis + 1 < scales.length ? side(axis + 1) : plot.width) - side(axis);
  const along = (place: number) => {
    const [from, to] = ends();
    return from + place * (to - from);
  };
  const point = (axis: number, place: number): [number, number] => (isNarrow() ? [along(place), side(axis)] : [side(axis), along(place)]);

  /** The pixel positions of each axis, and of each design along the axis. layOut() computes them. */
  let pixels: { across: number; along: Float32Array }[] = [];
  const layOut = () => {
    pixels = scales.map(({ place }, axis) => ({ across: side(axis), along: Float32Array.from(place, along) }));
  };
  const trace = (context: CanvasRenderingContext2D, design: number) => {
    let isDown = false;
    const swaps = isNarrow();
    for (const { across, along: own } of pixels) {
      const value = own[design];
      if (Number.isNaN(value)) continue;
      const [x, y] = swaps ? [value, across] : [across, value];
      if (isDown) context.lineTo(x, y);
      else context.moveTo(x, y);
      isDown = true;
    }
  };

  const strokeAll = (context: CanvasRenderingContext2D, designs: number[]) => {
    for (const i of designs) {
      context.beginPath();
      trace(context, i);
      context.stroke();
    }
  };

  /** Draws the faint lines of all designs. Stores them as a picture, because they change only with the size and the
   * theme. */
  const drawBack = () => {
    const { canvas } = plot;
    const key = `${canvas.width}x${canvas.height} ${styleColour("--off")}`;
    if (key !== backKey) {
      backKey = key;
      layOut();
      [back.width, back.height] = [canvas.width, canvas.height];
      const context = back.getContext("2d")!;
      const ratio = canvas.width / plot.width;
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.strokeStyle = styleColour("--off");
      context.globalAlpha = strength(selection.size) * 0.35;
      strokeAll(context, Array.from({ length: selection.size }, (_, i) => i));
    }
    plot.context.drawImage(back, 0, 0, plot.width, plot.height);
  };

  const draw = () => {
    const { context } = plot;
    drawBack();
    const rank = (i: number) => (study.designs.front[i] === "on" || study.designs.rank[i] === 1 ? 1 : 0);
    const designs = selection.designs;
    for (const isFirst of [0, 1]) {
      for (const place of PLACES_IN_ORDER) {
        context.globalAlpha = isFirst ? 1 : strength(designs.length);
        context.lineWidth = isFirst ? 2 : designs.length > MANY ? 1 : 1.2;
        context.strokeStyle = placeColour(place);
        strokeAll(context, designs.filter((i) => rank(i) === isFirst && study.designs.front[i] === place));
      }
    }
    context.globalAlpha = 1;
    if (selection.chosen >= 0) {
      context.lineWidth = 3;
      context.strokeStyle = styleColour("--text");
      context.beginPath();
      trace(context, selection.chosen);
      context.stroke();
    }
    scales.forEach((scale, axis) => drawBrush(scale, axis));
    scales.forEach((_, axis) => drawAxis(axis));
    scales.forEach((scale, axis) => nameAxis(scale, axis));
    scales.forEach((scale, axis) => nameTicks(scale, axis));
  };

  function drawAxis(axis: number): void {
    const { context } = plot;
    context.strokeStyle = styleColour("--faint");
    context.lineWidth = 1.2;
    context.beginPath();
    plot.segment(...point(axis, 0), ...point(axis, 1));
    context.stroke();
  }

  function drawBrush({ brush }: Scale, axis: number): void {
    if (!brush) return;
    const { context } = plot;
    const [[x1, y1], [x2, y2]] = [point(axis, brush[0]), point(axis, brush[1])];
    context.fillStyle = `${colour(0)}44`;
    context.strokeStyle = colour(0);
    context.lineWidth = 1.5;
    const box: [number, number, number, number] = isNarrow() ? [x1, y1 - 8, x2 - x1, 16] : [x1 - 8, y2, 16, y1 - y2];
    context.fillRect(...box);
    context.strokeRect(...box);
  }

  function nameAxis({ label }: Scale, axis: number): void {
    const [x, y] = point(axis, isNarrow() ? 0 : 1);
    if (isNarrow()) return void plot.text(plot.fitted(label, plot.width - 20), 4, y - 14, { colour: styleColour("--text") });
    // Alternates between two lines for the names of axes, so that each name has twice the space.
    const room = roomOf(axis) + (axis + 1 < scales.length ? roomOf(axis + 1) : 0) - 6;
    plot.text(plot.fitted(label, room), Math.max(2, x - 10), axis % 2 ? 27 : 12, { colour: styleColour("--text") });
  }

  function nameTicks({ ticks }: Scale, axis: number): void {
    const room = isNarrow() ? (0.9 * plot.width) / Math.max(2, Math.min(5, ticks.length)) : roomOf(axis) - 12;
    for (const [place, text] of ticks) {
      const [x, y] = point(axis, place);
      if (isNarrow()) plot.text(plot.fitted(text, room), x, y + 14, { align: "center", halo: true, within: true, colour: styleColour("--faint") });
      else plot.text(plot.fitted(text, room), x + 5, y + 4, { halo: true, colour: styleColour("--faint") });
    }
  }

  const plot: Plot = new Plot("Parallel coordinates of the designs", (width) => (width < NARROW ? 60 + 58 * (scales.length - 1) : 360), draw);
  const axisAt = (x: number, y: number) => {
    const distances = scales.map((_, axis) => Math.abs((isNarrow() ? y : x) - side(axis)));
    return distances.indexOf(Math.min(...distances));
  };
  const placeAt = (x: number, y: number) => {
    const [from, to] = ends();
    return Math.min(1, Math.max(0, ((isNarrow() ? x : y) - from) / (to - from)));
  };
  const setBrush = (axis: number, brush: [number, number] | null) => {
    scales[axis].brush = brush;
    const { place } = scales[axis];
    selection.filter(`axis ${axis}`, brush && ((i) => place[i] >= brush[0] - 1e-9 && place[i] <= brush[1] + 1e-9));
    selection.changed();
  };
  listenToPointer(plot.canvas, {
    click: (x, y) => {
      const axis = axisAt(x, y);
      if (scales[axis].brush) setBrush(axis, null);
      else selection.choose(designAt(x, y));
    },
    drag: (from, to) => {
      if (active < 0) active = axisAt(...from);
      const [a, b] = [placeAt(...from), placeAt(...to)];
      setBrush(active, [Math.min(a, b), Math.max(a, b)]);
    },
    end: () => (active = -1),
  });

  /** Returns the design whose line is nearest to the pixel. If no line is near, returns -1. */
  function designAt(x: number, y: number): number {
    const across = isNarrow() ? y : x;
    let axis = scales.findIndex((_, i) => side(i) > across) - 1;
    if (axis < 0) axis = scales.length - 2;
    const share = (across - side(axis)) / (side(axis + 1) - side(axis));
    let [found, distance] = [-1, 12];
    for (const i of selection.designs) {
      const own = along(scales[axis].place[i] * (1 - share) + scales[axis + 1].place[i] * share);
      const apart = Math.abs(own - (isNarrow() ? x : y));
      if (apart < distance) [found, distance] = [i, apart];
    }
    return found;
  }

  selection.onChange(() => plot.redraw());
  selection.onReset(() => scales.forEach((scale) => (scale.brush = null)));
  Object.assign(plot.canvas, { scales: scales.map(({ label }, axis) => ({ label, point: (place: number) => point(axis, place) })), setBrush }); // for tests
  return panel("Parallel coordinates", "A line for each design. Drag along axes to select: all panels follow. Click a selection to remove it.", element("div", { class: "wide" }, plot.root));
}

const strength = (lines: number) => Math.min(0.75, Math.max(0.06, 12 / Math.sqrt(lines) / 6));

function scalesOf(study: Study, size: number): Scale[] {
  const designs = Array.from({ length: size }, (_, i) => i);
  const factors = study.factors.filter(({ levels }) => levels.length > 1).map((factor) =>
    factor.number
      ? numeric(factor.label, factor.unit, factor.scale, factor.values as number[], few(factor.values as number[]))
      : categorical(factor.label, factor.values.map(String)));
  const objectives = study.objectives.map(({ label, unit, scale, mean, share }) => numeric(label, unit, scale, mean, null, share));
  return [...factors, ...objectives].filter(({ place }) => designs.some((i) => !Number.isNaN(place[i])));
}

/** Returns the distinct values. If there are more than MOST_TICKS, returns null. */
function few(values: number[]): number[] | null {
  const distinct = new Set(values);
  return distinct.size <= MOST_TICKS ? [...distinct] : null;
}

function numeric(label: string, unit: string, scale: number, values: (number | null)[], ticks: number[] | null, isShare = false): Scale {
  const [low, high] = extent(values, { margin: 0, isShare });
  const place = (value: number) => (value - low) / (high - low || 1);
  const named = ticks ?? [low, low + 0.25 * (high - low), low + 0.5 * (high - low), low + 0.75 * (high - low), high];
  // Draws the names of both ends first. Names between them are omitted if there is no space.
  const order = [...named].sort((a, b) => Math.abs(place(b) - 0.5) - Math.abs(place(a) - 0.5));
  return {
    label: unit ? `${label} [${unit}]` : label,
    room: 1,
    place: Float64Array.from(values, (value) => (value === null ? NaN : place(value))),
    ticks: order.map((value) => [place(value), digits(value * scale, 4)]),
    brush: null,
  };
}

function categorical(label: string, values: string[]): Scale {
  const words = [...new Set(values)];
  const place = (word: string) => (words.indexOf(word) + 0.5) / words.length;
  const longest = Math.max(...words.map((word) => word.length));
  return { label, room: Math.min(2.2, Math.max(1, longest / 8)), place: Float64Array.from(values, place), ticks: words.map((word) => [place(word), word]), brush: null };
}
