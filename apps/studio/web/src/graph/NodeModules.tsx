// The modules of a node, unfolded on it in the order in which they run: dragged into another one, switched, inserted, taken out. Their
// values are in the panel of properties.
import { useState } from "react";
import { menuOf, showMenu } from "../Menu";
import { enableModule, moveModule, pipelineOf, placeModule, removeModule, type PlacedModule } from "../model/scene";
import { edit, useStudio } from "../model/store";
import { kWorthTelling, msText } from "../model/time";
import type { NodeType } from "../model/types";

const kDragged = "application/x-weir-module";

/** What is dragged now: only to another place of its own node. */
let dragged: { node: string; module: string } | null = null;

/** Unfolds the modules of a node, or folds them. */
export const showModules = (node: string, shown: boolean): void =>
  useStudio.setState(({ unfolded }) => ({ unfolded: shown ? [...unfolded.filter((n) => n !== node), node] : unfolded.filter((n) => n !== node) }));

const rowsOf = (node: string): HTMLElement[] => [...document.querySelectorAll<HTMLElement>(`[data-node="${node}"] .inner .title`)];

/** Gives the keyboard to a module, or to the first one. */
export const focusModule = (node: string, module?: string): void =>
  void setTimeout(() => (rowsOf(node).find((row) => row.textContent === module) ?? rowsOf(node)[0])?.focus({ preventScroll: true }));

/** Unfolds them and goes on to the first one by the keyboard, or folds them. */
export function toggleModules(node: string): void {
  const { scene, types, unfolded } = useStudio.getState();
  if (!types?.nodes[scene.nodes[node]?.type ?? ""]?.modules) return;
  showModules(node, !unfolded.includes(node));
  focusModule(node);
}

const show = (node: string, module: string): void => useStudio.setState({ selected: [node], selectedLinks: [], wanted: { module } });

/** Asks which module shall come behind one, at a place of the page. */
const askInsert = (node: string, after: string, at: Element): void => {
  const { left, bottom } = at.getBoundingClientRect();
  useStudio.setState({ inserting: { node, after, x: left, y: bottom } });
};

interface RowProps {
  node: string;
  type: NodeType;
  module: PlacedModule;
  list: PlacedModule[];
  over: boolean;
  onOver(before: string | null): void;
}

function Row({ node, type, module: m, list, over, onOver }: RowProps) {
  const doc = useStudio((s) => s.types?.modules[m.type]?.doc);
  const writer = useStudio((s) => s.role === "writer");
  const shown = useStudio((s) => s.module === m.name && s.selected.length === 1 && s.selected[0] === node);
  const took = useStudio((s) => (s.numbers?.["modules_ms"] as { [path: string]: { per_step?: number } } | undefined)?.[`${node}/${m.name}`]?.per_step ?? 0);
  const at = list.indexOf(m);
  const use = (on: boolean) => edit((s) => enableModule(s, node, m.name, on));
  const move = (by: 1 | -1) => (edit((s) => moveModule(s, node, type, m.name, by)), focusModule(node, m.name));
  const remove = () => edit((s) => (m.own ? enableModule(s, node, m.name, false) : removeModule(s, node, m.name)));
  const menu = (e: React.MouseEvent) => {
    e.preventDefault();
    e.stopPropagation();
    const row = e.currentTarget;
    showMenu(e, m.name, menuOf(
      { name: "Its values", keys: "Enter", take: () => show(node, m.name) },
      { name: m.enabled ? "Leave it out" : "Use it", keys: "Space", off: !writer, take: () => use(!m.enabled) }, null,
      { name: "Insert behind it…", keys: "Insert", off: !writer, take: () => askInsert(node, m.name, row) },
      { name: "Move up", keys: "Alt+Up", off: !writer || at === 0, take: () => move(-1) },
      { name: "Move down", keys: "Alt+Down", off: !writer || at === list.length - 1, take: () => move(1) }, null,
      { name: "Reference", keys: "F1", take: () => useStudio.setState({ reference: m.type }) },
      { name: "Remove", keys: "Delete", off: !writer || m.own, take: remove },
    ));
  };
  const key = (e: React.KeyboardEvent) => {
    const by = e.key === "ArrowUp" ? -1 : e.key === "ArrowDown" ? 1 : 0, rows = rowsOf(node);
    if (by !== 0 && e.altKey) move(by);
    else if (by !== 0) rows[at + by]?.focus({ preventScroll: true });
    else if (e.key === "Enter") show(node, m.name);
    else if (e.key === " ") use(!m.enabled);
    else if (e.key === "Insert") askInsert(node, m.name, e.currentTarget);
    else if (e.key === "Delete" || e.key === "Backspace") remove();
    else if (e.key === "Escape") document.querySelector<HTMLElement>(".graph")?.focus({ preventScroll: true });
    else return;
    e.preventDefault();
    e.stopPropagation();
  };
  return (
    <li
      className={[!m.enabled && "off", over && "over", shown && "shown"].filter(Boolean).join(" ")} data-module={m.name} draggable={writer} onContextMenu={menu} {...target(node, type, m.name, onOver)}
      onDragStart={(e) => ((dragged = { node, module: m.name }), e.dataTransfer.setData(kDragged, m.name), (e.dataTransfer.effectAllowed = "move"))} onDragEnd={() => ((dragged = null), onOver(null))}
    >
      <span className="handle" aria-hidden title="Drag it to another place">⠿</span>
      <input type="checkbox" checked={m.enabled} disabled={!writer} aria-label={`Use ${m.name} of ${node}`} onChange={(e) => use(e.target.checked)} />
      <button className="title" aria-pressed={shown} title={doc} onClick={() => show(node, m.name)} onKeyDown={key}>{m.name}</button>
      {took >= kWorthTelling && <small>{msText(took)}</small>}
    </li>
  );
}

/** Where what is dragged comes to lie: before a module, or at the end. */
const target = (node: string, type: NodeType, before: string | null, onOver: (before: string | null) => void) => ({
  onDragOver: (e: React.DragEvent) => {
    if (dragged?.node !== node) return;
    e.preventDefault();
    onOver(before ?? "");
  },
  onDrop: (e: React.DragEvent) => {
    if (dragged?.node !== node) return;
    const { module } = dragged;
    e.preventDefault();
    e.stopPropagation();
    onOver(null);
    edit((s) => placeModule(s, node, type, module, before));
  },
});

export function NodeModules({ node, type }: { node: string; type: NodeType }) {
  const scene = useStudio((s) => s.scene);
  const writer = useStudio((s) => s.role === "writer");
  const [over, setOver] = useState<string | null>(null);
  const list = pipelineOf(scene, node, type);
  return (
    // Its own gestures are not those of the node and of the graph.
    <section className="inner nodrag nopan" aria-label={`Modules of ${node}, in their order`} onDoubleClick={(e) => e.stopPropagation()}>
      <ol onDragLeave={(e) => !e.currentTarget.contains(e.relatedTarget as Node | null) && setOver(null)}>
        {list.map((m) => <Row key={m.name} node={node} type={type} module={m} list={list} over={over === m.name} onOver={setOver} />)}
      </ol>
      <button className="end" disabled={!writer} data-over={over === "" ? "" : undefined} onClick={(e) => askInsert(node, list.at(-1)?.name ?? "", e.currentTarget)} {...target(node, type, null, setOver)}>Insert a module…</button>
    </section>
  );
}
