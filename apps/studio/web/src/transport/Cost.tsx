// What a reset would cost, told before it is made: particles, memory, and, as the last runs here went, time.
import { useEffect, useState } from "react";
import { kNoPace, mendPace, secondsFor, type Cost as Costs } from "../model/cost";
import { durationText } from "../model/time";
import type { Scene } from "../model/scene";
import { client, useStudio } from "../model/store";
import { Refusal } from "../protocol/client";

const kPaceKey = "weir-pace";
const kRestMs = 300;

function readPaces(): { [device: string]: number } {
  try {
    return JSON.parse(localStorage.getItem(kPaceKey) ?? "{}") as { [device: string]: number };
  } catch {
    return {};
  }
}

/** Keeps how fast a device is, as each run tells at its end. */
useStudio.subscribe((now, before) => {
  const rests = now.status.state === "paused" || now.status.state === "finished";
  if (!rests || before.status.state !== "playing") return;
  const paces = readPaces(), device = now.status.device ?? "";
  localStorage.setItem(kPaceKey, JSON.stringify({ ...paces, [device]: mendPace(paces[device] ?? kNoPace, now.status) }));
});

const kMiB = 2 ** 20;
const bytesText = (b: number): string => (b < 1024 * kMiB ? `${Math.max(1, Math.round(b / kMiB))} MiB` : `${(b / 1024 / kMiB).toPrecision(3)} GiB`);
const countText = (n: number): string => (n < 1e4 ? n.toLocaleString("en") : n < 1e6 ? `${Math.round(n / 1e3)} k` : `${(n / 1e6).toPrecision(3)} M`);

/** What the server has said of a scene. */
interface Told {
  of: Scene;
  cost: Costs | null;
  /** Why it cannot be built, "" where it can. */
  refused: string;
}

const sameRun = (a: Scene, b: Scene): boolean => a.nodes === b.nodes && a.links === b.links && a.world === b.world;

export function Cost() {
  const scene = useStudio((s) => s.scene);
  const taken = useStudio((s) => s.taken && s.connected);
  const wanted = useStudio((s) => (s.sceneState.reset !== undefined || s.status.state === "empty" || (s.status.state === "paused" && s.status.frame === 0)) && s.sceneState.problem === undefined && Object.keys(s.scene.nodes).length > 0);
  const device = useStudio((s) => s.status.device ?? "");
  const coarser = useStudio((s) => s.status.coarser ?? 1);
  const [told, setTold] = useState<Told | null>(null);
  useEffect(() => {
    if (!wanted || !taken) return;
    let late = false;
    const tell = (cost: Costs | null, refused: string) => late || setTold({ of: scene, cost, refused });
    // A connection that breaks says nothing of the scene.
    const timer = setTimeout(() => client.ask<Costs>("scene.cost").then((c) => tell(c, ""), (e: unknown) => void (e instanceof Refusal && tell(null, e.message))), kRestMs);
    return () => (clearTimeout(timer), void (late = true));
  }, [wanted, coarser, taken, scene.nodes, scene.links, scene.world]);
  const cost = told?.cost;
  // What was refused was the scene as it was then.
  if (wanted && told?.refused && sameRun(told.of, scene)) return <span className="cost lost" role="status" aria-label="Cost of the run" title={told.refused}>cannot be built</span>;
  if (!wanted || !cost || cost.particles === 0) return null;
  const paces = readPaces();
  const seconds = secondsFor(cost, paces[device] ?? Object.values(paces)[0] ?? kNoPace);
  return (
    <span className={cost.fits ? "cost" : "cost lost"} role="status" aria-label="Cost of the run" title={`At most ${Math.round(cost.particles).toLocaleString("en")} particles and ${bytesText(cost.bytes)}${cost.available > 0 ? ` of ${bytesText(cost.available)}` : ""}; ${cost.at_least ? "at least " : ""}${cost.steps.toLocaleString("en")} steps${seconds === null ? "" : ". The time is that of the last runs in this browser"}`}>
      ≤ {countText(Math.round(cost.particles))} particles, {bytesText(cost.bytes)}{cost.fits ? seconds !== null && `, ~${durationText(seconds)}` : ": more than there is"}
    </span>
  );
}
