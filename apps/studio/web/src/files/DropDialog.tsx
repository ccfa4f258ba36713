// Asks what a mesh that was dropped shall be.
import { kUses } from "../model/fromFile";
import { useStudio } from "../model/store";
import { Dialog } from "./Dialog";
import { useMesh } from "./dropped";

export function DropDialog() {
  const first = useStudio((s) => s.dropped[0]);
  if (!first) return null;
  const close = () => useStudio.setState((s) => ({ dropped: s.dropped.slice(1) }));
  return (
    <Dialog key={first.file.name} title="What shall it be?" className="uses" onClose={close}>
      <h2>What shall {first.file.name} be?</h2>
      <ul className="files">
        {kUses.map((use, i) => (
          <li key={use.name}>
            <button data-first={i === 0 ? "" : undefined} onClick={() => (close(), void useMesh(first.file, use, first.at))}><b>{use.name}</b><small>{use.doc}</small></button>
          </li>
        ))}
      </ul>
      <button onClick={close}>Cancel</button>
    </Dialog>
  );
}
