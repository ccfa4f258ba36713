// Files that are dropped, and scenes that other files carry.
import { describe, expect, test } from "vitest";
import { addNode, emptyScene, type Scene } from "../src/model/scene";
import type { Run } from "../src/model/runs";
import { kId, sceneIn, withScene } from "../src/share/carried";
import { inPage, replayPage } from "../src/share/replay";
import { isScene, kindOfFile, stemOf } from "../src/files/kinds";
import { kUses, withMesh, withParticles } from "../src/model/fromFile";
import type { Parameter, Types } from "../src/model/types";
import { fluid, sampler, types, frameOf, runOf } from "./samples";

describe("dropped files", () => {
  test("are told apart by name and content", () => {
    expect(["a.JSON", "b.obj", "c.tar.stl", "d.csv", "notes.txt", "none"].map(kindOfFile)).toEqual(["scene", "mesh", "mesh", "particles", "other", "other"]);
    expect([isScene('{"weir":1,"nodes":{}}'), isScene('{"name":"x"}'), isScene("[1"), isScene("null")]).toEqual([true, false, false, false]);
    expect(stemOf("folder/cup.v2.obj")).toBe("cup.v2");
  });
  const port = (name: string, type: string) => ({ name, type, doc: "", required: false, many: true });
  const parameter = (name: string, kind: string): Parameter => ({ name, kind, doc: "", default: null, live: false, animated: false });
  const known: Types = {
    ...types,
    nodes: {
      Block: { ...sampler, outputs: [port("surface", "TriangleMesh")] },
      MeshFile: { ...sampler, outputs: [port("surface", "TriangleMesh")], parameters: [parameter("file", "path")] },
      ParticleFile: { ...sampler, parameters: [parameter("time", "float"), parameter("file", "path")] },
      StaticBoundary: {
        ...sampler, inputs: [port("meshes", "TriangleMesh")], outputs: [port("boundary", "Boundary")],
        parameters: [parameter("rough", "bool"), { ...parameter("inverted", "bool"), also: ["container"] }],
      },
      MeshEmitter: { ...sampler, also: ["inflow"], inputs: [port("surface", "TriangleMesh")] }, MeshSampler: { ...sampler, also: ["fill"], inputs: [port("surface", "TriangleMesh")] },
      ParticleFluid: { ...fluid, inputs: ["initial", "emitters"].map((n) => port(n, "ParticleBatch")).concat(port("boundaries", "Boundary")) },
    },
  };
  const [water] = addNode(emptyScene(), "ParticleFluid", { x: 0, y: 0 }, "water");
  const links = (use: string, scene = water) => withMesh(scene, known, "meshes/cup.obj", "cup", kUses.find((u) => u.name === use)!, { x: 0, y: 0 })[0].links;
  test("become what they shall be, linked to the fluid", () => {
    expect(links("Obstacle")).toEqual(["cup.surface -> cup_obstacle.meshes", "cup_obstacle.boundary -> water.boundaries"]);
    expect(links("Fill it")).toEqual(["cup.surface -> cup_fill.surface", "cup_fill.particles -> water.initial"]);
    expect(links("Emit from it")).toEqual(["cup.surface -> cup_emit.surface", "cup_emit.particles -> water.emitters"]);
    expect(links("Only the mesh")).toBeUndefined();
    expect(links("Obstacle", emptyScene())).toEqual(["cup.surface -> cup_obstacle.meshes"]);
    const [container, name] = withMesh(water, known, "meshes/cup.obj", "cup", kUses[1]!, { x: 0, y: 0 });
    expect(container.nodes[name]).toEqual({ type: "StaticBoundary", params: { inverted: true } });
    expect(container.nodes["cup"]).toEqual({ type: "MeshFile", params: { file: "meshes/cup.obj" } });
    const [filled, read] = withParticles(water, known, "particles/a.csv", "a", { x: 0, y: 0 });
    expect([filled.nodes[read], filled.links]).toEqual([{ type: "ParticleFile", params: { file: "particles/a.csv" } }, ["a.particles -> water.initial"]]);
  });
  test("need types of nodes that take them, whatever they are called", () => {
    const { StaticBoundary, ...others } = known.nodes;
    const renamed = { ...known, nodes: { ...others, PluginWalls: StaticBoundary! } };
    const [scene, name] = withMesh(water, renamed, "cup.obj", "cup", kUses[0]!, { x: 0, y: 0 });
    expect(scene.nodes[name]!.type).toBe("PluginWalls");
    expect(() => withMesh(water, { ...known, nodes: others }, "cup.obj", "cup", kUses[0]!, { x: 0, y: 0 })).toThrow("no node here makes a Boundary of a mesh");
  });
});

