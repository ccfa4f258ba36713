// Nodes that are switched off. A muted node is as if it were not there. A bypassed node is left out, too, but what comes in
// is passed on: each of its outputs stands for the input of the same type, that of the same name where there are several, or
// else the first. An output without such an input gives nothing, as in a muted node.
//
// On the page such nodes stay nodes as all others, with their links; files, and with them the runner, have a scene without
// them: what was taken out, and the links that were put in instead, stand in the layout.
import { linksOf, linkText, parseLink, type LinkEnds, type Place, type Scene } from "./scene";
import type { NodeType, Types } from "./types";

export type Off = NonNullable<Place["off"]>;

export const offOf = (scene: Scene, name: string): Off | undefined => scene.layout?.nodes?.[name]?.off;

/** Switches nodes off, or on again if all of them are off in this way. */
export function toggleOff(scene: Scene, names: string[], how: Off): Scene {
  const real = names.filter((n) => n in scene.nodes);
  return setOff(scene, real, real.every((n) => offOf(scene, n) === how) ? undefined : how);
}

export function setOff(scene: Scene, names: string[], how: Off | undefined): Scene {
  if (names.every((n) => offOf(scene, n) === how)) return scene;
  const nodes = { ...scene.layout?.nodes };
  for (const name of names) {
    const { off: _, ...place } = nodes[name] ?? { x: 0, y: 0 };
    nodes[name] = how ? { ...place, off: how } : place;
  }
  return { ...scene, layout: { ...scene.layout, nodes } };
}

/** The input for which an output of a bypassed node stands, or null. */
export function inputFor(type: NodeType | undefined, output: string): string | null {
  const carried = type?.outputs.find((p) => p.name === output)?.type;
  const fitting = (type?.inputs ?? []).filter((p) => p.type === carried);
  return (fitting.find((p) => p.name === output) ?? fitting[0])?.name ?? null;
}

/** What a bypassed node's output gives: outputs of nodes that are on. */
function sourcesOf(scene: Scene, types: Types | null, links: LinkEnds[], node: string, output: string, seen: string[] = []): LinkEnds[] {
  // A file may hold a circle.
  if (seen.includes(node)) return [];
  const input = inputFor(types?.nodes[scene.nodes[node]?.type ?? ""], output);
  return links
    .filter((l) => l.to === node && l.input === input && l.from in scene.nodes)
    .flatMap((l) => {
      const off = offOf(scene, l.from);
      return off === undefined ? [l] : off === "bypassed" ? sourcesOf(scene, types, links, l.from, l.output, [...seen, node]) : [];
    });
}

/**
 * Whether anything flows along a link: not where it ends at a muted node, or at a port that is not passed on, nor where a
 * bypassed node has nothing to pass on.
 */
export function carries(scene: Scene, types: Types | null, link: LinkEnds): boolean {
  const [from, to] = [offOf(scene, link.from), offOf(scene, link.to)];
  if (from === "muted" || to === "muted") return false;
  if (from === "bypassed" && sourcesOf(scene, types, linksOf(scene), link.from, link.output).length === 0) return false;
  const type = types?.nodes[scene.nodes[link.to]?.type ?? ""];
  return to !== "bypassed" || (type?.outputs ?? []).some((p) => inputFor(type, p.name) === link.input);
}

/** The scene as it stands in files. */
export function forRunner(scene: Scene, types: Types | null): Scene {
  const isOff = (name: string) => name in scene.nodes && offOf(scene, name) !== undefined;
  const names = Object.keys(scene.nodes).filter(isOff);
  if (names.length === 0) return scene;
  const touches = (l: LinkEnds | null) => l !== null && (isOff(l.from) || isOff(l.to));
  const links = linksOf(scene);
  const kept = (scene.links ?? []).filter((t) => !touches(parseLink(t)));
  const passed: string[] = [];
  for (const l of links) {
    if (isOff(l.to) || offOf(scene, l.from) !== "bypassed" || !isOff(l.from)) continue;
    const many = types?.nodes[scene.nodes[l.to]?.type ?? ""]?.inputs.find((p) => p.name === l.input)?.many;
    const found = sourcesOf(scene, types, links, l.from, l.output);
    for (const source of many ? found : found.slice(0, 1)) {
      const text = linkText({ ...l, from: source.from, output: source.output });
      if (!kept.includes(text) && !passed.includes(text)) passed.push(text);
    }
  }
  const pick = (off: boolean) => Object.fromEntries(Object.entries(scene.nodes).filter(([n]) => isOff(n) === off));
  return {
    ...scene,
    nodes: pick(false),
    links: [...kept, ...passed],
    layout: { ...scene.layout, off: { nodes: pick(true), links: links.filter(touches).map(linkText), passed } },
  };
}

/** The scene as the page has it. */
export function fromFile(scene: Scene): Scene {
  const { off, ...layout } = scene.layout ?? {};
  if (!off) return scene;
  const passed = new Set(off.passed);
  const own = (scene.links ?? []).filter((t) => !passed.has(t));
  return { ...scene, nodes: { ...off.nodes, ...scene.nodes }, links: [...own, ...off.links.filter((t) => !own.includes(t))], layout };
}
