// What the graph shows of a scene. A node or link that stays as it was stays the same object here: so of a large graph only what
// has changed is rendered, and measured, again.
import type { Edge, Node, NodeChange } from "@xyflow/react";
import { useCallback, useMemo, useRef, useState } from "react";
import { bendsOf } from "../model/links";
import { linksOf, linkText, type Scene } from "../model/scene";
import { problemOf, useStudio } from "../model/store";
import { useWarnings } from "../model/warnings";
import { carries, forRunner, offOf } from "../model/switchedOff";
import type { Problem, Types } from "../model/types";
import { placeAll } from "./arrange";
import { portColor } from "./ports";
import type { SceneNodeData } from "./SceneNode";

/** The scale below which ports and links are too small to be hit. */
export const kLegible = 0.35;
export const isFar = (s: { transform: [number, number, number] }): boolean => s.transform[2] < kLegible;

const kSizeAtFirst = { width: 190, height: 100 };

interface Size { width: number; height: number }

/** What was made from the same things before, or else what is made of them now. */
class Kept<T> {
  private last = new Map<string, { from: unknown[]; made: T }>();
  private next = new Map<string, { from: unknown[]; made: T }>();

  get(id: string, from: unknown[], make: (before: T | undefined) => T): T {
    const old = this.last.get(id);
    const entry = old && old.from.every((v, i) => v === from[i]) ? old : { from, made: make(old?.made) };
    this.next.set(id, entry);
    return entry.made;
  }
  /** Forgets what nobody asked for since the last time. */
  turn(): void {
    this.last = this.next;
    this.next = new Map();
  }
}

/** At a place by its edges: a transform of its own for each of many nodes is what browsers are slow at. */
export const placed = (node: Node, position: { x: number; y: number }): Node => ({
  ...node, position, style: { ...node.style, transform: "none", left: position.x, top: position.y },
});

export const sizeOf = (n: Node): Size => ({
  width: n.width ?? n.measured?.width ?? kSizeAtFirst.width, height: n.height ?? n.measured?.height ?? kSizeAtFirst.height,
});

/** The box that all nodes lie in; shadows reach out of it. */
export function boundsOf(nodes: Node[]): { left: number; top: number; width: number; height: number } {
  if (nodes.length === 0) return { left: 0, top: 0, width: 0, height: 0 };
  const most = (of: (n: Node) => number) => nodes.reduce((m, n) => Math.max(m, of(n)), -Infinity);
  const left = -most((n) => -n.position.x), top = -most((n) => -n.position.y);
  return { left, top, width: most((n) => n.position.x + sizeOf(n).width) - left, height: most((n) => n.position.y + sizeOf(n).height) - top };
}

