// The parts of the page that know no browser.
import { describe, expect, test } from "vitest";
import { evaluate } from "../src/model/expression";
import { valueAt, withPoints, withTime, type Keyframe } from "../src/model/keyframes";
import { addNote, moveAll, notesOf, withCarried } from "../src/model/notes";
import {
  addGroupAround, addLink, addNode, collapse, copyNodes, emptyScene, freeNoteId, insertModule, linkProblem, linksFor, linksOf, linkText, moveModule, nameProblem, pasteNodes,
  pipelineOf, placeModule, removeNodes, renameNode, setParam, toggleCollapsed, type Scene,
} from "../src/model/scene";
import { afterChoice, isUsed, labelOf } from "../src/model/parameters";
import { menuOf } from "../src/Menu";
import { followMotion, otherChoices, shorterSteps } from "../src/model/remedy";
import { advance, counted, niceStep, recordedFrames, ticks } from "../src/model/playback";
import { differencesOf, frameAt, lean, pointAt, strideFor, type Run } from "../src/model/runs";
import { evenly, firstValues, readOff, readValues, tableOf } from "../src/model/sweep";
import { kBox, sceneIn, withScene } from "../src/share/carried";
import { inPage, replayPage } from "../src/share/replay";
import { titleOf, unitOf } from "../src/model/quantities";
import { distance, search } from "../src/model/search";
import { hostOf, nodesToAdd } from "../src/graph/addable";
import { isScene, kindOfFile, stemOf } from "../src/files/kinds";
import { kUses, withMesh, withParticles } from "../src/model/fromFile";
import { lightsOf, measuresOf, nodeIn, warningsOf, worst } from "../src/model/health";
import { Box3, PerspectiveCamera, Vector3 } from "three";
import { distanceFor } from "../src/viewport/view";
import { boxOf, withFace } from "../src/viewport/outlines";
import { roleOf } from "../src/model/roles";
import { carries, forRunner, fromFile, inputFor, offOf, setOff, toggleOff } from "../src/model/switchedOff";
import type { JsonObject, NodeType, Parameter, Types } from "../src/model/types";
import { fileNameOf, pathProblem, withNumber } from "../src/model/names";
import css from "../src/style.css?raw";
import { shortText } from "../src/model/numbers";
import { readPacket, type FramePacket } from "../src/protocol/packets";
import { writeMessage } from "../src/protocol/message";

const fluid: NodeType = {
  doc: "", source: "weir", parameters: [], family: "FluidModule",
  inputs: [{ name: "initial", type: "ParticleBatch", doc: "", required: false, many: true }],
  outputs: [{ name: "fluid", type: "Particles", doc: "" }],
  modules: [{ name: "predict", type: "Predict", enabled: true }, { name: "solver", type: "Pbf", enabled: true }],
};
const sampler: NodeType = {
  doc: "", source: "weir", parameters: [], inputs: [], outputs: [{ name: "particles", type: "ParticleBatch", doc: "" }],
};
const types: Types = { nodes: { ParticleFluid: fluid, BoxSampler: sampler }, modules: {}, world: [], sections: {} };

const link = { from: "box_sampler", output: "particles", to: "particle_fluid", input: "initial" };

function linked(): Scene {
  const [one] = addNode(emptyScene(), "BoxSampler", { x: 0, y: 0 });
  const [two] = addNode(one, "ParticleFluid", { x: 300, y: 0 });
  return addLink(two, link);
}

describe("expressions", () => {
  test("are what arithmetic says", () => {
    expect(evaluate("2*pi/3")).toBeCloseTo((2 * Math.PI) / 3, 12);
    expect(evaluate("-2^2 + (1 + 1)*3")).toBe(2);
    expect(evaluate("1e-3")).toBe(1e-3);
    expect(evaluate("sqrt(2)^2")).toBeCloseTo(2, 12);
  });
  test("that mean nothing are nothing", () => {
    for (const text of ["", "1+", "alert(1)", "1/0", "2 3", "(1", "--", "1e999"]) expect(evaluate(text)).toBeNull();
  });
});

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

describe("names of files", () => {
  test("come from titles", () => {
    expect(fileNameOf("A jet fills a goblet!")).toBe("a_jet_fills_a_goblet");
    expect(fileNameOf(undefined)).toBe("scene");
    expect(fileNameOf("…")).toBe("scene");
  });
  test("are numbered where they are taken", () => {
    const taken = new Set(["a.mp4", "a_001.mp4", "meshes/b.tar.gz", "c"]);
    const free = (path: string) => withNumber(path, (p) => taken.has(p));
    expect(free("x.mp4")).toBe("x.mp4");
    expect(free("a.mp4")).toBe("a_002.mp4");
    expect(free("c")).toBe("c_001");
    expect(free("meshes/b.tar.gz")).toBe("meshes/b.tar_001.gz");
  });
});

test("search finds letters in order, and word beginnings first", () => {
  const names = ["StaticBoundary", "SquareEmitter", "Sink", "SphereSampler"];
  expect(search("sqem", names, (n) => n)).toEqual(["SquareEmitter"]);
  expect(search("ss", names, (n) => n)[0]).toBe("SphereSampler");
});

