// The list from which nodes are added: fuzzy search, and only what fits where a link was dragged from.
import { useEffect, useMemo, useRef, useState } from "react";
import { search } from "../model/search";
import { useStudio } from "../model/store";
import type { NodeType } from "../model/types";

/** A port that waits to be linked to the new node. */
export interface Dangling {
  node: string;
  port: string;
  type: string;
  side: "input" | "output";
}

export interface AddMenuProps {
  at: { x: number; y: number };
  dangling: Dangling | null;
  onAdd(type: string): void;
  onNote(frame: boolean): void;
  onClose(): void;
}

const fits = (type: NodeType, d: Dangling | null): boolean =>
  !d || (d.side === "output" ? type.inputs : type.outputs).some((p) => p.type === d.type);

export function AddMenu({ at, dangling, onAdd, onNote, onClose }: AddMenuProps) {
  const types = useStudio((s) => s.types);
  const [query, setQuery] = useState("");
  const [index, setIndex] = useState(0);
  const input = useRef<HTMLInputElement>(null);
  useEffect(() => input.current?.focus(), []);

  const items = useMemo(() => {
    const nodes = Object.entries(types?.nodes ?? {})
      .filter(([, t]) => fits(t, dangling))
      .map(([name, t]) => ({ name, doc: t.doc, add: () => onAdd(name) }));
    const extra = dangling
      ? []
      : [
          { name: "Note", doc: "A text beside the nodes.", add: () => onNote(false) },
          { name: "Group", doc: "A frame that takes the nodes on it along.", add: () => onNote(true) },
        ];
    return search(query, [...nodes, ...extra], (i) => i.name);
  }, [types, dangling, query, onAdd, onNote]);

  const key = (e: React.KeyboardEvent) => {
    if (e.key === "ArrowDown") setIndex((i) => Math.min(i + 1, items.length - 1));
    else if (e.key === "ArrowUp") setIndex((i) => Math.max(i - 1, 0));
    else if (e.key === "Enter") items[index]?.add();
    else if (e.key === "Escape") onClose();
    else return;
    e.preventDefault();
    e.stopPropagation();
  };

  return (
    <>
      <div className="shade" onClick={onClose} />
      <div className="add-menu" style={{ left: at.x, top: at.y }} role="dialog" aria-label="Add a node">
        <input
          ref={input} value={query} placeholder={dangling ? `What takes a ${dangling.type}?` : "Search nodes"}
          aria-label="Search nodes" onKeyDown={key}
          onChange={(e) => (setQuery(e.target.value), setIndex(0))}
        />
        <ul role="listbox">
          {items.map((item, i) => (
            <li key={item.name} role="option" aria-selected={i === index} ref={(li) => { if (i === index) li?.scrollIntoView({ block: "nearest" }); }} onMouseMove={() => setIndex(i)} onClick={item.add}>
              <strong>{item.name}</strong>
              <small>{item.doc}</small>
            </li>
          ))}
          {items.length === 0 && <li className="none">Nothing fits.</li>}
        </ul>
      </div>
    </>
  );
}
