// How recorded frames are played, and the ticks of rulers.

export interface Pace {
  /** Frames of a second of simulated time. */
  rate: number;
  speed: number;
  way: 1 | -1;
  loop: boolean;
  /** The last frame that there is. */
  last: number;
}

/** Where playback is some seconds of clock later; at an end it begins anew or has ended. */
export function advance(at: number, seconds: number, { rate, speed, way, loop, last }: Pace): { at: number; ended: boolean } {
  // The time of a browser's frame may be before that of the event that began it.
  const to = at + way * rate * speed * Math.max(seconds, 0);
  if (to >= 0 && to <= last) return { at: to, ended: false };
  if (!loop || last <= 0) return { at: way > 0 ? last : 0, ended: true };
  const length = last + 1;
  return { at: Math.min(((to % length) + length) % length, last), ended: false };
}

/** 1, 2 or 5 times a power of ten, at least this much. */
export function niceStep(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((f) => f * power).find((s) => s >= least * (1 - 1e-9))!;
}

/** Round numbers from `low` to `high`, at most `most` and one. */
export function ticks(low: number, high: number, most: number): number[] {
  if (!(high > low)) return [low];
  const step = niceStep((high - low) / most);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** As ticks(), but two at least, so that an axis tells its scale. */
export function someTicks(low: number, high: number, most: number): number[] {
  const found = ticks(low, high, most);
  return found.length > 1 || !(high > low) ? found : someTicks(low, high, most + 1);
}

/** "1 frame", "2 frames" */
export const counted = (n: number, what: string): string => `${n.toLocaleString("en")} ${what}${n === 1 ? "" : "s"}`;

/** The frames up to `last` that can be looked at again, where 0, `every` and its multiples are kept. */
export const recordedFrames = (last: number, every: number): number[] => Array.from({ length: Math.floor(last / every) + 1 }, (_, i) => i * every);
