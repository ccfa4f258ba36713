// The 3D view: a renderer, a camera to orbit, and what there is to see. Draws only when something changed.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import type { FramePacket, GeometryPacket } from "../protocol/packets";
import { niceStep } from "../model/playback";
import { kColorMaps, type Ramp } from "./colorMaps";
import type { Cut } from "../model/clips";
import { Particles } from "./particles";

export interface ViewEvents {
  /** A handle was let go of: the new place, and the turn in degrees about fixed x, y, z. */
  moved(node: string, position: number[], rotation: number[]): void;
  picked(node: string, id: number, more: boolean): void;
  /** A click where no particle is, on the mesh or the outline of a node. */
  selected(node: string, more: boolean): void;
  range(low: number, high: number, name: string, unit: string): void;
}

export const kPresets = {
  front: [0, 0.2, 1], back: [0, 0.2, -1], left: [-1, 0.2, 0], right: [1, 0.2, 0], top: [0, 1, 0.001], iso: [0.8, 0.6, 1],
} as const;
export type Preset = keyof typeof kPresets;

export const kMeshColors = ["#9fb6c9", "#c9b69f", "#a9c99f", "#c49fc9"];

/** Pixels of the view's upper edge that the tools cover. */
const kTools = 44;
/** Share of the width that is used. */
const kBeside = 0.94;

