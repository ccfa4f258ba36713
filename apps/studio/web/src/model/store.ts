// All state of the page: the scene with its history, what the server says of it, the run, and what is selected.
import { temporal } from "zundo";
import { create } from "zustand";
import { Client, fetchTypes, isKnown, Refusal } from "../protocol/client";
import type { FramePacket, GeometryPacket, PicturePacket } from "../protocol/packets";
import { placeAll } from "../graph/arrange";
import { emptyScene, type Clip, type Owner, type Scene } from "./scene";
import { samplesOf, type History, type Run, type Sample } from "./runs";
import { forRunner, fromFile } from "./switchedOff";
import type { JsonObject, Parameter, Problem, Types } from "./types";

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
  /** Which node is set up while the scene is built, how many were before, and how many there are. */
  building?: { node: string; done: number; all: number };
  /** While the scene is built: whether it plays then. */
  plays?: boolean;
  /** Of the frames of the run, 0, this and its multiples can be looked at again. */
  recorded_every?: number;
  /** How many frames of the run are kept whole, with the present one: they can be drawn again. */
  whole?: number;
  /** How many times as coarse as the scene the run is: above 1 it is a preview. */
  coarser?: number;
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
  /** Of recorded frames: how many there will be, and how many of these are kept whole. */
  of?: number;
  whole?: number;
  problem?: Problem;
}

export interface LogLine {
  level: "debug" | "info" | "warning" | "error";
  text: string;
  at: number;
}

export interface SceneState {
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
  /** Which scene it is, and its file, "" where it has none: another object for each one that is opened or begun. */
  file: { path: string };

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
  /** The nodes whose modules are unfolded in the graph. */
  unfolded: string[];
  /** The module of the selected node whose values are shown. */
  module: string | null;
  /** A module is chosen, to come behind one of a node; and where on the page that was asked. */
  inserting: { node: string; after: string; x: number; y: number } | null;
  clip: Clip | null;
  attribute: string;
  attributes: string[];
  /** The nodes whose particles frames show. */
  fluids: string[];
  /** The particle that was clicked. */
  picked: { node: string; id: number } | null;
  /** The one before it, where both were wanted: their distance is told. */
  pickedBefore: { node: string; id: number } | null;
  message: string | null;
  /** Whether the server has the scene as it is edited here. */
  taken: boolean;
  /** Tells one run of the server from the next. */
  server: string;
  /** Changes that nobody has decided about: of an earlier run of the server, or of this window. */
  offer: Offered | null;
  /** What was built or run when that failed. */
  failed: Scene | null;
  /** There is a server, but it does not know this window: it was started again. */
  strange: boolean;
  /** What is asked or shown above the page. */
  dialog: "save" | "open" | "versions" | "templates" | "help" | "find" | null;
  /** The frame that the view shows. */
  shown: { frame: number; time: number } | null;
  /** A recorded frame that is looked at; else the view follows the run. */
  looking: number | null;
  /** When the run was begun to be built, in ms: what the log said before is of another one. */
  built: number;
  /** How many runs were begun to be built, or to go on from a frame. */
  builds: number;
  /** The scene as it was when that began. */
  ran: Scene | null;
  /** A run that is looked at beside the present one. */
  pinned: Run | null;
  /** How far it is that frames are gathered, of how many; null while none are. */
  gathering: { done: number; all: number } | null;
  /** Whether the server draws what is seen. */
  rendered: boolean;
  /** The type whose reference is shown. */
  reference: string | null;
  /** The parameter whose values are to be tried one after another. */
  sweeping: Sweepable | null;
  /** Meshes that were dropped, and where; each is asked about. */
  dropped: { file: File; at: { x: number; y: number } }[];
  /** What the panel of properties shall show and give the keyboard to. */
  wanted: Wanted | null;
}

/** A parameter, and where it is. */
export interface Sweepable {
  owner: Owner;
  path: string[];
  parameter: Parameter;
}

/** A module, or a parameter of the node that is selected, of its module, or of the scene where none is. */
export interface Wanted {
  module?: string | undefined;
  path?: string[];
}

interface Offered {
  scene: Scene;
  from: "draft" | "window";
  /** Seconds since 1970, as when its picture was made. */
  written?: number | undefined;
  picture?: number | undefined;
}

const kMaxSamples = 4000;
const kMaxLines = 1000;

