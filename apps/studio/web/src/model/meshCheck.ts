// What a mesh that was dropped is like: its size, whether it is closed, and which unit it seems to have.

export interface MeshCheck {
  triangles: number;
  low: number[];
  high: number[];
  /** Edges that do not have two triangles, one on each side. */
  open: number;
  /** Closed, but with its triangles facing inwards. */
  insideOut: boolean;
}

/** Corners nearer to each other than this are one, of the diagonal of the box around all. */
const kWeld = 1e-6;

/** Numbers the corners of triangles by their places. */
function welded(corners: ArrayLike<number>, low: number[], high: number[]): Int32Array {
  const cell = kWeld * Math.hypot(...high.map((h, i) => h - low[i]!)) || 1;
  const known = new Map<string, number>();
  return Int32Array.from({ length: corners.length / 3 }, (_, k) => {
    const key = [0, 1, 2].map((i) => Math.round((corners[3 * k + i]! - low[i]!) / cell)).join();
    const at = known.get(key) ?? known.size;
    known.set(key, at);
    return at;
  });
}

/** Of each edge, how often it is gone along one way less how often the other way, and how often in all. */
function openEdges(corners: Int32Array): number {
  const edges = new Map<number, [balance: number, uses: number]>();
  for (let t = 0; t < corners.length; t += 3)
    for (let i = 0; i < 3; ++i) {
      const [a, b] = [corners[t + i]!, corners[t + ((i + 1) % 3)]!];
      if (a === b) continue;
      const key = Math.min(a, b) * corners.length + Math.max(a, b);
      const edge = edges.get(key) ?? [0, 0];
      edges.set(key, [edge[0] + (a < b ? 1 : -1), edge[1] + 1]);
    }
  return [...edges.values()].filter(([balance, uses]) => balance !== 0 || uses !== 2).length;
}

/** Six times what the triangles enclose, about the lower corner. */
function volume6(c: ArrayLike<number>, low: number[]): number {
  let sum = 0;
  const at = (k: number, i: number) => c[k + i]! - low[i]!;
  for (let t = 0; t < c.length; t += 9) {
    const [x, y, z] = [0, 1, 2].map((i) => at(t + 3, (i + 1) % 3) * at(t + 6, (i + 2) % 3) - at(t + 3, (i + 2) % 3) * at(t + 6, (i + 1) % 3));
    sum += at(t, 0) * x! + at(t, 1) * y! + at(t, 2) * z!;
  }
  return sum;
}

/** `corners`: nine numbers for each triangle. */
export function checkMesh(corners: ArrayLike<number>): MeshCheck {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < corners.length; ++i) {
    low[i % 3] = Math.min(low[i % 3]!, corners[i]!);
    high[i % 3] = Math.max(high[i % 3]!, corners[i]!);
  }
  const open = openEdges(welded(corners, low, high));
  return { triangles: corners.length / 9, low, high, open, insideOut: open === 0 && volume6(corners, low) < 0 };
}

export interface Unit {
  name: string;
  /** m */
  size: number;
}

export const kUnits: Unit[] = [{ name: "m", size: 1 }, { name: "mm", size: 1e-3 }, { name: "cm", size: 1e-2 }, { name: "in", size: 0.0254 }];

/** How much larger or smaller than the scene something may be that belongs in it. */
const kLargest = 5, kSmallest = 0.02;

/** The unit in which a mesh as long as that fits a scene as long as this, m: metres if they do, or if none does. */
export const guessUnit = (long: number, scene: number): Unit =>
  kUnits.find((u) => u.size * long <= kLargest * scene && u.size * long >= kSmallest * scene) ?? kUnits[0]!;

export const longestSide = ({ low, high }: MeshCheck): number => Math.max(...high.map((h, i) => h - low[i]!));
