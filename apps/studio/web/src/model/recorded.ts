// Recorded frames of the run: looked at, gathered, kept beside the next run, and gone on from.
import type { FramePacket } from "../protocol/packets";
import { recordedFrames } from "./playback";
import { lean, strideFor, type Run } from "./runs";
import type { Scene } from "./scene";
import { askRun, client, come, last, request, say, taker, useStudio } from "./store";
import { forRunner } from "./switchedOff";

const set = useStudio.setState;
const get = useStudio.getState;

/** Shows a recorded frame, or the run where it is the present one; `stay` keeps that one from following the run. */
export async function lookAt(frame: number, stay = false): Promise<void> {
  const present = get().status.frame ?? 0;
  const to = Math.min(Math.max(Math.round(frame), 0), present);
  set({ looking: to < present || stay ? to : null });
  come.newest = Math.max(come.newest, to);
  await request("run.seek", { frame: to });
}

const kMostKept = 256 * 2 ** 20;

/** The frames of the run that are recorded, from the server, at most that many bytes: where there are more, some are left out. The run must stand still. */
export async function gatherFrames(most = kMostKept): Promise<FramePacket[]> {
  const { status, rendered } = get();
  const wanted = recordedFrames(status.frame ?? 0, status.recorded_every ?? 1);
  const found = new Map<number, FramePacket>();
  taker.gather = (packet) => void found.set(packet.frame, lean(packet));
  try {
    if (rendered) await client.ask("stream.set", { particles: true });
    await client.ask("run.seek", { frame: 0 });
    const first = found.get(0);
    const stride = first ? strideFor(first, wanted.length, most) : 1;
    const some = wanted.filter((_, i) => i % stride === 0 || i === wanted.length - 1);
    for (const [i, frame] of some.entries()) {
      await client.ask("run.seek", { frame });
      set({ gathering: { done: i + 1, all: some.length } });
    }
    return [...found.values()].sort((a, b) => a.frame - b.frame);
  } finally {
    taker.gather = null;
    set({ gathering: null });
    if (rendered) void client.ask("stream.set", { particles: false }).catch(say);
  }
}

/** The scene of the present run: as it is edited, but for what asks for a reset. */
export const sceneOfRun = (): Scene => forRunner((get().sceneState.reset && get().ran) || get().scene, get().types);

/** Where the run stands still its last numbers come soon after: waits for them, but not for ever. */
function numbersAreThere(): Promise<void> {
  const kNear = 1e-6, kPatienceMs = 3000;
  const there = () => get().status.state === "failed" || (get().samples.at(-1)?.time ?? -1) >= (get().status.time ?? 0) - kNear;
  return new Promise((resolve) => {
    if (there()) return resolve();
    const done = () => (leave(), clearTimeout(timer), resolve());
    const leave = useStudio.subscribe(() => there() && done());
    const timer = setTimeout(done, kPatienceMs);
  });
}

/** The present run, as it is kept. */
export async function gatherRun(label: string, most?: number): Promise<Run> {
  const frames = await gatherFrames(most);
  await numbersAreThere();
  return { label, scene: sceneOfRun(), geometry: last.geometry, samples: get().samples, frames };
}

/** Keeps the present run beside the ones that come, or lets it go. */
export async function pinRun(): Promise<void> {
  if (get().pinned) return set({ pinned: null });
  if (get().status.state === "playing" && !(await askRun("pause"))) return;
  try {
    set({ pinned: await gatherRun("A") });
  } catch (e) {
    say(e);
  }
}

/** Has the run go on from a recorded frame, with the scene as it is edited. */
export async function goOnFrom(frame: number): Promise<void> {
  set({ looking: null });
  if (!(await request("run.go_on", { frame }))) return void lookAt(frame);
}
