// Arrows in the view that stand for values: gravity, and the speed of what pours out of a nozzle. Their tips are dragged.
import { isUsed } from "./parameters";
import { setParam, type Owner, type Scene } from "./scene";
import type { Json, Types } from "./types";

/** A value as an arrow from a point, m, along a way, m for each of its units. */
export interface Arrow {
  owner: Owner;
  parameter: string;
  unit: string;
  from: number[];
  /** Of a speed: the way that it has, of length 1; a vector has its own. */
  way: number[] | null;
  value: number | number[];
  /** m for each unit of the value */
  scale: number;
}

const kDigits = 3;
const isVector = (v: Json | undefined): v is number[] => Array.isArray(v) && v.length === 3 && v.every((x) => typeof x === "number");
const add = (a: number[], b: number[], by: number): number[] => a.map((x, i) => x + by * b[i]!);
const dot = (a: number[], b: number[]): number => a.reduce((s, x, i) => s + x * b[i]!, 0);

export const tipOf = (a: Arrow): number[] => (a.way ? add(a.from, a.way, a.scale * (a.value as number)) : add(a.from, a.value as number[], a.scale));

/** The speed of a node that has a place, a turn and a speed; `turned` gives the way of its nozzle, which looks down, for its turn. */
export function speedArrow(scene: Scene, types: Types, node: string, scale: number, turned: (rotation: Json) => number[]): Arrow | null {
  const spec = scene.nodes[node], parameters = types.nodes[spec?.type ?? ""]?.parameters ?? [];
  const values = spec?.params ?? {};
  const value = (name: string): Json | undefined => {
    const p = parameters.find((q) => q.name === name);
    return p && isUsed(p, parameters, values) ? (values[name] ?? p.default) : undefined;
  };
  const [speed, position] = [value("speed"), value("position")];
  if (typeof speed !== "number" || !isVector(position)) return null;
  return { owner: { node }, parameter: "speed", unit: "m/s", from: position, way: turned(value("rotation") ?? null), value: speed, scale };
}

/** The one vector of the world's parameters that is an acceleration. */
export function gravityArrow(scene: Scene, types: Types, from: number[], scale: number): Arrow | null {
  const p = types.world.find((q) => q.kind === "vec3" && q.unit === "m/s^2");
  const value = p && (scene.world?.[p.name] ?? p.default);
  return p && isVector(value) ? { owner: { section: "world" }, parameter: p.name, unit: p.unit!, from, way: null, value, scale } : null;
}

/** Of all axes, how near to one a vector is drawn onto it, as the cosine. */
const kNear = Math.cos((8 * Math.PI) / 180);

/** A vector that is nearly along an axis lies on it. */
export function onAxis(v: number[]): number[] {
  const length = Math.hypot(...v);
  const axis = v.findIndex((x) => Math.abs(x) >= kNear * length);
  return axis < 0 || length === 0 ? v : v.map((x, i) => (i === axis ? Math.sign(x) * length : 0));
}

/** The scene with the tip of an arrow elsewhere. */
export function withTip(scene: Scene, arrow: Arrow, tip: number[]): Scene {
  const drawn = add(tip, arrow.from, -1).map((x) => x / arrow.scale);
  const round = (x: number) => Number(x.toPrecision(kDigits));
  const value = arrow.way ? round(Math.max(dot(drawn, arrow.way), 0)) : onAxis(drawn).map(round);
  return setParam(scene, arrow.owner, [arrow.parameter], value);
}
