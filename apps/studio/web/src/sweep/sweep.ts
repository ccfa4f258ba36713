// Runs the scene with several values of one parameter, one after another.
import { setParam, type Owner, type Scene } from "../model/scene";
import { gatherRun } from "../model/recorded";
import { client, useStudio, type Status } from "../model/store";
import { valueName, type Tried } from "../model/sweep";
import { forRunner } from "../model/switchedOff";
import type { Run } from "../model/runs";
import type { Json } from "../model/types";

/** Waits until the state of the run is one of which f is true. */
function until(f: (s: Status, builds: number) => boolean, stop: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const look = () => {
      const { status, builds } = useStudio.getState();
      if (stop.aborted) return (leave(), reject(new Error("it was stopped")));
      if (f(status, builds)) (leave(), resolve());
    };
    const left = useStudio.subscribe(look);
    stop.addEventListener("abort", look);
    const leave = () => (left(), stop.removeEventListener("abort", look));
    look();
  });
}

const kMostBytes = 192 * 2 ** 20;

/** Runs a scene that is not the edited one, to its end, and keeps what came of it. */
async function tryScene(scene: Scene, label: string, most: number, stop: AbortSignal): Promise<Run> {
  const { builds, types } = useStudio.getState();
  await client.ask("run.reset", { scene: forRunner(scene, types) });
  await until((s, b) => b > builds && (s.state === "failed" || (s.state === "paused" && s.frame === 0)), stop);
  const failed = () => useStudio.getState().status.problem?.message;
  if (useStudio.getState().status.state === "failed") throw new Error(failed());
  await client.ask("run.play");
  await until((s) => s.state === "failed" || s.state === "finished", stop);
  const run = { ...(await gatherRun(label, most)), scene: forRunner(scene, types) };
  if (useStudio.getState().status.state === "failed") throw new Error(failed());
  return run;
}

/** Tries the values one after another; tells of each what it came to. Who asked resets the run at the end. */
export async function sweep(values: Json[], owner: Owner, path: string[], tell: (i: number, tried: Tried) => void, stop: AbortSignal): Promise<void> {
  const { scene } = useStudio.getState();
  useStudio.setState({ looking: null });
  for (const [i, value] of values.entries()) {
    if (stop.aborted) break;
    try {
      tell(i, { value, run: await tryScene(setParam(scene, owner, path, value), valueName(value), kMostBytes / values.length, stop) });
    } catch (e) {
      if (!stop.aborted) tell(i, { value, run: null, problem: (e as Error).message });
    }
  }
  await client.ask("run.pause").catch(() => {});
}
