// What the scene says of shapes and nozzles, drawn from their parameters alone.
import * as THREE from "three";
import { isUsed } from "../model/parameters";
import type { Scene } from "../model/scene";
import type { Json, JsonObject, Parameter, Types } from "../model/types";

type Values = (name: string) => Json;

const vector = (v: Json): THREE.Vector3 =>
  Array.isArray(v) ? new THREE.Vector3(Number(v[0]), Number(v[1]), Number(v[2])) : new THREE.Vector3();

/** Degrees about the fixed x, then y, then z axis; or a quaternion w, x, y, z. */
export function quaternionOf(v: Json): THREE.Quaternion {
  if (!Array.isArray(v)) return new THREE.Quaternion();
  const n = v.map(Number);
  if (n.length === 4) return new THREE.Quaternion(n[1], n[2], n[3], n[0]).normalize();
  const [x, y, z] = n.map((d) => THREE.MathUtils.degToRad(d));
  // Three's order ZYX turns about x first when axes are fixed.
  return new THREE.Quaternion().setFromEuler(new THREE.Euler(x, y, z, "ZYX"));
}

/** The first value where keyframes are given. */
const first = (v: Json): Json =>
  v !== null && typeof v === "object" && !Array.isArray(v) && Array.isArray(v["keyframes"])
    ? ((v["keyframes"][0] as Json[])[1] ?? null)
    : v;

const valuesOf = (params: JsonObject | undefined, parameters: Parameter[]): Values => (name) =>
  first(params?.[name] ?? parameters.find((p) => p.name === name)?.default ?? null);

const lines = (geometry: THREE.BufferGeometry, color: string): THREE.LineSegments => {
  const edges = new THREE.EdgesGeometry(geometry, 20);
  geometry.dispose();
  return new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color }));
};

function shapeOf(v: Values): THREE.Object3D | null {
  const kColor = "#8a94a0";
  const kSegments = 32;
  const radius = Number(v("radius"));
  const height = Number(v("height"));
  let object: THREE.Object3D;
  switch (v("shape")) {
    case "box": {
      const [low, high] = [vector(v("min")), vector(v("max"))];
      const size = high.clone().sub(low);
      object = lines(new THREE.BoxGeometry(size.x, size.y, size.z), kColor);
      object.position.copy(low.add(high).multiplyScalar(0.5));
      break;
    }
    case "sphere":
      object = lines(new THREE.SphereGeometry(radius, kSegments / 2, kSegments / 4), kColor);
      break;
    case "cylinder":
      object = lines(new THREE.CylinderGeometry(radius, radius, height, kSegments), kColor);
      break;
    case "capsule":
      object = lines(new THREE.CapsuleGeometry(radius, height, kSegments / 4, kSegments / 2), kColor);
      break;
    case "cone":
      object = lines(new THREE.ConeGeometry(radius, height, kSegments).translate(0, height / 2, 0), kColor);
      break;
    case "plane": {
      const grid = new THREE.GridHelper(4, 16, kColor, kColor);
      grid.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), vector(v("normal")).normalize());
      object = grid;
      break;
    }
    default:
      return null;
  }
  if (v("shape") !== "box") object.position.copy(vector(v("position")));
  if (v("shape") !== "plane") object.quaternion.copy(quaternionOf(v("rotation")));
  return object;
}

function nozzleOf(isSquare: boolean, v: Values): THREE.Object3D {
  const group = new THREE.Group();
  const kColor = "#f0a030";
  const [width, height, radius] = [Number(v("width")), Number(v("height")), Number(v("radius"))];
  const mouth = isSquare
    ? new THREE.BoxGeometry(width, 1e-4, height)
    : new THREE.CylinderGeometry(radius, radius, 1e-4, 24);
  group.add(lines(mouth, kColor));
  const size = isSquare ? Math.max(width, height) : 2 * radius;
  group.add(new THREE.ArrowHelper(new THREE.Vector3(0, -1, 0), new THREE.Vector3(), 1.5 * size, kColor, 0.4 * size, 0.25 * size));
  group.position.copy(vector(v("position")));
  group.quaternion.copy(quaternionOf(v("rotation")));
  return group;
}

