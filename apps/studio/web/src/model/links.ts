// Links that are led around what lies between, and nodes that are put into a link.
import { addLink, linkProblem, linksOf, linkText, parseLink, removeLinks, type LinkEnds, type Scene } from "./scene";
import type { Types } from "./types";

export interface Point {
  x: number;
  y: number;
}

const kNone: Point[] = [];

/** Where a link is led through, from its output to its input. */
export const bendsOf = (scene: Scene, link: string): Point[] => scene.layout?.bends?.[link] ?? kNone;

/** With other bends; those of links that are gone are forgotten. */
export function withBends(scene: Scene, link: string, points: Point[]): Scene {
  const there = new Set(linksOf(scene).map(linkText));
  const kept = Object.entries(scene.layout?.bends ?? {}).filter(([l]) => l !== link && there.has(l));
  const rounded = points.map((p) => ({ x: Math.round(p.x), y: Math.round(p.y) }));
  const bends = Object.fromEntries([...kept, ...(rounded.length > 0 ? [[link, rounded] as const] : [])]);
  return { ...scene, layout: { ...scene.layout, bends: Object.keys(bends).length > 0 ? bends : undefined } };
}

/** Squared distance from a point to the line between two others. */
function distanceTo(p: Point, a: Point, b: Point): number {
  const [x, y] = [b.x - a.x, b.y - a.y];
  const along = Math.min(Math.max(((p.x - a.x) * x + (p.y - a.y) * y) / (x * x + y * y || 1), 0), 1);
  return (p.x - a.x - along * x) ** 2 + (p.y - a.y - along * y) ** 2;
}

/** With one more bend, in the stretch that it lies nearest to; `from` and `to` are the ends of the link. */
export function bent(bends: Point[], at: Point, from: Point, to: Point): Point[] {
  const stops = [from, ...bends, to];
  let nearest = 0;
  for (let i = 1; i + 1 < stops.length; ++i)
    if (distanceTo(at, stops[i]!, stops[i + 1]!) < distanceTo(at, stops[nearest]!, stops[nearest + 1]!)) nearest = i;
  return [...bends.slice(0, nearest), at, ...bends.slice(nearest)];
}

/** The scene with a node put into a link, or null where its ports do not fit or are taken. */
export function withNodeIn(scene: Scene, types: Types, link: string, name: string): Scene | null {
  const ends = parseLink(link), type = types.nodes[scene.nodes[name]?.type ?? ""];
  if (!ends || !type || ends.from === name || ends.to === name) return null;
  const carried = types.nodes[scene.nodes[ends.from]?.type ?? ""]?.outputs.find((p) => p.name === ends.output)?.type;
  const cut = withBends(removeLinks(scene, [link]), link, []);
  for (const input of type.inputs.filter((p) => p.type === carried))
    for (const output of type.outputs.filter((p) => p.type === carried)) {
      const into: LinkEnds = { ...ends, to: name, input: input.name }, out: LinkEnds = { ...ends, from: name, output: output.name };
      if (linkProblem(cut, types, into)) continue;
      const half = addLink(cut, into);
      if (!linkProblem(half, types, out)) return addLink(half, out);
    }
  return null;
}
