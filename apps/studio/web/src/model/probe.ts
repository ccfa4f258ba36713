// Measuring where somebody points: a node that measures is put there, and linked to what it measures.
import { addLink, addNode, setParam, type Scene } from "./scene";
import type { NodeType, Types } from "./types";

const kWord = "probe";

/** What people call a probe, takes particles, and has a place. */
const isProbe = (t: NodeType): boolean =>
  (t.also ?? []).includes(kWord) && t.inputs.length === 1 && t.parameters.some((p) => p.name === "position" && p.kind === "vec3");

export const probeType = (types: Types): string | null => Object.entries(types.nodes).find(([, t]) => isProbe(t))?.[0] ?? null;

const kDigits = 4;
const kBeside = { x: 300, y: 40 };

/** The scene with a probe at a place, m, of the particles that a node gives; and its name. Null where no type measures so. */
export function withProbe(scene: Scene, types: Types, node: string, position: number[]): [Scene, string] | null {
  const type = probeType(types), gives = types.nodes[scene.nodes[node]?.type ?? ""]?.outputs ?? [];
  if (type === null) return null;
  const input = types.nodes[type]!.inputs[0]!, output = gives.find((o) => o.type === input.type);
  if (!output) return null;
  const probes = Object.values(scene.nodes).filter((n) => n.type === type).length;
  const at = scene.layout?.nodes?.[node] ?? { x: 0, y: 0 };
  const [next, name] = addNode(scene, type, { x: at.x + kBeside.x, y: at.y + kBeside.y * (1 + 2 * probes) }, kWord);
  const placed = setParam(next, { node: name }, ["position"], position.map((x) => Number(x.toPrecision(kDigits))));
  return [addLink(placed, { from: node, output: output.name, to: name, input: input.name }), name];
}

/** m */
export const distanceBetween = (a: number[], b: number[]): number => Math.hypot(...a.map((x, i) => x - b[i]!));
