// The triangles of a mesh file, as far as the page can read it: nine numbers each. The readers come when they are needed.
import type { BufferGeometry, Mesh, Object3D } from "three";

/** Above this a check would take long. */
const kMostBytes = 32 * 2 ** 20;

const trianglesOf = (geometry: BufferGeometry): number[] => {
  const plain = geometry.index ? geometry.toNonIndexed() : geometry;
  return Array.from(plain.getAttribute("position").array);
};

const readers: { [ending: string]: (file: File) => Promise<number[]> } = {
  obj: async (file) => {
    const { OBJLoader } = await import("three/examples/jsm/loaders/OBJLoader.js");
    const found: number[] = [];
    new OBJLoader().parse(await file.text()).traverse((o: Object3D) => {
      if ((o as Mesh).isMesh) for (const x of trianglesOf((o as Mesh).geometry)) found.push(x);
    });
    return found;
  },
  stl: async (file) => {
    const { STLLoader } = await import("three/examples/jsm/loaders/STLLoader.js");
    return trianglesOf(new STLLoader().parse(await file.arrayBuffer()));
  },
  ply: async (file) => {
    const { PLYLoader } = await import("three/examples/jsm/loaders/PLYLoader.js");
    return trianglesOf(new PLYLoader().parse(await file.arrayBuffer()));
  },
};

/** Null where the page cannot read such a file, or it is large. Throws where it is damaged. */
export async function readMesh(file: File): Promise<number[] | null> {
  const read = readers[/\.([^./]+)$/.exec(file.name.toLowerCase())?.[1] ?? ""];
  return read && file.size <= kMostBytes ? read(file) : null;
}
