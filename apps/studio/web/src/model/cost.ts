// What a run will take, from what the last ones took.
import type { Status } from "./store";

/** See "scene.cost" in PROTOCOL.md. */
export interface Cost {
  particles: number;
  bytes: number;
  available: number;
  steps: number;
  at_least: boolean;
  fits: boolean;
}

/** Seconds a step and particle, where nobody knows. */
export const kNoPace = 0;

/** Fewer steps than this tell little. */
const kFewSteps = 5;
/** Of a new run in what is known after it. */
const kShare = 0.5;

/** What is known of a pace, in seconds a step and particle, after a run. */
export function mendPace(known: number, { steps = 0, stepping_seconds: spent = 0, particles = 0 }: Pick<Status, "steps" | "stepping_seconds" | "particles">): number {
  if (steps < kFewSteps || particles === 0 || spent === 0) return known;
  const pace = spent / steps / particles;
  return known === kNoPace ? pace : known + kShare * (pace - known);
}

/** How long a run takes, s, if all of its particles are there from the start; null where nobody knows. */
export const secondsFor = (cost: Cost, pace: number): number | null => (pace === kNoPace ? null : pace * cost.steps * cost.particles);