describe("search", () => {
  // As the server tells them.
  const docs: { [name: string]: string } = {
    BoxSampler: "Fills a box with particles.", CircleEmitter: "A round nozzle that emits a jet of particles along its -y axis.",
    MeshEmitter: "Emits particles from the surface of a mesh, along the normals of its triangles.",
    ParticleFluid: "An incompressible liquid, simulated with particles (semi-implicit incompressible SPH).",
    SemiAnalyticalSFI: "Couples fluids with rigid triangle meshes, at rest or in motion.", SphereSampler: "Fills a sphere with particles.",
    StaticBoundary: "Solids or containers that do not move: shapes and meshes by signed distance.", Sink: "Removes the particles of fluids.",
    SurfaceTension: "Draws the fluid's surface together.", Xsph: "Smooths velocities between neighbours (artificial viscosity).",
  };
  const also: { [name: string]: string[] } = {
    BoxSampler: ["block", "cube", "dam", "fill", "water"], CircleEmitter: ["jet", "nozzle", "tap"], MeshEmitter: ["jet", "inflow", "rain"],
    ParticleFluid: ["water", "liquid", "viscosity"], SemiAnalyticalSFI: ["moving", "stirrer", "collider", "wall"], SphereSampler: ["ball", "drop", "droplet", "fill", "water"],
    StaticBoundary: ["tank", "wall", "collider", "container"], Sink: ["drain", "outflow"], SurfaceTension: ["drops", "cohesion"], Xsph: ["viscosity", "viscous", "honey"],
  };
  const find = (query: string) => search(query, Object.keys(docs), (name) => ({ name, doc: docs[name]!, synonyms: also[name]! }));
  test("knows the words of those who look for water, tanks, walls, jets and viscosity", () => {
    expect(find("water")[0]).toBe("ParticleFluid");
    expect(search("water", [{ name: "WhiteWater", synonyms: ["spray"] }, { name: "ParticleFluid", synonyms: ["water"] }], (i) => i)[0]!.name).toBe("ParticleFluid");
    expect(find("tank")[0]).toBe("StaticBoundary");
    expect(find("wall")).toContain("SemiAnalyticalSFI");
    expect(find("collider")[0]).toBe("StaticBoundary");
    expect(find("jet")[0]).toBe("MeshEmitter");
    expect(find("jet")).toContain("CircleEmitter");
    expect(find("visc")).toEqual(expect.arrayContaining(["Xsph", "ParticleFluid"]));
  });
  test("forgives typos, and not everything", () => {
    expect(find("smaplr")).toEqual(expect.arrayContaining(["BoxSampler", "SphereSampler"]));
    expect(find("emiter")[0]).toBe("MeshEmitter");
    expect(find("boundry")[0]).toBe("StaticBoundary");
    expect(find("surfcae tension")[0]).toBe("SurfaceTension");
    for (const nonsense of ["qqq", "xylophone", "zzzzzz"]) expect(find(nonsense)).toEqual([]);
  });
  test("ranks what is written so above letters that are scattered", () => {
    expect(find("emit").slice(0, 2)).toEqual(["MeshEmitter", "CircleEmitter"]);
    expect(find("emit")).not.toContain("SemiAnalyticalSFI");
    expect(find("box")[0]).toBe("BoxSampler");
    expect(find("sink")[0]).toBe("Sink");
  });
  test("measures slips", () => {
    expect([distance("abc", "abc"), distance("abc", "acb"), distance("abc", "ab"), distance("kitten", "sitting")]).toEqual([0, 1, 1, 3]);
  });
  test("has all words of a query", () => {
    expect(find("box sampler")).toEqual(["BoxSampler"]);
    expect(find("sphere particles")).toEqual(["SphereSampler"]);
  });
});

describe("what can be added", () => {
  test("is told apart by what it gives, whoever made it", () => {
    expect([roleOf(fluid).name, roleOf(sampler).name, roleOf(undefined).name]).toEqual(["Liquids", "Sources of particles", "Others"]);
    const plugin: NodeType = { ...sampler, outputs: [{ name: "out", type: "Boundary", doc: "" }] };
    expect(roleOf(plugin).icon).toBe("solid");
  });
  test("has a role each as its group", () => {
    expect(nodesToAdd(types, () => true, () => {}).map((i) => [i.name, i.group])).toEqual([["ParticleFluid", "Liquids"], ["BoxSampler", "Sources of particles"]]);
  });
  test("is, of modules, put into the node that is selected, or else the first that takes them", () => {
    const [two, second] = addNode(linked(), "ParticleFluid", { x: 0, y: 0 });
    expect(hostOf(two, types, "FluidModule", [])).toBe("particle_fluid");
    expect(hostOf(two, types, "FluidModule", ["box_sampler", second])).toBe(second);
    expect(hostOf(emptyScene(), types, "FluidModule", [])).toBeNull();
  });
});

