// The modules of a node in the order in which they run: dragged into another one, switched, replaced, inserted.
import { useEffect, useMemo, useRef, useState } from "react";
import { Finder, type Found } from "../Finder";
import { menuOf, showMenu } from "../Menu";
import { kModuleRole } from "../model/roles";
import { enableModule, insertModule, moveModule, pipelineOf, placeModule, removeModule, replaceModule, type PlacedModule } from "../model/scene";
import { edit, useStudio } from "../model/store";
import { kWorthTelling, msText } from "../model/time";
import type { NodeType } from "../model/types";
import { Parameters } from "./Parameters";

const kDragged = "application/x-weir-module";

/** Types of modules with their texts, for the place behind one. */
function Inserter({ node, type, after, onInserted, onClose }: { node: string; type: NodeType; after: string; onInserted(): void; onClose(): void }) {
  const types = useStudio((s) => s.types)!;
  const [place, setPlace] = useState(after);
  const list = pipelineOf(useStudio((s) => s.scene), node, type);
  const items = useMemo((): Found[] => {
    const insert = (module: string) => () => {
      edit((s) => {
        const before = new Set(pipelineOf(s, node, type).map((m) => m.name));
        const next = insertModule(s, node, type, module, place);
        useStudio.setState({ wanted: { module: pipelineOf(next, node, type).find((m) => !before.has(m.name))?.name } });
        return next;
      });
      onInserted();
    };
    return Object.entries(types.modules).filter(([, m]) => m.family === type.family).sort(([a], [b]) => (a < b ? -1 : 1))
      .map(([name, m]) => ({ id: name, name, doc: m.doc, synonyms: m.also ?? [], role: kModuleRole, group: "What fits here", take: insert(name) }));
  }, [types, type, node, place, onInserted]);
  return (
    <div className="inserter finder" ref={(box) => box?.scrollIntoView({ block: "nearest" })}>
      <label>Behind <select aria-label="Behind which module" value={place} onChange={(e) => setPlace(e.target.value)}>{list.map((m) => <option key={m.name}>{m.name}</option>)}</select></label>
      <Finder items={items} label="Search modules" placeholder="Search modules" onClose={onClose} />
    </div>
  );
}

export function Modules({ node }: { node: string }) {
  const scene = useStudio((s) => s.scene);
  const types = useStudio((s) => s.types)!;
  const writer = useStudio((s) => s.role === "writer");
  const times = useStudio((s) => s.numbers?.["modules_ms"]) as { [path: string]: { per_step?: number } } | undefined;
  const wanted = useStudio((s) => s.wanted?.module ?? null);
  const [open, setOpen] = useState<string | null>(wanted);
  const [inserting, setInserting] = useState(false);
  const button = useRef<HTMLButtonElement>(null);
  const [over, setOver] = useState<string | null>(null);
  useEffect(() => {
    if (wanted !== null) setOpen(wanted);
  }, [wanted]);
  const type = types.nodes[scene.nodes[node]?.type ?? ""];
  if (!type?.modules) return null;
  const family = Object.entries(types.modules).filter(([, m]) => m.family === type.family);
  const list = pipelineOf(scene, node, type);
  const closeInserter = () => (setInserting(false), setTimeout(() => button.current?.focus()));
  const took = (name: string) => times?.[`${node}/${name}`]?.per_step ?? 0;
  const move = (name: string, by: number) => edit((s) => moveModule(s, node, type, name, by));
  const menu = (e: React.MouseEvent, m: PlacedModule, i: number) => {
    if ((e.target as Element).closest(".parameters")) return;
    e.preventDefault();
    showMenu(e, m.name, menuOf(
      { name: m.enabled ? "Leave it out" : "Use it", off: !writer, take: () => edit((s) => enableModule(s, node, m.name, !m.enabled)) }, null,
      { name: "Move up", off: !writer || i === 0, take: () => move(m.name, -1) }, { name: "Move down", off: !writer || i === list.length - 1, take: () => move(m.name, 1) },
      { name: "Insert behind it…", off: !writer, take: () => (setOpen(m.name), setInserting(true)) }, null,
      { name: "Remove", off: !writer || m.own, take: () => edit((s) => removeModule(s, node, m.name)) },
    ));
  };
  /** Where what is dragged comes to lie: before a module, or at the end. */
  const place = (before: string | null) => ({
    onDragOver: (e: React.DragEvent) => {
      if (!e.dataTransfer.types.includes(kDragged)) return;
      e.preventDefault();
      setOver(before ?? "");
    },
    onDrop: (e: React.DragEvent) => {
      const name = e.dataTransfer.getData(kDragged);
      setOver(null);
      if (!name) return;
      e.preventDefault();
      e.stopPropagation();
      edit((s) => placeModule(s, node, type, name, before));
    },
  });
  return (
    <section className="modules" aria-label="Modules">
      <h3>Modules, in their order</h3>
      <ol onDragLeave={(e) => !e.currentTarget.contains(e.relatedTarget as Node | null) && setOver(null)}>
        {list.map((m, i) => (
          <li
            key={m.name} className={[!m.enabled && "off", over === m.name && "over", open === m.name && "open"].filter(Boolean).join(" ")} data-module={m.name}
            onContextMenu={(e) => menu(e, m, i)} {...place(m.name)}
          >
            <div className="module" draggable={writer} onDragStart={(e) => (e.dataTransfer.setData(kDragged, m.name), (e.dataTransfer.effectAllowed = "move"))} onDragEnd={() => setOver(null)}>
              <span className="handle" aria-hidden title="Drag it to another place">⠿</span>
              <input type="checkbox" checked={m.enabled} disabled={!writer} aria-label={`Use ${m.name}`} onChange={(e) => edit((s) => enableModule(s, node, m.name, e.target.checked))} />
              <button className="title" aria-expanded={open === m.name} onClick={() => setOpen(open === m.name ? null : m.name)} title={types.modules[m.type]?.doc}>
                {m.name}
              </button>
              {took(m.name) >= kWorthTelling && <span className="badge">{msText(took(m.name))}</span>}
              <button aria-label={`Move ${m.name} up`} disabled={!writer || i === 0} onClick={() => move(m.name, -1)}>↑</button>
              <button aria-label={`Move ${m.name} down`} disabled={!writer || i === list.length - 1} onClick={() => move(m.name, 1)}>↓</button>
              {!m.own && <button aria-label={`Remove ${m.name}`} disabled={!writer} onClick={() => edit((s) => removeModule(s, node, m.name))}>×</button>}
              <select aria-label={`Type of ${m.name}`} disabled={!writer} value={m.type} onChange={(e) => edit((s) => replaceModule(s, node, m.name, e.target.value))}>
                {family.map(([t, d]) => <option key={t} title={d.doc}>{t}</option>)}
              </select>
            </div>
            {open === m.name && <p className="doc">{types.modules[m.type]?.doc}</p>}
            {open === m.name && <Parameters owner={{ node, module: m.name }} parameters={types.modules[m.type]?.parameters ?? []} />}
          </li>
        ))}
      </ol>
      {inserting ? (
        <Inserter node={node} type={type} after={list.some((m) => m.name === open) ? open! : list.at(-1)?.name ?? ""} onInserted={() => setInserting(false)} onClose={closeInserter} />
      ) : (
        <button ref={button} className="end" disabled={!writer} onClick={() => setInserting(true)} {...place(null)} data-over={over === "" ? "" : undefined}>Insert a module…</button>
      )}
    </section>
  );
}
