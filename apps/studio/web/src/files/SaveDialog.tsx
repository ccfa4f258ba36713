// Asks under which name the scene is saved.
import { useState } from "react";
import { fileNameOf, pathProblem } from "../model/names";
import { saveScene } from "../model/documents";
import { useStudio } from "../model/store";
import { keepThumbnail } from "../share/thumbnail";
import { Dialog } from "./Dialog";

export function SaveDialog({ path, onClose }: { path: string; onClose(): void }) {
  const title = useStudio((s) => s.scene.title);
  const [name, setName] = useState(path || `${fileNameOf(title)}.json`);
  const [taken, setTaken] = useState("");
  const wrong = pathProblem(name.trim());
  const take = async () => {
    const typed = name.trim();
    if (wrong) return;
    const file = typed.endsWith(".json") ? typed : `${typed}.json`;
    const how = await saveScene(file, file === taken);
    if (how === "saved") (onClose(), keepThumbnail());
    if (how === "exists") setTaken(file);
  };
  return (
    <Dialog title="Save the scene" onClose={onClose}>
      <h2>Save the scene</h2>
      <form onSubmit={(e) => (e.preventDefault(), void take())}>
        <label className="row"><span className="name">File</span>
          <input aria-label="File name" data-first aria-invalid={wrong !== null} value={name} onChange={(e) => (setName(e.target.value), setTaken(""))} onFocus={(e) => e.target.select()} />
        </label>
        {taken ? (
          <p className="lost" role="alert">There is a scene {taken} already. Another name keeps it.</p>
        ) : wrong !== null ? (
          <p className="lost" role="alert">{wrong}</p>
        ) : (
          <p className="hint">Below the served folder; folders are parted by /.</p>
        )}
        <button type="submit" className="wanted" disabled={wrong !== null}>{taken ? "Replace it" : "Save"}</button> <button type="button" onClick={onClose}>Cancel</button>
      </form>
    </Dialog>
  );
}
