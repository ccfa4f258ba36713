// A field to search in, and what was found: walked through by the arrow keys, taken by Enter or a click.
import { useEffect, useId, useMemo, useRef, useState, type ReactNode } from "react";
import { roleColor } from "./graph/ports";
import { Icon } from "./Icon";
import type { Role } from "./model/roles";
import { search, type Findable } from "./model/search";

export interface Found extends Findable {
  /** Tells it from all others. */
  id: string;
  role: Role;
  /** Above which heading it stands while nothing is searched for. */
  group: string;
  /** What it belongs to, beside its name. */
  beside?: string;
  take(): void;
}

const kMost = 60;

export function Finder({ items, label, placeholder, onClose, nothing = "Nothing fits." }: {
  items: Found[]; label: string; placeholder: string; onClose(): void; nothing?: ReactNode;
}) {
  const [query, setQuery] = useState("");
  const [index, setIndex] = useState(0);
  const input = useRef<HTMLInputElement>(null);
  useEffect(() => input.current?.focus(), []);
  const found = useMemo(() => search(query, items, (i) => i).slice(0, query.trim() ? kMost : undefined), [items, query]);
  const grouped = query.trim() === "";

  const id = useId();
  const key = (e: React.KeyboardEvent) => {
    if (e.key === "ArrowDown") setIndex((i) => Math.min(i + 1, found.length - 1));
    else if (e.key === "ArrowUp") setIndex((i) => Math.max(i - 1, 0));
    else if (e.key === "Enter") found[index]?.take();
    else if (e.key === "Escape") onClose();
    else return;
    e.preventDefault();
    e.stopPropagation();
  };
  return (
    <>
      <input
        ref={input} data-first value={query} placeholder={placeholder} aria-label={label} onKeyDown={key}
        role="combobox" aria-expanded aria-autocomplete="list" aria-controls={id} aria-activedescendant={found.length > 0 ? `${id}-${index}` : undefined}
        onChange={(e) => (setQuery(e.target.value), setIndex(0))}
      />
      <ul role="listbox" id={id} aria-label={label}>
        {found.map((item, i) => [
          grouped && item.group !== found[i - 1]?.group && <li key={`/${item.group}`} role="presentation" className="heading">{item.group}</li>,
          <li
            key={item.id} id={`${id}-${i}`} role="option" aria-selected={i === index} onMouseMove={() => setIndex(i)} onClick={item.take}
            ref={(li) => { if (i === index) li?.scrollIntoView({ block: "nearest" }); }}
          >
            <span className="sign" style={{ color: roleColor(item.role) }}><Icon name={item.role.icon} /></span>
            <strong>{item.name}</strong>{item.beside && <em>{item.beside}</em>}
            {!grouped && <span className="role">{item.group}</span>}
            {item.doc && <small>{item.doc}</small>}
          </li>,
        ])}
        {found.length === 0 && <li className="none" role="presentation">{nothing}</li>}
      </ul>
    </>
  );
}
