// Runs that the page keeps, to look at them beside another one: what they were of, and what came of them.
import type { FramePacket, GeometryPacket } from "../protocol/packets";
import { labelOf } from "./parameters";
import { inUnit } from "./quantities";
import type { Scene } from "./scene";
import type { Json, JsonObject } from "./types";

/** Some numbers of a run over simulated time, for plots. */
export interface Sample {
  time: number;
  values: { [name: string]: number };
}

export type Point = readonly [time: number, value: number];

/** The numbers of a run before this window came; see HISTORY in PROTOCOL.md. */
export interface History {
  times: number[];
  values: { [name: string]: (number | null)[] };
}

export const samplesOf = ({ times, values }: History): Sample[] =>
  times.map((time, i) => ({ time, values: Object.fromEntries(Object.entries(values).flatMap(([name, row]) => (row[i] === null ? [] : [[name, row[i]!]]))) }));

/** A quantity over time, in the unit that it is shown in. */
export const pointsOf = (name: string, samples: Sample[]): Point[] =>
  samples.flatMap((s): Point[] => (Number.isFinite(s.values[name]) ? [[s.time, inUnit(name, s.values[name]!)]] : []));

/** The last point that is not after a time, or else the first one. */
export function pointAt(points: Point[], time: number): Point {
  let low = 0, high = points.length - 1;
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (points[middle]![0] <= time + 1e-9) low = middle;
    else high = middle - 1;
  }
  return points[low]!;
}

export interface Run {
  /** What it is called beside others. */
  label: string;
  /** As it was run, without what is switched off. */
  scene: Scene;
  /** One after another. */
  frames: FramePacket[];
  geometry: GeometryPacket | null;
  samples: Sample[];
}

/** The frame nearest to a time; null where there are none. */
export function frameAt(frames: FramePacket[], time: number): FramePacket | null {
  let best: FramePacket | null = null;
  for (const f of frames) if (!best || Math.abs(f.time - time) < Math.abs(best.time - time)) best = f;
  return best;
}

const bytesOf = (f: FramePacket): number => f.fluids.reduce((sum, g) => sum + g.positions.byteLength + (g.attribute?.values.byteLength ?? 0), 0);

/** A frame as it is kept: without what only the pointer asks for. */
export const lean = (f: FramePacket): FramePacket => ({
  ...f,
  fluids: f.fluids.map((g) => ({
    ...g, positions: g.positions.slice(), ids: new Float64Array(), ...(g.attribute && { attribute: { ...g.attribute, values: g.attribute.values.slice() } }),
  })),
});

/** How many frames to go on by, so that all of them fit: 1, 2, … */
export const strideFor = (frame: FramePacket, count: number, most: number): number => Math.max(1, Math.ceil((bytesOf(frame) * count) / most));

/** One value in which two scenes differ. */
export interface Difference {
  /** Where it is, for people: "water / viscosity: Strength". */
  name: string;
  node: string | null;
  module?: string;
  path: string[];
  before: Json | undefined;
  after: Json | undefined;
}

const isObject = (v: unknown): v is JsonObject => v !== null && typeof v === "object" && !Array.isArray(v);

/** The leaves in which two objects of parameters differ. Keyframes are one value. */
function leaves(a: JsonObject, b: JsonObject, path: string[], found: (path: string[], before: Json | undefined, after: Json | undefined) => void): void {
  for (const key of new Set([...Object.keys(a), ...Object.keys(b)])) {
    const [before, after] = [a[key], b[key]], here = [...path, key];
    if (JSON.stringify(before) === JSON.stringify(after)) continue;
    if (isObject(before) && isObject(after) && !("keyframes" in before) && !("keyframes" in after)) leaves(before, after, here, found);
    else found(here, before, after);
  }
}

/** What decides a run and differs between two scenes. Undefined is the default, or that it is not there. */
export function differencesOf(a: Scene, b: Scene): Difference[] {
  const all: Difference[] = [];
  const parameters = (owner: string, before: JsonObject = {}, after: JsonObject = {}, at: { node: string | null; module?: string }, own: string[] = []) =>
    leaves(before, after, [], (path, from, to) => all.push({ ...at, path: [...own, ...path], before: from, after: to, name: `${owner}: ${path.map(labelOf).join(" / ")}` }));
  for (const name of new Set([...Object.keys(a.nodes), ...Object.keys(b.nodes)])) {
    const [from, to] = [a.nodes[name], b.nodes[name]];
    if (from?.type !== to?.type) {
      all.push({ name, node: name, path: [], before: from?.type, after: to?.type });
      continue;
    }
    parameters(name, from?.params, to?.params, { node: name });
    const modules = [from?.modules ?? {}, to?.modules ?? {}] as const;
    for (const module of new Set(modules.flatMap((m) => Object.keys(m)))) {
      const [{ params: before, ...m }, { params: after, ...n }] = [modules[0][module] ?? {}, modules[1][module] ?? {}];
      parameters(`${name} / ${module}`, before, after, { node: name, module });
      leaves(m as JsonObject, n as JsonObject, [], (path, x, y) => all.push({ name: `${name} / ${module}: ${path.join(" / ")}`, node: name, module, path: [], before: x, after: y }));
    }
  }
  const links = (s: Scene) => new Set(s.links ?? []);
  for (const l of links(a)) if (!links(b).has(l)) all.push({ name: "link", node: null, path: [], before: l, after: undefined });
  for (const l of links(b)) if (!links(a).has(l)) all.push({ name: "link", node: null, path: [], before: undefined, after: l });
  parameters("World", a.world, b.world, { node: null }, ["world"]);
  return all;
}
