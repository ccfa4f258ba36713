// What helps a run that goes wrong, to be done by one click.
import { numberText } from "./expression";
import { labelOf } from "./parameters";
import { paramsOf, pipelineOf, setParam, type Scene } from "./scene";
import type { JsonObject, Parameter, Problem, Types } from "./types";

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

const kTravel = 0.5;

/** Steps that follow the motion, where the scene's do not yet. */
export function followMotion(scene: Scene, world: Parameter[]): Remedy | null {
  if (!world.some((p) => p.name === "cfl") || typeof ((scene["world"] ?? {}) as JsonObject)["cfl"] === "number") return null;
  return { text: `Set cfl to ${kTravel} and begin anew`, change: (s) => setParam(s, kWorld, ["cfl"], kTravel) };
}

const kMostIterations = "max_iterations";

/** As many iterations as solvers are allowed by default, where the scene allows those of a node fewer. */
export function moreIterations(scene: Scene, types: Types, node: string): Remedy | null {
  const type = types.nodes[scene.nodes[node]?.type ?? ""];
  for (const slot of type ? pipelineOf(scene, node, type) : []) {
    const owner = { node, module: slot.name };
    const most = types.modules[slot.type]?.parameters.find((p) => p.name === kMostIterations)?.default;
    const now = paramsOf(scene, owner)[kMostIterations];
    if (!slot.enabled || typeof most !== "number" || typeof now !== "number" || now >= most) continue;
    return { text: `Set ${kMostIterations} to ${most} and begin anew`, change: (s) => setParam(s, owner, [kMostIterations], undefined) };
  }
  return null;
}

const kMostChoices = 3;

/** Where a problem of a node names one of its choices, such as its shape: the others that there are. */
export function otherChoices(problem: Problem, scene: Scene, types: Types): Remedy[] {
  const node = problem.node ?? "", type = types.nodes[scene.nodes[node]?.type ?? ""];
  const words = new Set(`${problem.message} ${problem.allowed ?? ""}`.toLowerCase().match(/[a-z_]+/g));
  const p = type?.parameters.find((q) => q.choices && words.has(q.name));
  if (!p) return [];
  const now = paramsOf(scene, { node })[p.name] ?? p.default;
  return Object.keys(p.choices!).filter((c) => c !== now).slice(0, kMostChoices).map((c) => ({ text: `${labelOf(p.name)}: ${c}`, change: (s) => setParam(s, { node }, [p.name], c) }));
}
