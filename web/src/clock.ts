// SPDX-License-Identifier: Apache-2.0
// The time that all parts of a run's page show, and its playback.

export type Listener = (time: number) => void;

export class Clock {
  private now = 0;
  private playing = false;
  private readonly listeners: Listener[] = [];
  private readonly stateListeners: (() => void)[] = [];
  private lastFrame = 0;
  speed = 1;

  constructor(private last: number) {}

  get end(): number {
    return this.last;
  }

  /** Moves the end to a later time while the run continues. */
  extend(end: number): void {
    this.last = end;
    this.notifyState();
  }

  get time(): number {
    return this.now;
  }

  get isPlaying(): boolean {
    return this.playing;
  }

  onTime(listener: Listener): void {
    this.listeners.push(listener);
  }

  onState(listener: () => void): void {
    this.stateListeners.push(listener);
  }

  set(time: number): void {
    this.now = Math.min(Math.max(time, 0), this.end);
    for (const listener of this.listeners) listener(this.now);
  }

  play(): void {
    if (this.playing) return;
    if (this.now >= this.end) this.set(0);
    this.playing = true;
    this.lastFrame = performance.now();
    requestAnimationFrame((frame) => this.advance(frame));
    this.notifyState();
  }

  pause(): void {
    this.playing = false;
    this.notifyState();
  }

  toggle(): void {
    if (this.playing) this.pause();
    else this.play();
  }

  setSpeed(speed: number): void {
    this.speed = speed;
    this.notifyState();
  }

  private advance(frame: number): void {
    if (!this.playing) return;
    const passed = Math.max(0, frame - this.lastFrame) / 1000;
    this.lastFrame = frame;
    this.set(this.now + passed * this.speed);
    if (this.now >= this.end) this.pause();
    else requestAnimationFrame((next) => this.advance(next));
  }

  private notifyState(): void {
    for (const listener of this.stateListeners) listener();
  }
}