describe("scenes in other files", () => {
  const scene = JSON.stringify({ weir: 1, title: "Wässer </script> & <b>", nodes: {} });
  // One black pixel, by another program (Python's zlib and struct).
  const png = Uint8Array.from(atob("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNgAAAAAgABSK+kcQAAAABJRU5ErkJggg=="), (c) => c.charCodeAt(0));
  const bytes = (text: string) => Uint8Array.from(text, (c) => c.charCodeAt(0));
  test("are found in a PNG, before its end", () => {
    expect(sceneIn(png)).toBeNull();
    const carrying = withScene(png, scene);
    expect(sceneIn(carrying)).toBe(scene);
    expect([...carrying.slice(-12)]).toEqual([...png.slice(-12)]);
    expect(sceneIn(carrying.slice(0, -30))).toBeNull();
  });
  test("are found in a box of an MP4, wherever it stands", () => {
    const box = (kind: string, body: Uint8Array) => [...bytes("\0\0"), (body.length + 8) >> 8, (body.length + 8) & 255, ...bytes(kind), ...body];
    const own = box("uuid", Uint8Array.of(...bytes(kId), ...new TextEncoder().encode(scene)));
    const video = Uint8Array.of(...box("ftyp", bytes("isom")), ...box("uuid", bytes("another program.")), ...box("mdat", new Uint8Array(300)), ...own);
    expect(sceneIn(video)).toBe(scene);
    expect(sceneIn(video.slice(0, -1))).toBeNull();
  });
  test("are found in an element of a Matroska or WebM, behind others", () => {
    const element = (id: number[], body: Uint8Array) => [...id, 0x40 | (body.length >> 8), body.length & 255, ...body];
    const own = element([0xec], Uint8Array.of(...bytes(kId), ...new TextEncoder().encode(scene)));
    const video = Uint8Array.of(...element([0x1a, 0x45, 0xdf, 0xa3], new Uint8Array(20)), ...element([0x18, 0x53, 0x80, 0x67], new Uint8Array(300)), ...element([0xec], bytes("another program has this")), ...own);
    expect(sceneIn(video)).toBe(scene);
    expect(sceneIn(video.slice(0, -1))).toBeNull();
    expect(sceneIn(video.slice(0, -own.length))).toBeNull();
  });
  test("are found in the last comment of a GIF", () => {
    const long = JSON.stringify({ weir: 1, title: "x".repeat(700), nodes: {} }), content = [...bytes(kId), ...new TextEncoder().encode(long)];
    const blocks = [];
    for (let at = 0; at < content.length; at += 255) blocks.push(Math.min(255, content.length - at), ...content.slice(at, at + 255));
    const gif = Uint8Array.of(...bytes("GIF89a"), ...new Uint8Array(40), ...bytes("!"), 0xfe, ...blocks, 0, ...bytes(";"));
    expect(sceneIn(gif)).toBe(long);
    expect(sceneIn(gif.slice(0, 300))).toBeNull();
    expect(sceneIn(gif.slice(0, 46))).toBeNull();
  });
  test("are found in a page that replays a run, which has its numbers as they were", async () => {
    const run: Run = { ...runOf([]), frames: [frameOf(0, 0), frameOf(1, 0.1)], geometry: { kind: "geometry", meshes: [{ node: "m", vertices: Float32Array.of(1, 2, 3), triangles: Uint32Array.of(0, 0, 0) }] } };
    const page = await (await replayPage(run, JSON.parse(scene) as Scene, { colors: ["#000000", "#ffffff"], range: null, camera: { eye: [1, 1, 1], target: [0, 0, 0], fov: 40 }, dark: true, lines: Float32Array.of(0, 0, 0, 1, 1, 1) })).text();
    expect(JSON.parse(sceneIn(bytes(unescape(encodeURIComponent(page))))!)).toEqual(JSON.parse(scene));
    const told = JSON.parse(/const RUN = (.*);\n/.exec(page)![1]!) as { frames: { time: number; fluids: { count: number; radius: number; positions: number; values: number }[] }[]; range: number[] };
    expect(told.range).toEqual([0, 4]);
    expect(told.frames.map((f) => f.time)).toEqual([0, 0.1]);
    const { count, radius, positions, values } = told.frames[1]!.fluids[0]!;
    expect(radius).toBeCloseTo(0.1);  // 2 of 16 particles fill the space of all
    const packed = bytes(atob(/id="weir-data">([^<]*)</.exec(page)![1]!));
    const data = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
    expect([...new Uint16Array(data, positions, 3 * count)]).toEqual([0, 0, 0, 65535, 65535, 65535]);
    expect([...new Uint16Array(data, values, count)]).toEqual([0, 65535]);
    expect(page.match(/<\/script>/g)!.length).toBe(3);
    expect(page).toContain("<title>Wässer &#60;/script&#62; &#38; &#60;b&#62;</title>");
  });
  test("end no script", () => expect(inPage({ a: "</script>" })).toBe('{"a":"\\u003c/script>"}'));
});
