// The scenes of the served folder and the folders below it.
import { useEffect, useState } from "react";
import { say } from "../model/store";
import { fetchFiles, type ServedFile } from "../protocol/client";
import { Dialog } from "./Dialog";

export function Chooser({ onChoose, onClose }: { onChoose(path: string): void; onClose(): void }) {
  const [files, setFiles] = useState<ServedFile[] | null>(null);
  const [folder, setFolder] = useState("");
  useEffect(() => void fetchFiles(folder).then((all) => setFiles(all.filter((f) => f.folder || f.path.endsWith(".json"))), say), [folder]);
  return (
    <Dialog title="Open a scene" onClose={onClose}>
      <h2>Open a scene <small>{folder}</small></h2>
      <ul className="files">
        {folder && <li><button onClick={() => setFolder(folder.split("/").slice(0, -1).join("/"))}>../</button></li>}
        {files?.map((f) => (
          <li key={f.path}>
            <button onClick={() => (f.folder ? setFolder(f.path) : onChoose(f.path))}>{f.path.split("/").at(-1)!.replace(/\.json$/, "")}{f.folder ? "/" : ""}</button>
          </li>
        ))}
        {files?.length === 0 && <li>There are no scenes here.</li>}
      </ul>
      <button onClick={onClose}>Cancel</button>
    </Dialog>
  );
}
