// Asks under which name the scene is saved.
import { useState } from "react";
import { saveScene } from "../model/store";
import { Dialog } from "./Dialog";

const kWrong = /^\/|(^|\/)\.\.(\/|$)|\\|\/$|^$/;

export function SaveDialog({ path, onClose }: { path: string; onClose(): void }) {
  const [name, setName] = useState(path || "scene.json");
  const wrong = kWrong.test(name.trim());
  const take = async () => {
    const file = name.trim();
    if (!wrong && (await saveScene(file.endsWith(".json") ? file : `${file}.json`))) onClose();
  };
  return (
    <Dialog title="Save the scene" onClose={onClose}>
      <h2>Save the scene</h2>
      <form onSubmit={(e) => (e.preventDefault(), void take())}>
        <label className="row"><span className="name">File</span>
          <input aria-label="File name" data-first aria-invalid={wrong} value={name} onChange={(e) => setName(e.target.value)} onFocus={(e) => e.target.select()} />
        </label>
        <p className="hint">Below the served folder; folders are parted by /.</p>
        <button type="submit" className="wanted" disabled={wrong}>Save</button> <button type="button" onClick={onClose}>Cancel</button>
      </form>
    </Dialog>
  );
}
