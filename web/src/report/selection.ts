// SPDX-License-Identifier: Apache-2.0
// The designs and missions that the user has selected: filters from brushes, one chosen design, and missions to
// compare. Identifies a design by its index in the page.

const FRAME_MS = 10;

type Test = (design: number) => boolean;

export interface Mission {
  design: number;
  replicate: number;
}

export class Selection {
  readonly isIn: Uint8Array;
  count: number;
  chosen = -1;
  ticked: Mission[] = [];
  /** The time that drawing took in the last animation frame [ms]. */
  lastFrame_ms = 0;
  /** Panels that must be drawn, because the selection has changed. */
  readonly dirty = new Set<() => void>();
  private readonly filters = new Map<string, Test>();
  private readonly listeners: (() => void)[] = [];
  private readonly resets: (() => void)[] = [];

  constructor(readonly size: number) {
    this.isIn = new Uint8Array(size).fill(1);
    this.count = size;
  }

  get isFiltered(): boolean {
    return this.filters.size > 0;
  }

  get designs(): number[] {
    return Array.from({ length: this.size }, (_, i) => i).filter((i) => this.isIn[i]);
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** Adds a listener for the removal of all filters. */
  onReset(listener: () => void): void {
    this.resets.push(listener);
  }

  /** Sets the filter of a brush. Null removes the filter. */
  filter(key: string, test: Test | null): void {
    if (test) this.filters.set(key, test);
    else if (!this.filters.delete(key)) return;
    const tests = [...this.filters.values()];
    this.count = 0;
    for (let i = 0; i < this.size; ++i) {
      this.isIn[i] = tests.every((each) => each(i)) ? 1 : 0;
      this.count += this.isIn[i];
    }
    this.changed();
  }

  reset(): void {
    for (const listener of this.resets) listener();
    for (const key of [...this.filters.keys()]) this.filter(key, null);
  }

  choose(design: number): void {
    if (design === this.chosen) return;
    this.chosen = design;
    this.changed();
  }

  isTicked({ design, replicate }: Mission): boolean {
    return this.ticked.some((one) => one.design === design && one.replicate === replicate);
  }

  /** Adds a mission to the comparison. If it is already there, removes it. */
  tick(mission: Mission): void {
    this.ticked = this.isTicked(mission)
      ? this.ticked.filter(({ design, replicate }) => design !== mission.design || replicate !== mission.replicate)
      : [...this.ticked, mission];
    this.changed();
  }

  clearTicks(): void {
    this.ticked = [];
    this.changed();
  }

  /** Draws all panels. Each animation frame draws panels until its time is used up. */
  changed(): void {
    const isIdle = this.dirty.size === 0;
    for (const listener of this.listeners) this.dirty.add(listener);
    if (isIdle) requestAnimationFrame(() => this.drawSome());
  }

  private drawSome(): void {
    const begin = performance.now();
    for (const listener of this.dirty) {
      this.dirty.delete(listener);
      listener();
      if (performance.now() - begin > FRAME_MS) break;
    }
    this.lastFrame_ms = performance.now() - begin;
    if (this.dirty.size > 0) requestAnimationFrame(() => this.drawSome());
  }
}
