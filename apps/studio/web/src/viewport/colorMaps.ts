// Colour maps of the viewport: control points at equal distances, linear between them.

export const kColorMaps = {
  viridis: ["#440154", "#414287", "#2a788e", "#22a884", "#7ad151", "#fde725"],
  turbo: ["#30123b", "#4686fb", "#1ae4b6", "#a4fc3c", "#fba238", "#d23105", "#7a0403"],
  cividis: ["#00224e", "#35456c", "#666970", "#948e77", "#c8b866", "#fee838"],
  coolwarm: ["#3b4cc0", "#8db0fe", "#dddddd", "#f49a7b", "#b40426"],
  water: ["#124a94", "#1f72c4", "#4aa3e2", "#8cc8ee", "#f0f8fd"],
} as const;

export type ColorMapName = keyof typeof kColorMaps;

/** Colours from low to high values, as "#rrggbb". */
export type Ramp = readonly string[];

export const isColorMap = (name: unknown): name is ColorMapName => typeof name === "string" && name in kColorMaps;

const kSize = 256;

/** RGBA bytes of a row of 256 texels. */
export function colorTable(ramp: Ramp) {
  const stops = ramp.map((c) => [1, 3, 5].map((i) => parseInt(c.slice(i, i + 2), 16)));
  const table = new Uint8Array(4 * kSize);
  for (let i = 0; i < kSize; ++i) {
    const at = (i / (kSize - 1)) * (stops.length - 1);
    const k = Math.min(Math.floor(at), stops.length - 2);
    for (let c = 0; c < 3; ++c) table[4 * i + c] = Math.round(stops[k]![c]! + (at - k) * (stops[k + 1]![c]! - stops[k]![c]!));
    table[4 * i + 3] = 255;
  }
  return table;
}

export const gradient = (ramp: Ramp): string => `linear-gradient(to right, ${ramp.join(", ")})`;
