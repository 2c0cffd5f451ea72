// SPDX-License-Identifier: Apache-2.0
// The objective that the user has selected for the panels of effects, distributions, importances and convergence.
import type { Study } from "./content";

export class Shown {
  objective: number;
  private readonly listeners: (() => void)[] = [];

  constructor(study: Study) {
    this.objective = Math.max(0, study.objectives.findIndex(({ sense }) => sense !== 0));
  }

  set(objective: number): void {
    this.objective = objective;
    for (const listener of this.listeners) listener();
  }

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }
}
