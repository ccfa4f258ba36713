// Scenes as files: opened, saved, begun anew, their versions, and the history, which goes on from one scene to the next.
import { useStore } from "zustand";
import { placeAll } from "../graph/arrange";
import { Refusal } from "../protocol/client";
import { emptyScene, type Scene } from "./scene";
import {
  client, edit, endPart, judged, offerDraft, opened, request, resetRun, say, take, useStudio, type SceneState, type ServedScene,
} from "./store";
import { fromFile } from "./switchedOff";

const set = useStudio.setState;
const get = useStudio.getState;

/** Takes the server to the file that a scene of the history belongs to; where that is gone, the scene has none any more. */
async function goTo(file: { path: string }): Promise<boolean> {
  const state = file.path ? await request<ServedScene>("scene.open", { path: file.path }) : null;
  if (state) {
    const { scene: _, draft: _d, draft_written: _w, pictured: _p, ...sceneState } = state;
    set({ sceneState });
    return true;
  }
  file.path = "";
  const sceneState = await request<SceneState>("scene.new");
  if (sceneState) set({ sceneState });
  return sceneState !== null;
}

async function stepNow(which: "undo" | "redo"): Promise<void> {
  const history = useStudio.temporal.getState();
  const next = (which === "undo" ? history.pastStates : history.futureStates).at(-1);
  if (!next) return;
  endPart();
  if (get().role !== "writer") return say(new Error("another window has the pen: take it to make changes here"));
  const other = next.file && next.file !== get().file;
  if (other && !(await goTo(next.file!))) return;
  history[which]();
  set({ undone: get().undone + 1 });
  if (!other) return;
  set({ selected: [], unfolded: [], offer: null, ...opened() });
  await judged();
  await resetRun();
}

/** One after another: a step to another scene waits for the server. */
let steps = Promise.resolve();
const step = (which: "undo" | "redo") => (): Promise<void> => (steps = steps.then(() => stepNow(which)).catch(say));
export const undo = step("undo");
export const redo = step("redo");

/** Whether there is something to undo, and to redo. */
export const useHistory = (): { past: boolean; future: boolean } => ({
  past: useStore(useStudio.temporal, (h) => h.pastStates.length > 0),
  future: useStore(useStudio.temporal, (h) => h.futureStates.length > 0),
});

/** Opens a scene of the served folder or a template. What was edited before can be undone to. */
export async function openScene(where: { path: string } | { template: string }): Promise<void> {
  await judged();
  const state = await request<ServedScene>("scene.open", where);
  if (!state) return;
  const { scene, draft, draft_written, pictured, ...sceneState } = state;
  endPart();
  take(scene, { selected: [], unfolded: [], file: { path: sceneState.path }, ...opened() }, sceneState, Object.keys(get().scene.nodes).length > 0);
  offerDraft({ draft, draft_written, pictured });
  // Not the button that asked for it, which Space would press again.
  document.querySelector<HTMLElement>(".graph")?.focus({ preventScroll: true });
  await resetRun();
}

/** Writes the scene to a file; one of another scene is replaced only with `overwrite`. */
export async function saveScene(path: string, overwrite = false): Promise<"saved" | "exists" | "failed"> {
  // What is being typed counts, and what is on its way.
  const field = document.activeElement as HTMLElement | null;
  field?.blur();
  field?.focus();
  await judged();
  try {
    set({ sceneState: await client.askSoon<SceneState>("scene.save", { path, ...(overwrite && { overwrite }) }) });
    // What can be undone is of the same scene, which has this file now.
    get().file.path = path;
    return "saved";
  } catch (e) {
    if (e instanceof Refusal && e.problem.exists) return "exists";
    say(e);
    return "failed";
  }
}

export async function newScene(): Promise<void> {
  await judged();
  const sceneState = await request<SceneState>("scene.new");
  if (!sceneState) return;
  set({ sceneState, selected: [], unfolded: [], ...opened() });
  edit(() => emptyScene(), undefined, { file: { path: "" } });
}

/** What the file of the scene held before it was saved again. */
export interface Version {
  number: number;
  /** Seconds since 1970. */
  written: number;
  picture: boolean;
}

export const versions = async (): Promise<Version[]> => (await request<{ versions: Version[] }>("scene.versions"))?.versions ?? [];

export async function sceneOfVersion(number: number): Promise<Scene | null> {
  const answer = await request<{ scene: Scene }>("scene.version", { number });
  return answer && placeAll(fromFile(answer.scene), get().types);
}