describe("a graph", () => {
  test("folds all that is chosen, and unfolds where all are folded", () => {
    const names = ["box_sampler", "particle_fluid", "note-1"];
    const [first] = names;
    const mixed = collapse(linked(), [first!], true);
    const folded = toggleCollapsed(mixed, names);
    expect(Object.values(folded.layout!.nodes!).map((p) => p.collapsed)).toEqual([true, true]);
    expect(toggleCollapsed(folded, names)).toEqual(collapse(mixed, [first!], false));
    expect(toggleCollapsed(folded, ["note-1"])).toBe(folded);
  });
  test("has groups around nodes", () => {
    const boxes = [{ x: 0, y: 10, width: 100, height: 50 }, { x: 200.4, y: -30, width: 100, height: 60 }];
    const [group] = addGroupAround(linked(), "note-1", boxes).layout!.notes!;
    expect(group!.frame).toBe(true);
    for (const b of boxes) {
      expect(group!.x).toBeLessThan(b.x);
      expect(group!.y).toBeLessThan(b.y);
      expect(group!.x + group!.width).toBeGreaterThan(b.x + b.width);
      expect(group!.y + group!.height).toBeGreaterThan(b.y + b.height);
    }
    const scene = linked();
    expect(addGroupAround(scene, "note-1", [])).toBe(scene);
  });

  const note = { text: "", width: 100, height: 50, frame: false };
  /** A group with box_sampler, a note and a smaller group on it; particle_fluid and another note lie beside. */
  function grouped(): Scene {
    let scene = addNote(linked(), { ...note, id: "around", x: -20, y: -20, width: 250, height: 200, frame: true });
    scene = addNote(scene, { ...note, id: "on", x: 0, y: 100 });
    scene = addNote(scene, { ...note, id: "small", x: 10, y: 20, frame: true });
    return addNote(scene, { ...note, id: "half", x: 200, y: 0 });
  }
  test("has groups that take along what lies on them, once", () => {
    const scene = grouped();
    const at = (s: Scene) => ({ ...s.layout!.nodes, ...Object.fromEntries(notesOf(s).map((n) => [n.id, { x: n.x, y: n.y }])) });
    const moved = at(moveAll(scene, { around: { x: 80, y: -20 } }));
    expect(moved).toEqual({
      ...at(scene), around: { x: 80, y: -20 }, box_sampler: { x: 100, y: 0 }, on: { x: 100, y: 100 }, small: { x: 110, y: 20 },
    });
    // What is chosen too goes where it is put.
    expect(withCarried(scene, { around: { x: 0, y: 0 }, box_sampler: { x: 5, y: 6 } })["box_sampler"]).toEqual({ x: 5, y: 6 });
    expect(withCarried(scene, { on: { x: 9, y: 9 } })).toEqual({ on: { x: 9, y: 9 } });
    expect(at(moveAll(scene, { particle_fluid: { x: 301.4, y: 2 } }))["particle_fluid"]).toEqual({ x: 301, y: 2 });
  });
  test("copies notes and groups with the nodes", () => {
    const scene = grouped();
    const [next, names] = pasteNodes(scene, copyNodes(scene, ["box_sampler", "around", "half"]), 40);
    expect(names).toEqual(["note:1", "note:2", "box_sampler_2"]);
    expect(notesOf(next).slice(4)).toEqual([
      { ...notesOf(scene)[0], id: "note:1", x: 20, y: 20 }, { ...notesOf(scene)[3], id: "note:2", x: 240, y: 40 },
    ]);
    expect(notesOf(next).slice(0, 4)).toEqual(notesOf(scene));
    expect(freeNoteId(next)).toBe("note:3");
    expect(notesOf(removeNodes(next, names))).toEqual(notesOf(scene));
  });
});

describe("a scene", () => {
  test("gives new nodes free names", () => {
    const [, name] = addNode(linked(), "BoxSampler", { x: 0, y: 0 });
    expect(name).toBe("box_sampler_2");
    expect(nameProblem(linked(), "world", "box_sampler")).not.toBeNull();
  });
  test("refuses links that cannot be", () => {
    expect(linkProblem(linked(), types, link)).toBe("they are linked already");
    expect(linkProblem(linked(), types, { ...link, output: "smoke" })).toBe("there is no such port");
  });
  test("knows all links that a node may still get", () => {
    const [two] = addNode(linked(), "ParticleFluid", { x: 0, y: 0 }, "sea");
    expect(linksFor(two, types, "box_sampler").map(linkText)).toEqual(["box_sampler.particles -> sea.initial"]);
    expect(linksFor(two, types, "sea").map(linkText)).toEqual(["box_sampler.particles -> sea.initial"]);
    expect(linksFor(two, types, "particle_fluid")).toEqual([]);
  });
  test("keeps links when a node is renamed, and drops them when it goes", () => {
    expect(linksOf(renameNode(linked(), "particle_fluid", "water"))[0]!.to).toBe("water");
    expect(removeNodes(linked(), ["box_sampler"]).links).toEqual([]);
  });
  test("copies nodes with the links between them", () => {
    const clip = copyNodes(linked(), ["box_sampler", "particle_fluid"]);
    const [next, names] = pasteNodes(linked(), clip, 40);
    expect(names).toEqual(["box_sampler_2", "particle_fluid_2"]);
    expect(linksOf(next)).toContainEqual({ ...link, from: "box_sampler_2", to: "particle_fluid_2" });
  });
  test("leaves nothing behind where a parameter goes back to its default", () => {
    const owner = { node: "box_sampler" };
    const set = setParam(linked(), owner, ["group", "a"], 3);
    expect(set.nodes["box_sampler"]!.params).toEqual({ group: { a: 3 } });
    expect(setParam(set, owner, ["group", "a"], undefined).nodes["box_sampler"]!.params).toEqual({});
  });
  test("orders modules as the runner does", () => {
    const inserted = insertModule(linked(), "particle_fluid", fluid, "Xsph");
    const names = (s: Scene) => pipelineOf(s, "particle_fluid", fluid).map((m) => m.name);
    expect(names(inserted)).toEqual(["predict", "solver", "xsph"]);
    expect(names(moveModule(inserted, "particle_fluid", fluid, "xsph", -1))).toEqual(["predict", "xsph", "solver"]);
  });
});

describe("modules", () => {
  const names = (s: Scene) => pipelineOf(s, "particle_fluid", fluid).map((m) => m.name);
  const three = insertModule(insertModule(linked(), "particle_fluid", fluid, "Xsph"), "particle_fluid", fluid, "Drag");
  test("are inserted behind another one, or at the end", () => {
    expect(names(three)).toEqual(["predict", "solver", "xsph", "drag"]);
    expect(names(insertModule(three, "particle_fluid", fluid, "Tension", "predict"))).toEqual(["predict", "tension", "solver", "xsph", "drag"]);
    expect(names(insertModule(three, "particle_fluid", fluid, "Tension", "gone"))).toEqual(["predict", "solver", "xsph", "drag", "tension"]);
  });
  test("are dragged before any other one, or to the end", () => {
    const put = (module: string, before: string | null, s = three) => placeModule(s, "particle_fluid", fluid, module, before);
    expect(names(put("drag", "predict"))).toEqual(["drag", "predict", "solver", "xsph"]);
    expect(names(put("predict", null))).toEqual(["solver", "xsph", "drag", "predict"]);
    expect(names(put("xsph", "solver", put("drag", "solver")))).toEqual(["predict", "drag", "xsph", "solver"]);
    expect([put("xsph", "drag"), put("drag", null), put("drag", "drag"), put("gone", null)].every((s) => s === three)).toBe(true);
  });
});

