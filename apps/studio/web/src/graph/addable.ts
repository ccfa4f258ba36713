// What can be added to a graph, as lists offer it.
import type { Found } from "../Finder";
import { kModuleRole, kRoleNames, roleOf } from "../model/roles";
import type { Scene } from "../model/scene";
import type { NodeType, Types } from "../model/types";

const kRecentKey = "weir-recent";
const kMaxRecent = 5;
const kRecent = "Recently used";

function recent(): string[] {
  try {
    return JSON.parse(localStorage.getItem(kRecentKey) ?? "[]") as string[];
  } catch {
    return [];
  }
}

export function remember(type: string): void {
  localStorage.setItem(kRecentKey, JSON.stringify([type, ...recent().filter((t) => t !== type)].slice(0, kMaxRecent)));
}

/** All types of nodes that fit: those that were used last, and the others by their roles. */
export function nodesToAdd(types: Types, fits: (type: NodeType) => boolean, add: (type: string) => void): Found[] {
  const last = recent();
  const rank = (name: string, t: NodeType) => (last.includes(name) ? last.indexOf(name) - kMaxRecent : kRoleNames.indexOf(roleOf(t).name));
  return Object.entries(types.nodes)
    .filter(([, t]) => fits(t))
    .sort(([a, s], [b, t]) => rank(a, s) - rank(b, t) || (a < b ? -1 : 1))
    .map(([name, t]) => ({
      id: name, name, doc: t.doc, synonyms: t.also ?? [], role: roleOf(t), group: last.includes(name) ? kRecent : roleOf(t).name,
      take: () => (remember(name), add(name)),
    }));
}

/** The node that a module goes to: the selected one, or else the first that takes such modules. */
export function hostOf(scene: Scene, types: Types, family: string, selected: string[]): string | null {
  const takes = (n: string) => types.nodes[scene.nodes[n]?.type ?? ""]?.family === family;
  return selected.find(takes) ?? Object.keys(scene.nodes).find(takes) ?? null;
}

export const modulesToAdd = (types: Types, take: (module: string) => void): Found[] =>
  Object.entries(types.modules).sort(([a], [b]) => (a < b ? -1 : 1)).map(([name, m]) => ({
    id: `module ${name}`, name, doc: m.doc, synonyms: m.also ?? [], role: kModuleRole, group: kModuleRole.name, beside: "module", take: () => take(name),
  }));
