// What goes to the server and comes from it.
import { afterEach, beforeEach, describe, expect, test, vi } from "vitest";
import { Client } from "../src/protocol/client";
import { readPacket } from "../src/protocol/packets";
import { writeMessage } from "../src/protocol/message";

describe("messages", () => {
  test("have numbers that the server can read", () => {
    for (const v of [-1e20, 9.3e18, 2 ** 63, 123456789012345680000]) {
      const text = writeMessage({ id: 1, scene: { world: { gravity: [0, v, 0] } } });
      expect(text).toMatch(/e\+\d/);
      expect(JSON.parse(text).scene.world.gravity[1]).toBe(v);
    }
  });
  test("are else as JSON has them", () => {
    const message = { id: 1, a: 2 ** 53, b: 0.1, c: 'a "1e20" in a text', d: [1e21, 1e-9, -0.5], e: null, f: "\uE0F7" };
    expect(JSON.parse(writeMessage(message))).toEqual(message);
    expect(writeMessage({ a: 2 ** 53, b: "x" })).toBe('{"a":9007199254740992,"b":"x"}');
  });
});

test("a packet is read where its header says", () => {
  const header = new TextEncoder().encode(
    '{"kind":"geometry","meshes":[{"node":"m","vertexCount":1,"triangleCount":1,"vertices":0,"triangles":16}]}'.padEnd(108),
  );
  const buffer = new ArrayBuffer(4 + 108 + 28);
  new DataView(buffer).setUint32(0, 108, true);
  new Uint8Array(buffer, 4, 108).set(header);
  new Float32Array(buffer, 112, 3).set([1, 2, 3]);
  new Int32Array(buffer, 128, 3).set([0, 0, 0]);
  const packet = readPacket(buffer);
  expect(packet.kind === "geometry" && [...packet.meshes[0]!.vertices]).toEqual([1, 2, 3]);
});

test("ids of particles have 64 bits", () => {
  const header = '{"kind":"frame","frame":0,"time":0,"poses":{},"fluids":[{"node":"w","count":2,"positions":0,"ids":16}]}'.padEnd(108);
  const buffer = new ArrayBuffer(4 + 108 + 32);
  new DataView(buffer).setUint32(0, 108, true);
  new Uint8Array(buffer, 4, 108).set(new TextEncoder().encode(header));
  new BigInt64Array(buffer, 128, 2).set([7n, 2n ** 40n + 5n]);
  const packet = readPacket(buffer);
  expect(packet.kind === "frame" && [...packet.fluids[0]!.ids]).toEqual([7, 2 ** 40 + 5]);
});

describe("a question", () => {
  const kPatienceMs = 30_000;
  let socket: { onopen(): void; onclose(): void; onmessage(m: { data: string }): void }, sent: { id: number; do: string }[];
  const answer = (id: number) => socket.onmessage({ data: JSON.stringify({ id, result: { done: true } }) });
  const connected = (): Client => {
    const client = new Client({ connected() {}, event() {}, frame() {}, geometry() {}, picture() {} });
    client.open();
    return client;
  };
  beforeEach(() => {
    vi.useFakeTimers();
    sent = [];
    class FakeSocket {
      static OPEN = 1;
      readyState = 1;
      onopen() {}
      onclose() {}
      onmessage() {}
      constructor() {
        socket = this;
      }
      send = (text: string) => sent.push(JSON.parse(text));
    }
    vi.stubGlobal("WebSocket", FakeSocket);
    vi.stubGlobal("location", { host: "here" });
  });
  afterEach(() => (vi.useRealTimers(), vi.unstubAllGlobals()));

  test("that is not answered in time is told of, and counts when it is answered after all", async () => {
    const told: string[] = [];
    const asked = connected().askAloud("scene.open", { path: "a.json" }, (e) => told.push(e.message));
    vi.advanceTimersByTime(kPatienceMs - 1);
    expect(told).toEqual([]);
    vi.advanceTimersByTime(1);
    expect(told).toEqual(['the server has not answered for 30 s: "scene.open" may not be done']);
    answer(sent[0]!.id);
    expect(await asked).toEqual({ done: true });
  });
  test("that is answered in time says nothing", async () => {
    const told: Error[] = [];
    const asked = connected().askAloud("run.play", {}, (e) => told.push(e));
    answer(sent[0]!.id);
    await asked;
    vi.advanceTimersByTime(2 * kPatienceMs);
    expect(told).toEqual([]);
  });
  test("that cannot wait fails in time, and any where the connection breaks", async () => {
    const client = connected();
    const soon = expect(client.askSoon("scene.save")).rejects.toThrow("the server does not answer");
    vi.advanceTimersByTime(kPatienceMs);
    await soon;
    const cut = expect(client.ask("run.play")).rejects.toThrow("the connection to the server broke");
    socket.onclose();
    await cut;
  });
});
