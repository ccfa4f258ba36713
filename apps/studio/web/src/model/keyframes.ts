// Values that change over time: {"keyframes": [[time, value], …]}, linear between them and held at the ends.
import type { Json, JsonObject } from "./types";

export type Keyframe = [time: number, value: Json];
type Point = [number, number];

export const isKeyframes = (v: Json | undefined): v is { keyframes: Json[] } =>
  v !== null && typeof v === "object" && !Array.isArray(v) && Array.isArray((v as JsonObject)["keyframes"]);

export const framesOf = (v: Json | undefined): Keyframe[] => (isKeyframes(v) ? (v.keyframes as Keyframe[]) : []);

/** How many numbers a value has; 0 where it has none. */
export const sizeOf = (v: Json | undefined): number => (typeof v === "number" ? 1 : Array.isArray(v) ? v.length : 0);

const part = (v: Json, k: number): number => Number(Array.isArray(v) ? v[k] : v);

const withPart = (v: Json, k: number, x: number): Json => (Array.isArray(v) ? v.map((old, i) => (i === k ? x : old)) : x);

/** The value at a time. */
export function valueAt(frames: Keyframe[], time: number): Json {
  const after = frames.findIndex((f) => f[0] >= time);
  if (after < 0) return frames.at(-1)?.[1] ?? null;
  const [t1, b] = frames[after]!;
  const before = frames[after - 1];
  if (!before || t1 === time) return b;
  const [t0, a] = before;
  const s = (time - t0) / (t1 - t0);
  const mix = (x: number, y: number) => Number((x + s * (y - x)).toPrecision(6));
  return Array.isArray(b) ? b.map((_, k) => mix(part(a, k), part(b, k))) : mix(part(a, 0), part(b, 0));
}

/** One of the numbers over time, as points. */
export const pointsOf = (frames: Keyframe[], k: number): Point[] => frames.map(([t, v]) => [t, part(v, k)]);

/** The keyframes when one of their numbers has these points: as many as before, one more, or one fewer. */
export function withPoints(frames: Keyframe[], k: number, points: Point[]): Keyframe[] {
  const differs = points.findIndex((p, i) => p[0] !== frames[i]?.[0] || p[1] !== part(frames[i]![1], k));
  const at = differs < 0 ? points.length : differs;
  if (points.length < frames.length) return frames.filter((_, i) => i !== at);
  if (points.length === frames.length)
    return frames.map(([, v], i) => [points[i]![0], withPart(v, k, points[i]![1])]);
  const [time, x] = points[at]!;
  return [...frames.slice(0, at), [time, withPart(valueAt(frames, time), k, x)], ...frames.slice(at)];
}

/** Changes a keyframe's time; they stay in order. */
export const withTime = (frames: Keyframe[], index: number, time: number): Keyframe[] =>
  frames.map((f, i): Keyframe => (i === index ? [time, f[1]] : f)).sort((a, b) => a[0] - b[0]);
