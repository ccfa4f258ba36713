// What makes work quick: links, costs, probes and arrows, as far as they know no browser.
import { describe, expect, test } from "vitest";
import { examplesOf } from "../src/model/examples";
import { gravityArrow, onAxis, speedArrow, tipOf, withTip } from "../src/model/arrows";
import { cutsOf, footOf, isShown, withCut, withNormal, withPlane } from "../src/model/clips";
import { readMesh } from "../src/files/readMesh";
import { checkMesh, guessUnit, longestSide } from "../src/model/meshCheck";
import { kNoPace, mendPace, secondsFor } from "../src/model/cost";
import { bendsOf, bent, withBends, withNodeIn } from "../src/model/links";
import { bodyOfMesh, pullables } from "../src/model/pull";
import { distanceBetween, probeType, withProbe } from "../src/model/probe";
import { renameNode, type Scene } from "../src/model/scene";
import { durationText } from "../src/model/time";
import { commandOf } from "../src/model/sweep";
import { quantityIn } from "../src/model/units";
import type { InputType, NodeType, Parameter, Types } from "../src/model/types";

const input = (name: string, type: string, many = true): InputType => ({ name, type, doc: "", required: false, many });
const output = (name: string, type: string) => ({ name, type, doc: "" });
const parameter = (name: string, kind: string, value: Parameter["default"], unit?: string): Parameter => ({ name, kind, doc: "", default: value, live: false, animated: false, ...(unit && { unit }) });
const node = (inputs: InputType[], outputs: NodeType["outputs"], more: Partial<NodeType> = {}): NodeType => ({ doc: "", source: "weir", inputs, outputs, parameters: [], ...more });

const position = parameter("position", "vec3", [0, 0, 0], "m");
const types: Types = {
  nodes: {
    Wall: node([input("walls", "Boundary")], [output("wall", "Boundary")]),
    Single: node([input("wall", "Boundary", false)], [output("wall", "Boundary")]),
    Fluid: node([input("walls", "Boundary"), input("born", "Batch")], [output("fluid", "Particles")]),
    Nozzle: node([], [output("born", "Batch")], { parameters: [position, parameter("rotation", "rotation", [0, 0, 0]), parameter("speed", "float", 2, "m/s")] }),
    Meter: node([input("particles", "Particles", false)], [], { also: ["probe"], parameters: [position] }),
  },
  modules: {}, sections: {}, world: [parameter("gravity", "vec3", [0, -9.8, 0], "m/s^2"), parameter("dt", "float", 1e-3, "s")],
};
const scene: Scene = {
  weir: 1, nodes: { a: { type: "Wall" }, b: { type: "Wall" }, one: { type: "Single" }, nozzle: { type: "Nozzle" }, water: { type: "Fluid" } },
  links: ["a.wall -> water.walls", "nozzle.born -> water.born"],
};
const link = "a.wall -> water.walls";

describe("a node that is put into a link", () => {
  test("takes what the link brings, and gives it on", () => {
    expect(withNodeIn(scene, types, link, "b")!.links).toEqual(["nozzle.born -> water.born", "a.wall -> b.walls", "b.wall -> water.walls"]);
    expect(withNodeIn(scene, types, link, "one")!.links).toContain("a.wall -> one.wall");
  });
  test("must have free ports that fit, and close no circle", () => {
    expect(withNodeIn(scene, types, link, "nozzle")).toBeNull();
    expect(withNodeIn(scene, types, link, "a")).toBeNull();
    expect(withNodeIn(scene, types, "nozzle.born -> water.born", "b")).toBeNull();
    expect(withNodeIn({ ...scene, links: [...scene.links!, "b.wall -> one.wall"] }, types, link, "one")).toBeNull();
    expect(withNodeIn({ ...scene, links: [...scene.links!, "b.wall -> a.walls"] }, types, link, "b")).toBeNull();
  });
});

describe("a link that is bent", () => {
  const there = withBends(scene, link, [{ x: 10.4, y: 20 }]);
  test("keeps its bends under another name, and forgets those of links that are gone", () => {
    expect(bendsOf(there, link)).toEqual([{ x: 10, y: 20 }]);
    expect(bendsOf(renameNode(there, "a", "basin"), "basin.wall -> water.walls")).toHaveLength(1);
    expect(withBends({ ...there, links: ["nozzle.born -> water.born"] }, "nozzle.born -> water.born", [{ x: 1, y: 1 }]).layout!.bends).not.toHaveProperty(link);
    expect(withBends(there, link, []).layout!.bends).toBeUndefined();
    expect(bendsOf(withNodeIn(there, types, link, "b")!, link)).toEqual([]);
  });
  test("gets a bend in the stretch that lies nearest", () => {
    const at = (x: number, y: number) => ({ x, y });
    expect(bent([at(100, 100)], at(50, 48), at(0, 0), at(200, 0))).toEqual([at(50, 48), at(100, 100)]);
    expect(bent([at(100, 100)], at(150, 48), at(0, 0), at(200, 0))).toEqual([at(100, 100), at(150, 48)]);
  });
});

