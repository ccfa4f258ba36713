// All state of the page: the scene with its history, what the server says of it, the run, and what is selected.
import { temporal } from "zundo";
import { create, useStore } from "zustand";
import { Client, fetchTypes, Refusal } from "../protocol/client";
import type { FramePacket, GeometryPacket, PicturePacket } from "../protocol/packets";
import { placeAll } from "../graph/arrange";
import { emptyScene, type Clip, type Scene } from "./scene";
import { forRunner, fromFile } from "./switchedOff";
import type { JsonObject, Problem, Types } from "./types";

export interface Status {
  state: "empty" | "building" | "paused" | "playing" | "finished" | "failed";
  device?: string;
  frame?: number;
  frames?: number;
  time?: number;
  duration?: number;
  steps?: number;
  particles?: number;
  stepping_seconds?: number;
  /** 0 to 1 */
  device_busy?: number;
  problem?: Problem;
}

export interface Device {
  name: string;
  description: string;
}

/** A video that is recorded on the server. */
export interface Video {
  state: "none" | "recording" | "finishing" | "done" | "failed";
  path: string;
  frames: number;
  problem?: Problem;
}

export interface LogLine {
  level: "debug" | "info" | "warning" | "error";
  text: string;
  at: number;
}

/** Some numbers of a run over simulated time, for plots. */
export interface Sample {
  time: number;
  values: { [name: string]: number };
}

interface SceneState {
  path: string;
  revision?: number;
  /** Whether it differs from its file. */
  changed?: boolean;
  problem?: Problem;
  warnings: string[];
  reset?: string;
}

export interface Studio {
  // The document; history covers this part alone.
  scene: Scene;

  types: Types | null;
  connected: boolean;
  role: "writer" | "viewer";
  devices: Device[];
  device: string;
  version: string;
  sceneState: SceneState;
  /** How many scenes were opened: those who look begin anew with each. */
  opened: number;
  /** How often something was undone, or done again. */
  undone: number;
  status: Status;
  /** Whether the server can draw pictures, and which videos it can write. */
  pictures: { problem?: Problem; videos: string[] };
  video: Video;
  numbers: JsonObject | null;
  samples: Sample[];
  log: LogLine[];
  selected: string[];
  selectedLinks: string[];
  /** The node whose modules are shown. */
  inside: string | null;
  clip: Clip | null;
  attribute: string;
  attributes: string[];
  /** The nodes whose particles frames show. */
  fluids: string[];
  /** The particle that was clicked. */
  picked: { node: string; id: number } | null;
  message: string | null;
  /** What is asked or shown above the page. */
  dialog: "save" | "help" | null;
}

const kMostSamples = 4000;
const kMostLines = 1000;

export const useStudio = create<Studio>()(
  temporal(
    (): Studio => ({
      scene: emptyScene(),
      types: null,
      connected: false,
      role: "viewer",
      devices: [],
      device: "auto",
      version: "",
      sceneState: { path: "", warnings: [] },
      opened: 0,
      undone: 0,
      status: { state: "empty" },
      pictures: { videos: [] },
      video: { state: "none", path: "", frames: 0 },
      numbers: null,
      samples: [],
      log: [],
      selected: [],
      selectedLinks: [],
      inside: null,
      clip: null,
      attribute: "speed",
      attributes: ["speed"],
      fluids: [],
      picked: null,
      message: null,
      dialog: null,
    }),
    { partialize: ({ scene }) => ({ scene }), equality: (a, b) => a.scene === b.scene },
  ),
);

/** What is wrong: with the scene, or else with the run that failed. */
export const problemOf = (s: Studio): Problem | undefined =>
  s.sceneState.problem ?? (s.status.state === "failed" ? s.status.problem : undefined);

const set = useStudio.setState;
const get = useStudio.getState;

/** What draws frames and meshes; the viewport puts itself here. */
export const viewers = {
  frame: (_: FramePacket): void => {},
  geometry: (_: GeometryPacket): void => {},
  picture: (_: PicturePacket): void => {},
};
/** Kept for a viewport that appears later. */
export const last: { frame: FramePacket | null; geometry: GeometryPacket | null } = { frame: null, geometry: null };

