// New, open, save, templates, and the help sheet.
import { useState } from "react";
import { newScene, openScene, redo, request, saveScene, undo, useHistory, useStudio } from "../model/store";
import { Chooser } from "./Chooser";
import { Help } from "./Help";
import { SaveDialog } from "./SaveDialog";
import { Templates } from "./Templates";

/** Saves, or asks for a name where the scene has none yet. */
export function save(): void {
  const { path } = useStudio.getState().sceneState;
  if (path) void saveScene(path);
  else useStudio.setState({ dialog: "save" });
}

export function FileBar({ dark, onDark }: { dark: boolean; onDark(): void }) {
  const [shown, setShown] = useState<"open" | "templates" | null>(null);
  const dialog = useStudio((s) => s.dialog);
  const path = useStudio((s) => s.sceneState.path);
  const changed = useStudio((s) => s.sceneState.changed);
  const title = useStudio((s) => s.scene.title);
  const connected = useStudio((s) => s.connected);
  const taken = useStudio((s) => s.taken);
  const role = useStudio((s) => s.role);
  const { past, future } = useHistory();
  const close = () => setShown(null);
  const show = (d: "save" | "help" | null) => useStudio.setState({ dialog: d });
  return (
    <header className="bar" role="toolbar" aria-label="File">
      <b className="logo">Weir</b>
      <button onClick={() => void newScene()}>New</button>
      <button onClick={() => setShown("open")}>Open</button>
      <button onClick={() => setShown("templates")}>Templates</button>
      <button onClick={save} title="Ctrl+S">Save</button>
      <button onClick={() => show("save")}>Save as</button>
      <span className="gap" />
      <button onClick={undo} disabled={!past} title="Ctrl+Z" aria-label="Undo">↶</button>
      <button onClick={redo} disabled={!future} title="Ctrl+Shift+Z" aria-label="Redo">↷</button>
      <span className="title">{title ?? "Untitled"} <small>{path ? `${path}${changed ? " · changed" : ""}` : "not saved"}</small>{!taken && <small className="waits" role="status"> · not yet at the server</small>}</span>
      {!connected && <span className="lost" role="alert">no connection</span>}
      {connected && role === "viewer" && <button className="wanted" onClick={() => void request("role.claim")} title="Another window makes changes; take that over">Take the pen</button>}
      <button onClick={onDark} aria-pressed={dark} aria-label="Dark colours" title="Light or dark">{dark ? "☀" : "☾"}</button>
      <button onClick={() => show("help")} title="Keys (?)" aria-label="Help">?</button>
      {shown === "open" && <Chooser onClose={close} onChoose={(p) => (close(), void openScene({ path: p }))} />}
      {shown === "templates" && <Templates onClose={close} onChoose={(p) => (close(), void openScene({ template: p }))} />}
      {dialog === "save" && <SaveDialog path={path} onClose={() => show(null)} />}
      {dialog === "help" && <Help onClose={() => show(null)} />}
    </header>
  );
}
