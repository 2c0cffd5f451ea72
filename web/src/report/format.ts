// SPDX-License-Identifier: Apache-2.0
import type { Factor, Objective } from "./content";

/** Formats a number with at most `most` significant digits and a real minus sign. Omits trailing zeros, except before
 * an exponent. */
export function digits(value: number, most = 4): string {
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e7 || size < 1e-4 ? value.toExponential(Math.min(most, 3) - 1) : String(Number(value.toPrecision(most)));
  return text.replaceAll("-", "\u2212");
}

export const joined = (text: string, unit: string) => (unit === "" ? text : `${text} ${unit}`);

export function factorText(factor: Factor, value: number | string | boolean): string {
  return factor.number ? joined(digits(Number(value) * factor.scale), factor.unit) : String(value);
}

export function objectiveText(objective: Objective, value: number | null): string {
  return value === null ? "\u2013" : joined(digits(value * objective.scale), objective.unit);
}

/** Returns the title of an objective, such as "energy [J]" or "energy (percentile 90) [J]". */
export function titleOf({ label, statistic, unit }: Objective): string {
  const name = statistic === "mean" ? label : `${label} (${statistic})`;
  return unit === "" ? name : `${name} [${unit}]`;
}

/** Formats a share in per cent. Uses more digits near 100 %, so that 0.9999 does not become "100 %". */
export function percent(share: number): string {
  if (share > 0 && share < 0.001) return "< 0.1 %";
  return `${digits(100 * share, share > 0.99 && share < 1 ? 4 : 2)} %`;
}

export const counted = (count: number, what: string) => `${count.toLocaleString("en")} ${what}${count === 1 ? "" : "s"}`;

/** Formats a probability, such as "2.1 %", or "1.4e-5" if it is small. */
export function chanceText(value: number | null): string {
  if (value === null) return "\u2013";
  return value !== 0 && value < 1e-3 ? value.toExponential(1).replace("-", "\u2212") : percent(value);
}
