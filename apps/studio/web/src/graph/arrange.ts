// Places nodes in columns along the links.
import dagre from "@dagrejs/dagre";
import { linksOf, moveNodes, pipelineOf, type Scene } from "../model/scene";
import type { Types } from "../model/types";

const kWidth = 220;
const kHeaderHeight = 44;
const kRowHeight = 26;

function rowsOf(scene: Scene, types: Types | null, name: string, unfolded: string[]): number {
  const t = types?.nodes[scene.nodes[name]?.type ?? ""];
  const modules = t && unfolded.includes(name) ? pipelineOf(scene, name, t).length + 1 : 0;
  return Math.max(t?.inputs.length ?? 1, t?.outputs.length ?? 1, 1) + modules;
}

/** The scene itself where every node has its place. */
export const placeAll = (scene: Scene, types: Types | null): Scene =>
  Object.keys(scene.nodes).every((n) => scene.layout?.nodes?.[n]) ? scene : arrange(scene, types);

/** `unfolded` are the nodes that show their modules. */
export function arrange(scene: Scene, types: Types | null, only?: string[], unfolded: string[] = []): Scene {
  const names = only ?? Object.keys(scene.nodes);
  const g = new dagre.graphlib.Graph();
  g.setGraph({ rankdir: "LR", nodesep: 28, ranksep: 90 });
  g.setDefaultEdgeLabel(() => ({}));
  for (const n of names) g.setNode(n, { width: kWidth, height: kHeaderHeight + kRowHeight * rowsOf(scene, types, n, unfolded) });
  for (const l of linksOf(scene)) if (g.hasNode(l.from) && g.hasNode(l.to)) g.setEdge(l.from, l.to);
  dagre.layout(g);
  const places: { [name: string]: { x: number; y: number } } = {};
  for (const n of names) {
    const at = g.node(n);
    places[n] = { x: at.x - at.width / 2, y: at.y - at.height / 2 };
  }
  return moveNodes(scene, places);
}
