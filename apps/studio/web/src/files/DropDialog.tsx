// Asks what a mesh that was dropped shall be, and tells what it is like: its size, and whether it is closed.
import { useEffect, useState } from "react";
import { kUses } from "../model/fromFile";
import { checkMesh, guessUnit, kUnits, longestSide, type MeshCheck, type Unit } from "../model/meshCheck";
import { shortText } from "../model/numbers";
import { counted } from "../model/playback";
import { useStudio } from "../model/store";
import { mainView } from "../viewport/view";
import { Dialog } from "./Dialog";
import { useMesh } from "./dropped";
import { readMesh } from "./readMesh";

/** Undefined while it is read, or why there is none. */
function useCheck(file: File): MeshCheck | string | undefined {
  const [check, setCheck] = useState<MeshCheck | string | undefined>();
  useEffect(() => {
    let gone = false;
    const found = readMesh(file).then(
      (corners) => (corners === null ? "This page does not check such a file." : corners.length === 0 ? "There are no triangles in it." : checkMesh(corners)),
      (e: Error) => `It cannot be read here: ${e.message}`,
    );
    void found.then((c) => gone || setCheck(c));
    return () => void (gone = true);
  }, [file]);
  return check;
}

function surfaceText({ open, insideOut }: MeshCheck): string {
  if (open > 0) return `open: ${counted(open, "edge")} without a triangle on each side`;
  return insideOut ? "closed, but inside out: it will be turned round" : "closed";
}

function Sheet({ check, unit, guess, onUnit }: { check: MeshCheck; unit: Unit; guess: Unit; onUnit(to: Unit): void }) {
  const size = check.high.map((h, i) => shortText(unit.size * (h - check.low[i]!))).join(" × ");
  return (
    <div className="mesh-check" aria-label="What the mesh is like">
      <p className={check.open > 0 ? "light watch" : "light good"}><i /><span>{counted(check.triangles, "triangle")}, {surfaceText(check)}</span></p>
      <p>
        <span data-size>{size} m</span>, in{" "}
        <select aria-label="Unit of the file" value={unit.name} onChange={(e) => onUnit(kUnits.find((u) => u.name === e.target.value)!)}>
          {kUnits.map((u) => <option key={u.name}>{u.name}</option>)}
        </select>
        {guess.size !== 1 && <span className="hint"> It looks like {guess.name}: in metres it would be {shortText(longestSide(check))} m long.</span>}
      </p>
    </div>
  );
}

function Question({ file, at, onClose }: { file: File; at: { x: number; y: number }; onClose(): void }) {
  const check = useCheck(file);
  const found = typeof check === "object" ? check : null;
  const guess = found ? guessUnit(longestSide(found), mainView.current?.extent().size ?? 1) : kUnits[0]!;
  const [chosen, setChosen] = useState<Unit | null>(null);
  const unit = chosen ?? guess;
  return (
    <Dialog title="What shall it be?" className="uses" onClose={onClose}>
      <h2>What shall {file.name} be?</h2>
      {found ? <Sheet check={found} unit={unit} guess={guess} onUnit={setChosen} /> : <p className="hint" role="status">{typeof check === "string" ? check : "Reading it…"}</p>}
      <ul className="files">
        {kUses.map((use, i) => (
          <li key={use.name}>
            <button data-first={i === 0 ? "" : undefined} onClick={() => (onClose(), void useMesh(file, use, at, { unit: unit.size, flip: found?.insideOut ?? false }))}><b>{use.name}</b><small>{use.doc}</small></button>
          </li>
        ))}
      </ul>
      <button onClick={onClose}>Cancel</button>
    </Dialog>
  );
}

export function DropDialog() {
  const first = useStudio((s) => s.dropped[0]);
  if (!first) return null;
  const close = () => useStudio.setState((s) => ({ dropped: s.dropped.slice(1) }));
  return <Question key={first.file.name} file={first.file} at={first.at} onClose={close} />;
}