describe("what a run will cost", () => {
  test("is time by what the last runs took for a step and particle", () => {
    const pace = mendPace(kNoPace, { steps: 100, stepping_seconds: 10, particles: 1000 });
    expect(pace).toBeCloseTo(1e-4, 12);
    expect(secondsFor({ particles: 2000, steps: 500, bytes: 0, available: 0, at_least: false, fits: true }, pace)).toBeCloseTo(100, 9);
    expect(mendPace(pace, { steps: 2, stepping_seconds: 10, particles: 1000 })).toBe(pace);
    expect(secondsFor({ particles: 1, steps: 1, bytes: 0, available: 0, at_least: false, fits: true }, kNoPace)).toBeNull();
  });
  test("is told no more exactly than it is known", () => expect([0.2, 40, 600, 9000].map(durationText)).toEqual(["1 s", "40 s", "10 min", "2.5 h"]));
});

describe("a probe", () => {
  test("is what people call so, and measures what it is linked to where it is put", () => {
    expect(probeType(types)).toBe("Meter");
    const [next, name] = withProbe(scene, types, "water", [0.123456, 1, 2])!;
    expect(next.nodes[name]).toEqual({ type: "Meter", params: { position: [0.1235, 1, 2] } });
    expect(next.links).toContain(`water.fluid -> ${name}.particles`);
    expect(withProbe(scene, types, "a", [0, 0, 0])).toBeNull();
    expect(withProbe(scene, { ...types, nodes: {} }, "water", [0, 0, 0])).toBeNull();
  });
  test("distances are those of Pythagoras", () => expect(distanceBetween([0, 0, 0], [2, 3, 6])).toBe(7));
});

describe("arrows in the view", () => {
  test("are speeds along a nozzle, and do not turn round", () => {
    const arrow = speedArrow(scene, types, "nozzle", 0.5, () => [0, -1, 0])!;
    expect(tipOf(arrow)).toEqual([0, -1, 0]);
    expect(withTip(scene, arrow, [5, -2, 5]).nodes["nozzle"]!.params).toEqual({ speed: 4 });
    expect(withTip(scene, arrow, [0, 2, 0]).nodes["nozzle"]!.params).toEqual({ speed: 0 });
    expect(speedArrow(scene, types, "water", 1, () => [0, -1, 0])).toBeNull();
    const keyed = { ...scene, nodes: { ...scene.nodes, nozzle: { type: "Nozzle", params: { speed: { keyframes: [[0, 1]] } } } } };
    expect(speedArrow(keyed, types, "nozzle", 1, () => [0, -1, 0])).toBeNull();
  });
  test("are gravity, which lies on an axis where it is near to one", () => {
    const arrow = gravityArrow(scene, types, [1, 1, 1], 0.1)!;
    expect(tipOf(arrow)[1]).toBeCloseTo(0.02, 12);
    expect(withTip(scene, arrow, [1.02, 0, 1]).world!["gravity"]).toEqual([0, -10, 0]);
    expect(onAxis([1, 1, 0])).toEqual([1, 1, 0]);
    expect(onAxis([0, 0, 0])).toEqual([0, 0, 0]);
  });
});

test("examples of a type are scenes that have it, the smallest first", () => {
  const template = (path: string, ...uses: string[]) => ({ path, title: path, description: "", group: "", thumbnail: "", types: uses });
  expect(examplesOf("Wall", [template("large", "Wall", "Fluid", "Nozzle"), template("none", "Fluid"), template("small", "Wall")]).map((t) => t.path)).toEqual(["small", "large"]);
});

test("a mesh of the view belongs to the body that its node's mesh goes to", () => {
  const some: Types = { ...types, nodes: { ...types.nodes, Cube: node([], [output("mesh", "TriangleMesh")]), Body: node([input("mesh", "TriangleMesh", false)], [], { parameters: [parameter("applied_force", "vec3", [0, 0, 0], "N")] }) } };
  const bodies: Scene = { weir: 1, nodes: { cube: { type: "Cube" }, cup: { type: "Cube" }, ship: { type: "Body" } }, links: ["cube.mesh -> ship.mesh"] };
  expect([bodyOfMesh(bodies, some, "cube"), bodyOfMesh(bodies, some, "ship"), bodyOfMesh(bodies, some, "cup")]).toEqual(["ship", "ship", null]);
  expect(pullables(bodies, some)).toEqual(["ship"]);
});

