// SPDX-License-Identifier: Apache-2.0
// Stores sizes of parts of a page, with which the next page opens. A browser may refuse to store them, for example for
// pages from the disk. Then they are forgotten.

const PREFIX = "mebots size: ";

/** Stores a size [px] under a name. If `size` is null, deletes the stored size. */
export function remember(name: string, size: number | null): void {
  try {
    if (size === null) localStorage.removeItem(PREFIX + name);
    else localStorage.setItem(PREFIX + name, String(Math.round(size)));
  } catch {
    // The size stays for this page.
  }
}

/** Returns the stored size [px]; null if there is none. */
export function recalled(name: string): number | null {
  try {
    const size = Number(localStorage.getItem(PREFIX + name) ?? NaN);
    return Number.isFinite(size) && size > 0 ? size : null;
  } catch {
    return null;
  }
}
