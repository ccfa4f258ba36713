// The triangles of a mesh file, as far as the page can read it: nine numbers each, placed as the program places them. The readers
// come when they are needed.
import { Cache, Matrix4, MeshBasicMaterial, Vector3, type BufferGeometry, type Mesh, type Object3D } from "three";

/** Above this a check would take long. */
const kMostBytes = 32 * 2 ** 20;

/** Appends the triangles of a geometry that stands somewhere; one that is mirrored there has its corners the other way round. */
function append(to: number[], geometry: BufferGeometry, place: Matrix4): void {
  const position = geometry.getAttribute("position"), { index } = geometry;
  const count = index?.count ?? position.count, order = place.determinant() < 0 ? [0, 2, 1] : [0, 1, 2];
  const corner = new Vector3();
  for (let t = 0; t + 3 <= count; t += 3)
    for (const k of order) {
      corner.fromBufferAttribute(position, index ? index.getX(t + k) : t + k).applyMatrix4(place);
      to.push(corner.x, corner.y, corner.z);
    }
}

function trianglesOf(root: Object3D): number[] {
  const found: number[] = [];
  root.updateMatrixWorld(true);
  root.traverse((o) => (o as Mesh).isMesh && append(found, (o as Mesh).geometry, o.matrixWorld));
  return found;
}

function trianglesOfGeometry(geometry: BufferGeometry): number[] {
  const found: number[] = [];
  append(found, geometry, new Matrix4());
  return found;
}

/**
 * Of a file of text that begins with "OFF", or without that: how many vertices and faces there are, the vertices, a line each, and the
 * faces, a line each: how many corners, and the numbers of these.
 */
export function trianglesOfOff(text: string): number[] {
  const lines = text.split("\n").map((l) => l.replace(/#.*/, "").trim().split(/\s+/)).filter(([word]) => word !== "");
  if (lines[0]?.[0]?.endsWith("OFF") && lines[0].shift() && lines[0].length === 0) lines.shift();
  const [vertices = NaN, faces = NaN] = (lines.shift() ?? []).map(Number);
  if (!(vertices + faces <= lines.length)) throw new Error("it is no OFF file of text, or ends too early");
  const corners = lines.slice(0, vertices).map((l) => l.slice(0, 3).map(Number));
  return lines.slice(vertices, vertices + faces).flatMap(([count, ...all]) => {
    const face = all.slice(0, Number(count)).map((i) => corners[Number(i)] ?? []);
    if (face.length !== Number(count) || face.some((c) => c.length < 3 || !c.every(Number.isFinite))) throw new Error(`there is no such face: ${all.join(" ")}`);
    return face.slice(2).flatMap((c, i) => [...face[0]!, ...face[i + 1]!, ...c]);
  });
}

interface WithBuffers { buffers?: { uri?: string }[] }

/** The page may fetch nothing but what the server has, so what is written into the file is decoded here. */
function decodeBuffers({ buffers = [] }: WithBuffers): void {
  for (const { uri } of buffers) {
    const data = /^data:[^,]*;base64,(.*)$/s.exec(uri ?? "")?.[1];
    if (uri !== undefined && data === undefined) throw new Error(`it needs ${uri}, which was not dropped with it`);
    if (data !== undefined) Cache.add(uri!, Uint8Array.from(atob(data), (c) => c.charCodeAt(0)).buffer);
  }
}

async function readGltf(content: string | ArrayBuffer): Promise<number[]> {
  const { GLTFLoader } = await import("three/examples/jsm/loaders/GLTFLoader.js");
  // Without colours, so that no pictures are fetched.
  const plain = new GLTFLoader().register(() => ({ name: "plain", loadMaterial: async () => new MeshBasicMaterial() }));
  Cache.enabled = true;
  try {
    if (typeof content === "string") decodeBuffers(JSON.parse(content) as WithBuffers);
    return trianglesOf((await plain.parseAsync(content, "")).scene);
  } finally {
    Cache.clear();
    Cache.enabled = false;
  }
}

const readers: { [ending: string]: (file: File) => Promise<number[]> } = {
  obj: async (file) => {
    const { OBJLoader } = await import("three/examples/jsm/loaders/OBJLoader.js");
    return trianglesOf(new OBJLoader().parse(await file.text()));
  },
  stl: async (file) => {
    const { STLLoader } = await import("three/examples/jsm/loaders/STLLoader.js");
    return trianglesOfGeometry(new STLLoader().parse(await file.arrayBuffer()));
  },
  ply: async (file) => {
    const { PLYLoader } = await import("three/examples/jsm/loaders/PLYLoader.js");
    return trianglesOfGeometry(new PLYLoader().parse(await file.arrayBuffer()));
  },
  off: async (file) => trianglesOfOff(await file.text()),
  gltf: async (file) => readGltf(await file.text()),
  glb: async (file) => readGltf(await file.arrayBuffer()),
  "3mf": async (file) => {
    const { ThreeMFLoader } = await import("three/examples/jsm/loaders/3MFLoader.js");
    return trianglesOf(new ThreeMFLoader().parse(await file.arrayBuffer()));
  },
};

/** Null where the page cannot read such a file, or it is large. Throws where it is damaged. */
export async function readMesh(file: File): Promise<number[] | null> {
  const read = readers[/\.([^./]+)$/.exec(file.name.toLowerCase())?.[1] ?? ""];
  return read && file.size <= kMostBytes ? read(file) : null;
}