export const useStudio = create<Studio>()(
  temporal(
    (): Studio => ({
      scene: emptyScene(),
      file: { path: "" },
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
      unfolded: [],
      module: null,
      inserting: null,
      clip: null,
      attribute: "speed",
      attributes: ["speed"],
      fluids: [],
      picked: null,
      pickedBefore: null,
      message: null,
      taken: true,
      server: "",
      offer: null,
      failed: null,
      strange: false,
      dialog: null,
      shown: null,
      looking: null,
      wanted: null,
      dropped: [],
      built: 0,
      builds: 0,
      ran: null,
      pinned: null,
      gathering: null,
      rendered: false,
      reference: null,
      sweeping: null,
    }),
    { partialize: ({ scene, file }) => ({ scene, file }), equality: (a, b) => a.scene === b.scene },
  ),
);

/** Whether two scenes differ in more than their layout. */
const differ = (a: Scene, b: Scene | null): boolean => a.nodes !== b?.nodes || a.links !== b.links || a.world !== b.world;

/** What is wrong: with the scene, or else with the run that failed, until the scene is another one. */
export const problemOf = (s: Studio): Problem | undefined =>
  s.sceneState.problem ?? (s.status.state === "failed" && !differ(s.scene, s.failed) ? s.status.problem : undefined);

const set = useStudio.setState;
const get = useStudio.getState;

/** What draws frames and meshes; the viewport puts itself here. */
export const viewers = {
  frame: (_: FramePacket): void => {},
  geometry: (_: GeometryPacket): void => {},
  picture: (_: PicturePacket): void => {},
  clear: (): void => {},
};
/** Kept for a viewport that appears later. */
export const last: { frame: FramePacket | null; geometry: GeometryPacket | null } = { frame: null, geometry: null };

export const client = new Client({
  connected: (on) => {
    set({ connected: on, ...(on && { strange: false }) });
    if (on) void greet();
    else void isKnown().then((known) => set({ strange: !known && !get().connected }), () => {});
  },
  event: receive,
  frame: (packet) => {
    if (taker.gather) {
      taker.gather(packet);
      return client.frameSeen();
    }
    if (!isWanted(packet.frame)) return client.frameSeen();
    last.frame = packet;
    set({ shown: { frame: packet.frame, time: packet.time } });
    const names = [...new Set(packet.fluids.flatMap((f) => f.attributes))];
    if (names.length > 0 && names.join() !== get().attributes.join()) set({ attributes: names });
    const fluids = packet.fluids.map((f) => f.node);
    if (fluids.join() !== get().fluids.join()) set({ fluids });
    viewers.frame(packet);
    client.frameSeen();
  },
  geometry: (packet) => {
    last.geometry = packet;
    forgetFrames();
    set({ samples: [] });
    viewers.geometry(packet);
  },
  picture: (packet) => viewers.picture(packet),
});

/** What takes the frames that come, in place of the view. */
export const taker: { gather: ((packet: FramePacket) => void) | null } = { gather: null };

/** The newest frame of the run that has come. */
export const come = { newest: -1 };

/** While recorded frames are looked at, what the run goes on to is not shown. */
function isWanted(frame: number): boolean {
  const isNew = frame > come.newest;
  if (isNew) come.newest = frame;
  return get().looking === null || !isNew;
}

/** Another run begins. */
function forgetFrames(): void {
  come.newest = -1;
  set({ shown: null, looking: null });
}

export function say(error: unknown): void {
  set({ message: error instanceof Error ? error.message : String(error) });
}

/** Asks the server, and shows what it refuses. */
export async function request<T = JsonObject>(what: string, fields: object = {}): Promise<T | null> {
  try {
    return await client.askAloud<T>(what, fields, say);
  } catch (e) {
    if (e instanceof Refusal && e.problem.node) set({ selected: [e.problem.node] });
    say(e);
    return null;
  }
}

/** A scene as the server has it; `draft` is what was made of its file and not saved, in an earlier run. */
export type ServedScene = SceneState & { scene: Scene; draft?: Scene; draft_written?: number; pictured?: number };

interface Hello extends Pick<Studio, "server" | "role" | "devices" | "device" | "version" | "status" | "pictures" | "video"> {
  scene: ServedScene;
  history: History;
  numbers: JsonObject | null;
}

/** Another scene is there, and nothing of the one before. */
export const opened = () => ({ opened: get().opened + 1, numbers: null, samples: [], picked: null });