export function useFlow(): { nodes: Node[]; edges: Edge[]; measured: (changes: NodeChange[]) => void } {
  const scene = useStudio((s) => s.scene);
  const types = useStudio((s) => s.types);
  const problem = useStudio(problemOf);
  const selected = useStudio((s) => s.selected);
  const selectedLinks = useStudio((s) => s.selectedLinks);
  const warnings = useWarnings();
  const unfolded = useStudio((s) => s.unfolded);
  const [sizes, setSizes] = useState<ReadonlyMap<string, Size>>(new Map());
  const kept = useRef({ data: new Kept<SceneNodeData>(), nodes: new Kept<Node>(), edges: new Kept<Edge>() }).current;
  const measured = useCallback((changes: NodeChange[]) => {
    const news = changes.flatMap((c): [string, Size][] => (c.type === "dimensions" && c.dimensions ? [[c.id, c.dimensions]] : []));
    if (news.length > 0) setSizes((all) => new Map([...all, ...news]));
  }, []);
  const flow = useMemo(() => {
    const full = placeAll(scene, types);
    const at = full.layout?.nodes ?? {};
    const text = problem && [problem.message, problem.allowed && `Allowed: ${problem.allowed}.`].filter(Boolean).join(". ");
    const chosen = new Set(selected), chosenLinks = new Set(selectedLinks);
    const wrong = (name: string) => problem && (problem.node === name || problem.pointer?.startsWith(`/nodes/${name}`));

    const node = (name: string, typeName: string): Node => {
      const { x, y } = at[name] ?? { x: 0, y: 0 };
      const collapsed = at[name]?.collapsed ?? false, type = types?.nodes[typeName], off = offOf(scene, name);
      const told = wrong(name) ? text ?? null : null, wrongPort = portOf(problem, name), isSelected = chosen.has(name), zIndex = unfolded.includes(name) ? 1 : 0;
      const warning = warnings.filter((w) => w.node === name).map((w) => w.text).join("\n") || null;
      const data = kept.data.get(name, [typeName, type, off, collapsed, told, wrongPort, warning], () => ({ name, typeName, type, off, collapsed, problem: told, wrongPort, warning }));
      return kept.nodes.get(name, [x, y, data, isSelected, sizes.get(name), zIndex], (before) => {
        const was = before?.data as SceneNodeData | undefined;
        // Its ports are where they were, unless they are others now.
        const samePorts = !was || (was.type === type && was.collapsed === collapsed);
        return placed({
          id: name, type: "scene", position: { x, y }, selected: isSelected, data, zIndex, ariaLabel: [`${name}, ${typeName}`, off, told && "wrong"].filter(Boolean).join(", "),
          initialWidth: kSizeAtFirst.width, initialHeight: kSizeAtFirst.height, measured: samePorts ? sizes.get(name) : undefined,
        }, { x, y });
      });
    };
    const notes = (scene.layout?.notes ?? []).map((note) => kept.nodes.get(note.id, [note, chosen.has(note.id), sizes.get(note.id)], () => placed({
      id: note.id, type: "note", position: { x: note.x, y: note.y }, width: note.width, height: note.height,
      zIndex: note.frame ? -1 : 0, selected: chosen.has(note.id), data: { note }, measured: sizes.get(note.id),
    }, note)));
    const nodes = [...notes, ...Object.entries(scene.nodes).map(([n, spec]) => node(n, spec.type))];

    const wrongLink = wrongLinkOf(problem, scene, types);
    const edges = linksOf(scene).map((l) => {
      const type = types?.nodes[scene.nodes[l.from]?.type ?? ""]?.outputs.find((p) => p.name === l.output)?.type ?? "";
      const id = linkText(l), isSelected = chosenLinks.has(id);
      const className = id === wrongLink ? "wrong" : carries(scene, types, l) ? "" : "idle";
      const bends = bendsOf(scene, id);
      return kept.edges.get(id, [type, isSelected, className, bends], (): Edge => ({
        id, source: l.from, target: l.to, sourceHandle: l.output, targetHandle: l.input, selected: isSelected, className, ariaLabel: `Link ${id}`,
        data: { className, bends }, style: { stroke: portColor(type) },
      }));
    });
    for (const k of Object.values(kept)) k.turn();
    return { nodes, edges };
  }, [scene, types, problem, warnings, selected, selectedLinks, sizes, unfolded, kept]);
  return { ...flow, measured };
}

/** Messages name ports as 'node.port'. */
function portOf(problem: Problem | undefined, node: string): string | null {
  const text = `${problem?.message} ${problem?.allowed} ${problem?.hint}`;
  const start = `'${node}.`;
  const at = text.indexOf(start);
  return at < 0 ? null : text.slice(at + start.length).split("'")[0]!;
}

/** The link that a problem is about; it counts the links that the runner has. */
function wrongLinkOf(problem: Problem | undefined, scene: Scene, types: Types | null): string | null {
  const index = /^\/links\/(\d+)$/.exec(problem?.pointer ?? "")?.[1];
  return index === undefined ? null : forRunner(scene, types).links?.[Number(index)] ?? null;
}
