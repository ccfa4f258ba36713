// A scene as it is edited: the JSON of a scene file, and functions that make a changed copy of it.
import type { Json, JsonObject, ModuleSlot, NodeType, Types } from "./types";

export interface ModuleSpec {
  type?: string;
  after?: string;
  before?: string;
  enabled?: boolean;
  params?: JsonObject;
}

export interface NodeSpec {
  type: string;
  params?: JsonObject;
  modules?: { [name: string]: ModuleSpec };
}

export interface Note {
  id: string;
  text: string;
  x: number;
  y: number;
  width: number;
  height: number;
  /** A frame stands behind nodes and takes them along. */
  frame: boolean;
}

/** What the page alone knows of a node. */
export interface Place {
  x: number;
  y: number;
  collapsed?: boolean;
  /** See switchedOff.ts. */
  off?: "muted" | "bypassed";
}

/** Where a camera was, m, and its vertical angle, degrees. */
export interface KeptView {
  name: string;
  eye: number[];
  target: number[];
  fov: number;
}

/** What the page alone knows; the runner ignores it. */
export interface Layout {
  nodes?: { [name: string]: Place };
  notes?: Note[];
  /** By link: points that it is led through. */
  bends?: { [link: string]: { x: number; y: number }[] };
  /** Cameras to come back to. */
  views?: KeptView[];
  /** In files only, see switchedOff.ts. */
  off?: { nodes: { [name: string]: NodeSpec }; links: string[]; passed: string[] };
}

export interface Scene {
  weir: number;
  title?: string;
  world?: JsonObject;
  nodes: { [name: string]: NodeSpec };
  links?: string[];
  layout?: Layout;
  [section: string]: unknown;
}

export interface LinkEnds {
  from: string;
  output: string;
  to: string;
  input: string;
}

export const emptyScene = (): Scene => ({ weir: 1, nodes: {} });

const kName = /^[A-Za-z][A-Za-z0-9_-]{0,99}$/;
const kTaken = new Set(["world", "render", "title", "links", "nodes", "layout", "plugins", "weir"]);

export function parseLink(text: string): LinkEnds | null {
  const m = /^\s*([^.\s]+)\.(\S+)\s*->\s*([^.\s]+)\.(\S+)\s*$/.exec(text);
  return m ? { from: m[1]!, output: m[2]!, to: m[3]!, input: m[4]! } : null;
}

export const linkText = (l: LinkEnds): string => `${l.from}.${l.output} -> ${l.to}.${l.input}`;

export const linksOf = (scene: Scene): LinkEnds[] =>
  (scene.links ?? []).map(parseLink).filter((l): l is LinkEnds => l !== null);

/** "water", "water_2", …: a name that nobody has. */
export function freeName(scene: Scene, wish: string): string {
  const taken = (n: string) => n in scene.nodes || kTaken.has(n);
  const base = wish.replace(/[^A-Za-z0-9_-]/g, "_").replace(/^[^A-Za-z]+/, "") || "node";
  if (!taken(base)) return base;
  const stem = base.replace(/_\d+$/, "");
  for (let i = 2; ; ++i) if (!taken(`${stem}_${i}`)) return `${stem}_${i}`;
}

/** "square_emitter" of "SquareEmitter". */
export const nameOfType = (type: string): string =>
  type.replace(/([a-z0-9])([A-Z])/g, "$1_$2").replace(/([A-Z]+)([A-Z][a-z])/g, "$1_$2").toLowerCase();

/** Why a node cannot be called so, or null. */
export function nameProblem(scene: Scene, name: string, own: string): string | null {
  if (name === own) return null;
  if (!kName.test(name)) return "letters, digits, '_' and '-', beginning with a letter";
  if (kTaken.has(name) || name in scene.nodes) return `'${name}' is taken`;
  return null;
}

const withLayout = (scene: Scene, change: Partial<Layout>): Scene => ({
  ...scene,
  layout: { ...scene.layout, ...change },
});

export const viewsOf = (scene: Scene): KeptView[] => scene.layout?.views ?? [];

/** Keeps a camera, under the first name "View 1", "View 2", … that is free. */
export function keepView(scene: Scene, camera: Omit<KeptView, "name">): Scene {
  const views = viewsOf(scene);
  let n = 1;
  while (views.some((v) => v.name === `View ${n}`)) ++n;
  return withLayout(scene, { views: [...views, { name: `View ${n}`, ...camera }] });
}

export function forgetView(scene: Scene, name: string): Scene {
  const left = viewsOf(scene).filter((v) => v.name !== name);
  return withLayout(scene, { views: left.length > 0 ? left : undefined });
}