describe("a mesh that was dropped", () => {
  /** A box from 0 to a corner, its triangles facing outwards. */
  const box = ([x, y, z]: [number, number, number]): number[] => {
    const quad = (a: number[], b: number[], c: number[], d: number[]) => [...a, ...b, ...c, ...a, ...c, ...d];
    const p = (i: number, j: number, k: number) => [i * x, j * y, k * z];
    return [
      ...quad(p(0, 0, 0), p(0, 1, 0), p(1, 1, 0), p(1, 0, 0)), ...quad(p(0, 0, 1), p(1, 0, 1), p(1, 1, 1), p(0, 1, 1)),
      ...quad(p(0, 0, 0), p(0, 0, 1), p(0, 1, 1), p(0, 1, 0)), ...quad(p(1, 0, 0), p(1, 1, 0), p(1, 1, 1), p(1, 0, 1)),
      ...quad(p(0, 0, 0), p(1, 0, 0), p(1, 0, 1), p(0, 0, 1)), ...quad(p(0, 1, 0), p(0, 1, 1), p(1, 1, 1), p(1, 1, 0)),
    ];
  };
  const reversed = (corners: number[]): number[] => {
    const turned = [...corners];
    for (let t = 0; t < corners.length; t += 9) for (let i = 0; i < 3; ++i) [turned[t + 3 + i], turned[t + 6 + i]] = [corners[t + 6 + i]!, corners[t + 3 + i]!];
    return turned;
  };
  test("is measured, and told whether it is closed", () => {
    const closed = checkMesh(box([200, 100, 50]));
    expect(closed).toEqual({ triangles: 12, low: [0, 0, 0], high: [200, 100, 50], open: 0, insideOut: false });
    expect(longestSide(closed)).toBe(200);
    // Without one triangle its three edges are open.
    expect(checkMesh(box([1, 1, 1]).slice(9))).toMatchObject({ triangles: 11, open: 3 });
    expect(checkMesh(reversed(box([1, 1, 1])))).toMatchObject({ open: 0, insideOut: true });
    // One face turned round: its two triangles do not fit to the others along four edges.
    const mixed = [...reversed(box([1, 1, 1]).slice(0, 18)), ...box([1, 1, 1]).slice(18)];
    expect(checkMesh(mixed)).toMatchObject({ open: 4 });
  });
  test("has the unit in which it fits the scene", () => {
    const unit = (long: number, scene: number) => guessUnit(long, scene).name;
    expect([unit(0.2, 1), unit(1, 1), unit(200, 1), unit(20, 0.5), unit(1e7, 1), unit(1e-5, 1)]).toEqual(["m", "m", "mm", "mm", "m", "m"]);
  });
});

