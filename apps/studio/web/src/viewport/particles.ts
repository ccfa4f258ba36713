// Particles as shaded spheres: one point each, drawn by a shader that knows where a ball's surface is.
import * as THREE from "three";
import type { FluidFrame } from "../protocol/packets";
import { isShown, type Cut } from "../model/clips";
import { colorTable, type Ramp } from "./colorMaps";

const kVertexShader = /* glsl */ `
  uniform vec3 low, extent;
  uniform vec4 cuts[4];
  uniform float halves[4];
  uniform int cutCount;
  uniform float radius, pixels, valueLow, valueHigh, rangeLow, rangeHigh;
  attribute float value;
  attribute float marked;
  varying float t;
  varying vec3 center;
  flat varying float mark;
  void main() {
    vec3 place = low + extent * position;
    vec4 eye = modelViewMatrix * vec4(place, 1.0);
    center = eye.xyz;
    mark = marked;
    float v = mix(valueLow, valueHigh, value);
    t = clamp((v - rangeLow) / max(rangeHigh - rangeLow, 1e-12), 0.0, 1.0);
    gl_Position = projectionMatrix * eye;
    gl_PointSize = max(2.0, pixels * radius * projectionMatrix[1][1] / max(-eye.z, 1e-4));
    for (int i = 0; i < 4; ++i) {
      float beyond = dot(cuts[i].xyz, place) - cuts[i].w;
      if (i < cutCount && (halves[i] < 0.0 ? beyond > 0.0 : abs(beyond) > halves[i])) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    }
  }`;

const kFragmentShader = /* glsl */ `
  uniform sampler2D map;
  uniform float radius;
  uniform mat4 projection;
  uniform bool plain;
  uniform vec3 color;
  varying float t;
  varying vec3 center;
  flat varying float mark;
  void main() {
    vec2 at = 2.0 * gl_PointCoord - 1.0;
    float rr = dot(at, at);
    if (rr > 1.0) discard;
    vec3 normal = vec3(at.x, -at.y, sqrt(1.0 - rr));
    vec4 clip = projection * vec4(center + radius * normal, 1.0);
    gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
    vec3 base = plain ? color : texture2D(map, vec2(t, 0.5)).rgb;
    if (mark > 0.5) base = vec3(1.0, 0.3, 0.1);
    float light = 0.42 + 0.58 * max(0.0, dot(normal, normalize(vec3(0.35, 0.8, 0.5))));
    gl_FragColor = vec4(base * light, 1.0);
  }`;

/** Of more, the first are shown. */
const kMostCuts = 4;

/** The particles of one fluid. */
export class Particles {
  readonly points: THREE.Points;
  private readonly geometry = new THREE.BufferGeometry();
  private readonly material: THREE.ShaderMaterial;
  private shown: FluidFrame | null = null;
  private chosen = -1;
  private cuts: Cut[] = [];

  constructor() {
    this.material = new THREE.ShaderMaterial({
      vertexShader: kVertexShader,
      fragmentShader: kFragmentShader,
      uniforms: {
        low: { value: new THREE.Vector3() }, extent: { value: new THREE.Vector3() }, radius: { value: 0.01 },
        pixels: { value: 1 }, valueLow: { value: 0 }, valueHigh: { value: 1 }, rangeLow: { value: 0 },
        rangeHigh: { value: 1 }, map: { value: null }, projection: { value: new THREE.Matrix4() },
        cuts: { value: Array.from({ length: kMostCuts }, () => new THREE.Vector4()) }, halves: { value: new Array<number>(kMostCuts).fill(-1) }, cutCount: { value: 0 },
        plain: { value: false }, color: { value: new THREE.Color("#4aa3e2") },
      },
    });
    this.points = new THREE.Points(this.geometry, this.material);
    this.points.frustumCulled = false;
    this.points.onBeforeRender = (renderer, _scene, camera) => {
      const size = renderer.getDrawingBufferSize(new THREE.Vector2());
      this.material.uniforms["pixels"]!.value = size.y;
      this.material.uniforms["projection"]!.value.copy(camera.projectionMatrix);
    };
  }

