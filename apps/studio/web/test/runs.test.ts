// Whole runs: kept and compared, and sweeps of a value.
import { describe, expect, test } from "vitest";
import type { Scene } from "../src/model/scene";
import { differencesOf, frameAt, lean, strideFor } from "../src/model/runs";
import { evenly, firstValues, readOff, readValues, tableOf } from "../src/model/sweep";
import type { Parameter } from "../src/model/types";
import { frameOf, runOf } from "./samples";

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
