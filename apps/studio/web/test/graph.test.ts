// What the graph of a scene is made of, and how it is changed.
import { describe, expect, test } from "vitest";
import { addNote, moveAll, notesOf, withCarried } from "../src/model/notes";
import {
  addGroupAround, addLink, addNode, collapse, copyNodes, emptyScene, freeNoteId, insertModule, linkProblem, linksFor, linksOf, linkText, moveModule, nameProblem, pasteNodes, pipelineOf, placeModule, removeNodes, renameNode, setParam, toggleCollapsed, type Scene,
} from "../src/model/scene";
import { hostOf, nodesToAdd } from "../src/graph/addable";
import { roleOf } from "../src/model/roles";
import { carries, forRunner, fromFile, inputFor, offOf, setOff, toggleOff } from "../src/model/switchedOff";
import type { NodeType, Types } from "../src/model/types";
import { fluid, sampler, types, link, linked } from "./samples";

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
