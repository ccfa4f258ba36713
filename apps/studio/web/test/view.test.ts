// The view and the colours of the page.
import { describe, expect, test } from "vitest";
import { Box3, PerspectiveCamera, Vector3 } from "three";
import { distanceFor } from "../src/viewport/view";
import { boxOf, withFace } from "../src/viewport/outlines";
import type { JsonObject, Parameter, Types } from "../src/model/types";
import css from "../src/style.css?raw";
import { sampler, types } from "./samples";

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
