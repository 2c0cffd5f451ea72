// SPDX-License-Identifier: Apache-2.0
// Stores sizes of a page's parts for the next page. A browser may refuse to store data, for example for pages from the
// disk. The sizes are then lost.

const PREFIX = "mebots size: ";

/** Stores a size [px] under a name. If `size` is null, deletes it. */
export function remember(name: string, size: number | null): void {
  try {
    if (size === null) localStorage.removeItem(PREFIX + name);
    else localStorage.setItem(PREFIX + name, String(Math.round(size)));
  } catch {
    // If the browser refuses to store data, the size is lost when the page closes.
  }
}

/** Returns the stored size [px]; null if it is missing. */
export function recalled(name: string): number | null {
  try {
    const size = Number(localStorage.getItem(PREFIX + name) ?? NaN);
    return Number.isFinite(size) && size > 0 ? size : null;
  } catch {
    return null;
  }
}
