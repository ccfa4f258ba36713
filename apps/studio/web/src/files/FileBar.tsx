// New, open, save, templates, and the help sheet.
import { useState } from "react";
import { newScene, openScene, request, saveScene, say, undo, redo, useStudio } from "../model/store";
import { fetchFiles, fetchTemplates, type ServedFile } from "../protocol/client";
import { Help } from "./Help";

function Chooser({ title, load, onChoose, onClose }: {
  title: string;
  load: (folder: string) => Promise<ServedFile[]>;
  onChoose(path: string): void;
  onClose(): void;
}) {
  const [files, setFiles] = useState<ServedFile[] | null>(null);
  const [folder, setFolder] = useState("");
  const show = (where: string) => (setFolder(where), void load(where).then((all) => setFiles(all.filter((f) => f.folder || f.path.endsWith(".json"))), say));
  if (files === null) void Promise.resolve().then(() => show(""));
  return (
    <>
      <div className="shade" onClick={onClose} />
      <div className="dialog" role="dialog" aria-label={title} onKeyDown={(e) => e.key === "Escape" && onClose()}>
        <h2>{title}</h2>
        <ul className="files">
          {folder && <li><button onClick={() => show(folder.split("/").slice(0, -1).join("/"))}>../</button></li>}
          {files?.map((f) => (
            <li key={f.path}>
              <button autoFocus={f === files[0]} onClick={() => (f.folder ? show(f.path) : onChoose(f.path))}>{f.path.split("/").at(-1)!.replace(/\.json$/, "")}{f.folder ? "/" : ""}</button>
            </li>
          ))}
          {files?.length === 0 && <li>There are no scenes here.</li>}
        </ul>
        <button onClick={onClose}>Cancel</button>
      </div>
    </>
  );
}

/** Asks for a name where the scene has none yet. */
export async function save(as: boolean): Promise<void> {
  const { path } = useStudio.getState().sceneState;
  const name = as || !path ? prompt("Save as (below the served folder):", path || "scene.json") : path;
  if (name) await saveScene(name.endsWith(".json") ? name : `${name}.json`);
}

export function FileBar({ dark, onDark }: { dark: boolean; onDark(): void }) {
  const [shown, setShown] = useState<"open" | "templates" | "help" | null>(null);
  const path = useStudio((s) => s.sceneState.path);
  const title = useStudio((s) => s.scene.title);
  const connected = useStudio((s) => s.connected);
  const role = useStudio((s) => s.role);
  const close = () => setShown(null);
  return (
    <header className="bar" role="toolbar" aria-label="File">
      <b className="logo">Weir</b>
      <button onClick={newScene}>New</button>
      <button onClick={() => setShown("open")}>Open</button>
      <button onClick={() => setShown("templates")}>Templates</button>
      <button onClick={() => void save(false)} title="Ctrl+S">Save</button>
      <button onClick={() => void save(true)}>Save as</button>
      <span className="gap" />
      <button onClick={undo} title="Ctrl+Z" aria-label="Undo">↶</button>
      <button onClick={redo} title="Ctrl+Shift+Z" aria-label="Redo">↷</button>
      <span className="title">{title ?? "Untitled"} <small>{path || "not saved"}</small></span>
      {!connected && <span className="lost" role="alert">no connection</span>}
      {connected && role === "viewer" && <button className="wanted" onClick={() => void request("role.claim")} title="Another window makes changes; take that over">Take the pen</button>}
      <button onClick={onDark} aria-pressed={dark} title="Light or dark">{dark ? "☀" : "☾"}</button>
      <button onClick={() => setShown("help")} title="Keys (?)" aria-label="Help">?</button>
      {shown === "open" && <Chooser title="Open a scene" load={fetchFiles} onClose={close} onChoose={(p) => (close(), void openScene({ path: p }))} />}
      {shown === "templates" && <Chooser title="Start from a template" load={fetchTemplates} onClose={close} onChoose={(p) => (close(), void openScene({ template: p }))} />}
      {shown === "help" && <Help onClose={close} />}
    </header>
  );
}
