// Values: what is typed, which of them mean something, and how they go over time.
import { describe, expect, test } from "vitest";
import { evaluate } from "../src/model/expression";
import { valueAt, withPoints, withTime, type Keyframe } from "../src/model/keyframes";
import { afterChoice, isUsed, labelOf } from "../src/model/parameters";
import type { JsonObject, Parameter } from "../src/model/types";

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
