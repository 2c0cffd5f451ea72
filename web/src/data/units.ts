// SPDX-License-Identifier: Apache-2.0
// Formats numbers: four digits, a prefix if the unit allows one, and the unit.

const PREFIXED = new Set(["W", "J", "V", "A", "N", "N.m", "Hz", "Pa", "C", "F", "Ohm", "1/s", "bit/s", "s"]);
const PREFIXES: [number, string][] = [
  [1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"],
];
/** A share of a time. */
export const SHARE = "s/s";

const RATES: Record<string, string> = { J: "W", s: SHARE, m: "m/s", rad: "rad/s", "m/s": "m/s2", C: "A", "1": "1/s", "-": "1/s" };

/** Formats "N.m" as "N·m" and "m/s2" as "m/s²"; empty for a number without a unit. */
export function shownUnit(unit: string): string {
  if (unit === "-" || unit === "1" || unit === "") return "";
  if (unit === SHARE) return "%";
  return unit.replaceAll(".", "·").replace(/([a-zA-Z])2\b/g, "$1²").replace(/([a-zA-Z])3\b/g, "$1³");
}

/** The unit of a rate of change in time. */
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

/** The prefix under which a number of this size reads best. */
export function prefixFor(size: number, unit: string): [number, string] {
  if (unit === SHARE) return [0.01, ""];
  if (!PREFIXED.has(unit) || !(size > 0)) return [1, ""];
  // Kiloseconds are not in use.
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

export function shownTime(seconds: number): string {
  return `${seconds.toFixed(2)} s`;
}
