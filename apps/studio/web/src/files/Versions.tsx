// What the file of the scene held before it was saved again: looked at, and taken back.
import { useEffect, useMemo, useState } from "react";
import { sceneOfVersion, versions, type Version } from "../model/documents";
import { counted } from "../model/playback";
import { differencesOf, type Difference } from "../model/runs";
import type { Scene } from "../model/scene";
import { edit, useStudio } from "../model/store";
import { forRunner } from "../model/switchedOff";
import { ageOf } from "../model/time";
import { addressOfPicture } from "../protocol/client";
import { Dialog } from "./Dialog";

const kMost = 12;

const valueText = (v: Difference["before"]): string => (v === undefined ? "default" : typeof v === "string" ? v : JSON.stringify(v));

function Changes({ from, to }: { from: Scene; to: Scene }) {
  const all = useMemo(() => differencesOf(from, to), [from, to]);
  if (all.length === 0) return <p>It differs from the present scene in nothing that a run depends on.</p>;
  return (
    <>
      <p>Since then {counted(all.length, "thing")} changed:</p>
      <ul className="changes">
        {all.slice(0, kMost).map((d, i) => <li key={i}>{d.name} <b>{valueText(d.before)}</b> → <b>{valueText(d.after)}</b></li>)}
      </ul>
      {all.length > kMost && <p className="hint">and {all.length - kMost} more</p>}
    </>
  );
}

export function Versions({ path, onClose }: { path: string; onClose(): void }) {
  const [all, setAll] = useState<Version[] | null>(null);
  const [chosen, setChosen] = useState<Version | null>(null);
  const [scene, setScene] = useState<Scene | null>(null);
  const present = useStudio((s) => s.scene);
  const types = useStudio((s) => s.types);
  const writer = useStudio((s) => s.role === "writer");
  useEffect(() => void versions().then(setAll), []);
  useEffect(() => {
    let late = false;
    setScene(null);
    if (chosen) void sceneOfVersion(chosen.number).then((s) => late || setScene(s));
    return () => void (late = true);
  }, [chosen]);
  const takeBack = () => {
    edit(() => scene!);
    onClose();
  };
  return (
    <Dialog title="Versions" className="versions" onClose={onClose}>
      <h2>Versions of {path}</h2>
      {all?.length === 0 && <p className="hint">There are none yet: each time it is saved, what the file held before is kept.</p>}
      <div className="sides">
        <ul className="files" aria-label="Versions">
          {all?.map((v) => (
            <li key={v.number}>
              <button aria-pressed={v === chosen} onClick={() => setChosen(v)} title={new Date(1000 * v.written).toLocaleString()}>
                {v.picture ? <img src={addressOfPicture(path, v.written, v.number)} alt="" width={96} height={54} /> : <span className="blank" />}
                <span><b>Version {v.number}</b><time>{ageOf(v.written)}</time></span>
              </button>
            </li>
          ))}
        </ul>
        {chosen && (
          <section aria-label={`Version ${chosen.number}`} aria-live="polite">
            {chosen.picture && <img src={addressOfPicture(path, chosen.written, chosen.number)} alt={`What version ${chosen.number} looked like`} width={320} height={180} />}
            {scene && <><p><b>{scene.title ?? "Untitled"}</b>, {counted(Object.keys(scene.nodes).length, "node")}</p><Changes from={forRunner(scene, types)} to={forRunner(present, types)} /></>}
            <button className="wanted" disabled={!scene || !writer} onClick={takeBack} title="The scene becomes this version; undo brings the present one back, and the file stays as it is until you save">Take it back</button>
          </section>
        )}
      </div>
      <button data-first onClick={onClose}>Close</button>
    </Dialog>
  );
}
