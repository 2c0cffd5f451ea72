// SPDX-License-Identifier: Apache-2.0
// The time span that all plots show, and the time under the pointer, which all plots mark. At first, the span is the
// whole run.

export class Window {
  private from = 0;
  private to: number;
  private at: number | null = null;
  private readonly listeners: (() => void)[] = [];
  private readonly pointListeners: (() => void)[] = [];

  constructor(private end: number) {
    this.to = end;
  }

  /** Moves the end of the run to a later time. If the span is the whole run, extends the span. */
  extend(end: number): void {
    const whole = this.isWhole;
    this.end = end;
    this.set(this.from, whole ? end : this.to);
  }

  get start(): number {
    return this.from;
  }

  get stop(): number {
    return this.to;
  }

  /** The averaging time of rates [s]. It corresponds to a few pixels of a plot, so that fast switching appears as its
   * mean. */
  get mean(): number {
    return (this.to - this.from) / 110;
  }

  get isWhole(): boolean {
    return this.from === 0 && this.to === this.end;
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  set(from: number, to: number): void {
    const shortest = this.end / 2000;
    const span = Math.min(Math.max(to - from, shortest), this.end);
    this.from = Math.min(Math.max(from, 0), this.end - span);
    this.to = this.from + span;
    for (const listener of this.listeners) listener();
  }

  /** Scales the span by a factor around the time `at`. */
  zoom(factor: number, at: number): void {
    this.set(at - (at - this.from) * factor, at + (this.to - at) * factor);
  }

  reset(): void {
    this.set(0, this.end);
  }

  /** The time under the pointer. If the pointer is on no plot, null. */
  get pointed(): number | null {
    return this.at;
  }

  point(time: number | null): void {
    if (time === this.at) return;
    this.at = time;
    for (const listener of this.pointListeners) listener();
  }

  onPoint(listener: () => void): void {
    this.pointListeners.push(listener);
  }
}