export const client = new Client({
  connected: (on) => {
    set({ connected: on });
    if (on) void greet();
  },
  event: receive,
  frame: (packet) => {
    last.frame = packet;
    const names = [...new Set(packet.fluids.flatMap((f) => f.attributes))];
    if (names.length > 0 && names.join() !== get().attributes.join()) set({ attributes: names });
    const fluids = packet.fluids.map((f) => f.node);
    if (fluids.join() !== get().fluids.join()) set({ fluids });
    viewers.frame(packet);
    client.frameSeen();
  },
  geometry: (packet) => {
    last.geometry = packet;
    set({ samples: [] });
    viewers.geometry(packet);
  },
  picture: (packet) => viewers.picture(packet),
});

export function say(error: unknown): void {
  set({ message: error instanceof Error ? error.message : String(error) });
}

/** Asks the server, and shows what it refuses. */
export async function request<T = JsonObject>(what: string, fields: object = {}): Promise<T | null> {
  try {
    return await client.ask<T>(what, fields);
  } catch (e) {
    if (e instanceof Refusal && e.problem.node) set({ selected: [e.problem.node] });
    say(e);
    return null;
  }
}

/** A scene as the server has it; `draft` is what was made of its file and not saved, in an earlier run. */
type ServedScene = SceneState & { scene: Scene; draft?: Scene };

interface Hello extends Pick<Studio, "role" | "devices" | "device" | "version" | "status" | "pictures" | "video"> {
  scene: ServedScene;
}

/** Another scene is there, and nothing of the one before. */
const opened = () => ({ opened: get().opened + 1, numbers: null, samples: [], picked: null });

/** Shows what the server has; that is no edit. */
function take(scene: Scene, more: Partial<Studio>, sceneState: SceneState): void {
  applying = true;
  set({ ...more, scene: placeAll(fromFile(scene), get().types), sceneState });
  applying = false;
  useStudio.temporal.getState().clear();
}

/** Asks whether changes are wanted that an earlier run of the server had and that nobody saved. */
async function offer(draft: Scene | undefined): Promise<void> {
  if (!draft) return;
  if (confirm("There are changes to this scene that were not saved. Take them up again?"))
    edit(() => placeAll(fromFile(draft), get().types));
  else await request("draft.drop");
}

async function greet(): Promise<void> {
  try {
    if (!get().types) set({ types: await fetchTypes() });
    const { scene: served, ...hello } = await client.ask<Hello>("hello");
    const { scene, draft, ...sceneState } = served;
    // What was edited while there was no connection is kept where nobody else has made changes meanwhile.
    const keep = unsent && hello.role === "writer" && sceneState.revision === get().sceneState.revision;
    unsent = false;
    if (keep) {
      set({ ...hello, sceneState });
      return void send();
    }
    const another = sceneState.path !== get().sceneState.path;
    take(scene, { ...hello, ...(another && opened()) }, sceneState);
    if (hello.role === "writer") await offer(draft);
  } catch (e) {
    say(e);
  }
}

function receive(name: string, data: unknown): void {
  if (name === "status") set({ status: data as Status });
  if (name === "video") set({ video: data as Video });
  if (name === "role") set({ role: data as Studio["role"] });
  if (name === "numbers") takeNumbers(data as JsonObject);
  if (name === "log") {
    const line = { ...(data as Omit<LogLine, "at">), at: Date.now() };
    set({ log: [...get().log, line].slice(-kMostLines) });
  }
  if (name === "scene") {
    const { scene, draft: _, ...sceneState } = data as ServedScene;
    applying = true;
    const another = sceneState.path !== get().sceneState.path;
    set({ scene: fromFile(scene), sceneState, ...(another && opened()) });
    applying = false;
  }
}

function takeNumbers(numbers: JsonObject): void {
  const values: { [name: string]: number } = {};
  const collect = (prefix: string, v: unknown) => {
    if (typeof v === "number") values[prefix] = v;
    else if (v && typeof v === "object" && !Array.isArray(v))
      for (const [k, inner] of Object.entries(v)) collect(prefix ? `${prefix}.${k}` : k, inner);
    else if (Array.isArray(v) && v.length === 3 && v.every((x) => typeof x === "number"))
      values[prefix] = Math.hypot(...(v as number[]));
  };
  for (const [node, report] of Object.entries((numbers["nodes"] as JsonObject) ?? {})) collect(node, report);
  const stepMs = (numbers["step_ms"] as JsonObject | undefined)?.["median"];
  if (typeof stepMs === "number") values["step (ms)"] = stepMs;
  if (typeof numbers["particles"] === "number") values["particles"] = numbers["particles"];
  const time = Number(numbers["simulated_seconds"] ?? 0);
  const samples = get().samples.filter((s) => s.time < time);
  set({ numbers, samples: [...samples, { time, values }].slice(-kMostSamples) });
}

