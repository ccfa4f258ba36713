// What is done to what is selected, by keys and menus alike.
import { moveAll, notesOf } from "../model/notes";
import { copyNodes, linksOf, linkText, pasteNodes, removeLinks, removeNodes, toggleCollapsed, type Clip, type Scene } from "../model/scene";
import { edit, useStudio } from "../model/store";
import { toggleOff, type Off } from "../model/switchedOff";
import { arrange } from "./arrange";

const kPasteOffset = 40;

const now = useStudio.getState;

/** The selected nodes, without notes. */
export const chosenNodes = (): string[] => now().selected.filter((n) => n in now().scene.nodes);

export const select = (selected: string[], selectedLinks: string[] = []): void => useStudio.setState({ selected, selectedLinks });

export const selectAll = (): void => select([...notesOf(now().scene).map((n) => n.id), ...Object.keys(now().scene.nodes)]);

const insert = (clip: Clip): void => edit((s) => {
  const [next, names] = pasteNodes(s, clip, kPasteOffset);
  select(names);
  return next;
});

export const copy = (): void => useStudio.setState({ clip: copyNodes(now().scene, now().selected) });

export function cut(): void {
  copy();
  edit((s) => removeNodes(s, now().selected));
}

export function paste(): void {
  const { clip, scene } = now();
  if (!clip) return;
  insert(clip);
  // What is pasted again lies beside, not upon, what was pasted before.
  if (now().scene !== scene) copy();
}

export function duplicate(): void {
  if (now().selected.length > 0) insert(copyNodes(now().scene, now().selected));
}

export const remove = (): void => edit((s) => removeNodes(removeLinks(s, now().selectedLinks), now().selected));

export const fold = (): void => edit((s) => toggleCollapsed(s, now().selected));

export const switchOff = (how: Off): void => edit((s) => toggleOff(s, now().selected, how));

export function arrangeNodes(): void {
  const chosen = chosenNodes();
  edit((s) => arrange(s, now().types, chosen.length > 1 ? chosen : undefined, now().unfolded));
}

export const nudge = (x: number, y: number): void => edit((s) => {
  const at = { ...s.layout?.nodes, ...Object.fromEntries(notesOf(s).map((n) => [n.id, n])) };
  return moveAll(s, Object.fromEntries(now().selected.map((n) => [n, { x: (at[n]?.x ?? 0) + x, y: (at[n]?.y ?? 0) + y }])));
});

/** The links of some nodes. */
export const linksAt = (scene: Scene, names: string[]): string[] =>
  linksOf(scene).filter((l) => names.includes(l.from) || names.includes(l.to)).map(linkText);

export const disconnect = (): void => edit((s) => {
  const links = linksAt(s, now().selected);
  return links.length > 0 ? removeLinks(s, links) : s;
});

/** Selects the next node, from left to right, as things flow. */
export function selectNext(by: number): void {
  const { scene, selected } = now();
  const at = (n: string) => scene.layout?.nodes?.[n] ?? { x: 0, y: 0 };
  const names = Object.keys(scene.nodes).sort((a, b) => at(a).x - at(b).x || at(a).y - at(b).y);
  const from = names.indexOf(selected[0] ?? "");
  const next = names[from < 0 ? (by > 0 ? 0 : names.length - 1) : (from + by + names.length) % names.length];
  if (next) select([next]);
}

/** What stands in the panel of properties is typed over. */
export function focusName(): void {
  const field = document.querySelector<HTMLInputElement>(".name-field input");
  field?.focus();
  field?.select();
}

/** The text of the note that is selected. */
export const focusNote = (): void => document.querySelector<HTMLElement>(".react-flow__node-note.selected textarea")?.focus();

/** The first value of what is selected, or its name where it has none. */
export function focusProperties(): void {
  const field = document.querySelector<HTMLElement>(".properties .parameters :is(input, select, textarea, button):not(:disabled)");
  if (field) field.focus();
  else focusName();
}
