// Time that has passed: recorded frames, rulers and plots.
import { describe, expect, test } from "vitest";
import { advance, counted, niceStep, recordedFrames, someTicks, ticks } from "../src/model/playback";
import { pointAt } from "../src/model/runs";
import { titleOf, unitOf } from "../src/model/quantities";

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
    // Where the round one is beyond the end, smaller steps.
    expect(ticks(0.015, 1.9, 2)).toEqual([1]);
    expect(someTicks(0.015, 1.9, 2)).toEqual([0.5, 1, 1.5]);
    expect(someTicks(1, 1, 2)).toEqual([1]);
    for (const [low, high] of [[0.99, 1.01], [3, 3.0001], [-7, 1e6]] as const) expect(someTicks(low, high, 2).length).toBeGreaterThan(1);
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
