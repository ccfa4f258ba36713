// What is built, for how long, and the way out of it.
import { useEffect, useState } from "react";
import { request, useStudio } from "../model/store";

const kSecond = 1000;

export function Building() {
  const node = useStudio((s) => s.status.building?.node);
  const done = useStudio((s) => s.status.building?.done ?? 0);
  const all = useStudio((s) => s.status.building?.all ?? 0);
  const built = useStudio((s) => s.built);
  const writer = useStudio((s) => s.role === "writer");
  const [now, setNow] = useState(Date.now);
  useEffect(() => {
    const timer = setInterval(() => setNow(Date.now()), kSecond);
    return () => clearInterval(timer);
  }, []);
  const seconds = Math.max(0, Math.floor((now - built) / kSecond));
  return (
    <div className="building" role="status">
      <p>Building the scene{seconds > 0 && `, ${seconds} s`}</p>
      <progress value={done} max={Math.max(all, 1)} aria-label="Nodes that are set up" />
      <p className="hint">{node === undefined ? "…" : <>{node}, {done + 1} of {all}</>}</p>
      <button disabled={!writer} onClick={() => void request("run.cancel")}>Cancel</button>
    </div>
  );
}
