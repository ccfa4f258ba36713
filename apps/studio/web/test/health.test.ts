// What is told of a run that goes wrong, and what helps.
import { describe, expect, test } from "vitest";
import { emptyScene, type Scene } from "../src/model/scene";
import { followMotion, moreIterations, otherChoices, shorterSteps } from "../src/model/remedy";
import { lightsOf, measuresOf, nodeIn, warningsOf, worst } from "../src/model/health";
import type { JsonObject, Parameter, Types } from "../src/model/types";
import { fluid, sampler, types } from "./samples";

describe("the health of a run", () => {
  const report = (mean: number, escaped = 0, bad = 0) => ({ nodes: { water: { particles: 1000, compression: { mean, max: 2 * mean }, particles_escaped: escaped, particles_not_finite: bad }, tank: { type: "StaticBoundary" } } });
  const levels = (numbers: ReturnType<typeof report>) => lightsOf(numbers, []).map((l) => l.level);
  test("is told by compression and lost particles, with the node", () => {
    expect(levels(report(0.0006))).toEqual(["good", "good", "unknown", "unknown", "unknown"]);
    expect(levels(report(0.02))[0]).toBe("watch");
    expect(levels(report(1.78))[0]).toBe("bad");
    expect(lightsOf(report(1.78), [])[0]).toMatchObject({ value: "180 %", node: "water" });
    expect(levels(report(0, 1))[1]).toBe("watch");
    expect(levels(report(0, 0, 5))[1]).toBe("bad");
    expect(lightsOf(null, []).map((l) => l.level)).toEqual(["unknown", "unknown", "unknown", "unknown", "unknown"]);
  });
  test("is told by how many spacings a particle flies in a step", () => {
    const told = (max_speed: number, rare_events: JsonObject[] = []) => ({ time_step: { longest: 0.001 }, rare_events, nodes: { water: { max_speed }, foam: { max_speed: 1e6 } } });
    const cfl = (max_speed: number, bound: number | null = null, events: JsonObject[] = []) => lightsOf(told(max_speed, events), [], { spacings: { water: 0.01 }, cfl: bound })[3]!;
    expect(cfl(4)).toMatchObject({ level: "good", value: "0.4", node: "water" });
    expect(cfl(5.02)).toMatchObject({ level: "good", value: "0.5" });
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
  test("is told by the steps that met the tolerance of their solver", () => {
    const of = (nodes: { [node: string]: JsonObject }, steps = 200) => lightsOf({ steps, nodes }, []).at(-1)!;
    const pressure = (not_converged: number, mean = 14.26) => ({ solver_iterations: { mean, max: 60, last: 12, not_converged } });
    expect(of({ water: pressure(0) })).toMatchObject({ name: "Convergence", level: "good", value: "100 %", node: "water" });
    expect(of({ water: pressure(0) }).why).toBe("With 14 iterations on average, each step of water met the solver's tolerance.");
    expect(of({ water: pressure(2) })).toMatchObject({ level: "good", value: "99 %" });
    expect(of({ water: pressure(1) }, 4000).value).toBe("99.9 %");
    expect(of({ water: pressure(3), oil: pressure(20) })).toMatchObject({ level: "watch", value: "90 %", node: "oil" });
    expect(of({ water: pressure(21) }).why).toContain("21 of 200 steps of water ended before the solver's tolerance was met");
    expect(of({ water: pressure(21) }).level).toBe("bad");
    // Viscosity is solved for, too; a solver without a tolerance tells nothing.
    const honey = { ...pressure(0), viscosity_steps_not_converged: 50, viscosity_iterations_mean: 99 };
    expect(of({ honey })).toMatchObject({ level: "bad", value: "75 %", node: "honey" });
    expect(of({ water: { solver_iterations: 3 } })).toMatchObject({ level: "unknown", value: "–" });
    expect(of({ water: { solver_iterations: 3 } }).why).toContain("water makes 3 iterations in each step");
    expect(of({ tank: { type: "StaticBoundary" } }).level).toBe("unknown");
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

test("iterations help that a scene allows its solver fewer of than there would be", () => {
  const most: Parameter = { name: "max_iterations", kind: "int", doc: "", default: 1000, live: true, animated: false };
  const solving: Types = { ...types, modules: { Pbf: { doc: "", source: "weir", family: "FluidModule", parameters: [most] } } };
  const scene = (given: JsonObject): Scene => ({ weir: 1, nodes: { water: { type: "ParticleFluid", modules: { solver: { params: given } } } } });
  const remedy = moreIterations(scene({ max_iterations: 2, step: 1 }), solving, "water")!;
  expect(remedy.text).toBe("Set max_iterations to 1000 and begin anew");
  expect(remedy.change(scene({ max_iterations: 2, step: 1 })).nodes["water"]!.modules!["solver"]!.params).toEqual({ step: 1 });
  for (const given of [{}, { max_iterations: 1000 }, { max_iterations: 5000 }] as JsonObject[]) expect(moreIterations(scene(given), solving, "water")).toBeNull();
  expect(moreIterations(scene({ max_iterations: 2 }), types, "water")).toBeNull();
  expect(moreIterations(scene({}), solving, "gone")).toBeNull();
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