export function addNode(scene: Scene, type: string, at: { x: number; y: number }, wish?: string): [Scene, string] {
  const name = freeName(scene, wish ?? nameOfType(type));
  const next = { ...scene, nodes: { ...scene.nodes, [name]: { type } } };
  return [moveNodes(next, { [name]: at }), name];
}

export function moveNodes(scene: Scene, places: { [name: string]: { x: number; y: number } }): Scene {
  const nodes = { ...scene.layout?.nodes };
  for (const [name, at] of Object.entries(places))
    nodes[name] = { ...nodes[name], x: Math.round(at.x), y: Math.round(at.y) };
  return withLayout(scene, { nodes });
}

export function collapse(scene: Scene, names: string[], collapsed: boolean): Scene {
  const nodes = { ...scene.layout?.nodes };
  for (const n of names) nodes[n] = { ...(nodes[n] ?? { x: 0, y: 0 }), collapsed: collapsed || undefined };
  return withLayout(scene, { nodes });
}

/** Folds nodes, or unfolds them where all are folded. */
export function toggleCollapsed(scene: Scene, names: string[]): Scene {
  const there = names.filter((n) => n in scene.nodes);
  if (there.length === 0) return scene;
  return collapse(scene, there, !there.every((n) => scene.layout?.nodes?.[n]?.collapsed));
}

const kAround = { x: 24, top: 44, bottom: 24 };

/** A group around nodes, whose sizes on the page are known; where there are none, the scene as it is. */
export function addGroupAround(scene: Scene, id: string, boxes: { x: number; y: number; width: number; height: number }[]): Scene {
  if (boxes.length === 0) return scene;
  const x = Math.min(...boxes.map((b) => b.x)) - kAround.x;
  const y = Math.min(...boxes.map((b) => b.y)) - kAround.top;
  const width = Math.max(...boxes.map((b) => b.x + b.width)) + kAround.x - x;
  const height = Math.max(...boxes.map((b) => b.y + b.height)) + kAround.bottom - y;
  const round = Math.round;
  const group: Note = { id, text: "", x: round(x), y: round(y), width: round(width), height: round(height), frame: true };
  return withLayout(scene, { notes: [...(scene.layout?.notes ?? []), group] });
}

export function removeNodes(scene: Scene, names: string[]): Scene {
  const gone = new Set(names);
  const keep = <T>(o: { [k: string]: T } | undefined) =>
    Object.fromEntries(Object.entries(o ?? {}).filter(([n]) => !gone.has(n)));
  const links = (scene.links ?? []).filter((t) => {
    const l = parseLink(t);
    return !l || (!gone.has(l.from) && !gone.has(l.to));
  });
  const notes = (scene.layout?.notes ?? []).filter((n) => !gone.has(n.id));
  return {
    ...scene,
    nodes: keep(scene.nodes),
    links,
    layout: { ...scene.layout, nodes: keep(scene.layout?.nodes), notes },
  };
}

export function renameNode(scene: Scene, from: string, to: string): Scene {
  const rename = <T>(o: { [k: string]: T }) =>
    Object.fromEntries(Object.entries(o).map(([n, v]) => [n === from ? to : n, v]));
  const renamed = (l: LinkEnds) => linkText({ ...l, from: l.from === from ? to : l.from, to: l.to === from ? to : l.to });
  const links = linksOf(scene).map(renamed);
  const bends = scene.layout?.bends && Object.fromEntries(Object.entries(scene.layout.bends).map(([l, points]) => [renamed(parseLink(l)!), points]));
  // Sections name nodes, too.
  const render = scene["render"] as JsonObject | undefined;
  const surfaces = render?.["surfaces"];
  const next: Scene = { ...scene, nodes: rename(scene.nodes), links };
  if (Array.isArray(surfaces))
    next["render"] = {
      ...render,
      surfaces: surfaces.map((s) =>
        s !== null && typeof s === "object" && !Array.isArray(s) && s["node"] === from ? { ...s, node: to } : s,
      ),
    };
  return withLayout(next, { nodes: rename(scene.layout?.nodes ?? {}), ...(bends && { bends }) });
}

/** Why two ports cannot be linked, or null. */
export function linkProblem(scene: Scene, types: Types, l: LinkEnds): string | null {
  const from = types.nodes[scene.nodes[l.from]?.type ?? ""]?.outputs.find((p) => p.name === l.output);
  const to = types.nodes[scene.nodes[l.to]?.type ?? ""]?.inputs.find((p) => p.name === l.input);
  if (!from || !to) return "there is no such port";
  if (from.type !== to.type) return `${l.output} is a ${from.type}, ${l.input} takes a ${to.type}`;
  const links = linksOf(scene);
  if (links.some((k) => linkText(k) === linkText(l))) return "they are linked already";
  if (!to.many && links.some((k) => k.to === l.to && k.input === l.input)) return `${l.to}.${l.input} takes one link only`;
  if (l.from === l.to || reaches(links, l.to, l.from)) return "the link would close a circle";
  return null;
}

