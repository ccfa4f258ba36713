// Places nodes in columns along the links.
import dagre from "@dagrejs/dagre";
import { linksOf, moveNodes, type Scene } from "../model/scene";

const kWidth = 220;
const kHeaderHeight = 44;
const kRowHeight = 26;

export function arrange(scene: Scene, rowsOf: (node: string) => number, only?: string[]): Scene {
  const names = only ?? Object.keys(scene.nodes);
  const g = new dagre.graphlib.Graph();
  g.setGraph({ rankdir: "LR", nodesep: 28, ranksep: 90 });
  g.setDefaultEdgeLabel(() => ({}));
  for (const n of names) g.setNode(n, { width: kWidth, height: kHeaderHeight + kRowHeight * rowsOf(n) });
  for (const l of linksOf(scene)) if (g.hasNode(l.from) && g.hasNode(l.to)) g.setEdge(l.from, l.to);
  dagre.layout(g);
  const places: { [name: string]: { x: number; y: number } } = {};
  for (const n of names) {
    const at = g.node(n);
    places[n] = { x: at.x - at.width / 2, y: at.y - at.height / 2 };
  }
  return moveNodes(scene, places);
}
