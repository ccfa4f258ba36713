// The connection to the server: questions with answers, events, packets. It comes back by itself when it breaks.
import { withNumber } from "../model/names";
import { writeMessage } from "./message";
import type { JsonObject, Problem } from "../model/types";
import { readPacket, type FramePacket, type GeometryPacket, type PicturePacket } from "./packets";

/** What the server refused, and why. */
export class Refusal extends Error {
  constructor(readonly problem: Problem) {
    super([problem.message, problem.allowed && `allowed: ${problem.allowed}`, problem.hint].filter(Boolean).join(" — "));
  }
}

export interface ClientEvents {
  connected(on: boolean): void;
  event(name: string, data: unknown): void;
  frame(packet: FramePacket): void;
  geometry(packet: GeometryPacket): void;
  picture(packet: PicturePacket): void;
}

const kRetryMs = 1000;
/** A server that is asked for no more than a judgement has given it long before. */
const kPatienceMs = 30_000;

export class Client {
  private socket: WebSocket | null = null;
  private waiting = new Map<number, { resolve: (v: never) => void; reject: (e: Error) => void }>();
  private lastId = 0;

  constructor(private readonly events: ClientEvents) {}

  open(): void {
    const socket = new WebSocket(`ws://${location.host}/api/live`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.events.connected(true);
    socket.onclose = () => this.closed();
    socket.onmessage = (m) => this.receive(m.data as string | ArrayBuffer);
    this.socket = socket;
  }

  /** The same for what is answered soon: rejects, too, if there is no answer. */
  askSoon<T = JsonObject>(what: string, fields: object = {}): Promise<T> {
    let timer: ReturnType<typeof setTimeout>;
    const late = new Promise<never>((_, reject) => {
      timer = setTimeout(() => reject(new Error("the server does not answer")), kPatienceMs);
    });
    return Promise.race([this.ask<T>(what, fields), late]).finally(() => clearTimeout(timer));
  }

  /** Asks the server; rejects with a Refusal, or where the connection breaks. */
  ask<T = JsonObject>(what: string, fields: object = {}): Promise<T> {
    const id = ++this.lastId;
    return new Promise<T>((resolve, reject) => {
      if (this.socket?.readyState !== WebSocket.OPEN) return reject(new Error("there is no connection to the server"));
      this.waiting.set(id, { resolve: resolve as (v: never) => void, reject });
      this.socket.send(writeMessage({ id, do: what, ...fields }));
    });
  }

  /** The same, and says so where the answer is late. It counts still when it comes: the server has done what was asked. */
  async askAloud<T = JsonObject>(what: string, fields: object, say: (late: Error) => void): Promise<T> {
    const timer = setTimeout(() => say(new Error(`the server has not answered for ${kPatienceMs / 1000} s: "${what}" may not be done`)), kPatienceMs);
    return this.ask<T>(what, fields).finally(() => clearTimeout(timer));
  }

  /** Lets the server send one more frame. */
  frameSeen(): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send('{"do":"frame.seen"}');
  }

  private closed(): void {
    for (const { reject } of this.waiting.values()) reject(new Error("the connection to the server broke"));
    this.waiting.clear();
    this.events.connected(false);
    setTimeout(() => this.open(), kRetryMs);
  }

  private receive(data: string | ArrayBuffer): void {
    if (typeof data !== "string") {
      const packet = readPacket(data);
      if (packet.kind === "frame") this.events.frame(packet);
      else if (packet.kind === "picture") this.events.picture(packet);
      else this.events.geometry(packet);
      return;
    }
    const message = JSON.parse(data);
    if (message.event !== undefined) return this.events.event(message.event, message.data);
    const asked = this.waiting.get(message.id);
    if (!asked) return;
    this.waiting.delete(message.id);
    if (message.error) asked.reject(new Refusal(message.error));
    else asked.resolve(message.result as never);
  }
}

async function fetched(address: string, init?: RequestInit): Promise<Response> {
  const answer = await fetch(address, init);
  if (!answer.ok) throw new Error(await answer.text());
  return answer;
}

/** Whether the server lets this window in; rejects where there is none. */
export const isKnown = async (): Promise<boolean> => {
  const kUnauthorized = 401;
  return (await fetch("/api/files")).status !== kUnauthorized;
};

export interface ServedFile {
  path: string;
  folder: boolean;
  bytes: number;
  /** Seconds since 1970; 0 where nobody knows. */
  modified?: number;
  /** Of a scene: when a picture of its run was made, seconds since 1970; left out where there is none. */
  picture?: number;
}

/** A scene to start from. `thumbnail` is an address, or "". */
export interface Template {
  path: string;
  title: string;
  description: string;
  group: string;
  /** Of its nodes and modules. */
  types: string[];
  thumbnail: string;
}

const pathOf = (file: string) => file.split("/").map(encodeURIComponent).join("/");

export const addressOfFile = (path: string): string => `/api/file/${pathOf(path)}`;
/** The picture of a scene that was made at a time, or of its version. */
export const addressOfPicture = (path: string, made: number, version?: number): string =>
  `/api/picture/${pathOf(path)}?at=${made}${version === undefined ? "" : `&version=${version}`}`;
export const uploadPicture = (path: string, jpeg: Blob) => fetched(`/api/picture/${pathOf(path)}`, { method: "PUT", body: jpeg });
export const fetchTypes = async () => (await fetched("/api/types")).json();
export const fetchTemplates = async (): Promise<Template[]> => (await fetched("/api/templates")).json();
export const fetchFiles = async (folder: string): Promise<ServedFile[]> =>
  (await fetched(`/api/files?folder=${encodeURIComponent(folder)}`)).json();
/** Copies a file to the served folder; refused where there is one of that name already. */
export const upload = (path: string, file: File) =>
  fetched(`${addressOfFile(path)}?new`, { method: "PUT", body: file });

/** The path, or where there is such a file, one with a number: "a_001.mp4". */
export async function freePath(path: string): Promise<string> {
  const folder = path.includes("/") ? path.slice(0, path.lastIndexOf("/")) : "";
  const taken = new Set((await fetchFiles(folder)).map((f) => f.path));
  return withNumber(path, (p) => taken.has(p));
}
