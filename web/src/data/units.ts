// SPDX-License-Identifier: Apache-2.0
// Formats numbers with four digits, a prefix if the unit permits one, and the unit.

const PREFIXED = new Set(["W", "J", "V", "A", "N", "N.m", "Hz", "Pa", "C", "F", "Ohm", "1/s", "bit/s", "s"]);
const PREFIXES: [number, string][] = [
  [1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"],
];
export const SHARE = "s/s";

const RATES: Record<string, string> = { J: "W", s: SHARE, m: "m/s", rad: "rad/s", "m/s": "m/s2", C: "A", "1": "1/s", "-": "1/s" };

/** Maps a unit to the quantity that it measures, followed by other words for it. */
const UNIT_WORDS: Record<string, string> = {
  V: "voltage volt", A: "current ampere", W: "power watt", J: "energy joule", s: "time second", m: "length distance metre",
  "m/s": "speed velocity", "m/s2": "acceleration", rad: "angle radian", "rad/s": "angular_speed rate", Hz: "frequency clock hertz", N: "force newton",
  "N.m": "torque newton metre", degC: "temperature celsius", K: "temperature kelvin", kg: "mass kilogram", Pa: "pressure pascal", Ohm: "resistance",
};

/** Returns the words by which a search finds variables with this unit. */
export function wordsOf(unit: string): string {
  return (UNIT_WORDS[unit] ?? "").replaceAll("_", " ");
}

/** Returns the quantity that a unit measures, such as "voltage" for V. For an unknown unit, returns an empty text. */
export function meaningOf(unit: string): string {
  return (UNIT_WORDS[unit] ?? "").split(" ")[0].replaceAll("_", " ");
}

/** Formats a unit, such as "N·m" for "N.m" and "m/s²" for "m/s2". For a number without a unit, returns an empty text. */
export function shownUnit(unit: string): string {
  if (unit === "-" || unit === "1" || unit === "") return "";
  if (unit === SHARE) return "%";
  return unit.replaceAll(".", "·").replace(/([a-zA-Z])2\b/g, "$1²").replace(/([a-zA-Z])3\b/g, "$1³");
}

export function rateUnit(unit: string): string {
  return RATES[unit] ?? `${unit}/s`;
}

function digits(value: number): string {
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size >= 1e6 || size < 1e-4) return value.toExponential(2);
  const decimals = Math.max(0, 3 - Math.floor(Math.log10(size)));
  return value.toFixed(Math.min(decimals, 5)).replace("-", "\u2212");
}

/** Returns the factor and the prefix that make a number of this size easiest to read. */
export function prefixFor(size: number, unit: string): [number, string] {
  if (unit === SHARE) return [0.01, ""];
  if (!PREFIXED.has(unit) || !(size > 0)) return [1, ""];
  if (unit === "s" && size >= 1) return [1, ""];
  return PREFIXES.find(([factor]) => size >= 0.9995 * factor) ?? PREFIXES[PREFIXES.length - 1];
}

export function shown(value: number, unit: string): string {
  if (unit === SHARE) return `${+(100 * value).toPrecision(3)} %`;
  if (shownUnit(unit) === "" && Number.isInteger(value) && Math.abs(value) < 1e9) return String(value).replace("-", "\u2212");
  const [factor, prefix] = prefixFor(Math.abs(value), unit);
  const text = digits(value / factor);
  const name = shownUnit(unit);
  if (unit === "1/s") return `${text} ${prefix}/s`.replace(" /s", "/s").replace(/ (.)\/s/, " $1/s");
  return name === "" ? text : `${text} ${prefix}${name}`;
}

let timeScale: [number, string] = [1, "s"];

/** Chooses the unit of all shown times. The unit depends on the length of the run, because a chip's program may end
 * after a millisecond. */
export function setTimeScale(end: number): void {
  timeScale = end >= 1 || !(end > 0) ? [1, "s"] : end >= 1e-3 ? [1e-3, "ms"] : [1e-6, "µs"];
}

export function shownTime(seconds: number): string {
  return `${(seconds / timeScale[0]).toFixed(2)} ${timeScale[1]}`;
}

/** Formats the time of a tick with as many digits as necessary. */
export function shownTick(seconds: number): string {
  return `${+(seconds / timeScale[0]).toFixed(6)} ${timeScale[1]}`;
}