describe("nodes that are switched off", () => {
  const port = (name: string, type: string, many = true) => ({ name, type, doc: "", required: false, many });
  const plain = { doc: "", source: "weir", parameters: [] };
  const solids: Types = {
    modules: {}, world: [], sections: {},
    nodes: {
      Mesh: { ...plain, inputs: [], outputs: [port("surface", "TriangleMesh")] },
      Walls: { ...plain, inputs: [port("meshes", "TriangleMesh"), port("boundaries", "Boundary")], outputs: [port("boundary", "Boundary")] },
      Water: { ...plain, inputs: [port("boundaries", "Boundary")], outputs: [] },
      One: { ...plain, inputs: [port("boundary", "Boundary", false)], outputs: [] },
    },
  };
  const scene: Scene = {
    weir: 1,
    nodes: { mesh: { type: "Mesh" }, floor: { type: "Walls" }, box: { type: "Walls" }, all: { type: "Walls" }, water: { type: "Water" }, one: { type: "One" } },
    links: [
      "mesh.surface -> all.meshes", "floor.boundary -> all.boundaries", "box.boundary -> all.boundaries",
      "all.boundary -> water.boundaries", "all.boundary -> one.boundary",
    ],
  };
  const runs = (s: Scene) => forRunner(s, solids);

  test("are not in what the runner gets when they are muted, nor are their links", () => {
    const muted = runs(setOff(scene, ["all"], "muted"));
    expect(Object.keys(muted.nodes)).not.toContain("all");
    expect(muted.links).toEqual([]);
  });
  test("pass on what comes in at the input of the same type when they are bypassed", () => {
    expect(inputFor(solids.nodes["Walls"], "boundary")).toBe("boundaries");
    expect(inputFor(solids.nodes["Mesh"], "surface")).toBeNull();
    const bypassed = setOff(scene, ["all"], "bypassed");
    // An input that takes one link only gets the first.
    expect(runs(bypassed).links).toEqual([
      "floor.boundary -> water.boundaries", "box.boundary -> water.boundaries", "floor.boundary -> one.boundary",
    ]);
    const [mesh, floor] = linksOf(scene);
    expect([carries(bypassed, solids, mesh!), carries(bypassed, solids, floor!)]).toEqual([false, true]);
  });
  test("give nothing where nothing comes in", () => {
    const flowing = (s: Scene) => linksOf(s).filter((l) => carries(s, solids, l)).map((l) => `${l.from} ${l.to}`);
    const bypassed = setOff(scene, ["all"], "bypassed");
    expect(flowing(bypassed)).toEqual(["floor all", "box all", "all water", "all one"]);
    expect(flowing(setOff(bypassed, ["floor"], "muted"))).toEqual(["box all", "all water", "all one"]);
    expect(flowing(setOff(bypassed, ["floor", "box"], "muted"))).toEqual([]);
    // Bypassed themselves, they have nothing to pass on.
    expect(flowing(setOff(bypassed, ["floor", "box"], "bypassed"))).toEqual([]);
  });
  test("pass on through each other, and nothing of what is muted", () => {
    const chain = addLink(scene, { from: "mesh", output: "surface", to: "floor", input: "meshes" });
    expect(runs(setOff(chain, ["all", "floor"], "bypassed")).links).toEqual(["box.boundary -> water.boundaries", "box.boundary -> one.boundary"]);
    expect(runs(setOff(setOff(scene, ["all"], "bypassed"), ["floor"], "muted")).links).toEqual([
      "box.boundary -> water.boundaries", "box.boundary -> one.boundary",
    ]);
  });
  test("are found again in a file as they were", () => {
    const off = setOff(setOff(scene, ["all"], "bypassed"), ["mesh", "water"], "muted");
    const read = fromFile(JSON.parse(JSON.stringify(runs(off))) as Scene);
    expect(new Set(read.links)).toEqual(new Set(scene.links));
    expect(read.nodes).toEqual(scene.nodes);
    expect([offOf(read, "all"), offOf(read, "mesh"), offOf(read, "box")]).toEqual(["bypassed", "muted", undefined]);
    expect(runs(read)).toEqual({ ...runs(off), links: expect.arrayContaining(runs(off).links!) });
    expect(runs(scene)).toBe(scene);
  });
  test("are switched on again when all of them are off in the same way", () => {
    const both = toggleOff(toggleOff(scene, ["all"], "muted"), ["all", "floor"], "muted");
    expect([offOf(both, "all"), offOf(both, "floor")]).toEqual(["muted", "muted"]);
    expect(offOf(toggleOff(both, ["all", "floor"], "muted"), "floor")).toBeUndefined();
    expect(offOf(toggleOff(both, ["all"], "bypassed"), "all")).toBe("bypassed");
  });
  test("keep a circle in a file from lasting for ever", () => {
    const circle = addLink(setOff(scene, ["all", "box"], "bypassed"), { from: "all", output: "boundary", to: "box", input: "boundaries" });
    expect(runs(circle).links).toEqual(["floor.boundary -> water.boundaries", "floor.boundary -> one.boundary"]);
  });
});

