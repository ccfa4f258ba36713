// The graph of nodes and links, and all that is done to it by mouse and keyboard.
import {
  Controls, MiniMap, ReactFlow, useReactFlow, type Connection, type Edge, type Node, type NodeChange,
} from "@xyflow/react";
import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import {
  addGroupAround, addLink, addNode, copyNodes, linkProblem, linksOf, linkText, moveNodes, pasteNodes, removeLinks, removeNodes,
  toggleCollapsed, type LinkEnds, type Note, type Scene,
} from "../model/scene";
import { carries, forRunner, offOf, toggleOff, type Off } from "../model/switchedOff";
import { edit, problemOf, redo, say, undo, useStudio } from "../model/store";
import type { Problem, Types } from "../model/types";
import { AddMenu, type Dangling } from "./AddMenu";
import { arrange, placeAll } from "./arrange";
import { Dots } from "./Dots";
import { changeNote, NoteNode } from "./NoteNode";
import { portColor } from "./ports";
import { SceneNode, type SceneNodeData } from "./SceneNode";

const kNodeTypes = { scene: SceneNode, note: NoteNode };
const kPasteOffset = 40;
const kLegible = 0.35;
const newNoteId = () => `note-${Date.now()}`;
const kOverview = { width: 150, height: 100 };

/** What the graph shows of a scene. */
function useFlow(): { nodes: Node[]; edges: Edge[] } {
  const scene = useStudio((s) => s.scene);
  const types = useStudio((s) => s.types);
  const problem = useStudio(problemOf);
  const selected = useStudio((s) => s.selected);
  const selectedLinks = useStudio((s) => s.selectedLinks);
  return useMemo(() => {
    const placed = placeAll(scene, types);
    const at = placed.layout?.nodes ?? {};
    const text = problem && [problem.message, problem.allowed && `Allowed: ${problem.allowed}.`].filter(Boolean).join(". ");
    const wrong = (name: string) => problem && (problem.node === name || problem.pointer?.startsWith(`/nodes/${name}`));
    const node = (name: string, typeName: string): Node => ({
      id: name, type: "scene", position: at[name] ?? { x: 0, y: 0 }, selected: selected.includes(name),
      initialWidth: 190, initialHeight: 100,
      data: {
        name, typeName, type: types?.nodes[typeName], off: offOf(scene, name), collapsed: at[name]?.collapsed ?? false,
        problem: wrong(name) ? text ?? null : null, wrongPort: portOf(problem, name),
      } satisfies SceneNodeData,
    });
    const notes = (scene.layout?.notes ?? []).map((note): Node => ({
      id: note.id, type: "note", position: { x: note.x, y: note.y }, width: note.width, height: note.height,
      zIndex: note.frame ? -1 : 0, selected: selected.includes(note.id), data: { note },
    }));
    const nodes = [...notes, ...Object.entries(scene.nodes).map(([n, spec]) => node(n, spec.type))];
    const wrongLink = wrongLinkOf(problem, scene, types);
    const edges = linksOf(scene).map((l): Edge => {
      const type = types?.nodes[scene.nodes[l.from]?.type ?? ""]?.outputs.find((p) => p.name === l.output)?.type ?? "";
      const id = linkText(l);
      return {
        id, source: l.from, target: l.to, sourceHandle: l.output, targetHandle: l.input,
        selected: selectedLinks.includes(id),
        className: id === wrongLink ? "wrong" : carries(scene, types, l) ? "" : "idle",
        style: { stroke: portColor(type) },
      };
    });
    return { nodes, edges };
  }, [scene, types, problem, selected, selectedLinks]);
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

const endsOf = (c: Connection | Edge): LinkEnds => ({
  from: c.source, output: c.sourceHandle ?? "", to: c.target, input: c.targetHandle ?? "",
});

export function GraphEditor() {
  const { nodes, edges } = useFlow();
  const flow = useReactFlow();
  const surface = useRef<HTMLDivElement>(null);
  const pointer = useRef({ x: 300, y: 200 });
  const [menu, setMenu] = useState<{ x: number; y: number; dangling: Dangling | null } | null>(null);
  const [dragged, setDragged] = useState<{ [id: string]: { x: number; y: number } }>({});
  const path = useStudio((s) => s.sceneState.path);
  const types = useStudio((s) => s.types);

  useEffect(() => void setTimeout(() => flow.fitView({ padding: 0.15, maxZoom: 1, minZoom: kLegible }), 50), [flow, path, types]);

  const openMenu = useCallback((x: number, y: number, dangling: Dangling | null = null) => {
    const box = surface.current!.getBoundingClientRect();
    setMenu({ x: Math.min(x - box.left, box.width - 330), y: Math.min(y - box.top, box.height - 340), dangling });
  }, []);

  const add = useCallback((type: string) => {
    const box = surface.current!.getBoundingClientRect();
    const at = flow.screenToFlowPosition({ x: menu!.x + box.left, y: menu!.y + box.top });
    edit((s) => {
      const [next, name] = addNode(s, type, at);
      useStudio.setState({ selected: [name] });
      const link = menu!.dangling && types && linkTo(next, types, name, menu!.dangling);
      return link ? addLink(next, link) : next;
    });
    setMenu(null);
    surface.current?.focus();
  }, [flow, menu, types]);

  const addNote = useCallback((frame: boolean) => {
    const box = surface.current!.getBoundingClientRect();
    const at = flow.screenToFlowPosition({ x: menu!.x + box.left, y: menu!.y + box.top });
    const note: Note = { id: newNoteId(), text: "", ...at, width: frame ? 420 : 200, height: frame ? 260 : 90, frame };
    edit((s) => ({ ...s, layout: { ...s.layout, notes: [...(s.layout?.notes ?? []), note] } }));
    setMenu(null);
  }, [flow, menu]);

  const onNodesChange = useCallback((changes: NodeChange[]) => {
    let selected = new Set(useStudio.getState().selected);
    for (const c of changes) if (c.type === "select") c.selected ? selected.add(c.id) : selected.delete(c.id);
    if (changes.some((c) => c.type === "select")) useStudio.setState({ selected: [...selected] });
    // While nodes are dragged they move here only; the scene learns of it at the end.
    const moves = changes.filter((c) => c.type === "position" && c.position && c.dragging);
    if (moves.length > 0)
      setDragged((d) => Object.fromEntries([...Object.entries(d), ...moves.map((m) => m.type === "position" ? [m.id, m.position!] : ["", { x: 0, y: 0 }])]));
  }, []);

  const dropped = useCallback((_: unknown, node: Node, all: Node[]) => {
    const moved = all.length > 0 ? all : [node];
    edit((s) => {
      let next = moveNodes(s, Object.fromEntries(moved.filter((n) => n.type === "scene").map((n) => [n.id, n.position])));
      for (const n of moved.filter((m) => m.type === "note")) next = moveNote(next, n);
      return next;
    });
    setDragged({});
  }, []);

  const key = useKeys(pointer, openMenu, surface);
  const shown = useMemo(() => nodes.map((n) => (dragged[n.id] ? { ...n, position: dragged[n.id]! } : n)), [nodes, dragged]);

  return (
    <div
      className="graph" ref={surface} tabIndex={0} role="application" aria-label="Node editor" onKeyDown={key}
      onPointerMove={(e) => (pointer.current = { x: e.clientX, y: e.clientY })}
      onDoubleClick={(e) => (e.target as Element).classList.contains("react-flow__pane") && openMenu(e.clientX, e.clientY)}
    >
      <ReactFlow
        nodes={shown} edges={edges} nodeTypes={kNodeTypes} onNodesChange={onNodesChange} onNodeDragStop={dropped}
        onSelectionDragStop={(e, all) => dropped(e, all[0]!, all)}
        onEdgesChange={(changes) => {
          const links = new Set(useStudio.getState().selectedLinks);
          for (const c of changes) if (c.type === "select") c.selected ? links.add(c.id) : links.delete(c.id);
          useStudio.setState({ selectedLinks: [...links] });
        }}
        onConnect={(c) => edit((s) => addLink(s, endsOf(c)))}
        isValidConnection={(c) => types !== null && linkProblem(useStudio.getState().scene, types, endsOf(c as Connection)) === null}
        onConnectEnd={(event, state) => connectEnded(event, state, openMenu)}
        onNodeDoubleClick={(_, n) => n.type === "scene" && (n.data as SceneNodeData).type?.modules && useStudio.setState({ inside: n.id })}
        onMoveStart={() => (surface.current!.dataset["moving"] = "")} onMoveEnd={() => delete surface.current!.dataset["moving"]}
        onMove={(_, { zoom }) => (zoom < kLegible ? (surface.current!.dataset["far"] = "") : delete surface.current!.dataset["far"])}
        deleteKeyCode={null} multiSelectionKeyCode={["Shift", "Control", "Meta"]} selectionKeyCode="Shift" minZoom={0.05}
        zoomOnDoubleClick={false} elevateNodesOnSelect={false} onlyRenderVisibleElements proOptions={{ hideAttribution: true }}
      >
        <Dots />
        <MiniMap pannable zoomable ariaLabel="Overview" style={kOverview} nodeColor={(n) => (n.selected ? "#0b6fa8" : "#8a94a0")} />
        <Controls showInteractive={false} />
      </ReactFlow>
      {nodes.length === 0 && types && <p className="empty-hint">Tab or a double click adds a node. Templates, above, are scenes to start from.</p>}
      {menu && <AddMenu at={menu} dangling={menu.dangling} onAdd={add} onNote={addNote} onClose={() => setMenu(null)} />}
    </div>
  );
}

/** A frame takes the nodes that lie on it along. */
function moveNote(scene: Scene, node: Node): Scene {
  const note = scene.layout?.notes?.find((n) => n.id === node.id);
  if (!note) return scene;
  const by = { x: node.position.x - note.x, y: node.position.y - note.y };
  let next = changeNote(scene, note.id, node.position);
  if (!note.frame) return next;
  const on = Object.entries(scene.layout?.nodes ?? {}).filter(
    ([, p]) => p.x >= note.x && p.y >= note.y && p.x <= note.x + note.width && p.y <= note.y + note.height,
  );
  return moveNodes(next, Object.fromEntries(on.map(([n, p]) => [n, { x: p.x + by.x, y: p.y + by.y }])));
}

/** The link from a dangling port to the first port of a new node that fits. */
function linkTo(scene: Scene, types: Types, name: string, d: Dangling): LinkEnds | null {
  const t = types.nodes[scene.nodes[name]!.type]!;
  const port = (d.side === "output" ? t.inputs : t.outputs).find((p) => p.type === d.type);
  if (!port) return null;
  return d.side === "output"
    ? { from: d.node, output: d.port, to: name, input: port.name }
    : { from: name, output: port.name, to: d.node, input: d.port };
}

/** A link that ends nowhere opens the list; one that ends at a wrong port says why it is wrong. */
function connectEnded(
  event: MouseEvent | TouchEvent,
  state: { isValid: boolean | null; fromNode: unknown; fromHandle: unknown; toHandle: unknown; toNode: unknown },
  openMenu: (x: number, y: number, d: Dangling) => void,
): void {
  const { scene, types } = useStudio.getState();
  const fromNode = state.fromNode as Node | null;
  const from = state.fromHandle as { id: string; type: "source" | "target" } | null;
  if (state.isValid || !types || !fromNode || !from) return;
  const to = state.toHandle as { id: string } | null;
  const toNode = state.toNode as Node | null;
  if (to && toNode) {
    const ends = from.type === "source"
      ? { from: fromNode.id, output: from.id, to: toNode.id, input: to.id }
      : { from: toNode.id, output: to.id, to: fromNode.id, input: from.id };
    return say(new Error(linkProblem(scene, types, ends) ?? "an output is linked to an input"));
  }
  const t = types.nodes[scene.nodes[fromNode.id]?.type ?? ""];
  const side = from.type === "source" ? "output" : "input";
  const type = (side === "output" ? t?.outputs : t?.inputs)?.find((p) => p.name === from.id)?.type;
  const at = "changedTouches" in event ? event.changedTouches[0]! : event;
  if (type) openMenu(at.clientX, at.clientY, { node: fromNode.id, port: from.id, type, side });
}

/** What stands in the panel of properties is typed over. */
function focusName(): void {
  const field = document.querySelector<HTMLInputElement>(".name-field input");
  field?.focus();
  field?.select();
}

function useKeys(
  pointer: React.RefObject<{ x: number; y: number }>,
  openMenu: (x: number, y: number) => void,
  surface: React.RefObject<HTMLDivElement | null>,
) {
  const flow = useReactFlow();
  return useCallback((e: React.KeyboardEvent) => {
    if ((e.target as Element).closest("input, textarea, select, [contenteditable]")) return;
    const { selected, selectedLinks, clip, types, scene } = useStudio.getState();
    const command = e.ctrlKey || e.metaKey;
    const paste = (c: typeof clip) => c && edit((s) => {
      const [next, names] = pasteNodes(s, c, kPasteOffset);
      useStudio.setState({ selected: names, selectedLinks: [] });
      return next;
    });
    const key = e.key.toLowerCase();
    const box = surface.current!.getBoundingClientRect();
    const at = pointer.current ?? { x: box.left + box.width / 2, y: box.top + box.height / 2 };
    const step = e.shiftKey ? 50 : 10;
    const nudge = (x: number, y: number) => edit((s) => moveNodes(s, Object.fromEntries(
      selected.filter((n) => n in s.nodes).map((n) => {
        const p = s.layout?.nodes?.[n] ?? { x: 0, y: 0 };
        return [n, { x: p.x + x, y: p.y + y }];
      }),
    )));
    const switchOff = (how: Off) => edit((s) => toggleOff(s, selected, how));
    const group = () => {
      const chosen = new Set(selected.filter((n) => n in scene.nodes));
      const boxes = flow.getNodes().filter((n) => chosen.has(n.id))
        .map((n) => ({ ...n.position, width: n.measured?.width ?? n.initialWidth!, height: n.measured?.height ?? n.initialHeight! }));
      edit((s) => addGroupAround(s, newNoteId(), boxes));
    };
    const selectNext = (by: number) => {
      // From left to right, as things flow.
      const at = (n: string) => scene.layout?.nodes?.[n] ?? { x: 0, y: 0 };
      const names = Object.keys(scene.nodes).sort((a, b) => at(a).x - at(b).x || at(a).y - at(b).y);
      const now = names.indexOf(selected[0] ?? "");
      const next = names[now < 0 ? (by > 0 ? 0 : names.length - 1) : (now + by + names.length) % names.length];
      if (next) useStudio.setState({ selected: [next], selectedLinks: [] });
    };
    if (command && key === "z") e.shiftKey ? redo() : undo();
    else if (command && key === "y") redo();
    else if (command && key === "a") useStudio.setState({ selected: Object.keys(scene.nodes) });
    else if (command && key === "c") useStudio.setState({ clip: copyNodes(scene, selected) });
    else if (command && key === "x") (useStudio.setState({ clip: copyNodes(scene, selected) }), edit((s) => removeNodes(s, selected)));
    else if (command && key === "v") paste(clip);
    else if (command && key === "d") paste(copyNodes(scene, selected));
    else if (command) return;
    // By Shift+Tab the keyboard leaves the graph.
    else if ((key === "tab" && !e.shiftKey) || key === "a") openMenu(at.x, at.y);
    else if (key === "delete" || key === "backspace") edit((s) => removeNodes(removeLinks(s, selectedLinks), selected));
    else if (key === "c") edit((s) => toggleCollapsed(s, selected));
    else if (key === "g") group();
    else if (key === "f2" && selected.length === 1) focusName();
    else if (key === "pagedown") selectNext(1);
    else if (key === "pageup") selectNext(-1);
    else if (key === "escape") useStudio.setState({ selected: [], selectedLinks: [] });
    else if (key === "m") switchOff("muted");
    else if (key === "b") switchOff("bypassed");
    else if (key === "l") edit((s) => arrange(s, types, selected.length > 1 ? selected : undefined));
    else if (key === "f") void flow.fitView({ padding: 0.15, maxZoom: 1, duration: 200 });
    else if (key === "enter" && selected.length === 1) useStudio.setState({ inside: selected[0]! });
    else if (key === "arrowleft") nudge(-step, 0);
    else if (key === "arrowright") nudge(step, 0);
    else if (key === "arrowup") nudge(0, -step);
    else if (key === "arrowdown") nudge(0, step);
    else return;
    e.preventDefault();
    e.stopPropagation();
  }, [flow, openMenu, pointer, surface]);
}
