// Numbers as tables and keys show them.
import type { Json } from "./types";

/** Four digits, and all of whole numbers, as of ids; vectors parted by commas. NaN is "–". */
export const shortText = (v: Json | undefined): string =>
  typeof v === "number" ? String(Number.isSafeInteger(v) ? v : Number(v.toPrecision(4))) : Array.isArray(v) ? v.map(shortText).join(", ") : v == null ? "–" : String(v);
