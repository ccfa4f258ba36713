// Numbers as tables and keys show them.
import type { Json } from "./types";

/** Four digits; vectors parted by commas. NaN is "–". */
export const shortText = (v: Json | undefined): string =>
  typeof v === "number" ? String(Number(v.toPrecision(4))) : Array.isArray(v) ? v.map(shortText).join(", ") : v == null ? "–" : String(v);
