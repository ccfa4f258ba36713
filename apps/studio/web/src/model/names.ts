// Names of files.

const kDigits = 3;

/** "A jet fills a goblet" → "a_jet_fills_a_goblet" */
export const fileNameOf = (title: string | undefined): string =>
  (title ?? "").toLowerCase().replace(/[^a-z0-9]+/g, "_").replace(/^_|_$/g, "") || "scene";

/** The path, or if it is taken, the first with a number that is not: "a_001.mp4". */
export function withNumber(path: string, isTaken: (path: string) => boolean): string {
  const [, stem, ending] = /^(.*?)(\.[^./]*)?$/s.exec(path)!;
  for (let n = 0; ; ++n) {
    const next = n === 0 ? path : `${stem}_${String(n).padStart(kDigits, "0")}${ending ?? ""}`;
    if (!isTaken(next)) return next;
  }
}