describe("a mesh file that was dropped", () => {
  const kPlaces = [[0, 0, 0], [2, 0, 0], [0, 3, 0], [0, 0, 4]], kFaces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
  const kFound = { triangles: 4, low: [0, 0, 0], high: [2, 3, 4], open: 0, insideOut: false };
  const file = (name: string, ...parts: BlobPart[]) => new File(parts, name);
  const checked = async (f: File) => checkMesh((await readMesh(f))!);

  test("is read as OFF, with colours, with faces of more corners, and without its first word", async () => {
    const text = ["OFF # a corner", "4 4 6", ...kPlaces.map((p) => p.join(" ")), "", ...kFaces.map((f) => `3 ${f.join(" ")}`)].join("\n");
    expect(await checked(file("a.off", text))).toEqual(kFound);
    expect(await checked(file("a.OFF", text.replace("OFF # a corner\n", "")))).toEqual(kFound);
    const coloured = ["COFF 4 1 0", "0 0 0 1 0 0 1", "1 0 0 1 0 0 1", "1 1 0 1 0 0 1", "0 1 0 1 0 0 1", "4 0 1 2 3 255 0 0"].join("\r\n");
    expect(await checked(file("a.off", coloured))).toMatchObject({ triangles: 2, high: [1, 1, 0], open: 4 });
    for (const damaged of ["", "OFF", "OFF\n4 4 0\n0 0 0", text.replace("3 1 2 3", "3 1 2 9"), text.replace("2 0 0", "2 x 0"), text.replace("3 1 2 3", "4 1 2 3")])
      await expect(readMesh(file("a.off", damaged)), damaged).rejects.toThrow(/ends too early|no such face/);
  });

  /** A node that turns the mesh, mirrors it and makes it larger. */
  const gltf = (buffer: object) => ({
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], buffers: [buffer],
    nodes: [{ mesh: 0, scale: [-2, 2, 2], translation: [4, 0, 0] }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }], textures: [{ source: 0 }], images: [{ uri: "missing.png" }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 4, type: "VEC3", min: [0, 0, 0], max: [2, 3, 4] }, { bufferView: 1, componentType: 5123, count: 12, type: "SCALAR" }],
    bufferViews: [{ buffer: 0, byteOffset: 0, byteLength: 48 }, { buffer: 0, byteOffset: 48, byteLength: 24 }],
  });
  const bytes = new Uint8Array([...new Uint8Array(Float32Array.from(kPlaces.flat()).buffer), ...new Uint8Array(Uint16Array.from(kFaces.flat()).buffer)]);

  test("is read as glTF where its node stands, without the pictures that it names", async () => {
    const text = JSON.stringify(gltf({ byteLength: bytes.length }));
    const json = new TextEncoder().encode(text.padEnd(4 * Math.ceil(text.length / 4)));
    const words = (...n: number[]) => new Uint8Array(Uint32Array.from(n).buffer);
    const glb = file("a.glb", words(0x46546c67, 2, 28 + json.length + bytes.length, json.length, 0x4e4f534a), json, words(bytes.length, 0x004e4942), bytes);
    const expected = { triangles: 4, low: [0, 0, 0], high: [4, 6, 8], open: 0, insideOut: false };
    expect(await checked(glb)).toEqual(expected);
    const embedded = gltf({ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${btoa(String.fromCharCode(...bytes))}` });
    expect(await checked(file("a.gltf", JSON.stringify(embedded)))).toEqual(expected);
    await expect(readMesh(file("a.gltf", JSON.stringify(gltf({ byteLength: bytes.length, uri: "a.bin" }))))).rejects.toThrow("it needs a.bin");
  });
  test("is not read in other formats, and is told to be damaged where it is", async () => {
    expect(await readMesh(file("a.fbx", "x"))).toBeNull();
    await expect(readMesh(file("a.glb", "x"))).rejects.toThrow();
  });
});

describe("a plane that cuts the fluids open", () => {
  const cut = withCut({ weir: 1, nodes: {} }, [0.5, 0.25, 0.125]);
  test("is moved along its normal, and turned about its handle", () => {
    expect(cutsOf(cut)).toEqual([{ point: [0.5, 0.25, 0.125], normal: [0, 0, 1], thickness: null }]);
    expect(footOf(cutsOf(cut)[0]!, [1, 2, 3])).toEqual([1, 2, 0.125]);
    expect(cutsOf(withPlane(cut, 0, [9, 9, 0.75]))[0]!.point).toEqual([0.5, 0.25, 0.75]);
    const turned = cutsOf(withNormal(cut, 0, [0, 0, 0.125], [3, 0, 4.125]))[0]!;
    expect(turned.point).toEqual([0, 0, 0.125]);
    turned.normal.forEach((x, i) => expect(x).toBeCloseTo([0.6, 0, 0.8][i]!));
    // Nearly along an axis is along it.
    expect(cutsOf(withNormal(cut, 0, [0, 0, 0], [1, 0.02, 0]))[0]!.normal).toEqual([1, 0, 0]);
  });
  test("hides what lies on the side of its normal, or all but a slice", () => {
    const plane = { point: [0, 0, 1], normal: [0, 0, 1], thickness: null };
    expect([isShown([plane], [5, 5, 0.9]), isShown([plane], [0, 0, 1.1])]).toEqual([true, false]);
    const slice = { ...plane, thickness: 0.4 };
    expect([0.7, 0.9, 1.1, 1.3].map((z) => isShown([slice], [0, 0, z]))).toEqual([false, true, true, false]);
    expect(isShown([plane, { ...plane, normal: [1, 0, 0] }], [1, 0, 0])).toBe(false);
  });
});

test("numbers are typed with units of the parameter's kind", () => {
  const typed: [string, string, number | null][] = [
    ["10cm", "m", 0.1], ["2*3 mm", "m", 0.006], ["1e-3 km", "m", 1], ["5 s", "m", null], ["1.5 ms", "s", 0.0015], ["36 km/h", "m/s", 10], ["1 g/cm^3", "kg/m^3", 1000],
    ["1 mPa s", "Pa*s", 0.001], ["1 bar", "Pa", 1e5], ["0.25 rev", "degrees", 90], ["60 rpm", "rad/s", 6.28318530718], ["3 1/(m^2 s)", "1/(m^2 s)", 3], ["5 apples", "m", null], ["cm", "m", null], ["2 N*m", "J", 2],
  ];
  for (const [text, unit, value] of typed) expect(quantityIn(text, unit), text).toBe(value);
});

test("a sweep is also a command", () => {
  expect(commandOf("dam.json", { node: "water" }, ["spacing"], [0.01, 0.02])).toBe("weir sweep dam.json --out dam_sweep --set water.spacing=0.01,0.02");
  expect(commandOf("my dam.json", { node: "water", module: "solver" }, ["iterations"], [5])).toBe("weir sweep 'my dam.json' --out 'my dam_sweep' --set water.solver.iterations=5");
  expect(commandOf("a/b.json", { section: "world" }, ["dt"], [1e-3])).toBe("weir sweep a/b.json --out a/b_sweep --set world.dt=0.001");
});