/** All links that a node could have, and has not. */
export function linksFor(scene: Scene, types: Types, name: string): LinkEnds[] {
  const ends = (from: string, to: string): LinkEnds[] => {
    const outputs = types.nodes[scene.nodes[from]?.type ?? ""]?.outputs ?? [], inputs = types.nodes[scene.nodes[to]?.type ?? ""]?.inputs ?? [];
    return outputs.flatMap((o) => inputs.map((i) => ({ from, output: o.name, to, input: i.name })));
  };
  const others = Object.keys(scene.nodes).filter((n) => n !== name);
  const all = [...others.flatMap((n) => ends(name, n)), ...others.flatMap((n) => ends(n, name))];
  return all.filter((l) => linkProblem(scene, types, l) === null);
}

function reaches(links: LinkEnds[], from: string, to: string): boolean {
  const seen = new Set<string>();
  const open = [from];
  while (open.length > 0) {
    const at = open.pop()!;
    if (at === to) return true;
    if (seen.has(at)) continue;
    seen.add(at);
    for (const l of links) if (l.from === at) open.push(l.to);
  }
  return false;
}

export const addLink = (scene: Scene, l: LinkEnds): Scene => ({ ...scene, links: [...(scene.links ?? []), linkText(l)] });

export function removeLinks(scene: Scene, texts: string[]): Scene {
  const gone = new Set(texts);
  return { ...scene, links: (scene.links ?? []).filter((t) => !gone.has(t)) };
}

function setIn(object: JsonObject | undefined, path: string[], value: Json | undefined): JsonObject {
  const [key, ...rest] = path as [string, ...string[]];
  const next: JsonObject = { ...object };
  if (rest.length > 0) {
    const inner = setIn(object?.[key] as JsonObject | undefined, rest, value);
    if (Object.keys(inner).length === 0) delete next[key];
    else next[key] = inner;
  } else if (value === undefined) {
    delete next[key];
  } else {
    next[key] = value;
  }
  return next;
}

/** Where parameters stand: a node's, a module's, the world's or a section's. */
export type Owner = { node: string } | { node: string; module: string } | { section: string };

/** The same object each time: who looks at it sees no change. */
const kNoParams: JsonObject = {};

export function paramsOf(scene: Scene, owner: Owner): JsonObject {
  if ("section" in owner) return (scene[owner.section] as JsonObject | undefined) ?? kNoParams;
  const node = scene.nodes[owner.node];
  if ("module" in owner) return node?.modules?.[owner.module]?.params ?? kNoParams;
  return node?.params ?? kNoParams;
}

/** `undefined` takes the parameter back to its default. */
export function setParam(scene: Scene, owner: Owner, path: string[], value: Json | undefined): Scene {
  if ("section" in owner)
    return { ...scene, [owner.section]: setIn(scene[owner.section] as JsonObject | undefined, path, value) };
  const node = scene.nodes[owner.node]!;
  if ("module" in owner) {
    const module = node.modules?.[owner.module];
    return setModule(scene, owner.node, owner.module, { ...module, params: setIn(module?.params, path, value) });
  }
  return { ...scene, nodes: { ...scene.nodes, [owner.node]: { ...node, params: setIn(node.params, path, value) } } };
}

/** All parameters of an owner at once. */
export function setParams(scene: Scene, owner: Owner, params: JsonObject): Scene {
  if ("section" in owner) return { ...scene, [owner.section]: params };
  if ("module" in owner) return setModule(scene, owner.node, owner.module, { ...scene.nodes[owner.node]?.modules?.[owner.module], params });
  return { ...scene, nodes: { ...scene.nodes, [owner.node]: { ...scene.nodes[owner.node]!, params } } };
}

function setModule(scene: Scene, node: string, module: string, spec: ModuleSpec | null): Scene {
  const old = scene.nodes[node]!;
  const modules = { ...old.modules };
  if (spec === null) delete modules[module];
  else modules[module] = spec;
  return { ...scene, nodes: { ...scene.nodes, [node]: { ...old, modules } } };
}

export interface PlacedModule extends ModuleSlot {
  /** Whether the node has it by default. */
  own: boolean;
}

/** The modules of a node in the order in which they run, with the scene's changes. */
export function pipelineOf(scene: Scene, name: string, type: NodeType): PlacedModule[] {
  const list: PlacedModule[] = (type.modules ?? []).map((m) => ({ ...m, own: true }));
  for (const [module, spec] of Object.entries(scene.nodes[name]?.modules ?? {})) {
    let slot = list.find((m) => m.name === module);
    if (!slot) {
      slot = { name: module, type: spec.type ?? "", enabled: true, own: false };
      list.push(slot);
    }
    if (spec.type) slot.type = spec.type;
    if (spec.enabled !== undefined) slot.enabled = spec.enabled;
    const next = spec.after ?? spec.before;
    if (next === undefined) continue;
    list.splice(list.indexOf(slot), 1);
    const at = list.findIndex((m) => m.name === next);
    list.splice(at < 0 ? list.length : spec.after ? at + 1 : at, 0, slot);
  }
  return list;
}