/** Shows what the server has; that is not an edit. */
export function take(scene: Scene, more: Partial<Studio>, sceneState: SceneState, keepHistory = false): void {
  applying = true;
  set({ ...more, scene: placeAll(fromFile(scene), get().types), sceneState, taken: true });
  applying = false;
  if (!keepHistory) useStudio.temporal.getState().clear();
}

/** Offers what an earlier run of the server was left with. */
export function offerDraft({ draft, draft_written, pictured }: Omit<ServedScene, keyof SceneState | "scene">): void {
  if (draft) set({ offer: { scene: fromFile(draft), from: "draft", written: draft_written, picture: pictured } });
}

/** Takes up what is offered, keeps it for later, or drops it for good. */
export function answerOffer(answer: "restore" | "later" | "delete"): void {
  const { offer } = get();
  set({ offer: null });
  if (!offer) return;
  if (answer === "restore") void restore(offer.scene);
  else if (answer === "delete") void (offer.from === "draft" ? request("draft.drop") : forgetUnsent());
}

async function restore(scene: Scene): Promise<void> {
  if (get().role !== "writer" && !(await request("role.claim"))) return;
  set({ role: "writer" });
  edit(() => placeAll(scene, get().types));
  await sending;
  if (get().status.state !== "empty") await resetRun();
}

/** Of this window, at this address: outlives it until the server has it. */
const kUnsentKey = "weir-unsent";

function keepUnsent(what: Omit<Offered, "from">): void {
  try {
    localStorage.setItem(kUnsentKey, JSON.stringify(what));
  } catch {
    // There is no room for it: the window itself still has it.
  }
}

function forgetUnsent(): void {
  localStorage.removeItem(kUnsentKey);
}

function readUnsent(): Omit<Offered, "from"> | null {
  try {
    return JSON.parse(localStorage.getItem(kUnsentKey) ?? "null") as Omit<Offered, "from"> | null;
  } catch {
    return null;
  }
}

const sameScene = (a: Scene, b: Scene): boolean => JSON.stringify(forRunner(a, get().types)) === JSON.stringify(forRunner(b, get().types));

async function greet(): Promise<void> {
  try {
    if (!get().types) set({ types: await fetchTypes() });
    const { scene: served, history, numbers, ...hello } = await client.ask<Hello>("hello");
    const told = { numbers, samples: samplesOf(history) };
    const { scene, draft, draft_written, pictured, ...sceneState } = served;
    const before = get();
    const restarted = before.server !== "" && before.server !== hello.server;
    // What was edited while there was no connection is kept where nobody else has made changes meanwhile.
    const keep = unsent && !restarted && hello.role === "writer" && sceneState.revision === before.sceneState.revision;
    const lost = !keep && (unsent || restarted) && Object.keys(before.scene.nodes).length > 0 ? before.scene : null;
    unsent = false;
    if (keep) {
      set({ ...hello, ...told, sceneState });
      return void send();
    }
    const another = restarted || sceneState.path !== before.sceneState.path;
    const file = another || lost ? { path: sceneState.path } : before.file;
    take(scene, { ...hello, file, ...(another && opened()), ...told }, sceneState, lost !== null);
    if (hello.status.state === "failed") set({ failed: get().scene });
    if (hello.status.state === "empty") clearView();
    const left = lost ? { scene: lost, written: Date.now() / 1000 } : before.server === "" ? readUnsent() : null;
    if (left && !sameScene(left.scene, get().scene)) {
      keepUnsent(left);
      return set({ offer: { ...left, from: "window", picture: pictured } });
    }
    if (hello.role === "writer") offerDraft({ draft, draft_written, pictured });
  } catch (e) {
    say(e);
  }
}

function receive(name: string, data: unknown): void {
  if (name === "status") takeStatus(data as Status);
  if (name === "video") set({ video: data as Video });
  if (name === "role") set({ role: data as Studio["role"] });
  if (name === "numbers") takeNumbers(data as JsonObject);
  if (name === "log") {
    const line = { ...(data as Omit<LogLine, "at">), at: Date.now() };
    set({ log: [...get().log, line].slice(-kMaxLines) });
  }
  if (name === "scene") {
    const { scene, draft: _, draft_written: _w, pictured: _p, ...sceneState } = data as ServedScene;
    applying = true;
    const another = sceneState.path !== get().sceneState.path;
    set({ scene: fromFile(scene), sceneState, ...(another && { file: { path: sceneState.path }, ...opened() }) });
    applying = false;
  }
}

