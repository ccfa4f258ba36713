// New, open, save, templates, and the help sheet.
import { Icon } from "../Icon";
import { newScene, openScene, redo, saveScene, undo, useHistory } from "../model/documents";
import { request, useStudio, type Studio } from "../model/store";
import { Chooser } from "./Chooser";
import { Help } from "./Help";
import { Palette } from "./Palette";
import { SaveDialog } from "./SaveDialog";
import { Versions } from "./Versions";
import { keepThumbnail } from "../share/thumbnail";
import { Templates } from "./Templates";

/** Saves, or asks for a name where the scene has none yet. */
export function save(): void {
  const { path } = useStudio.getState().sceneState;
  if (path) void saveScene(path).then(keepThumbnail);
  else useStudio.setState({ dialog: "save" });
}

export function FileBar({ dark, onDark }: { dark: boolean; onDark(): void }) {
  const dialog = useStudio((s) => s.dialog);
  const path = useStudio((s) => s.sceneState.path);
  const changed = useStudio((s) => s.sceneState.changed);
  const title = useStudio((s) => s.scene.title);
  const connected = useStudio((s) => s.connected);
  const taken = useStudio((s) => s.taken);
  const role = useStudio((s) => s.role);
  const { past, future } = useHistory();
  const show = (d: Studio["dialog"]) => useStudio.setState({ dialog: d });
  const close = () => show(null);
  return (
    <header className="bar" role="toolbar" aria-label="File">
      <b className="logo">Weir</b>
      <button onClick={() => void newScene()}>New</button>
      <button onClick={() => show("open")}>Open</button>
      <button onClick={() => show("templates")}>Templates</button>
      <button onClick={save} title="Ctrl+S">Save</button>
      <button onClick={() => show("save")}>Save as</button>
      <button onClick={() => show("versions")} disabled={!path} title="What the file held before it was saved again">Versions</button>
      <span className="gap" />
      <button onClick={() => void undo()} disabled={!past} title="Ctrl+Z" aria-label="Undo"><Icon name="undo" /></button>
      <button onClick={() => void redo()} disabled={!future} title="Ctrl+Shift+Z" aria-label="Redo"><Icon name="redo" /></button>
      <span className="title">{title ?? "Untitled"} <small>{path ? `${path}${changed ? " · changed" : ""}` : "not saved"}</small>{!taken && <small className="waits" role="status"> · not yet at the server</small>}</span>
      {!connected && <span className="lost" role="alert">no connection</span>}
      {connected && role === "viewer" && <button className="wanted" onClick={() => void request("role.claim")} title="Another window makes changes; take that over">Take the pen</button>}
      <button onClick={onDark} aria-pressed={dark} aria-label="Dark colours" title="Light or dark"><Icon name={dark ? "sun" : "moon"} /></button>
      <button onClick={() => show("find")} title="Find anything (Ctrl+K)" aria-label="Find"><Icon name="find" /></button>
      <button onClick={() => show("help")} title="Keys (?)" aria-label="Help">?</button>
      {dialog === "open" && <Chooser onClose={close} onChoose={(p) => (close(), void openScene({ path: p }))} />}
      {dialog === "templates" && <Templates onClose={close} onChoose={(p) => (close(), void openScene({ template: p }))} />}
      {dialog === "save" && <SaveDialog path={path} onClose={() => show(null)} />}
      {dialog === "versions" && <Versions path={path} onClose={close} />}
      {dialog === "find" && <Palette onClose={close} onDark={onDark} />}
      {dialog === "help" && <Help onClose={() => show(null)} />}
    </header>
  );
}