export const enableModule = (scene: Scene, node: string, module: string, enabled: boolean): Scene =>
  setModule(scene, node, module, { ...scene.nodes[node]?.modules?.[module], enabled });

export const replaceModule = (scene: Scene, node: string, module: string, type: string): Scene =>
  setModule(scene, node, module, { ...scene.nodes[node]?.modules?.[module], type, params: {} });

/** Behind a module, or else at the end. */
export function insertModule(scene: Scene, node: string, type: NodeType, module: string, after?: string): Scene {
  const list = pipelineOf(scene, node, type);
  let name = nameOfType(module);
  for (let i = 2; list.some((m) => m.name === name); ++i) name = `${nameOfType(module)}_${i}`;
  const last = list.find((m) => m.name === after) ?? list.at(-1);
  return setModule(scene, node, name, last ? { type: module, after: last.name } : { type: module });
}

export const removeModule = (scene: Scene, node: string, module: string): Scene =>
  setModule(scene, node, module, null);

export function moveModule(scene: Scene, node: string, type: NodeType, module: string, by: number): Scene {
  const list = pipelineOf(scene, node, type);
  const at = list.findIndex((m) => m.name === module);
  const neighbour = list[at + by];
  if (!neighbour) return scene;
  const { after: _a, before: _b, ...rest } = scene.nodes[node]?.modules?.[module] ?? {};
  return setModule(scene, node, module, { ...rest, [by > 0 ? "after" : "before"]: neighbour.name });
}

/** Puts a module before another one, or at the end. It is placed last, so what the file says of the others does not move it again. */
export function placeModule(scene: Scene, node: string, type: NodeType, module: string, before: string | null): Scene {
  const list = pipelineOf(scene, node, type);
  const at = list.findIndex((m) => m.name === module), next = list[at + 1]?.name ?? null;
  if (at < 0 || before === module || before === next) return scene;
  const { after: _a, before: _b, ...rest } = scene.nodes[node]?.modules?.[module] ?? {};
  const place = before === null ? { after: list.at(-1)!.name } : { before };
  return setModule(setModule(scene, node, module, null), node, module, { ...rest, ...place });
}

/** Nodes with the links between them, notes and groups, to be pasted elsewhere. */
export interface Clip {
  nodes: { [name: string]: NodeSpec };
  places: { [name: string]: Place };
  links: LinkEnds[];
  notes: Note[];
}

/** What has these names, and the notes that have these ids. */
export function copyNodes(scene: Scene, names: string[]): Clip {
  const chosen = new Set(names);
  const pick = <T>(o: { [k: string]: T }) => Object.fromEntries(Object.entries(o).filter(([n]) => chosen.has(n)));
  return {
    nodes: pick(scene.nodes),
    places: pick(scene.layout?.nodes ?? {}),
    links: linksOf(scene).filter((l) => chosen.has(l.from) && chosen.has(l.to)),
    notes: (scene.layout?.notes ?? []).filter((n) => chosen.has(n.id)),
  };
}

/** An id that nobody has; no node can be called so. */
export function freeNoteId(scene: Scene): string {
  const taken = new Set((scene.layout?.notes ?? []).map((n) => n.id));
  for (let i = 1; ; ++i) if (!taken.has(`note:${i}`)) return `note:${i}`;
}

/** Returns the names and ids that the copies got. */
export function pasteNodes(scene: Scene, clip: Clip, offset: number): [Scene, string[]] {
  const names = new Map<string, string>();
  let next = scene;
  for (const [name, spec] of Object.entries(clip.nodes)) {
    const free = freeName(next, name);
    names.set(name, free);
    const at = clip.places[name] ?? { x: 0, y: 0 };
    next = { ...next, nodes: { ...next.nodes, [free]: structuredClone(spec) } };
    next = withLayout(next, { nodes: { ...next.layout?.nodes, [free]: { ...at, x: at.x + offset, y: at.y + offset } } });
  }
  for (const l of clip.links) next = addLink(next, { ...l, from: names.get(l.from)!, to: names.get(l.to)! });
  const ids: string[] = [];
  for (const note of clip.notes) {
    const id = freeNoteId(next);
    ids.push(id);
    next = withLayout(next, { notes: [...(next.layout?.notes ?? []), { ...note, id, x: note.x + offset, y: note.y + offset }] });
  }
  return [next, [...ids, ...names.values()]];
}