/** How far from the centre of a box a camera sees all of it, in a direction; `tall` and `wide` are the tangents of half its angles. */
export function distanceFor(box: THREE.Box3, direction: THREE.Vector3, tall: number, wide: number): number {
  const right = new THREE.Vector3(0, 1, 0).cross(direction).normalize();
  if (right.lengthSq() === 0) right.set(1, 0, 0);
  const up = direction.clone().cross(right), half = box.getSize(new THREE.Vector3()).multiplyScalar(0.5);
  let most = 1e-3;
  for (let i = 0; i < 8; ++i) {
    const corner = half.clone().multiply(new THREE.Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    most = Math.max(most, corner.dot(direction) + Math.max(Math.abs(corner.dot(up)) / tall, Math.abs(corner.dot(right)) / wide));
  }
  return most;
}

/** The view of the present run, where the browser has WebGL. */
export const mainView: { current: View | null } = { current: null };

export class View {
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(40, 1, 0.005, 500);
  private readonly renderer: THREE.WebGLRenderer;
  private readonly controls: OrbitControls;
  private readonly handle: TransformControls;
  private readonly fluids = new Map<string, Particles>();
  private readonly meshes = new Map<string, THREE.Mesh>();
  private readonly outlines = new THREE.Group();
  private outlineOf = new Map<string, THREE.Object3D>();
  private map: Ramp = kColorMaps.viridis;
  private range: [number, number] | null = null;
  private readonly cameraListeners = new Set<() => void>();
  private readonly drawnListeners = new Set<() => void>();
  private shown: FramePacket | null = null;
  private chosen: { node: string; id: number } | null = null;
  private asked = false;
  private fitted = false;
  private cuts: Cut[] = [];
  drawn = 0;

  constructor(private readonly element: HTMLElement, private readonly events: ViewEvents) {
    this.renderer = new THREE.WebGLRenderer({ antialias: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    element.prepend(this.renderer.domElement);
    this.camera.position.set(1.2, 1, 1.8);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => {
      this.draw();
      for (const listener of this.cameraListeners) listener();
    });
    this.handle = new TransformControls(this.camera, this.renderer.domElement);
    this.handle.addEventListener("dragging-changed", (e) => {
      this.controls.enabled = !e.value;
      if (!e.value) this.letGo();
    });
    this.handle.addEventListener("change", () => this.draw());
    for (const type of ["keydown", "keyup"] as const) addEventListener(type, this.snapByKey);
    this.scene.add(this.handle.getHelper(), this.outlines);
    this.scene.add(new THREE.HemisphereLight("#ffffff", "#6b7480", 2.2));
    const sun = new THREE.DirectionalLight("#ffffff", 1.6);
    sun.position.set(2, 4, 3);
    this.scene.add(sun);
    new ResizeObserver(() => this.resize()).observe(element);
    this.pickOnClick();
    this.resize();
  }

  setBackground(color: string): void {
    this.scene.background = new THREE.Color(color);
    this.draw();
  }

  setColors(map: Ramp, range: [number, number] | null): void {
    this.map = map;
    this.range = range;
    for (const particles of this.fluids.values()) particles.setMap(map);
    if (this.shown) this.frame(this.shown);
    this.draw();
  }

  /** Planes that cut the fluids open. */
  setCuts(cuts: Cut[]): void {
    this.cuts = cuts;
    for (const particles of this.fluids.values()) particles.cut(cuts);
    this.draw();
  }

  /** The colours of another view, over a range of values. */
  colorAs(other: View, range: [number, number] | null): void {
    this.setColors(other.map, range);
    this.setCuts(other.cuts);
  }

  frame(packet: FramePacket): void {
    this.shown = packet;
    for (const fluid of packet.fluids) {
      let particles = this.fluids.get(fluid.node);
      if (!particles) {
        particles = new Particles();
        particles.setMap(this.map);
        particles.cut(this.cuts);
        particles.choose(this.chosen?.node === fluid.node ? this.chosen.id : -1);
        this.fluids.set(fluid.node, particles);
        this.scene.add(particles.points);
      }
      particles.show(fluid);
      const a = fluid.attribute;
      const [low, high] = this.range ?? [a?.low ?? 0, a?.high ?? 1];
      particles.setRange(low, high);
      if (a) this.events.range(low, high, a.name, a.unit);
    }
    for (const [node, particles] of this.fluids)
      if (!packet.fluids.some((f) => f.node === node)) {
        this.scene.remove(particles.points);
        particles.dispose();
        this.fluids.delete(node);
      }
    for (const [node, pose] of Object.entries(packet.poses)) {
      const mesh = this.meshes.get(node);
      mesh?.position.set(pose[0]!, pose[1]!, pose[2]!);
      mesh?.quaternion.set(pose[3]!, pose[4]!, pose[5]!, pose[6]!);
    }
    this.draw();
  }

  /** Shows nothing of a run. */
  clear(): void {
    this.frame({ kind: "frame", frame: 0, time: 0, fluids: [], poses: {} });
    this.geometry({ kind: "geometry", meshes: [] });
    this.shown = null;
    this.draw();
  }

  geometry(packet: GeometryPacket): void {
    for (const mesh of this.meshes.values()) {
      this.scene.remove(mesh);
      mesh.geometry.dispose();
      (mesh.material as THREE.Material).dispose();
    }
    this.meshes.clear();
    packet.meshes.forEach((data, i) => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(data.vertices, 3));
      geometry.setIndex(new THREE.BufferAttribute(data.triangles, 1));
      geometry.computeVertexNormals();
      const material = new THREE.MeshStandardMaterial({
        color: kMeshColors[i % kMeshColors.length]!, roughness: 0.5, transparent: true, opacity: 0.35, depthWrite: false, side: THREE.DoubleSide,
      });
      const mesh = new THREE.Mesh(geometry, material);
      mesh.renderOrder = 1;
      this.meshes.set(data.node, mesh);
      this.scene.add(mesh);
    });
    this.draw();
    if (!this.fitted) this.fit();
  }

  setOutlines(outlines: Map<string, THREE.Object3D>): void {
    for (const object of this.outlineOf.values())
      object.traverse((o) => {
        if (o instanceof THREE.LineSegments || o instanceof THREE.Mesh) o.geometry.dispose();
      });
    const held = this.handle.object?.userData["node"] as string | undefined;
    this.handle.detach();
    this.outlines.clear();
    this.outlineOf = outlines;
    for (const object of outlines.values()) this.outlines.add(object);
    if (held !== undefined) this.hold(held, this.handle.mode as "translate" | "rotate");
    this.draw();
  }

  /** Shows a handle at a node's outline, or none. */
  hold(node: string | null, mode: "translate" | "rotate"): void {
    const object = node ? this.outlineOf.get(node) : undefined;
    if (!object) return void this.handle.detach();
    object.userData["node"] = node;
    this.handle.setMode(mode);
    this.handle.attach(object);
  }

  /** Marks a particle, or none. */
  choose(which: { node: string; id: number } | null): void {
    this.chosen = which;
    for (const [node, particles] of this.fluids) particles.choose(which?.node === node ? which.id : -1);
    this.draw();
  }

  /** Of a scene that is still to come: fits once more when its meshes are there. */
  fitAnew(): void {
    this.fit();
    this.fitted = false;
  }

  /** While Ctrl is down, the handle moves and turns in steps. */
  private readonly snapByKey = (e: KeyboardEvent): void => {
    const kTurn = 15;
    this.handle.setTranslationSnap(e.ctrlKey ? this.snapStep() : null);
    this.handle.setRotationSnap(e.ctrlKey ? THREE.MathUtils.degToRad(kTurn) : null);
  };

  /** The round step, m, in which things are moved while Ctrl is down: about a fiftieth of what the scene holds. */
  snapStep(): number {
    const kSteps = 50;
    return niceStep(this.extent().size / kSteps);
  }

  /** Around all that the scene holds; empty where it holds nothing. */
  private bounds(): THREE.Box3 {
    const box = new THREE.Box3();
    for (const mesh of this.meshes.values()) box.expandByObject(mesh);
    for (const o of this.outlines.children) if (!(o instanceof THREE.GridHelper)) box.expandByObject(o);
    return box;
  }

  /** The middle of that, and its longest side, m. */
  extent(): { center: number[]; size: number } {
    const box = this.bounds();
    return box.isEmpty() ? { center: [0, 0, 0], size: 1 } : { center: box.getCenter(new THREE.Vector3()).toArray(), size: Math.max(...box.getSize(new THREE.Vector3()).toArray()) };
  }

  fit(preset?: Preset): void {
    this.fitFrom(preset ? new THREE.Vector3(...kPresets[preset]) : this.camera.position.clone().sub(this.controls.target));
  }

  /** From a direction, such as that of an axis, all that the scene holds. */
  lookFrom(direction: number[]): void {
    const kUpright = 1e-3;
    // Straight from above or below the camera would not know which way is up.
    this.fitFrom(new THREE.Vector3().fromArray(direction).add(new THREE.Vector3(0, 0, direction[1] !== 0 && direction[2] === 0 ? kUpright : 0)));
  }

  /** A direction of the world as the camera sees it: to the right, upwards, towards it. */
  seenAs(direction: number[]): number[] {
    return new THREE.Vector3().fromArray(direction).applyQuaternion(this.camera.quaternion.clone().invert()).toArray();
  }

  private fitFrom(direction: THREE.Vector3): void {
    const box = this.bounds();
    if (box.isEmpty()) box.set(new THREE.Vector3(-0.5, 0, -0.5), new THREE.Vector3(0.5, 1, 0.5));
    else this.fitted = true;
    const tall = Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2));
    // The tools lie on the upper edge; below there is as much left free.
    const free = Math.max(0.5, 1 - (2 * kTools) / Math.max(this.element.clientHeight, 1));
    const distance = distanceFor(box, direction.normalize(), tall * free, tall * this.camera.aspect * kBeside);
    const center = box.getCenter(new THREE.Vector3());
    this.camera.near = distance / 500;
    this.camera.far = distance * 50;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(direction, distance);
    this.controls.update();
    this.draw();
  }

  /** Calls back whenever the camera has moved. Returns what ends that. */
  onCamera(listener: () => void): () => void {
    this.cameraListeners.add(listener);
    return () => void this.cameraListeners.delete(listener);
  }

  /** Calls back whenever the view was drawn. Returns what ends that. */
  onDrawn(listener: () => void): () => void {
    this.drawnListeners.add(listener);
    return () => void this.drawnListeners.delete(listener);
  }

  /** Where a point is seen, in pixels from the view's upper left corner; null where it is behind the camera. */
  project(point: number[]): { x: number; y: number } | null {
    const p = new THREE.Vector3().fromArray(point).project(this.camera);
    if (p.z > 1) return null;
    return { x: ((p.x + 1) / 2) * this.element.clientWidth, y: ((1 - p.y) / 2) * this.element.clientHeight };
  }

  /** From the camera through what lies under the pointer. */
  private rayAt(clientX: number, clientY: number): THREE.Ray {
    const box = this.element.getBoundingClientRect();
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2(((clientX - box.left) / box.width) * 2 - 1, 1 - ((clientY - box.top) / box.height) * 2), this.camera);
    return caster.ray;
  }

  /** The middle of a mesh as it stands, m. */
  centerOf(node: string): number[] | null {
    const mesh = this.meshes.get(node);
    return mesh ? new THREE.Box3().setFromObject(mesh).getCenter(new THREE.Vector3()).toArray() : null;
  }

  /** The first mesh under the pointer of those that are wanted, and its middle. */
  meshAt(clientX: number, clientY: number, wanted: (node: string) => boolean): { node: string; center: number[] } | null {
    const caster = new THREE.Raycaster();
    caster.ray.copy(this.rayAt(clientX, clientY));
    let best: { node: string; distance: number } | null = null;
    for (const [node, mesh] of this.meshes) {
      const hit = wanted(node) ? caster.intersectObject(mesh, false)[0] : undefined;
      if (hit && (!best || hit.distance < best.distance)) best = { node, distance: hit.distance };
    }
    return best && { node: best.node, center: this.centerOf(best.node)! };
  }

  /** The point on a line that is nearest to what lies under the pointer; null where one looks along it. `way` has length 1. */
  alongWay(clientX: number, clientY: number, point: number[], way: number[]): number[] | null {
    const { origin, direction } = this.rayAt(clientX, clientY), from = new THREE.Vector3().fromArray(point);
    const line = new THREE.Vector3().fromArray(way), across = line.dot(direction), kParallel = 1e-4;
    if (1 - across * across < kParallel) return null;
    const between = origin.clone().sub(from);
    return from.addScaledVector(line, (between.dot(line) - across * between.dot(direction)) / (1 - across * across)).toArray();
  }

  /** The coordinate of that point on the line along an axis (0, 1, 2). */
  along(clientX: number, clientY: number, point: number[], axis: number): number | null {
    return this.alongWay(clientX, clientY, point, [0, 1, 2].map((i) => Number(i === axis)))?.[axis] ?? null;
  }

  /** Where the pointer meets the plane through a point that faces the camera. */
  besides(clientX: number, clientY: number, point: number[]): number[] | null {
    const facing = this.camera.getWorldDirection(new THREE.Vector3());
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(facing, new THREE.Vector3().fromArray(point));
    return this.rayAt(clientX, clientY).intersectPlane(plane, new THREE.Vector3())?.toArray() ?? null;
  }

  /** As the scene's render.camera has it. */
  pose(): { eye: number[]; target: number[]; fov: number } {
    const round = (v: THREE.Vector3) => v.toArray().map((x) => Number(x.toPrecision(4)));
    return { eye: round(this.camera.position), target: round(this.controls.target), fov: this.camera.fov };
  }

  setPose(eye: number[], target: number[], fov: number): void {
    this.camera.fov = fov;
    this.camera.position.fromArray(eye);
    this.controls.target.fromArray(target);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.fitted = true;
    this.draw();
  }

  /** Looks as another view does, and tells it. */
  lookAs(other: View): void {
    if (this.camera.position.equals(other.camera.position) && this.controls.target.equals(other.controls.target) && this.camera.fov === other.camera.fov) return;
    this.camera.fov = other.camera.fov;
    this.camera.near = other.camera.near;
    this.camera.far = other.camera.far;
    this.camera.position.copy(other.camera.position);
    this.controls.target.copy(other.controls.target);
    this.camera.updateProjectionMatrix();
    this.fitted = true;
    // Not by way of the controls, which would tell that the camera has moved.
    this.camera.lookAt(this.controls.target);
    this.draw();
    for (const listener of this.cameraListeners) listener();
  }

  /** What is seen now, as a picture of that width and height in pixels, or as large as it is seen. */
  picture(width = this.renderer.domElement.width, height = this.renderer.domElement.height): HTMLCanvasElement {
    const picture = document.createElement("canvas");
    [picture.width, picture.height] = [width, height];
    this.renderer.render(this.scene, this.camera);
    const { width: wide, height: tall } = this.renderer.domElement;
    // All of the smaller side is in it.
    const scale = Math.max(width / wide, height / tall);
    picture.getContext("2d")!.drawImage(this.renderer.domElement, (width - scale * wide) / 2, (height - scale * tall) / 2, scale * wide, scale * tall);
    return picture;
  }

  dispose(): void {
    for (const type of ["keydown", "keyup"] as const) removeEventListener(type, this.snapByKey);
    this.controls.dispose();
    this.handle.dispose();
    for (const particles of this.fluids.values()) particles.dispose();
    this.renderer.dispose();
    this.renderer.domElement.remove();
  }

  private draw(): void {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.renderer.render(this.scene, this.camera);
      ++this.drawn;
      for (const listener of this.drawnListeners) listener();
    });
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  private letGo(): void {
    const object = this.handle.object;
    const node = object?.userData["node"] as string | undefined;
    if (!object || !node) return;
    const euler = new THREE.Euler().setFromQuaternion(object.quaternion, "ZYX");
    const round = (x: number) => Number(x.toFixed(4));
    this.events.moved(node, object.position.toArray().map(round), [euler.x, euler.y, euler.z].map((r) => round(THREE.MathUtils.radToDeg(r))));
  }

  private pickOnClick(): void {
    const canvas = this.renderer.domElement;
    let down = { x: 0, y: 0 };
    canvas.addEventListener("pointerdown", (e) => (down = { x: e.clientX, y: e.clientY }));
    canvas.addEventListener("click", (e) => {
      if (Math.hypot(e.clientX - down.x, e.clientY - down.y) > 3) return;
      const box = canvas.getBoundingClientRect();
      const at = new THREE.Vector2(((e.clientX - box.left) / box.width) * 2 - 1, 1 - ((e.clientY - box.top) / box.height) * 2);
      const caster = new THREE.Raycaster();
      caster.setFromCamera(at, this.camera);
      let best: { node: string; id: number; distance: number } | null = null;
      for (const [node, particles] of this.fluids) {
        const hit = particles.pick(caster.ray);
        if (hit && (!best || hit.distance < best.distance)) best = { node, ...hit };
      }
      if (best) return this.events.picked(best.node, best.id, e.shiftKey);
      const node = this.nodeAt(caster);
      if (node !== null) this.events.selected(node, e.shiftKey);
    });
  }

  /** The node whose mesh or outline a ray meets first, or comes near to. */
  private nodeAt(caster: THREE.Raycaster): string | null {
    const kNear = 0.01;
    caster.params.Line.threshold = kNear * this.camera.position.distanceTo(this.controls.target);
    let best: { node: string; distance: number } | null = null;
    for (const [node, object] of [...this.meshes, ...this.outlineOf]) {
      const hit = caster.intersectObject(object, true)[0];
      if (hit && (!best || hit.distance < best.distance)) best = { node, distance: hit.distance };
    }
    return best?.node ?? null;
  }
}