/** By node: shapes of boundaries, boxes of samplers and sinks, nozzles. */
export function outlinesOf(scene: Scene, types: Types): Map<string, THREE.Object3D> {
  const found = new Map<string, THREE.Object3D>();
  for (const [name, spec] of Object.entries(scene.nodes)) {
    const type = types.nodes[spec.type];
    if (!type) continue;
    const v = valuesOf(spec.params, type.parameters);
    const has = (p: string) => type.parameters.some((q) => q.name === p);
    const object =
      has("shape") ? shapeOf(v)
      : has("speed") && has("position") ? nozzleOf(has("width"), v)
      : has("min") && has("max") && !type.outputs.some((o) => o.type === "TriangleMesh") ? shapeOf((n) => (n === "shape" ? "box" : v(n)))
      : null;
    if (object) found.set(name, object);
  }
  return found;
}

/** The lines of outlines, in the world: six numbers each. */
export function linesOf(outlines: Iterable<THREE.Object3D>): Float32Array {
  const found: number[] = [];
  const p = new THREE.Vector3();
  for (const outline of outlines) {
    outline.updateMatrixWorld(true);
    outline.traverse((o) => {
      if (!(o instanceof THREE.LineSegments)) return;
      const points = o.geometry.getAttribute("position");
      for (let i = 0; i < points.count; ++i) found.push(...p.fromBufferAttribute(points, i).applyMatrix4(o.matrixWorld).toArray());
    });
  }
  return Float32Array.from(found);
}

/** Of a box whose sides are along the axes: its lower and its upper corner, m. */
export interface Corners {
  min: number[];
  max: number[];
}

const kDigits = 4;
/** How near two faces may come, of the side between them. */
const kThinnest = 0.01;

/** A box with one of its faces elsewhere, not beyond the one across. */
export function withFace(box: Corners, end: "min" | "max", axis: number, to: number): Corners {
  const across = box[end === "min" ? "max" : "min"][axis]!;
  const gap = kThinnest * Math.abs(across - box[end][axis]!);
  const within = end === "min" ? Math.min(to, across - gap) : Math.max(to, across + gap);
  return { ...box, [end]: box[end].map((v, i) => (i === axis ? Number(within.toPrecision(kDigits)) : v)) };
}

/** The box that a node's parameters give, which its faces can change; null where they give none, one that is turned, or one that changes over time. */
export function boxOf(scene: Scene, types: Types, name: string): Corners | null {
  const spec = scene.nodes[name], parameters = types.nodes[spec?.type ?? ""]?.parameters ?? [];
  const own = (p: string) => parameters.find((q) => q.name === p);
  if (own("min")?.kind !== "vec3" || own("max")?.kind !== "vec3") return null;
  const value = (p: string): Json => spec!.params?.[p] ?? own(p)?.default ?? null;
  if (own("shape") && value("shape") !== "box") return null;
  const numbers = (v: Json) => Array.isArray(v) && v.every((x) => typeof x === "number");
  if (own("rotation") && !(numbers(value("rotation")) && (value("rotation") as number[]).length === 3 && (value("rotation") as number[]).every((x) => x === 0))) return null;
  const [min, max] = [value("min"), value("max")];
  return numbers(min) && numbers(max) ? { min: min as number[], max: max as number[] } : null;
}

/** Whether a node can be moved by a handle in the view, and turned. */
export function handleOf(scene: Scene, types: Types, name: string): { rotates: boolean } | null {
  const parameters = types.nodes[scene.nodes[name]?.type ?? ""]?.parameters ?? [];
  const used = parameters.filter((p) => isUsed(p, parameters, scene.nodes[name]?.params ?? {}));
  if (!used.some((p) => p.name === "position" && p.kind === "vec3")) return null;
  return { rotates: used.some((p) => p.name === "rotation") };
}

export { vector as vectorOf, valuesOf };
