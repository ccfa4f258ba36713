// Which bodies of a run a hand can pull.
import { linksOf, type Scene } from "./scene";
import type { Types } from "./types";

/** What a hand adds its own to. */
const kForce = "applied_force";

const isPullable = (scene: Scene, types: Types, node: string): boolean =>
  types.nodes[scene.nodes[node]?.type ?? ""]?.parameters.some((p) => p.name === kForce && p.kind === "vec3") ?? false;

export const pullables = (scene: Scene, types: Types): string[] => Object.keys(scene.nodes).filter((n) => isPullable(scene, types, n));

/** The body that a mesh of the view belongs to: itself, or what its node's mesh goes to; null where that is none. */
export function bodyOfMesh(scene: Scene, types: Types, mesh: string): string | null {
  if (isPullable(scene, types, mesh)) return mesh;
  return linksOf(scene).find((l) => l.from === mesh && isPullable(scene, types, l.to))?.to ?? null;
}
