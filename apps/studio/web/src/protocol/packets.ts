// Packets of frames and meshes; see PROTOCOL.md.

export interface AttributeData {
  name: string;
  unit: string;
  low: number;
  high: number;
  values: Uint16Array;
}

export interface FluidFrame {
  node: string;
  total: number;
  count: number;
  spacing: number;
  low: [number, number, number];
  high: [number, number, number];
  positions: Uint16Array;
  /** Whole numbers, exact below 2⁵³. */
  ids: Float64Array;
  attributes: string[];
  attribute?: AttributeData;
}

export interface FramePacket {
  kind: "frame";
  frame: number;
  time: number;
  fluids: FluidFrame[];
  /** Of nodes whose meshes move: x, y, z and the quaternion x, y, z, w. */
  poses: { [node: string]: number[] };
}

export interface MeshData {
  node: string;
  vertices: Float32Array;
  triangles: Uint32Array;
}

export interface GeometryPacket {
  kind: "geometry";
  meshes: MeshData[];
}

export interface PicturePacket {
  kind: "picture";
  frame: number;
  time: number;
  width: number;
  height: number;
  type: string;
  data: Uint8Array<ArrayBuffer>;
}

/** Of 64 bits, not negative; faster than by way of BigInt. */
function readLongs(buffer: ArrayBuffer, at: number, count: number): Float64Array {
  const words = new Uint32Array(buffer, at, 2 * count);
  const numbers = new Float64Array(count);
  for (let i = 0; i < count; ++i) numbers[i] = words[2 * i]! + 2 ** 32 * words[2 * i + 1]!;
  return numbers;
}

/* eslint-disable @typescript-eslint/no-explicit-any */
export function readPacket(buffer: ArrayBuffer): FramePacket | GeometryPacket | PicturePacket {
  const length = new DataView(buffer).getUint32(0, true);
  const header: any = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const start = 4 + length;
  if (header.kind === "picture") return { ...header, data: new Uint8Array(buffer, start + header.data, header.bytes) };
  if (header.kind === "geometry") {
    const meshes = header.meshes.map((m: any) => ({
      node: m.node,
      vertices: new Float32Array(buffer, start + m.vertices, 3 * m.vertexCount),
      triangles: new Uint32Array(buffer, start + m.triangles, 3 * m.triangleCount),
    }));
    return { kind: "geometry", meshes };
  }
  const fluids = header.fluids.map((f: any) => ({
    ...f,
    positions: new Uint16Array(buffer, start + f.positions, 3 * f.count),
    ids: readLongs(buffer, start + f.ids, f.count),
    attribute: f.attribute && {
      ...f.attribute,
      values: new Uint16Array(buffer, start + f.attribute.values, f.count),
    },
  }));
  return { ...header, fluids };
}
