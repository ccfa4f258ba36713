// A run as one page that replays it: particles, solids, colours, camera and the scene itself, in one file.
import { colorTable, type Ramp } from "../viewport/colorMaps";
import { kMeshColors } from "../viewport/view";
import type { FramePacket } from "../protocol/packets";
import type { Run } from "../model/runs";
import { fileNameOf } from "../model/names";
import type { Scene } from "../model/scene";
import player from "./player.js?raw";

export interface ReplayLook {
  colors: Ramp;
  /** As the colours go, where the scene says so; else over all that is shown. */
  range: [number, number] | null;
  camera: { eye: number[]; target: number[]; fov: number };
  dark: boolean;
  /** Of shapes, six numbers each, in m. */
  lines: Float32Array;
}

/** Arrays one after another, each where its type can be read. */
class Arrays {
  readonly parts: Uint8Array<ArrayBuffer>[] = [];
  length = 0;

  add(a: Uint16Array | Uint32Array | Float32Array): number {
    const kAlign = 4;
    const at = this.length;
    const bytes = new Uint8Array(Math.ceil(a.byteLength / kAlign) * kAlign);
    bytes.set(new Uint8Array(a.buffer, a.byteOffset, a.byteLength));
    this.parts.push(bytes);
    this.length += bytes.length;
    return at;
  }
}

const kLargest = 65535;

const frameOf = (f: FramePacket, arrays: Arrays) => ({
  time: f.time, poses: f.poses,
  fluids: f.fluids.filter((g) => g.count > 0).map((g) => ({
    count: g.count, low: g.low, high: g.high, radius: 0.5 * g.spacing * Math.cbrt(g.total / g.count),
    least: g.attribute?.low ?? 0, most: g.attribute?.high ?? 1,
    positions: arrays.add(g.positions), values: arrays.add(g.attribute?.values ?? new Uint16Array(g.count).fill(kLargest / 2)),
  })),
});

function sizeOf(frames: FramePacket[]): number {
  const all = frames.flatMap((f) => f.fluids);
  return Math.max(1e-3, ...all.map((g) => Math.hypot(...g.high.map((h, i) => h - g.low[i]!))));
}

const rgb = (hex: string): number[] => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

/** Base64, piece by piece: a page's worth of numbers is too long for one text. */
function* base64Of(bytes: Uint8Array): Generator<string> {
  const kPiece = 3 * 2 ** 13;
  for (let at = 0; at < bytes.length; at += kPiece) yield btoa(String.fromCharCode(...bytes.subarray(at, at + kPiece)));
}

/** JSON that may stand in a page: no text in it ends a script. */
export const inPage = (v: unknown): string => JSON.stringify(v).replaceAll("<", "\\u003c");

const escaped = (text: string): string => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

const kLight = { back: "#eef2f6", panel: "#ffffff", text: "#1c232b", line: "#8a939e" };
const kDark = { back: "#171c22", panel: "#1d2329", text: "#e6ebf0", line: "#6b7682" };

export async function replayPage(run: Run, scene: Scene, look: ReplayLook): Promise<Blob> {
  const arrays = new Arrays();
  const frames = run.frames.map((f) => frameOf(f, arrays));
  const meshes = (run.geometry?.meshes ?? []).map((m, i) => ({
    node: m.node, color: rgb(kMeshColors[i % kMeshColors.length]!), vertexCount: m.vertices.length / 3, cornerCount: m.triangles.length, vertices: arrays.add(m.vertices), triangles: arrays.add(m.triangles),
  }));
  const lines = { count: look.lines.length / 3, at: arrays.add(look.lines), color: rgb("#8a94a0") };
  const shown = run.frames.flatMap((f) => f.fluids.flatMap((g) => (g.attribute && g.count > 0 ? [g.attribute] : [])));
  const range = look.range ?? (shown.length > 0 ? [Math.min(...shown.map((a) => a.low)), Math.max(...shown.map((a) => a.high))] : [0, 1]);
  const colors = look.dark ? kDark : kLight, title = scene.title ?? "Untitled";
  const told = {
    frames, meshes, lines, range, size: sizeOf(run.frames), colors: [...colorTable(look.colors)], background: rgb(colors.back), camera: look.camera, file: `${fileNameOf(scene.title)}.json`,
  };
  const packed = new Uint8Array(await new Response(new Blob(arrays.parts).stream().pipeThrough(new CompressionStream("gzip"))).arrayBuffer());
  const steps = [0, 0.25, 0.5, 0.75, 1].map((x) => {
    const table = told.colors, i = 4 * Math.round(x * (table.length / 4 - 1));
    return `rgb(${table[i]} ${table[i + 1]} ${table[i + 2]})`;
  });
  const number = (x: number) => Number(x.toPrecision(4));
  const key = shown[0] ? `${number(range[0]!)} <i></i> ${number(range[1]!)} ${escaped(shown[0].unit)} <b>${escaped(shown[0].name)}</b>` : "";
  const head = `<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width"><meta name="generator" content="Weir">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'">
<title>${escaped(title)}</title>
<style>
* { box-sizing: border-box; } html, body { height: 100%; margin: 0; } body { display: flex; flex-direction: column; font: 14px/1.4 system-ui, sans-serif; background: ${colors.panel}; color: ${colors.text}; }
#view { flex: 1; min-height: 0; width: 100%; touch-action: none; display: block; } footer { display: flex; gap: 10px; align-items: center; padding: 7px 12px; flex-wrap: wrap; }
footer input { flex: 1; min-width: 120px; } #time { min-width: 5em; text-align: right; font-variant-numeric: tabular-nums; } button, select { font: inherit; color: inherit; background: none; border: 1px solid ${colors.line}; border-radius: 4px; padding: 2px 10px; } option { background: ${colors.panel}; }
h1 { font-size: 15px; margin: 0; padding: 7px 12px; } .key { position: absolute; right: 12px; top: 6px; } .key i { display: inline-block; width: 110px; height: 9px; border-radius: 2px; background: linear-gradient(90deg, ${steps.join(", ")}); }
</style></head><body>
<h1>${escaped(title)}</h1><div class="key">${key}</div>
<canvas id="view" role="img" aria-label="The simulation: drag to turn, right drag to move, wheel to go nearer" tabindex="0"></canvas><p id="why" hidden></p>
<footer><button id="play">Play</button><input id="frame" type="range" min="0" value="0" aria-label="Frame"><span id="time"></span>
<select id="speed" aria-label="Speed">${[0.1, 0.25, 0.5, 1, 2].map((s) => `<option value="${s}"${s === 1 ? " selected" : ""}>${s}×</option>`).join("")}</select><button id="save" title="The scene that this is a run of, for Weir">Scene</button></footer>
<script type="application/json" id="weir-scene">${inPage(scene)}</script>
<script type="text/plain" id="weir-data">`;
  return new Blob([head, ...base64Of(packed), "</script>\n<script>\nconst RUN = ", inPage(told), ";\n", player, "</script></body></html>\n"], { type: "text/html" });
}
