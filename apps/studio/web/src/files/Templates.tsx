// Scenes to start from, with what they look like.
import { useEffect, useState } from "react";
import { say } from "../model/store";
import { fetchTemplates, type Template } from "../protocol/client";
import { search } from "../model/search";
import { Dialog } from "./Dialog";

const nameOf = (t: Template) => t.path.split("/").at(-1)!.replace(/\.json$/, "").replaceAll("_", " ");

export function Templates({ onChoose, onClose }: { onChoose(path: string): void; onClose(): void }) {
  const [all, setAll] = useState<Template[]>([]);
  const [query, setQuery] = useState("");
  useEffect(() => void fetchTemplates().then(setAll, say), []);
  const found = query ? search(query, all, (t) => ({ name: `${nameOf(t)} ${t.title}`, doc: t.description })) : all;
  const groups = [...new Set(found.map((t) => t.group))];
  return (
    <Dialog title="Start from a template" className="templates" onClose={onClose}>
      <h2>Start from a template</h2>
      <input aria-label="Search templates" data-first placeholder="Search" value={query} onChange={(e) => setQuery(e.target.value)} onKeyDown={(e) => e.key === "Enter" && found[0] && onChoose(found[0].path)} />
      {groups.map((group) => (
        <section key={group} aria-label={group}>
          {groups.length > 1 && <h3>{group}</h3>}
          <ul className="cards">
            {found.filter((t) => t.group === group).map((t) => (
              <li key={t.path}>
                <button onClick={() => onChoose(t.path)} title={t.description}>
                  {t.thumbnail ? <img src={t.thumbnail} alt="" width={240} height={135} loading="lazy" /> : <span className="blank" />}
                  <b>{t.title || nameOf(t)}</b>
                </button>
              </li>
            ))}
          </ul>
        </section>
      ))}
      {found.length === 0 && <p className="hint">There are none.</p>}
      <button onClick={onClose}>Cancel</button>
    </Dialog>
  );
}
