// The parts of the page that know no browser.
import { describe, expect, test } from "vitest";
import { evaluate } from "../src/model/expression";
import { valueAt, withPoints, withTime, type Keyframe } from "../src/model/keyframes";
import {
  addLink, addNode, copyNodes, emptyScene, insertModule, linkProblem, linksOf, moveModule, mute, nameProblem, pasteNodes,
  pipelineOf, removeNodes, renameNode, setParam, type Scene,
} from "../src/model/scene";
import { search } from "../src/model/search";
import type { NodeType, Types } from "../src/model/types";
import { readPacket } from "../src/protocol/packets";

const fluid: NodeType = {
  doc: "", source: "weir", parameters: [], family: "FluidModule",
  inputs: [{ name: "initial", type: "ParticleBatch", doc: "", required: false, many: true }],
  outputs: [{ name: "fluid", type: "Fluid", doc: "" }],
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

test("search finds letters in order, and word beginnings first", () => {
  const names = ["StaticBoundary", "SquareEmitter", "Sink", "SphereSampler"];
  expect(search("sqem", names, (n) => n)).toEqual(["SquareEmitter"]);
  expect(search("ss", names, (n) => n)[0]).toBe("SphereSampler");
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
  test("keeps links when a node is renamed, and drops them when it goes", () => {
    expect(linksOf(renameNode(linked(), "particle_fluid", "water"))[0]!.to).toBe("water");
    expect(removeNodes(linked(), ["box_sampler"]).links).toEqual([]);
  });
  test("parks muted nodes and takes them back as they were", () => {
    const muted = mute(linked(), "box_sampler", true);
    expect(Object.keys(muted.nodes)).toEqual(["particle_fluid"]);
    expect(linksOf(mute(muted, "box_sampler", false))).toEqual(linksOf(linked()));
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