function takeStatus(status: Status): void {
  const { state: before } = get().status;
  if (status.state === "failed" && before !== "failed") set({ failed: get().scene });
  if (status.state === "empty" && before !== "empty") clearView();
  const begins = status.state === "building" && before !== "building";
  set({ status, ...(begins && { built: Date.now(), builds: get().builds + 1, ran: get().scene }) });
}

/** There is no run any more: nothing of it is shown. */
function clearView(): void {
  last.frame = null;
  last.geometry = null;
  forgetFrames();
  set({ fluids: [], samples: [], numbers: null, picked: null });
  viewers.clear();
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
  set({ numbers, samples: [...samples, { time, values }].slice(-kMaxSamples) });
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

/** What is changed next is an undo step of its own. */
export const endPart = (): void => void (lastPart = null);

/** Waits until the server has judged what was edited. */
export const judged = async (): Promise<void> => void (await sending);

/** Changes the scene; one undo step. Changes of the same part that follow each other quickly, or in one drag, are one step. */
export function edit(change: (scene: Scene) => Scene, part?: string, more: Partial<Studio> = {}): void {
  if (get().role !== "writer") return say(new Error("another window has the pen: take it to make changes here"));
  const next = change(get().scene);
  if (next === get().scene) return;
  const history = useStudio.temporal.getState();
  const now = performance.now();
  const sameDrag = pointer.down && lastPart?.press === pointer.press;
  const together = part !== undefined && lastPart?.name === part && (sameDrag || now - lastPart.at < kTogetherMs);
  lastPart = part === undefined ? null : { name: part, at: now, press: pointer.press };
  if (together) history.pause();
  set({ ...more, scene: next });
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
  set({ taken: false });
  keepUnsentSoon();
  if (!now.connected) unsent = true;
  else if (now.role === "writer") void send();
});

const kKeepMs = 500;
let keeping: ReturnType<typeof setTimeout> | undefined;
/** The browser keeps what this window has edited, and not what is offered for later. */
let kept = false;

/** An edit that the server has not taken up soon is kept by the browser. */
function keepUnsentSoon(): void {
  clearTimeout(keeping);
  keeping = setTimeout(() => {
    if (get().taken) return;
    kept = true;
    keepUnsent({ scene: get().scene, written: Date.now() / 1000 });
  }, kKeepMs);
}

/** Sends the scene as it is; resolves when the server has judged it. */
function send(): Promise<void> {
  again = true;
  return (sending ??= sendAll().finally(() => (sending = null)));
}

async function sendAll(): Promise<void> {
  while (again) await sendNow();
}

const kAgainMs = 1000;

async function sendNow(): Promise<void> {
  again = false;
  const { scene } = get();
  try {
    const sceneState = await client.askSoon<SceneState>("scene.set", { scene: forRunner(scene, get().types) });
    const taken = scene === get().scene;
    set({ sceneState, taken });
    if (taken && kept) forgetUnsent();
    if (taken) kept = false;
  } catch (e) {
    say(e);
    if (e instanceof Refusal) return;
    // It did not come there, or nobody knows: it is sent again, with what was edited meanwhile.
    if (!get().connected) return void (unsent = true);
    again = true;
    await new Promise((resolve) => setTimeout(resolve, kAgainMs));
  }
}

/** Asks for something of the run, of the scene as it is edited: an edit that waits for the answer to an earlier one goes first. */
export function askRun<T = JsonObject>(what: "play" | "pause" | "step" | "reset", fields: object = {}): Promise<T | null> {
  if (again) void sendNow();
  if (what !== "pause") set({ looking: null });
  return request<T>(`run.${what}`, fields);
}

/** Whether the run goes on, or will as soon as it is built. */
export const isPlaying = (status: Status): boolean => status.state === "playing" || (status.state === "building" && status.plays === true);

/** Plays or pauses, whichever it does not do. */
export const togglePlay = (): void => void askRun(isPlaying(get().status) ? "pause" : "play");

/** Builds the scene again, at time 0, on a device; without one on that of before. */
export async function resetRun(device?: string, coarser?: number): Promise<void> {
  const state = await askRun<SceneState & { device: string }>("reset", { ...(device !== undefined && { device }), ...(coarser !== undefined && { coarser }) });
  if (!state) return;
  const { device: _, ...sceneState } = state;
  set({ sceneState });
}