describe("keyframes", () => {
  const frames: Keyframe[] = [[0, [0, 1, 2]], [2, [4, 1, 0]]];
  test("are linear between them and held at the ends", () => {
    expect(valueAt(frames, 0.5)).toEqual([1, 1, 1.5]);
    expect([valueAt(frames, -1), valueAt(frames, 9)]).toEqual([frames[0]![1], frames[1]![1]]);
  });
  test("take a point that is moved, added or taken away in one of their numbers", () => {
    expect(withPoints(frames, 0, [[0, 0], [3, 5]])).toEqual([[0, [0, 1, 2]], [3, [5, 1, 0]]]);
    expect(withPoints(frames, 1, [[0, 1], [1, 7], [2, 1]])).toEqual([frames[0], [1, [2, 7, 1]], frames[1]]);
    expect(withPoints(frames, 2, [[2, 0]])).toEqual([frames[1]]);
  });
  test("stay in order when a time changes", () => {
    expect(withTime(frames, 0, 3).map((f) => f[0])).toEqual([2, 3]);
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

test("tables show whole numbers whole, and four digits of others", () => {
  expect(shortText(2 ** 40 + 5)).toBe("1099511627781");
  expect([12345, 1234.56, [0.123456, -98765.4], null].map(shortText)).toEqual(["12345", "1235", "0.1235, -98770", "–"]);
});

describe("playback of recorded frames", () => {
  const pace = { rate: 30, speed: 1, way: 1 as const, loop: false, last: 60 };
  test("goes by the clock, forwards and backwards", () => {
    expect(advance(10, 0.5, pace)).toEqual({ at: 25, ended: false });
    expect(advance(10, 0.5, { ...pace, speed: 0.1 }).at).toBeCloseTo(11.5);
    expect(advance(40, 1, { ...pace, way: -1 }).at).toBe(10);
    expect(advance(0, -0.01, pace)).toEqual({ at: 0, ended: false });
  });
  test("ends at the ends, or begins anew", () => {
    expect(advance(50, 1, pace)).toEqual({ at: 60, ended: true });
    expect(advance(5, 1, { ...pace, way: -1 })).toEqual({ at: 0, ended: true });
    expect(advance(50, 1, { ...pace, loop: true })).toEqual({ at: 19, ended: false });
    expect(advance(5, 1, { ...pace, loop: true, way: -1 })).toEqual({ at: 36, ended: false });
    expect(advance(0, 1, { ...pace, loop: true, last: 0 })).toEqual({ at: 0, ended: true });
  });
});

test("frames that are kept where memory is short are marked, and no others", () => {
  expect([recordedFrames(3, 1), recordedFrames(9, 4), recordedFrames(0, 8)]).toEqual([[0, 1, 2, 3], [0, 4, 8], [0]]);
});

describe("rulers", () => {
  test("have round ticks, few enough", () => {
    expect(ticks(0, 150, 12)).toEqual([0, 20, 40, 60, 80, 100, 120, 140]);
    expect(ticks(0.13, 0.58, 4)).toEqual([0.2, 0.4]);
    expect(ticks(1, 1, 4)).toEqual([1]);
    expect(niceStep(0.03)).toBe(0.05);
    for (const high of [1, 7, 33, 1e-6, 12345]) expect(ticks(0, high, 5).length).toBeLessThanOrEqual(6);
  });
  test("count in words", () => {
    expect([counted(0, "frame"), counted(1, "frame"), counted(2000, "frame")]).toEqual(["0 frames", "1 frame", "2,000 frames"]);
  });
});

test("plots read off the last value before a time", () => {
  const points = [[0, 5], [1, 6], [2, 7]] as const;
  expect([-1, 0, 0.5, 1, 9].map((t) => pointAt([...points], t)[1])).toEqual([5, 5, 5, 6, 7]);
  expect([unitOf("water.kinetic_energy"), unitOf("step (ms)"), titleOf("water.compression.mean")]).toEqual(["J", "ms", "water: compression mean"]);
});

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

describe("the health of a run", () => {
  const report = (mean: number, escaped = 0, bad = 0) => ({ nodes: { water: { particles: 1000, compression: { mean, max: 2 * mean }, particles_escaped: escaped, particles_not_finite: bad }, tank: { type: "StaticBoundary" } } });
  const levels = (numbers: ReturnType<typeof report>) => lightsOf(numbers, []).map((l) => l.level);
  test("is told by compression and lost particles, with the node", () => {
    expect(levels(report(0.0006))).toEqual(["good", "good", "unknown", "unknown"]);
    expect(levels(report(0.02))[0]).toBe("watch");
    expect(levels(report(1.78))[0]).toBe("bad");
    expect(lightsOf(report(1.78), [])[0]).toMatchObject({ value: "180 %", node: "water" });
    expect(levels(report(0, 1))[1]).toBe("watch");
    expect(levels(report(0, 0, 5))[1]).toBe("bad");
    expect(lightsOf(null, []).map((l) => l.level)).toEqual(["unknown", "unknown", "unknown", "unknown"]);
  });
  test("is told by how many spacings a particle flies in a step", () => {
    const told = (max_speed: number, rare_events: JsonObject[] = []) => ({ time_step: { longest: 0.001 }, rare_events, nodes: { water: { max_speed }, foam: { max_speed: 1e6 } } });
    const cfl = (max_speed: number, bound: number | null = null, events: JsonObject[] = []) => lightsOf(told(max_speed, events), [], { spacings: { water: 0.01 }, cfl: bound })[3]!;
    expect(cfl(4)).toMatchObject({ level: "good", value: "0.4", node: "water" });
    expect(cfl(6).level).toBe("watch");
    expect(cfl(40)).toMatchObject({ level: "bad", value: "4" });
    expect(cfl(40).why).toContain("4 spacings in a step of 0.001 s");
    // Steps that follow the motion are as short as they should be, unless they may not be.
    expect(cfl(40, 0.5)).toMatchObject({ level: "good", value: "0.5" });
    expect(cfl(40, 0.5, [{ node: "world", what: "steps were longer than cfl allows", count: 3 }]).level).toBe("bad");
    const fluids: Types = { ...types, nodes: { Fluid: { ...fluid, parameters: [{ name: "spacing", kind: "float", doc: "", default: 0.02, live: false, animated: false }] } } };
    const wet: Scene = { weir: 1, world: { cfl: 0.5 }, nodes: { water: { type: "Fluid" }, oil: { type: "Fluid", params: { spacing: 0.01 } }, box: { type: "Box" } } };
    expect(measuresOf(wet, fluids, 2)).toEqual({ spacings: { water: 0.04, oil: 0.02 }, cfl: 0.5 });
    const world = [{ name: "cfl", kind: "float", doc: "", default: null, live: false, animated: false }];
    expect(followMotion({ weir: 1, nodes: {} }, world)!.change({ weir: 1, nodes: {} })["world"]).toEqual({ cfl: 0.5 });
    expect(followMotion(wet, world)).toBeNull();
  });
  test("is told by energy that grows while no particles come", () => {
    const sample = (time: number, kinetic: number, potential: number, particles = 10) => ({ time, values: { "water.kinetic_energy": kinetic, "water.potential_energy": potential, particles } });
    const energy = (...samples: ReturnType<typeof sample>[]) => lightsOf(null, samples)[2]!.level;
    expect(energy(sample(0, 0, 10), sample(1, 4, 5.9), sample(2, 2, 4))).toBe("good");
    expect(energy(sample(0, 0, 10), sample(1, 4, 6.5))).toBe("good");
    expect(energy(sample(0, 0, 10), sample(1, 4, 8.5))).toBe("watch");
    expect(energy(sample(0, 1, 1), sample(1, 40, 1))).toBe("bad");
    expect(energy(sample(0, 1, 1, 10), sample(1, 40, 1, 20))).toBe("unknown");
  });
  test("is as bad as its worst light", () => {
    expect(worst([{ level: "good" }, { level: "bad" }, { level: "watch" }])).toBe("bad");
    expect(worst([])).toBe("unknown");
  });
  test("has the warnings of this run, each once, at their nodes", () => {
    const log = [
      { level: "warning" as const, text: "node 'cup': the mesh has holes", at: 5 }, { level: "warning" as const, text: "node 'nozzle': changes the flux by +15 %", at: 20 },
      { level: "warning" as const, text: "node 'nozzle': changes the flux by +15 %", at: 21 }, { level: "info" as const, text: "node 'water': built", at: 22 },
    ];
    expect(warningsOf(["tank: is thin"], { rare_events: [{ node: "water", what: "particles left the domain", count: 3 }] }, log, 10, ["tank", "water", "nozzle"])).toEqual([
      { text: "tank: is thin", node: "tank", count: 1 }, { text: "water: 3 particles left the domain", node: "water", count: 1 },
      { text: "node 'nozzle': changes the flux by +15 %", node: "nozzle", count: 2 },
    ]);
    expect([nodeIn("/links/0: 'a.b' is wrong", ["a"]), nodeIn("nothing", ["nothing"])]).toEqual(["a", null]);
  });
});

test("a camera that is fitted sees all of a box, and no more than it must", () => {
  for (const [size, aspect] of [[[1, 1, 1], 2], [[0.2, 3, 0.2], 1.6], [[5, 0.5, 1], 0.7]] as const)
    for (const direction of [[0.8, 0.6, 1], [0, 1, 0.001], [0, 1, 0], [-1, 0.2, 0]]) {
      const half = new Vector3(...size).multiplyScalar(0.5), d = new Vector3(...direction).normalize();
      const tall = Math.tan((20 * Math.PI) / 180);
      const camera = new PerspectiveCamera(40, aspect, 0.001, 100);
      camera.position.copy(d).multiplyScalar(distanceFor(new Box3(half.clone().negate(), half), d, tall, tall * aspect));
      camera.lookAt(0, 0, 0);
      camera.updateMatrixWorld();
      const seen = [...Array(8).keys()].map((i) => half.clone().multiply(new Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)).project(camera));
      const outermost = Math.max(...seen.flatMap((p) => [Math.abs(p.x), Math.abs(p.y)]));
      expect(outermost).toBeGreaterThan(0.99);
      expect(outermost).toBeLessThan(1.01);
    }
});

describe("parameters", () => {
  const parameter = (name: string, more: Partial<Parameter> = {}): Parameter => ({ name, kind: "float", doc: "", default: 1, live: false, animated: false, ...more });
  const only = (...choices: string[]) => ({ only_for: { parameter: "shape", choices } });
  const all = [
    parameter("shape", { kind: "enum", default: "none", choices: { none: "", box: "", cone: "" } }), parameter("min", only("box")), parameter("height", only("cone", "box")),
    parameter("friction"),
  ];
  const used = (values: JsonObject) => all.filter((p) => isUsed(p, all, values)).map((p) => p.name);
  test("have labels that people read", () => {
    expect(["rest_density", "shape", "dt", "min_dt", "cfl", "mu"].map(labelOf)).toEqual(["Rest density", "Shape", "dt", "Min dt", "CFL", "µ"]);
  });
  test("that mean nothing under the present choice are known", () => {
    expect(used({})).toEqual(["shape", "friction"]);
    expect(used({ shape: "cone" })).toEqual(["shape", "height", "friction"]);
    expect(used({ shape: { keyframes: [[0, "box"]] } })).toEqual(["shape", "min", "height", "friction"]);
  });
  test("go with the choice that gave them a meaning, and come back with it", () => {
    const cone = afterChoice(all, { shape: "cone", min: 2, height: 3, friction: 4, strange: 5 }, {});
    expect(cone).toEqual({ values: { shape: "cone", height: 3, friction: 4, strange: 5 }, left: { min: 2 } });
    const none = afterChoice(all, { ...cone.values, shape: "none" }, cone.left);
    expect(none).toEqual({ values: { shape: "none", friction: 4, strange: 5 }, left: { min: 2, height: 3 } });
    expect(afterChoice(all, { ...none.values, shape: "box", height: 7 }, none.left)).toEqual({ values: { shape: "box", min: 2, height: 7, friction: 4, strange: 5 }, left: {} });
  });
});

test("a path that cannot be written has a sentence that says why", () => {
  for (const fine of ["a.json", "folder/a", "a..b.json"]) expect(pathProblem(fine)).toBeNull();
  expect(pathProblem("../a.json")).toContain("below the served folder");
  expect(pathProblem("/a.json")).toContain("below the served folder");
  expect(["", "folder/", "a\\b", ".a.json", "b/.git/c"].map((p) => pathProblem(p) !== null)).toEqual([true, true, true, true, true]);
});

test("a menu has no lines above, below, or twice", () => {
  const item = (name: string) => ({ name, take: () => {} });
  expect(menuOf(null, item("a"), false, null, null, item("b"), null).map((i) => i?.name)).toEqual(["a", undefined, "b"]);
});

test("steps of half the length help: by CFL where the scene has it, or else by dt", () => {
  const world: Parameter[] = [
    { name: "dt", kind: "float", unit: "s", doc: "", default: 0.001, above: 0, live: false, animated: false }, { name: "cfl", kind: "float", doc: "", default: null, above: 0, live: false, animated: false },
  ];
  const remedy = (given: JsonObject) => shorterSteps({ ...emptyScene(), world: given }, world)!;
  expect([remedy({}).text, remedy({ dt: 0.004 }).text, remedy({ dt: 0.004, cfl: 1 }).text]).toEqual([
    "Halve dt to 0.0005 s and begin anew", "Halve dt to 0.002 s and begin anew", "Halve cfl to 0.5 and begin anew",
  ]);
  expect(remedy({ cfl: 1 }).change(emptyScene())["world"]).toEqual({ cfl: 0.5 });
  expect(shorterSteps(emptyScene(), [])).toBeNull();
});

/** A frame of two particles of one fluid. */
const frameOf = (frame: number, time: number): FramePacket => ({
  kind: "frame", frame, time, poses: {},
  fluids: [{
    node: "water", total: 16, count: 2, spacing: 0.1, low: [0, 0, 0], high: [1, 2, 3], positions: Uint16Array.of(0, 0, 0, 65535, 65535, 65535), ids: Float64Array.of(1, 2), attributes: ["speed"],
    attribute: { name: "speed", unit: "m/s", low: 0, high: 4, values: Uint16Array.of(0, 65535) },
  }],
});
const runOf = (values: number[]): Run => ({
  label: "A", scene: emptyScene(), frames: [], geometry: null, samples: values.map((v, i) => ({ time: i / 10, values: { "water.kinetic_energy": v, "water.compression.mean": v / 100 } })),
});

describe("runs that are kept", () => {
  test("show the frame nearest to a time", () => {
    const frames = [frameOf(0, 0), frameOf(5, 0.5), frameOf(10, 1)];
    expect([-1, 0.2, 0.3, 0.76, 9].map((t) => frameAt(frames, t)!.frame)).toEqual([0, 0, 5, 10, 10]);
    expect(frameAt([], 1)).toBeNull();
  });
  test("have own copies of what is seen, and no more frames than there is room for", () => {
    const frame = frameOf(0, 0), kept = lean(frame);
    frame.fluids[0]!.positions.fill(7);
    expect([...kept.fluids[0]!.positions]).toEqual([0, 0, 0, 65535, 65535, 65535]);
    expect(kept.fluids[0]!.ids.length).toBe(0);
    // 16 bytes a frame.
    expect([strideFor(frame, 10, 160), strideFor(frame, 10, 159), strideFor(frame, 10, 16), strideFor(frame, 10, Infinity)]).toEqual([1, 2, 10, 1]);
  });
  test("differ in what decides a run, and in nothing else", () => {
    const a: Scene = {
      weir: 1, title: "A", world: { dt: 0.001 }, links: ["a.x -> b.y"], layout: { nodes: { water: { x: 0, y: 0 } } },
      nodes: { water: { type: "ParticleFluid", params: { spacing: 0.1, rest: { steps: 3 } }, modules: { viscosity: { params: { strength: 0.1 } } } }, tap: { type: "Emitter" } },
    };
    const b: Scene = {
      weir: 1, title: "B", world: { dt: 0.001, gravity: [0, -1, 0] }, links: ["a.x -> b.z"],
      nodes: { water: { type: "ParticleFluid", params: { rest: { steps: 4 } }, modules: { viscosity: { enabled: false, params: { strength: 0.2 } } } }, wall: { type: "StaticBoundary" } },
    };
    expect(differencesOf(a, a)).toEqual([]);
    const found = differencesOf(a, b);
    expect(found.map((d) => [d.name, d.before, d.after])).toEqual([
      ["water: Spacing", 0.1, undefined], ["water: Rest / Steps", 3, 4], ["water / viscosity: Strength", 0.1, 0.2], ["water / viscosity: enabled", undefined, false],
      ["tap", "Emitter", undefined], ["wall", undefined, "StaticBoundary"], ["link", "a.x -> b.y", undefined], ["link", undefined, "a.x -> b.z"], ["World: Gravity", undefined, [0, -1, 0]],
    ]);
    expect(found[2]).toMatchObject({ node: "water", module: "viscosity", path: ["strength"] });
    expect(found.at(-1)!.path).toEqual(["world", "gravity"]);
  });
});

describe("sweeps", () => {
  const strength: Parameter = { name: "strength", kind: "float", doc: "", default: 0.1, live: true, animated: false, min: 0, max: 0.3 };
  test("begin around the value that there is, within what is allowed", () => {
    expect(firstValues(strength, 0.1)).toEqual([0.05, 0.07071, 0.1, 0.1414, 0.2]);
    expect(firstValues(strength, 0.2)).toEqual([0.1, 0.1414, 0.2, 0.2828]);
    expect(firstValues({ ...strength, kind: "int", min: 1, max: 9 }, 2)).toEqual([1, 2, 3, 4]);
    expect(firstValues({ ...strength, kind: "enum", choices: { a: "", b: "" } }, "a")).toEqual(["a", "b"]);
    expect(evenly(0, 1, 3, true)).toEqual([0, 0.5, 1]);  // no ratio leads away from 0
    expect(evenly(1, 100, 3, true)).toEqual([1, 10, 100]);
  });
  test("take values as they are typed, and say what is wrong with them", () => {
    expect(readValues(strength, "0.1, 2*0.1; 0.1 0")).toEqual({ values: [0.1, 0.2, 0], problem: null });
    expect(readValues(strength, "0.1, 7").problem).toMatch(/7 cannot be.*at most 0.3/);
    expect(readValues(strength, "0.1, wide").problem).toMatch(/wide cannot be/);
    expect(readValues(strength, "0.1").problem).toMatch(/Two/);
    expect(readValues({ ...strength, kind: "enum", choices: { a: "", b: "" } }, "a, c").problem).toMatch(/c cannot be.*a, b/);
  });
  test("are read off, and make a table", () => {
    const { samples } = runOf([1, 5, 3]);
    expect((["last", "mean", "most", "least"] as const).map((r) => readOff(samples, "water.kinetic_energy", r))).toEqual([3, 3, 5, 1]);
    expect(readOff(samples, "nothing", "last")).toBeNull();
    // As it is shown: percent.
    expect(readOff(samples, "water.compression.mean", "last")).toBeCloseTo(3);
    expect(tableOf("strength", [{ value: 0.1, run: runOf([1]) }, { value: 0.2, run: null, problem: "no" }])).toBe(
      "strength,water.kinetic_energy,water.compression.mean\n0.1,1,0.01\n0.2,,\n");
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
    const own = box("uuid", Uint8Array.of(...bytes(kBox), ...new TextEncoder().encode(scene)));
    const video = Uint8Array.of(...box("ftyp", bytes("isom")), ...box("uuid", bytes("another program.")), ...box("mdat", new Uint8Array(300)), ...own);
    expect(sceneIn(video)).toBe(scene);
    expect(sceneIn(video.slice(0, -1))).toBeNull();
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

/** By WCAG 2, of two colours "#rrggbb". */
function contrast(a: string, b: string): number {
  const light = (hex: string) => {
    const [r, g, b] = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255).map((c) => (c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r! + 0.7152 * g! + 0.0722 * b!;
  };
  const [dark, bright] = [light(a), light(b)].sort((x, y) => x - y);
  return (bright! + 0.05) / (dark! + 0.05);
}

test.each([["light", /:root \{([^}]*)\}/], ["dark", /:root\[data-theme="dark"\] \{([^}]*)\}/]] as const)("borders of fields and texts stand out in the %s", (_, sheet) => {
  const colors = Object.fromEntries([...sheet.exec(css)![1]!.matchAll(/--([a-z-]+): (#[0-9a-f]{6});/g)].map(([, name, hex]) => [name, hex!]));
  for (const ground of ["panel", "back"]) {
    expect(contrast(colors["edge"]!, colors[ground]!)).toBeGreaterThanOrEqual(3);
    for (const text of ["text", "soft", "accent", "wrong", "other"]) expect(contrast(colors[text]!, colors[ground]!), `${text} on ${ground}`).toBeGreaterThanOrEqual(4.5);
  }
  expect(contrast(colors["accent-text"]!, colors["accent"]!)).toBeGreaterThanOrEqual(4.5);
});

describe("boxes with handles", () => {
  const vector = (name: string, value: number[]): Parameter => ({ name, kind: "vec3", doc: "", default: value, live: false, animated: false });
  const parameters = [vector("min", [0, 0, 0]), vector("max", [1, 1, 1]), { ...vector("shape", []), kind: "enum", default: "none" }, { ...vector("rotation", [0, 0, 0]), kind: "rotation" }];
  const withTypes: Types = { ...types, nodes: { Wall: { ...sampler, parameters }, Block: { ...sampler, parameters: parameters.slice(0, 2) } } };
  const box = (type: string, params: JsonObject) => boxOf({ weir: 1, nodes: { it: { type, params } } }, withTypes, "it");
  test("are those along the axes that stay as they are", () => {
    expect(box("Block", { max: [1, 2, 3] })).toEqual({ min: [0, 0, 0], max: [1, 2, 3] });
    expect(box("Wall", { shape: "box" })).toEqual({ min: [0, 0, 0], max: [1, 1, 1] });
    expect([box("Wall", {}), box("Wall", { shape: "box", rotation: [0, 9, 0] }), box("Block", { max: { keyframes: [[0, [1, 1, 1]]] } }), box("Nothing", {})]).toEqual([null, null, null, null]);
  });
  test("have faces that do not pass each other", () => {
    const whole = { min: [0, 0, 0], max: [1, 2, 4] };
    expect(withFace(whole, "max", 1, 1.23456)).toEqual({ min: [0, 0, 0], max: [1, 1.235, 4] });
    expect(withFace(whole, "min", 2, 9)).toEqual({ min: [0, 0, 3.96], max: [1, 2, 4] });
  });
});

test("a problem that names a choice of its node offers the others", () => {
  const shape: Parameter = { name: "shape", kind: "enum", doc: "", default: "none", live: false, animated: false, choices: { none: "", box: "", sphere: "" } };
  const withTypes: Types = { ...types, nodes: { Wall: { ...sampler, parameters: [shape] } } };
  const scene: Scene = { weir: 1, nodes: { tank: { type: "Wall" } } };
  const remedies = otherChoices({ message: "the boundary is empty: it has no shape", node: "tank" }, scene, withTypes);
  expect(remedies.map((r) => r.text)).toEqual(["Shape: box", "Shape: sphere"]);
  expect(remedies[0]!.change(scene).nodes["tank"]!.params).toEqual({ shape: "box" });
  expect(otherChoices({ message: "no link", node: "tank" }, scene, withTypes)).toEqual([]);
  expect(otherChoices({ message: "no shape", node: "gone" }, scene, withTypes)).toEqual([]);
});
