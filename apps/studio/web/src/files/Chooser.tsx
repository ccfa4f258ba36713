// The scenes of the served folder and the folders below it.
import { useEffect, useState } from "react";
import { Icon } from "../Icon";
import { ageOf } from "../model/time";
import { search } from "../model/search";
import { say } from "../model/store";
import { addressOfPicture, fetchFiles, type ServedFile } from "../protocol/client";
import { Dialog } from "./Dialog";

const nameOf = (f: ServedFile) => f.path.split("/").at(-1)!.replace(/\.json$/, "");
const kOrders = { name: (a: ServedFile, b: ServedFile) => (a.path < b.path ? -1 : 1), newest: (a: ServedFile, b: ServedFile) => (b.modified ?? 0) - (a.modified ?? 0) };

export function Chooser({ onChoose, onClose }: { onChoose(path: string): void; onClose(): void }) {
  const [files, setFiles] = useState<ServedFile[] | null>(null);
  const [folder, setFolder] = useState("");
  const [query, setQuery] = useState("");
  const [order, setOrder] = useState<keyof typeof kOrders>("newest");
  useEffect(() => {
    setQuery("");
    void fetchFiles(folder).then((all) => setFiles(all.filter((f) => f.folder || f.path.endsWith(".json"))), say);
  }, [folder]);
  const sorted = [...(files ?? [])].sort((a, b) => Number(b.folder) - Number(a.folder) || kOrders[order](a, b));
  const shown = search(query, sorted, nameOf);
  const take = (f: ServedFile | undefined) => f && (f.folder ? setFolder(f.path) : onChoose(f.path));
  return (
    <Dialog title="Open a scene" className="chooser" onClose={onClose}>
      <h2>Open a scene</h2>
      <div className="sought">
        <input aria-label="Search scenes" data-first placeholder="Search" value={query} onChange={(e) => setQuery(e.target.value)} onKeyDown={(e) => e.key === "Enter" && take(shown[0])} />
        <select aria-label="Order" value={order} onChange={(e) => setOrder(e.target.value as keyof typeof kOrders)}><option value="newest">newest first</option><option value="name">by name</option></select>
      </div>
      <p className="hint">In {folder ? `${folder}/` : "the served folder"}</p>
      <ul className="files">
        {folder && <li><button onClick={() => setFolder(folder.split("/").slice(0, -1).join("/"))}>../</button></li>}
        {shown.map((f) => (
          <li key={f.path}>
            <button onClick={() => take(f)}>
              {f.picture ? <img src={addressOfPicture(f.path, f.picture)} alt="" width={96} height={54} loading="lazy" /> : <span className="sign"><Icon name={f.folder ? "folder" : "drop"} /></span>}<b>{nameOf(f)}{f.folder ? "/" : ""}</b>
              {!!f.modified && !f.folder && <time dateTime={new Date(1000 * f.modified).toISOString()} title={new Date(1000 * f.modified).toLocaleString()}>{ageOf(f.modified)}</time>}
            </button>
          </li>
        ))}
        {files && shown.length === 0 && <li className="hint">{files.length === 0 ? "There are no scenes here." : "None fits."}</li>}
      </ul>
      <button onClick={onClose}>Cancel</button>
    </Dialog>
  );
}