  show(fluid: FluidFrame): void {
    this.shown = fluid;
    const g = this.geometry;
    g.setAttribute("position", new THREE.BufferAttribute(fluid.positions, 3, true));
    this.mark();
    const values = fluid.attribute?.values ?? new Uint16Array(fluid.count);
    g.setAttribute("value", new THREE.BufferAttribute(values, 1, true));
    g.setDrawRange(0, fluid.count);
    const u = this.material.uniforms;
    u["low"]!.value.fromArray(fluid.low);
    u["extent"]!.value.fromArray(fluid.high.map((h, i) => h - fluid.low[i]!));
    // Fewer particles are drawn larger, so that they fill the same space.
    u["radius"]!.value = 0.5 * fluid.spacing * Math.cbrt(fluid.total / Math.max(fluid.count, 1));
    u["plain"]!.value = !fluid.attribute;
    u["valueLow"]!.value = fluid.attribute?.low ?? 0;
    u["valueHigh"]!.value = fluid.attribute?.high ?? 1;
  }

  setRange(low: number, high: number): void {
    this.material.uniforms["rangeLow"]!.value = low;
    this.material.uniforms["rangeHigh"]!.value = high;
  }

  setMap(ramp: Ramp): void {
    const texture = new THREE.DataTexture(colorTable(ramp), 256, 1);
    texture.magFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    this.material.uniforms["map"]!.value?.dispose();
    this.material.uniforms["map"]!.value = texture;
  }

  cut(cuts: Cut[]): void {
    this.cuts = cuts.slice(0, kMostCuts);
    const u = this.material.uniforms;
    this.cuts.forEach(({ point, normal, thickness }, i) => {
      const [x, y, z] = normal as [number, number, number];
      (u["cuts"]!.value as THREE.Vector4[])[i]!.set(x, y, z, x * point[0]! + y * point[1]! + z * point[2]!);
      (u["halves"]!.value as number[])[i] = thickness === null ? -1 : thickness / 2;
    });
    u["cutCount"]!.value = this.cuts.length;
  }

  choose(id: number): void {
    this.chosen = id;
    this.mark();
  }

  /** By a number for each particle, as ids have more digits than a shader's floats. */
  private mark(): void {
    const ids = this.shown?.ids ?? new Float64Array();
    const marks = new Float32Array(this.shown?.count ?? 0);
    const at = ids.indexOf(this.chosen);
    if (at >= 0) marks[at] = 1;
    this.geometry.setAttribute("marked", new THREE.BufferAttribute(marks, 1));
  }

  /** The id of the particle that a ray meets first, and how far away it is; or null. */
  pick(ray: THREE.Ray): { id: number; distance: number } | null {
    const f = this.shown;
    if (!f) return null;
    const radius = this.material.uniforms["radius"]!.value as number;
    const scale = f.high.map((h, i) => (h - f.low[i]!) / 65535);
    const p = new THREE.Vector3();
    let best: { id: number; distance: number } | null = null;
    for (let i = 0; i < f.count; ++i) {
      p.set(
        f.low[0] + f.positions[3 * i]! * scale[0]! - ray.origin.x,
        f.low[1] + f.positions[3 * i + 1]! * scale[1]! - ray.origin.y,
        f.low[2] + f.positions[3 * i + 2]! * scale[2]! - ray.origin.z,
      );
      const along = p.dot(ray.direction);
      if (along <= 0 || p.lengthSq() - along * along > radius * radius) continue;
      if (best && along >= best.distance) continue;
      if (isShown(this.cuts, p.add(ray.origin).toArray())) best = { id: f.ids[i]!, distance: along };
    }
    return best;
  }

  dispose(): void {
    this.geometry.dispose();
    this.material.uniforms["map"]!.value?.dispose();
    this.material.dispose();
  }
}
