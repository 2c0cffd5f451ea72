// SPDX-License-Identifier: Apache-2.0
// Colours of curves. Most are from the palette of Okabe and Ito, which people with any colour vision can distinguish.
// On a dark background, all colours are lighter.

const LIGHT = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b58900", "#56b4e9", "#5c4d9e", "#7f7f7f", "#8c564b"];
const DARK = ["#4ea8de", "#f0803c", "#2fc79a", "#e39ac4", "#e6c14a", "#8fd3ff", "#a394e8", "#a9a9a9", "#c49c94"];

const darkQuery = matchMedia("(prefers-color-scheme: dark)");
const listeners: (() => void)[] = [];

let dark = darkQuery.matches; // initially as in the system, until the user chooses

export function isDark(): boolean {
  return dark;
}

export function colour(index: number): string {
  const palette = isDark() ? DARK : LIGHT;
  return palette[index % palette.length];
}

export function styleColour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

export function onTheme(listener: () => void): void {
  listeners.push(listener);
}

export function setTheme(wanted: boolean): void {
  dark = wanted;
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  for (const listener of listeners) listener();
}

setTheme(dark);
darkQuery.addEventListener("change", () => setTheme(darkQuery.matches));

// Cividis (Nunez, Anderton and Renslow 2018). Its lightness rises evenly, so that it looks the same to colour-blind
// people.
const CIVIDIS = [
  [0, 34, 78], [18, 53, 112], [59, 73, 108], [87, 93, 109], [112, 113, 115], [138, 134, 120], [165, 156, 116],
  [195, 179, 105], [225, 204, 85], [254, 232, 56],
];

/** Converts a share from 0 to 1 to a colour of CIVIDIS: red, green and blue from 0 to 1. */
export function scaleColour(share: number): [number, number, number] {
  const place = Math.min(Math.max(share, 0), 1) * (CIVIDIS.length - 1);
  const first = Math.min(Math.floor(place), CIVIDIS.length - 2);
  const part = place - first;
  const mixed = CIVIDIS[first].map((value, i) => (value + part * (CIVIDIS[first + 1][i] - value)) / 255);
  return [mixed[0], mixed[1], mixed[2]];
}
