// Notes and groups (a note with a frame) beside the nodes, and how all of them are moved.
import { moveNodes, type Note, type Scene } from "./scene";

type Places = { [id: string]: { x: number; y: number } };

const withNotes = (scene: Scene, notes: Note[]): Scene => ({ ...scene, layout: { ...scene.layout, notes } });

export const notesOf = (scene: Scene): Note[] => scene.layout?.notes ?? [];

export const addNote = (scene: Scene, note: Note): Scene => withNotes(scene, [...notesOf(scene), note]);

export const changeNote = (scene: Scene, id: string, change: Partial<Note>): Scene =>
  withNotes(scene, notesOf(scene).map((n) => (n.id === id ? { ...n, ...change } : n)));

/** Where all stands that moves when some nodes and notes are moved there: a group takes along what lies on it. */
export function withCarried(scene: Scene, moved: Places): Places {
  const all = { ...moved };
  for (const group of notesOf(scene)) {
    const to = moved[group.id];
    if (!to || !group.frame) continue;
    const lies = (p: { x: number; y: number }, size = { width: 0, height: 0 }) =>
      p.x >= group.x && p.y >= group.y && p.x + size.width <= group.x + group.width && p.y + size.height <= group.y + group.height;
    const take = (id: string, p: { x: number; y: number }) => (all[id] ??= { x: p.x + to.x - group.x, y: p.y + to.y - group.y });
    for (const [n, p] of Object.entries(scene.layout?.nodes ?? {})) if (n in scene.nodes && lies(p)) take(n, p);
    for (const n of notesOf(scene)) if (n !== group && lies(n, n)) take(n.id, n);
  }
  return all;
}

/** Moves nodes and notes to where they are put, and what groups take along. */
export function moveAll(scene: Scene, moved: Places): Scene {
  const all = withCarried(scene, moved);
  const next = moveNodes(scene, Object.fromEntries(Object.entries(all).filter(([id]) => id in scene.nodes)));
  const notes = notesOf(scene);
  if (!notes.some((n) => n.id in all)) return next;
  const at = (n: Note) => all[n.id]!;
  return withNotes(next, notes.map((n) => (n.id in all ? { ...n, x: Math.round(at(n).x), y: Math.round(at(n).y) } : n)));
}