// Editing. Each change goes to the server at once, which answers with what is wrong.

let applying = false;
let sending: Promise<void> | null = null;
let again = false;
/** Something was edited while there was no connection. */
let unsent = false;

const kTogetherMs = 600;
let lastPart: { name: string; at: number; press: number } | null = null;
/** Counts how often a button of the pointer went down, and tells whether one is. */
const pointer = { press: 0, down: false };
addEventListener("pointerdown", () => (++pointer.press, (pointer.down = true)), true);
for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => (pointer.down = false), true);

/** Changes the scene; one undo step. Changes of the same part that follow each other quickly, or in one drag, are one step. */
export function edit(change: (scene: Scene) => Scene, part?: string): void {
  if (get().role !== "writer") return say(new Error("another window has the pen: take it to make changes here"));
  const next = change(get().scene);
  if (next === get().scene) return;
  const history = useStudio.temporal.getState();
  const now = performance.now();
  const sameDrag = pointer.down && lastPart?.press === pointer.press;
  const together = part !== undefined && lastPart?.name === part && (sameDrag || now - lastPart.at < kTogetherMs);
  lastPart = part === undefined ? null : { name: part, at: now, press: pointer.press };
  if (together) history.pause();
  set({ scene: next });
  if (together) history.resume();
}

/** What is gone, as by an undo, is not selected. */
useStudio.subscribe((now, before) => {
  if (now.scene === before.scene) return;
  const there = (id: string) => id in now.scene.nodes || now.scene.layout?.notes?.some((n) => n.id === id);
  const links = new Set(now.scene.links);
  if (!now.selected.every(there)) set({ selected: now.selected.filter(there) });
  if (!now.selectedLinks.every((l) => links.has(l))) set({ selectedLinks: now.selectedLinks.filter((l) => links.has(l)) });
});

useStudio.subscribe((now, before) => {
  if (now.scene === before.scene || applying) return;
  if (!now.connected) unsent = true;
  else if (now.role === "writer") void send();
});

/** Sends the scene as it is; resolves when the server has judged it. */
function send(): Promise<void> {
  again = true;
  return (sending ??= sendAll().finally(() => (sending = null)));
}

async function sendAll(): Promise<void> {
  while (again) await sendNow();
}

async function sendNow(): Promise<void> {
  again = false;
  const state = await request<SceneState>("scene.set", { scene: forRunner(get().scene, get().types) });
  if (state) set({ sceneState: state });
}

/** Asks for something of the run, of the scene as it is edited: an edit that waits for the answer to an earlier one goes first. */
export function askRun<T = JsonObject>(what: "play" | "pause" | "step" | "reset", fields: object = {}): Promise<T | null> {
  if (again) void sendNow();
  return request<T>(`run.${what}`, fields);
}

const step = (which: "undo" | "redo") => () => {
  lastPart = null;
  useStudio.temporal.getState()[which]();
  set({ undone: get().undone + 1 });
};
export const undo = step("undo");
export const redo = step("redo");

/** Whether there is something to undo, and to redo. */
export const useHistory = (): { past: boolean; future: boolean } => ({
  past: useStore(useStudio.temporal, (h) => h.pastStates.length > 0),
  future: useStore(useStudio.temporal, (h) => h.futureStates.length > 0),
});

/** Opens a scene of the served folder or a template. */
export async function openScene(where: { path: string } | { template: string }): Promise<void> {
  const state = await request<ServedScene>("scene.open", where);
  if (!state) return;
  const { scene, draft, ...sceneState } = state;
  take(scene, { selected: [], inside: null, ...opened() }, sceneState);
  await offer(draft);
  await sending;
  await resetRun();
}

/** Builds the scene again, at time 0, on a device; without one on that of before. */
export async function resetRun(device?: string): Promise<void> {
  const state = await askRun<SceneState & { device: string }>("reset", device === undefined ? {} : { device });
  if (!state) return;
  const { device: _, ...sceneState } = state;
  set({ sceneState });
}

export async function saveScene(path: string): Promise<boolean> {
  // What is being typed counts, and what is on its way.
  const field = document.activeElement as HTMLElement | null;
  field?.blur();
  field?.focus();
  await sending;
  const sceneState = await request<SceneState>("scene.save", { path });
  if (sceneState) set({ sceneState });
  return sceneState !== null;
}

export async function newScene(): Promise<void> {
  const sceneState = await request<SceneState>("scene.new");
  if (!sceneState) return;
  set({ sceneState, selected: [], inside: null, ...opened() });
  edit(() => emptyScene());
}
