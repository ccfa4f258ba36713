// The planes that cut the fluids open in pictures and in the view: where they are, moved and turned by hand.
import { onAxis } from "./arrows";
import { setParam, type Scene } from "./scene";
import type { Json, JsonObject, Types } from "./types";

/** See "clips" of the section "render": what lies on the side of the normal is hidden; with a thickness, m, all but a slice. */
export interface Cut {
  point: number[];
  /** Of length 1. */
  normal: number[];
  thickness: number | null;
}

const kSection = { section: "render" }, kName = "clips";
const kDigits = 4;

const dot = (a: number[], b: number[]): number => a.reduce((s, x, i) => s + x * b[i]!, 0);
const plus = (a: number[], b: number[], by: number): number[] => a.map((x, i) => x + by * b[i]!);
const round = (v: number[]): number[] => v.map((x) => Number(x.toPrecision(kDigits)));
const numbers = (v: Json | undefined, usual: number[]): number[] => (Array.isArray(v) && v.length === 3 && v.every((x) => typeof x === "number") ? (v as number[]) : usual);
const unit = (v: number[]): number[] => v.map((x) => x / (Math.hypot(...v) || 1));

const given = (scene: Scene): JsonObject[] => {
  const clips = (scene["render"] as JsonObject | undefined)?.[kName];
  return Array.isArray(clips) ? (clips as JsonObject[]) : [];
};

export const cutsOf = (scene: Scene): Cut[] =>
  given(scene).map((c) => ({ point: numbers(c["point"], [0, 0, 0]), normal: unit(numbers(c["normal"], [0, 0, 1])), thickness: typeof c["thickness"] === "number" ? c["thickness"] : null }));

export const canCut = (types: Types): boolean => types.sections["render"]?.some((p) => p.name === kName) ?? false;

export const withCut = (scene: Scene, point: number[]): Scene => setParam(scene, kSection, [kName], [...given(scene), { point: round(point), normal: [0, 0, 1] }]);

const changed = (scene: Scene, which: number, change: JsonObject): Scene =>
  setParam(scene, kSection, [kName], given(scene).map((c, i) => (i === which ? { ...c, ...change } : c)));

/** The foot of a point on the plane: where its handles are. */
export const footOf = ({ point, normal }: Cut, of: number[]): number[] => plus(of, normal, dot(plus(point, of, -1), normal));

/** The plane moved along its normal, to where it passes through a point. */
export function withPlane(scene: Scene, which: number, through: number[]): Scene {
  const { point, normal } = cutsOf(scene)[which]!;
  return changed(scene, which, { point: round(plus(point, normal, dot(plus(through, point, -1), normal))) });
}

/** The plane turned about a point of it, so that its normal looks to another one; nearly along an axis, it is along it. */
export function withNormal(scene: Scene, which: number, about: number[], to: number[]): Scene {
  const way = plus(to, about, -1);
  return Math.hypot(...way) > 0 ? changed(scene, which, { point: round(about), normal: round(onAxis(unit(way))) }) : scene;
}

/** Whether all cuts show a place. */
export const isShown = (cuts: Cut[], at: number[]): boolean =>
  cuts.every(({ point, normal, thickness }) => {
    const beyond = dot(plus(at, point, -1), normal);
    return thickness === null ? beyond <= 0 : Math.abs(beyond) <= thickness / 2;
  });
