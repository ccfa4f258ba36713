// What helps a run that goes wrong, to be done by one click.
import { numberText } from "./expression";
import { setParam, type Scene } from "./scene";
import type { JsonObject, Parameter } from "./types";

export interface Remedy {
  text: string;
  change(scene: Scene): Scene;
}

const kWorld = { section: "world" };

/** Steps of half the length: by the bound that follows the motion, where the scene has one, or else by the longest step. */
export function shorterSteps(scene: Scene, world: Parameter[]): Remedy | null {
  const given = (scene["world"] ?? {}) as JsonObject;
  for (const name of ["cfl", "dt"]) {
    const p = world.find((q) => q.name === name);
    const now = given[name] ?? p?.default;
    if (!p || typeof now !== "number") continue;
    const half = Number(numberText(now / 2));
    if (half <= (p.above ?? p.min ?? 0)) continue;
    return { text: `Halve ${name} to ${half}${p.unit ? ` ${p.unit}` : ""} and begin anew`, change: (s) => setParam(s, kWorld, [name], half) };
  }
  return null;
}
